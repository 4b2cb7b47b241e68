// SPDX-License-Identifier: BSD-3-Clause
// Evidence of a HEARTBEAT, to the microsecond, and when another one is requested.
#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

#include "firmware/app/mode_evidence.hpp"

namespace jink::app {
namespace {

constexpr TimePoint kFirstHeard{7'000'000};

/// `time` after the first HEARTBEAT, and so many microseconds later.
TimePoint moment(Seconds time, std::int64_t later_us = 0)
{
    return {kFirstHeard.us + std::llround(static_cast<double>(time) * 1e6) + later_us};
}

/// The autopilot's own HEARTBEATs with these intervals; the last is received at `moment(sum)`.
ModeEvidence heard_in_gaps(std::initializer_list<Seconds> gaps)
{
    ModeEvidence evidence;
    Seconds at = 0.0F;
    evidence.note_heartbeat(moment(at));
    for (const Seconds gap : gaps) {
        at += gap;
        evidence.note_heartbeat(moment(at));
    }
    return evidence;
}

/// Whether 1.5 periods of this length, and not more, pass as fresh.
::testing::AssertionResult has_period(const ModeEvidence& evidence, Seconds last, Seconds period)
{
    if (!evidence.is_fresh(moment(last + 1.5F * period, -2))) {
        return ::testing::AssertionFailure() << "shorter than " << period;
    }
    if (evidence.is_fresh(moment(last + 1.5F * period, 2))) {
        return ::testing::AssertionFailure() << "longer than " << period;
    }
    return ::testing::AssertionSuccess();
}

TEST(ModeEvidenceEdges, NothingHeardProvesNothing)
{
    ModeEvidence evidence;
    EXPECT_FALSE(evidence.is_newer_than_requests());
    EXPECT_FALSE(evidence.is_fresh(moment(0.0F)));
    EXPECT_FALSE(evidence.is_fresh(TimePoint{}));
    EXPECT_FALSE(evidence.was_silent(0.5F, moment(100.0F)));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(0.0F)));
    EXPECT_FALSE(evidence.is_clear_to_ask(TimePoint{}));
    evidence.note_accepted(moment(0.0F));
    EXPECT_FALSE(evidence.is_newer_than_requests());
}

TEST(ModeEvidenceEdges, HeartbeatIsFreshForOneAndAHalfPeriods)
{
    const ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    EXPECT_TRUE(evidence.is_fresh(moment(4.5F)));
    EXPECT_FALSE(evidence.is_fresh(moment(4.5F, 1)));
    EXPECT_TRUE(has_period(ModeEvidence{heard_in_gaps({})}, 0.0F, ModeEvidence::kLongestPeriod)) << "not measured yet";
}

TEST(ModeEvidenceEdges, SilenceIsLongerThanItsTime)
{
    const ModeEvidence evidence = heard_in_gaps({});
    EXPECT_FALSE(evidence.was_silent(2.0F, moment(2.0F)));
    EXPECT_TRUE(evidence.was_silent(2.0F, moment(2.0F, 1)));
}

TEST(ModeEvidenceEdges, PeriodIsTheMedianOfTheLastThreeGaps)
{
    for (const auto& [a, b, c] : {std::tuple{0.4F, 0.6F, 0.8F},
                                  {0.4F, 0.8F, 0.6F},
                                  {0.6F, 0.4F, 0.8F},
                                  {0.6F, 0.8F, 0.4F},
                                  {0.8F, 0.4F, 0.6F},
                                  {0.8F, 0.6F, 0.4F}}) {
        EXPECT_TRUE(has_period(heard_in_gaps({a, b, c}), a + b + c, 0.6F)) << a << ' ' << b << ' ' << c;
        EXPECT_TRUE(has_period(heard_in_gaps({0.3F, 0.3F, 0.3F, a, b, c}), 0.9F + a + b + c, 0.6F));
    }
    EXPECT_TRUE(has_period(heard_in_gaps({0.4F}), 0.4F, 1.0F)) << "one gap alone proves no period";
    EXPECT_TRUE(has_period(heard_in_gaps({0.4F, 0.4F}), 0.8F, 0.4F));
}

TEST(ModeEvidenceEdges, PeriodLiesWithinItsBounds)
{
    EXPECT_TRUE(has_period(heard_in_gaps({0.05F, 0.05F, 0.05F}), 0.15F, ModeEvidence::kShortestPeriod));
    EXPECT_TRUE(has_period(heard_in_gaps({3.0F, 3.0F, 3.0F}), 9.0F, ModeEvidence::kLongestPeriod));
}

TEST(ModeEvidenceEdges, HeartbeatAtTheInstantOfTheRequestIsNotNewer)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    evidence.note_request(moment(1.5F));
    EXPECT_FALSE(evidence.is_newer_than_requests());
    evidence.note_heartbeat(moment(1.5F));
    EXPECT_FALSE(evidence.is_newer_than_requests());
    evidence.note_heartbeat(moment(1.5F, 1));
    EXPECT_TRUE(evidence.is_newer_than_requests());
}

TEST(ModeEvidenceEdges, HeartbeatBeforeTheAcceptanceIsNotNewerAndOneOfItsTickIs)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    evidence.note_request(moment(1.5F));
    evidence.note_heartbeat(moment(1.6F));
    evidence.note_accepted(moment(1.6F));
    EXPECT_TRUE(evidence.is_newer_than_requests()) << "it may have come after the answer";
    evidence.note_accepted(moment(1.7F));
    EXPECT_FALSE(evidence.is_newer_than_requests());
    evidence.note_heartbeat(moment(1.8F));
    EXPECT_TRUE(evidence.is_newer_than_requests());
    evidence.note_request(moment(2.0F));
    evidence.note_accepted(moment(1.9F));
    evidence.note_heartbeat(moment(1.95F));
    EXPECT_FALSE(evidence.is_newer_than_requests()) << "an answer never moves the request back";
}

TEST(ModeEvidenceEdges, AcceptanceOfWhatWasNeverAskedForChangesNothing)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    evidence.note_accepted(moment(1.5F));
    EXPECT_TRUE(evidence.is_newer_than_requests());
    EXPECT_TRUE(evidence.is_clear_to_ask(moment(1.05F)));
}

TEST(ModeEvidenceEdges, YoungHeartbeatIsEvidenceByItself)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    ModeEvidence older = evidence;
    EXPECT_TRUE(evidence.is_clear_to_ask(moment(3.0F + ModeEvidence::kFresh)));
    EXPECT_FALSE(older.is_clear_to_ask(moment(3.0F + ModeEvidence::kFresh, 1)));
}

TEST(ModeEvidenceEdges, WithoutAnAnswerAnOlderOneIsGoodEnoughAfterTheWait)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    const Seconds began = 3.5F;
    for (int i = 0; i < 12; ++i) {
        EXPECT_FALSE(evidence.is_clear_to_ask(moment(began + 0.02F * static_cast<float>(i))));
        static_cast<void>(evidence.is_due(false, moment(began + 0.02F * static_cast<float>(i))));
    }
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(began + ModeEvidence::kAnswer, -1)));
    EXPECT_TRUE(evidence.is_clear_to_ask(moment(began + ModeEvidence::kAnswer)));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(4.5F, 1))) << "and older than 1.5 periods it is not";
}

TEST(ModeEvidenceEdges, WaitBeginsAnewAfterATickInWhichNothingWasWanted)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.5F)));
    static_cast<void>(evidence.is_due(false, moment(3.5F)));
    static_cast<void>(evidence.is_due(false, moment(3.6F)));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.8F))) << "the request of before was given up";
    EXPECT_TRUE(evidence.is_clear_to_ask(moment(4.05F)));
}

TEST(ModeEvidenceEdges, WaitBeginsAnewAfterARequest)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.5F)));
    evidence.note_request(moment(3.55F));
    evidence.note_heartbeat(moment(3.6F));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.8F))) << "the wait of the next request";
}

TEST(ModeEvidenceEdges, OnlyWhatIsNeededOrKeptFreshIsAskedFor)
{
    const auto due = [](bool needed, bool kept_fresh, Seconds age) {
        ModeEvidence evidence = heard_in_gaps({1.0F});
        if (needed) {
            evidence.need_heartbeat();
        }
        return evidence.is_due(kept_fresh, moment(1.0F + age));
    };
    EXPECT_FALSE(due(false, false, 5.0F));
    for (const bool needed : {false, true}) {
        EXPECT_TRUE(due(needed, !needed, 0.05F)) << "half of kFresh";
        EXPECT_FALSE(due(needed, !needed, 0.049F)) << "young enough";
    }
    EXPECT_TRUE(ModeEvidence().is_due(true, moment(0.0F)));
    EXPECT_TRUE(ModeEvidence().is_due(true, TimePoint{1000})) << "wherever the clock begins";
    EXPECT_FALSE(ModeEvidence().is_due(false, moment(0.0F)));
}

TEST(ModeEvidenceEdges, HeartbeatThatIsNotNewerThanTheRequestIsAskedForHoweverYoung)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    evidence.note_request(moment(1.01F));
    EXPECT_TRUE(evidence.is_due(true, moment(1.02F)));
}

TEST(ModeEvidenceEdges, NeedLastsOneTick)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    evidence.need_heartbeat();
    EXPECT_TRUE(evidence.is_due(false, moment(2.0F)));
    EXPECT_FALSE(evidence.is_due(false, moment(2.5F)));
    evidence.need_heartbeat();
    evidence.note_request(moment(2.6F));
    EXPECT_FALSE(evidence.is_due(false, moment(2.7F))) << "it was asked for a mode in that tick";
}

TEST(ModeEvidenceEdges, AskedAgainAfterThePause)
{
    ModeEvidence evidence = heard_in_gaps({1.0F});
    EXPECT_TRUE(evidence.is_due(true, moment(2.0F)));
    EXPECT_FALSE(evidence.is_due(true, moment(2.0F + ModeEvidence::kPoll, -1)));
    EXPECT_TRUE(evidence.is_due(true, moment(2.0F + ModeEvidence::kPoll)));
}

/// HEARTBEATs that were asked for come, but old: the wait is for one that does not come.
TEST(ModeEvidenceEdges, AnAnswerThatIsUnderWayIsWaitedFor)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.5F)));
    evidence.note_heartbeat(moment(3.7F));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.82F))) << "0.32 s after the wait began";
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.7F + ModeEvidence::kAnswer, -1)));
    EXPECT_TRUE(evidence.is_clear_to_ask(moment(3.7F + ModeEvidence::kAnswer)));
}

TEST(ModeEvidenceEdges, NeedOfAHeartbeatAloneIsNoWaitForItsAnswer)
{
    ModeEvidence evidence = heard_in_gaps({1.0F, 1.0F, 1.0F});
    evidence.need_heartbeat();
    static_cast<void>(evidence.is_due(false, moment(3.48F)));
    EXPECT_FALSE(evidence.is_clear_to_ask(moment(3.5F))) << "the wait begins with the request";
}

}  // namespace
}  // namespace jink::app
