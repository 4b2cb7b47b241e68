// SPDX-License-Identifier: BSD-3-Clause
// SETUP_SIGNING: permitted senders and times, and reports and output afterwards.
#include <gtest/gtest.h>

#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

constexpr std::uint64_t kSetupTime = 34'715'520'000'000;

class SetupSigningTest : public EndpointTest {
protected:
    void SetUp() override
    {
        signing.let_keys_be_set(true);
        signing.advance_to(kSetupTime);
        endpoint = std::make_unique<Endpoint>(EndpointOptions{}, &signing);
        heartbeat(3, 3, false);
        clear();
        static_cast<void>(sent());
    }
    static Signing::Key key_of(unsigned char fill)
    {
        Signing::Key key;
        key.fill(std::byte{fill});
        return key;
    }
    static SetupSigning request(unsigned char fill, std::uint64_t time = kSetupTime)
    {
        SetupSigning m;
        m.target_system = kSystem;
        m.target_component = kUs;
        m.initial_timestamp = time;
        m.secret_key.fill(fill);
        return m;
    }
    /// From a ground station that signs with `key`, a little ahead of us.
    template <Message M>
    void signed_from_ground(const M& message, unsigned char key)
    {
        Signing theirs(key_of(key), 2, signing.time());
        Bytes frame(kMaxFrame);
        frame.resize(encode_signed(message, {255, 190, sequence++}, theirs, frame));
        endpoint->receive(frame, now, *inbox);
    }
    /// The text that is the only answer, received with `key` (nullptr: without).
    std::string answer(Signing* key)
    {
        Parser listener(key);
        const auto bytes = endpoint->pending();
        const std::vector<Received> frames = parse(listener, bytes);
        endpoint->consume(bytes.size());
        Statustext m;
        EXPECT_EQ(frames.size(), 1U);
        if (frames.empty() || !decode(frames[0].frame(), m)) {
            return "no text";
        }
        EXPECT_EQ(frames[0].is_signed, key != nullptr);
        return {m.text.data(), strnlen(m.text.data(), m.text.size())};
    }

    Signing signing;
};

TEST_F(SetupSigningTest, TheFirstKeyComesUnsignedAndHoldsFromThenOn)
{
    from(255, 190, request(9));
    ASSERT_TRUE(signing.has_key());
    EXPECT_EQ(signing.key(), key_of(9));
    EXPECT_EQ(count().keys_set, 1U);
    Signing ears_key(key_of(9), 3, kSetupTime);
    EXPECT_EQ(answer(&ears_key), "jink: signing key set");
    clear();
    heartbeat(3, 3, false);
    EXPECT_FALSE(inbox->has_autopilot) << "not signed";
    EXPECT_EQ(endpoint->parser_diagnostics().unsigned_refused, 1U);
    from(255, 190, request(10));
    EXPECT_EQ(signing.key(), key_of(9)) << "the second comes unsigned: not even heard";
}

TEST_F(SetupSigningTest, AChangeTakesTheKey)
{
    from(255, 190, request(9));
    signed_from_ground(request(10), 11);
    EXPECT_EQ(signing.key(), key_of(9)) << "signed with another key";
    signed_from_ground(request(10), 9);
    EXPECT_EQ(signing.key(), key_of(10));
    EXPECT_EQ(count().keys_set, 2U);
    EXPECT_EQ(signing.generation(), 2U);
}

TEST_F(SetupSigningTest, AnUnsignedChangeIsRefusedAlsoWhereUnsignedFramesAreTaken)
{
    from(255, 190, request(9));
    UnsignedFrames frames;
    frames.all = true;
    signing.take_unsigned(frames);
    static_cast<void>(sent());
    endpoint->consume(endpoint->pending().size());
    from(255, 190, request(10));
    from(255, 190, request(0, 0));
    EXPECT_EQ(signing.key(), key_of(9));
    EXPECT_TRUE(signing.has_key());
    EXPECT_EQ(count().keys_refused, 2U);
}

TEST_F(SetupSigningTest, ZerosTakeTheKeyAwayAndTheAnswerIsStillSigned)
{
    from(255, 190, request(9));
    endpoint->consume(endpoint->pending().size());
    signed_from_ground(request(0, 0), 9);
    EXPECT_FALSE(signing.has_key());
    Signing ears_key(key_of(9), 3, kSetupTime);
    EXPECT_EQ(answer(&ears_key), "jink: signing is off");
    clear();
    heartbeat(3, 3, false);
    EXPECT_TRUE(inbox->has_autopilot);
}

TEST_F(SetupSigningTest, ArmedVehiclesKeepTheirKey)
{
    heartbeat(3, 3, true);
    from(255, 190, request(9));
    EXPECT_FALSE(signing.has_key());
    EXPECT_EQ(answer(nullptr), "jink: no signing key set: armed");
    EXPECT_EQ(count().keys_refused, 1U);
}

TEST_F(SetupSigningTest, WithoutAPlaceToStoreItNoKeyIsTaken)
{
    signing.let_keys_be_set(false);
    from(255, 190, request(9));
    EXPECT_FALSE(signing.has_key());
    EXPECT_EQ(answer(nullptr), "jink: no signing key set: no place to store it");
    endpoint = std::make_unique<Endpoint>();  // as boards have it
    heartbeat(3, 3, false);
    from(255, 190, request(9));
    EXPECT_EQ(count().keys_refused, 1U);
}

TEST_F(SetupSigningTest, OthersAndBroadcastsAreNotForUs)
{
    for (const auto& [system, component] :
         {std::pair{kSystem, 1}, {kSystem, 0}, {0, 0}, {0, int{kUs}}, {8, int{kUs}}}) {
        SetupSigning m = request(9);
        m.target_system = static_cast<std::uint8_t>(system);
        m.target_component = static_cast<std::uint8_t>(component);
        from(255, 190, m);
        EXPECT_FALSE(signing.has_key()) << system << " " << component;
    }
    EXPECT_EQ(count().keys_refused, 0U);
    EXPECT_TRUE(endpoint->pending().empty());
}

TEST_F(SetupSigningTest, ATimeNearTheEndOf48BitsIsRefusedAndAnEarlierOneMovesNothingBack)
{
    for (const std::uint64_t time : {Signing::kLatestTime + 1, Signing::kLatestTime, Signing::kLatestStart + 1}) {
        from(255, 190, request(9, time));
        EXPECT_FALSE(signing.has_key()) << time;
        EXPECT_EQ(answer(nullptr), "jink: no signing key set: time out of range");
        EXPECT_EQ(signing.time(), kSetupTime) << "nobody without a key may spend our time";
    }
    from(255, 190, request(9, 5));
    EXPECT_TRUE(signing.has_key());
    EXPECT_GE(signing.time(), kSetupTime);
    signed_from_ground(request(9, kSetupTime + 60'000'000), 9);
    EXPECT_GE(signing.time(), kSetupTime + 60'000'000);
}

TEST_F(SetupSigningTest, AnAutopilotThatSignsIsHeardBeforeThereIsAKey)
{
    // So that a ground station can hand over the key on a link that signs already.
    signing = Signing();
    signing.let_keys_be_set(true);
    endpoint = std::make_unique<Endpoint>(EndpointOptions{}, &signing);
    Signing autopilots(key_of(9), 0, kSetupTime);
    Heartbeat m;
    m.autopilot = 3;
    Bytes frame(kMaxFrame);
    frame.resize(encode_signed(m, {kSystem, 1, 0}, autopilots, frame));
    endpoint->receive(frame, now, *inbox);
    EXPECT_TRUE(inbox->has_autopilot);
    signed_from_ground(request(9), 9);
    EXPECT_TRUE(signing.has_key());
    EXPECT_EQ(endpoint->parser_diagnostics().signed_unchecked, 2U);
}

}  // namespace
}  // namespace jink::link::mavlink
