// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/mode_evidence.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace jink::app {
namespace {

constexpr TimePoint kHeardFrom{1'000'000};

/// Unsolicited HEARTBEATs at 0, 1, .. 4 s: the period is 1 s.
ModeEvidence heard_once_a_second()
{
    ModeEvidence evidence;
    for (int i = 0; i < 5; ++i) {
        evidence.note_heartbeat(kHeardFrom + static_cast<float>(i));
    }
    return evidence;
}

TEST(ModeEvidence, DiscardedHeartbeatProvesNothingUntilTheNextOne)
{
    ModeEvidence evidence = heard_once_a_second();
    EXPECT_TRUE(evidence.is_newer_than_requests());
    EXPECT_TRUE(evidence.is_fresh(kHeardFrom + 4.02F));
    evidence.discard();
    EXPECT_FALSE(evidence.is_newer_than_requests());
    EXPECT_FALSE(evidence.is_fresh(kHeardFrom + 4.02F));
    EXPECT_FALSE(evidence.is_clear_to_ask(kHeardFrom + 4.02F));
    evidence.note_heartbeat(kHeardFrom + 4.04F);
    EXPECT_TRUE(evidence.is_newer_than_requests());
    EXPECT_TRUE(evidence.is_fresh(kHeardFrom + 4.06F));
    EXPECT_TRUE(evidence.is_clear_to_ask(kHeardFrom + 4.06F));
}

/// Requests of a HEARTBEAT within 2 s of ticks of 20 ms, without an answer; the shortest time between two of them.
struct Polls {
    int count = 0;
    float shortest = 1e9F;
};

Polls polls_without_an_answer(bool waits, bool kept_fresh)
{
    ModeEvidence evidence = heard_once_a_second();
    Polls polls;
    TimePoint last = kHeardFrom;
    for (int i = 0; i < 100; ++i) {
        const TimePoint now = kHeardFrom + 4.5F + 0.02F * static_cast<float>(i);
        if (waits) {
            evidence.need_heartbeat();
        }
        if (evidence.is_due(kept_fresh, now)) {
            polls.shortest = polls.count > 0 ? std::min(polls.shortest, now - last) : polls.shortest;
            ++polls.count;
            last = now;
        }
    }
    return polls;
}

TEST(ModeEvidence, UnansweredPollIsRepeatedAfterThePauseAndNotBefore)
{
    for (const bool waits : {true, false}) {
        const Polls polls = polls_without_an_answer(waits, !waits);
        EXPECT_GE(polls.count, 16) << "every kPoll, in whole ticks";
        EXPECT_LE(polls.count, 20);
        EXPECT_GE(polls.shortest, ModeEvidence::kPoll - 1e-4F);
    }
    EXPECT_EQ(polls_without_an_answer(false, false).count, 0);
}

TEST(ModeEvidence, AnswerEndsThePause)
{
    ModeEvidence evidence = heard_once_a_second();
    EXPECT_TRUE(evidence.is_due(true, kHeardFrom + 4.5F));
    evidence.note_heartbeat(kHeardFrom + 4.52F);
    evidence.note_request(kHeardFrom + 4.54F);
    EXPECT_TRUE(evidence.is_due(true, kHeardFrom + 4.56F)) << "the next question, not the last one again";
}

/// Each HEARTBEAT of the autopilot's own is followed after `delay` by one that was asked for.
TEST(ModeEvidence, GapsToAndFromAHeartbeatThatWasAskedForAreNotThePeriod)
{
    for (const float delay : {0.4F, 0.6F}) {
        ModeEvidence evidence = heard_once_a_second();
        for (int i = 5; i < 12; ++i) {
            const TimePoint asked = kHeardFrom + static_cast<float>(i - 1) + delay;
            ASSERT_TRUE(evidence.is_due(true, asked + -0.02F)) << i;
            evidence.note_heartbeat(asked);
            evidence.note_heartbeat(kHeardFrom + static_cast<float>(i));
        }
        EXPECT_TRUE(evidence.is_fresh(kHeardFrom + 12.4F)) << "1.5 periods of 1 s, " << delay;
        EXPECT_FALSE(evidence.is_fresh(kHeardFrom + 12.6F)) << delay;
    }
}

TEST(ModeEvidence, GapBetweenTwoHeartbeatsThatWereAskedForIsNotThePeriod)
{
    ModeEvidence evidence = heard_once_a_second();
    for (int i = 1; i <= 9; ++i) {
        const TimePoint now = kHeardFrom + 4.0F + 0.3F * static_cast<float>(i);
        ASSERT_TRUE(evidence.is_due(true, now + -0.02F)) << i;
        evidence.note_heartbeat(now);
    }
    EXPECT_TRUE(evidence.is_fresh(kHeardFrom + 6.7F + 1.4F));
}

TEST(ModeEvidence, PeriodFollowsTheAutopilotsOwnHeartbeats)
{
    ModeEvidence evidence = heard_once_a_second();
    for (int i = 1; i <= 3; ++i) {
        evidence.note_heartbeat(kHeardFrom + 4.0F + 0.4F * static_cast<float>(i));
    }
    EXPECT_TRUE(evidence.is_fresh(kHeardFrom + 5.2F + 0.58F));
    EXPECT_FALSE(evidence.is_fresh(kHeardFrom + 5.2F + 0.62F));
}

}  // namespace
}  // namespace jink::app
