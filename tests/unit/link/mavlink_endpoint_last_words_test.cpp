// SPDX-License-Identifier: BSD-3-Clause
// The message for a processor fault, composed beforehand.
#include <gtest/gtest.h>

#include "firmware/link/mavlink/text.hpp"
#include "hal/last_words.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink::test {
namespace {

class EndpointLastWords : public EndpointTest {
protected:
    std::vector<Received> words(bool hold, std::string_view text, std::size_t room = hal::LastWords::kMax)
    {
        Bytes out(room);
        const std::size_t n = endpoint->compose_last_words(out, hold, text);
        Parser reader;
        return parse(reader, std::span<const std::byte>(out).first(n));
    }
    static CommandLong command(const Received& r)
    {
        CommandLong m;
        EXPECT_TRUE(decode(r.frame(), m));
        return m;
    }
    static Heartbeat state(const Received& r)
    {
        Heartbeat m;
        EXPECT_TRUE(decode(r.frame(), m));
        return m;
    }
};

TEST_F(EndpointLastWords, InControlTheyAskForTheHoldModeTwice)
{
    heartbeat(3, 4);
    endpoint->send_text(Severity::info, "one frame before");
    static_cast<void>(sent());
    const auto frames = words(true, "gone");
    ASSERT_EQ(frames.size(), 4U);
    const CommandLong first = command(frames[0]);
    EXPECT_EQ(first.command, 176);
    EXPECT_EQ(first.target_system, kSystem);
    EXPECT_EQ(first.target_component, 1);
    EXPECT_EQ(first.param1, 129.0F);
    EXPECT_EQ(first.param2, 17.0F);  // BRAKE
    EXPECT_EQ(first.confirmation, 0);
    EXPECT_EQ(state(frames[1]).system_status, 6);
    EXPECT_EQ(state(frames[1]).type, 18);
    Statustext text;
    ASSERT_TRUE(decode(frames[2].frame(), text));
    EXPECT_EQ(text_of(text.text), "gone");
    EXPECT_EQ(text.severity, 2);
    EXPECT_EQ(command(frames[3]).param2, 17.0F);
    EXPECT_EQ(command(frames[3]).confirmation, 1);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].header.sequence, 1 + i) << "they go on where the frames sent ended";
        EXPECT_EQ(frames[i].header.system_id, kSystem);
        EXPECT_EQ(frames[i].header.component_id, kUs);
    }
    // The sent frames are numbered as if the last words did not exist.
    EXPECT_TRUE(endpoint->pending().empty());
    endpoint->send_heartbeat(SystemState::active);
    const auto next = sent();
    ASSERT_EQ(next.size(), 1U);
    EXPECT_EQ(next[0].header.sequence, 1);
}

TEST_F(EndpointLastWords, TheHoldModeIsThatOfTheStack)
{
    heartbeat(12, px4_mode(6, 0));
    auto frames = words(true, "");
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(command(frames[0]).param2, 4.0F);  // AUTO
    EXPECT_EQ(command(frames[0]).param3, 3.0F);  // LOITER
    heartbeat(3, 15, true, 1);
    frames = words(true, "");
    EXPECT_EQ(command(frames[0]).param2, 12.0F);  // a plane's LOITER
}

TEST_F(EndpointLastWords, OutOfControlTheyAskForNothing)
{
    heartbeat();
    const auto frames = words(false, "gone");
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(state(frames[0]).system_status, 5);
    EXPECT_EQ(frames[1].message_id, Statustext::kInfo.id);
}

TEST_F(EndpointLastWords, WithoutAnAutopilotThereIsNobodyToAsk)
{
    const auto frames = words(true, "gone");
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].message_id, Heartbeat::kInfo.id);
    EXPECT_EQ(frames[0].header.system_id, 1);
}

TEST_F(EndpointLastWords, NoRoomMeansNoWordsRatherThanHalfOfThem)
{
    heartbeat(3, 4);
    Bytes all(hal::LastWords::kMax);
    const std::size_t size = endpoint->compose_last_words(all, true, "0123456789");
    for (std::size_t room = 0; room < size; ++room) {
        Bytes out(room);
        EXPECT_EQ(endpoint->compose_last_words(out, true, "0123456789"), 0U) << room;
    }
    Bytes out(size);
    EXPECT_EQ(endpoint->compose_last_words(out, true, "0123456789"), size);
}

TEST(MavlinkLastWordsSigned, AreAcceptedAfterEverythingThatWasSentBefore)
{
    Signing::Key key;
    key.fill(std::byte{9});
    Signing ours(key, 1, 1000);
    Signing theirs(key, 2, 1000);
    const auto endpoint = std::make_unique<Endpoint>(EndpointOptions{}, &ours);
    const auto inbox = std::make_unique<Inbox>();
    Signing autopilots(key, 3, 5'000'000);  // ahead of us by 40 s: our time leaps after it
    Heartbeat m;
    m.autopilot = 3;
    Parser ears(&theirs);
    for (std::uint8_t step = 0; step < 20; ++step) {
        Bytes frame(kMaxFrame);
        frame.resize(encode_signed(m, {7, 1, step}, autopilots, frame));
        endpoint->receive(frame, {1000 + step}, *inbox);
        for (int i = 0; i < 5; ++i) {
            endpoint->send_text(Severity::info, "of this step");
        }
        // Composed before the step's frames are sent, and sent after all of them.
        Bytes words(hal::LastWords::kMax);
        const std::size_t n =
            endpoint->compose_last_words(words, true, "12345678901234567890123456789012345678901234567890");
        ASSERT_GT(n, 0U) << "the longest words there are fit";
        const auto heard = parse(ears, endpoint->pending());
        endpoint->consume(endpoint->pending().size());
        EXPECT_EQ(heard.size(), 5U);
        const auto last = parse(ears, std::span<const std::byte>(words).first(n));
        EXPECT_EQ(last.size(), 4U) << "step " << int{step}
                                   << ", refused as stale: " << ears.diagnostics().stale_signature;
    }
}

}  // namespace
}  // namespace jink::link::mavlink::test
