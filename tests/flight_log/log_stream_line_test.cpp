// SPDX-License-Identifier: BSD-3-Clause
// A board's log over the link: receivers and their commands, acknowledgements, the line's share, full and lost lines.
#include <gtest/gtest.h>

#include "tests/flight_log/stream_content.hpp"
#include "tests/flight_log/stream_flight.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using link::CommandResult;

/// A receiver that acknowledges a part only once is lost with its acknowledgement: the log ends, and can begin anew.
TEST(LogStream, AReceiverThatDoesNotAcknowledgeIsGivenUp)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    s.lose_ack = 1.0;
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    s.fly(400);
    EXPECT_FALSE(s.stream->is_on());
    EXPECT_EQ(s.stream->counts().given_up, 1U);
    EXPECT_EQ(s.stream->counts().repeated, 49U);
    ASSERT_EQ(s.parts.size(), 50U) << "PX4's number of tries";
    for (std::size_t i = 1; i < s.parts.size(); ++i) {
        EXPECT_EQ(s.parts[i].sequence, 0);
        EXPECT_TRUE(s.parts[i].acknowledged);
        EXPECT_GE(s.parts[i].at.us - s.parts[i - 1].at.us, 50'000);
        EXPECT_LE(s.parts[i].at.us - s.parts[i - 1].at.us, 70'000) << "steps of 20 ms";
    }
    s.lose_ack = 0.0;
    s.receiver = {};
    ASSERT_EQ(s.ask(StreamFlight::kStart, 0.0F, 12), StreamFlight::kAccepted) << "another receiver";
    EXPECT_EQ(s.parts.back().to_system, 12);
    s.fly(10);
    EXPECT_EQ(s.ask(StreamFlight::kStop), StreamFlight::kAccepted);
    s.receiver = {};
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    EXPECT_TRUE(s.fly_to_data());
    EXPECT_EQ(s.stream->counts().starts, 3U);
}

/// Of the part that waits, by the receiver itself: everything else repeats the part.
TEST(LogStream, OnlyTheRightAcknowledgementGoesOn)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    s.listens = false;
    s.acknowledge(0);  // before there is a log
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    for (std::uint16_t part = 0; part < 5; ++part) {
        s.fly(4);
        ASSERT_EQ(s.parts.back().sequence, part);
        for (int i = 0; i < 5; ++i) {
            s.acknowledge(static_cast<std::uint16_t>(part + 1));
            s.acknowledge(static_cast<std::uint16_t>(part - 1));
            s.acknowledge(part, 254);
            s.acknowledge(part, StreamFlight::kGround, 1);
            s.fly(4);
            ASSERT_EQ(s.parts.back().sequence, part);
        }
        s.acknowledge(part);
        s.acknowledge(part);
        s.fly(2);  // the line's share may be used up for one step
        ASSERT_EQ(s.parts.back().sequence, part + 1);
    }
    EXPECT_GT(s.stream->counts().repeated, 10U);
}

TEST(LogStream, OneReceiverAtATimeAndOneFormat)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    EXPECT_EQ(s.ask(StreamFlight::kStop), StreamFlight::kAccepted) << "there is none to stop";
    for (const float format : {1.0F, -1.0F, 0.5F, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(s.ask(StreamFlight::kStart, format), number_of(CommandResult::denied));
    }
    EXPECT_FALSE(s.stream->is_on());
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    EXPECT_EQ(s.ask(StreamFlight::kStart, 0.0F, 254), number_of(CommandResult::temporarily_rejected));
    EXPECT_EQ(s.ask(StreamFlight::kStart, 0.0F, 255, 1), number_of(CommandResult::temporarily_rejected));
    const std::uint16_t reached = s.parts.back().sequence;
    EXPECT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted)
        << "the answer was lost: the same command once more";
    s.fly(100);
    EXPECT_GT(s.parts.back().sequence, reached);
    EXPECT_EQ(s.stream->counts().starts, 1U);
    EXPECT_EQ(read_content(s.receiver.file).end, ulog::End::complete);

    s.fly(500);
    s.receiver = {};
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted) << "ten seconds later it begins anew";
    EXPECT_EQ(s.parts.back().sequence, 0);
    ASSERT_TRUE(s.fly_to_data());
    s.fly(100);
    EXPECT_EQ(read_content(s.receiver.file).end, ulog::End::complete);
    EXPECT_EQ(s.ask(StreamFlight::kStop, 0.0F, 33), StreamFlight::kAccepted) << "from anyone: the receiver may be gone";
    EXPECT_FALSE(s.stream->is_on());
    EXPECT_EQ(s.stream->counts().refused, 6U);

    s.target_component = 195;
    s.command(StreamFlight::kStart);
    s.tick();
    EXPECT_FALSE(s.stream->is_on()) << "to another component";
}

/// Over any time: the share of the line and one part. And behind everything else of its step.
TEST(LogStream, TakesItsShareOfTheLineAtMost)
{
    for (const std::uint32_t baud : {9'600U, 57'600U, 115'200U, 921'600U}) {
        SCOPED_TRACE(baud);
        StreamFlight s(baud);
        ASSERT_TRUE(s.begin());
        for (int i = 0; i < 30; ++i) {
            s.f->obstacles.emplace_back(200.0F + 3.0F * static_cast<float>(i), 100.0F, 50.0F);
        }
        ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        for (int i = 0; i < 2'000; ++i) {
            s.tick();
            for (std::size_t j = 0; j + 1 < s.f->said.size(); ++j) {
                const std::uint32_t id = s.f->said[j].frame().message_id;
                ASSERT_TRUE(id != 266 && id != 267) << "the last frame of a step";
            }
        }
        ASSERT_GT(s.parts.size(), 5U);
        const double rate = baud / 10.0 * 0.1;
        for (std::size_t i = 0; i < s.parts.size(); ++i) {
            double sum = 0.0;
            for (std::size_t j = i; j < s.parts.size(); ++j) {
                sum += static_cast<double>(s.parts[j].frame);
                const double time = static_cast<double>(s.parts[j].at.us - s.parts[i].at.us) * 1e-6;
                ASSERT_LE(sum, rate * time + 280.0) << i << " to " << j;
            }
        }
        if (baud == 921'600U) {
            EXPECT_EQ(s.stream->ring().dropped(), 0U) << "thirty aircraft fit";
        }
        if (baud == 57'600U) {
            EXPECT_GT(s.stream->ring().dropped(), 0U);
        }
        const StreamContent c = read_content(s.receiver.file);
        EXPECT_TRUE(c.end == ulog::End::complete) << "after " << s.receiver.file.size();
    }
}

/// A line that takes less than jink itself sends: no part waits on it, nothing of jink's own is lost to the log, and
/// a dropout message follows.
/// A line that takes nothing for three seconds, then a changed parameter. False: the ring happens to have a place for
/// it.
bool stall_and_change(StreamFlight& s, int ticks_before)
{
    s.fly(ticks_before);
    s.see_a_mast();
    s.fly(200);
    const std::uint32_t full = s.f->endpoint.diagnostics().outbox_full;
    std::size_t parts = s.parts.size();
    s.f->port.room = 0;
    s.fly(2);
    for (int i = 0; i < 150; ++i) {
        const std::size_t waiting = s.f->endpoint.pending().size();
        s.tick();
        if (waiting > 0) {
            EXPECT_EQ(s.parts.size(), parts);
        }
        parts = s.parts.size();
    }
    EXPECT_GT(s.stream->ring().dropped(), 0U);
    EXPECT_EQ(s.f->endpoint.diagnostics().outbox_full, full);
    link::mavlink::ParamSet set;
    set.param_id = app::test::wire::param_name("JNK_LOOKAHEAD");
    set.param_type = 9;
    set.param_value = 11.0F;
    s.send(set);
    s.fly(20);
    return s.stream->ring().size() > flightlog::MessageRing::kBytes - 20;
}

TEST(LogStream, AFullLineIsLeftToTheRest)
{
    int stalled = 0;
    for (int ticks_before = 100; ticks_before < 120; ++ticks_before) {
        StreamFlight s;
        ASSERT_TRUE(s.begin());
        ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        ASSERT_TRUE(s.fly_to_data());
        stalled += stall_and_change(s, ticks_before) ? 1 : 0;
        s.f->port.room = 1U << 20U;
        s.fly(300);
        const StreamContent c = read_content(s.receiver.file);
        EXPECT_EQ(c.end, ulog::End::complete);
        EXPECT_GT(c.dropouts, 0);
        EXPECT_EQ(c.changed, (std::map<std::string, float>{{"JNK_LOOKAHEAD", 11.0F}})) << "a change is not lost";
        EXPECT_EQ(s.receiver.lost, 0) << "dropped before it was a part";
    }
    EXPECT_GT(stalled, 0) << "without a place for the change";
}

/// A port that is lost loses the part that is on it, and the receiver finds the next message.
TEST(LogStream, ALostPortIsAGap)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    s.fly(100);
    s.f->port.state = hal::PortState::lost;
    const std::size_t parts = s.parts.size();
    s.fly(100);
    EXPECT_EQ(s.parts.size(), parts);
    s.f->port.state = hal::PortState::open;
    s.fly(200);
    EXPECT_GT(s.parts.size(), parts);
    const StreamContent c = read_content(s.receiver.file);
    EXPECT_EQ(c.end, ulog::End::complete);
    EXPECT_GT(c.dropouts, 0);
}

/// Until data the receiver's silence is bounded in time too, where a slow line does not carry fifty repetitions.
TEST(LogStream, ASlowLineEndsTheWaiting)
{
    StreamFlight s(9'600);
    ASSERT_TRUE(s.begin());
    s.listens = false;
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    s.fly(400);
    EXPECT_TRUE(s.stream->is_on());
    s.fly(150);
    EXPECT_FALSE(s.stream->is_on()) << "ten seconds";
    EXPECT_LT(s.parts.size(), 10U);
    EXPECT_EQ(s.stream->counts().given_up, 1U);
}

}  // namespace
