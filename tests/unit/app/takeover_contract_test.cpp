// SPDX-License-Identifier: BSD-3-Clause
// The contract of the take-over, one sentence and one input at a time: conflicts, tries, vehicles, drops.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

TEST(TakeoverContract, ConflictLastsWhileItIsPredictedOrFlown)
{
    for (const Change& change : {kPredictedAlone, kFlownAlone}) {
        Bench overruled = commanding();
        overruled.step(wants(Beat::manual));
        Bench refused = declined();
        for (int i = 0; i < 5; ++i) {
            varied(overruled, wants(Beat::former, 1.0F), change);
            EXPECT_EQ(overruled.control(), Control::overruled);
            varied(refused, wants(Beat::former), change);
            EXPECT_EQ(refused.control(), Control::refused);
        }
        overruled.step(calm(Beat::former));
        EXPECT_EQ(overruled.control(), Control::autopilot);
        refused.step(calm(Beat::former));
        EXPECT_EQ(refused.control(), Control::autopilot);
    }
}

TEST(TakeoverContract, TriesAreThoseOfOneConflict)
{
    const auto more_requests = [](const Change& meanwhile) {
        Bench b = awaiting();
        b.step(wants(Beat::former, 1.01F));
        EXPECT_EQ(b.takeover.diagnostics().requests, 2U);
        b.step(fault(Beat::former));
        varied(b, fault(Beat::former), meanwhile);
        for (int i = 0; i < 12; ++i) {
            b.step(wants(Beat::former, 0.5F));
        }
        return b.takeover.diagnostics().requests - 2U;
    };
    EXPECT_EQ(more_requests([](TakeoverInput&) {}), 1U);
    EXPECT_EQ(more_requests(kPredictedAlone), 1U);
    EXPECT_EQ(more_requests(kFlownAlone), 1U);
    EXPECT_EQ(more_requests([](TakeoverInput& in) { in.wants_control = in.in_conflict = false; }), 3U);
}

TEST(TakeoverContract, NothingIsWantedBeforeTheSupervisorWantsControl)
{
    Bench b;
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(varied(b, wants(Beat::former), kPredictedAlone).action, TakeoverAction::none);
        EXPECT_FALSE(b.takeover.streaming());
    }
    varied(b, wants(Beat::former), kFlownAlone);
    EXPECT_TRUE(b.takeover.streaming());
}

TEST(TakeoverContract, RequestThatIsNoLongerWantedIsWaitedForAndNotRepeated)
{
    Bench b = awaiting();
    b.step(calm(Beat::former, 0.9F));
    EXPECT_EQ(b.control(), Control::requesting);
    EXPECT_EQ(b.step(calm(Beat::none, 0.2F)).action, TakeoverAction::none);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::took_over) << "a late grant is ours to give back";
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
    EXPECT_EQ(b.takeover.diagnostics().refused, 0U);
}

TEST(TakeoverContract, RequestThatIsNoLongerWantedAndShownToHaveFailedIsOver)
{
    Bench b = awaiting();
    b.step(calm(Beat::former, 1.1F));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::none);
    EXPECT_FALSE(b.takeover.streaming()) << "a pilot's external mode";
}

TEST(TakeoverContract, RefusalThatAHeartbeatConfirmsLeavesNoClaim)
{
    Bench b = awaiting();
    b.step(wants(Beat::former, 1.01F));
    b.step(wants(Beat::former, 1.01F));
    EXPECT_EQ(b.step(wants(Beat::former, 1.01F)).event, TakeoverEvent::refused);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::refused) << "a pilot's external mode";
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverContract, VehicleOnTheGroundDisarmedOrNotSteerableIsNeitherProvenNorTakenOver)
{
    const std::vector<Change> unfit{[](TakeoverInput& in) { in.report.landed = true; },
                                    [](TakeoverInput& in) { in.report.armed = false; },
                                    [](TakeoverInput& in) { in.report.steerable = false; },
                                    [](TakeoverInput& in) { in.may_act = false; },
                                    [](TakeoverInput& in) { in.report.mode = FlightMode::going_home; },
                                    [](TakeoverInput& in) { in.report.mode = FlightMode::unknown; }};
    for (std::size_t i = 0; i < unfit.size(); ++i) {
        Bench b;
        b.stack = link::AutopilotStack::px4;
        b.stands_by = true;
        varied(b, calm(Beat::former), unfit[i]);
        EXPECT_FALSE(b.takeover.proving()) << i;
        varied(b, wants(Beat::former), unfit[i]);
        EXPECT_FALSE(b.takeover.streaming()) << i;
        b.step(calm(Beat::former));
        EXPECT_TRUE(b.takeover.proving()) << i;
        EXPECT_FALSE(b.takeover.streaming()) << i;
        b.step(wants(Beat::former));
        EXPECT_FALSE(b.takeover.proving()) << i << ": the stream itself";
        EXPECT_TRUE(b.takeover.streaming()) << i;
    }
}

TEST(TakeoverContract, StreamIsProvenToAPx4AloneAndOnlyWhenAskedTo)
{
    for (const auto stack :
         {link::AutopilotStack::px4, link::AutopilotStack::ardupilot, link::AutopilotStack::unknown}) {
        for (const bool keep : {false, true}) {
            Bench b;
            b.stack = stack;
            b.stands_by = keep;
            b.step(calm(Beat::former));
            EXPECT_EQ(b.takeover.proving(), keep && stack == link::AutopilotStack::px4);
        }
    }
}

/// An autopilot that answers 0.04 s after each question; counts the questions.
struct Answering {
    Bench bench;
    int questions = 0;
    std::array<bool, 2> on_the_line{};

    TakeoverOutput step(bool wants, bool may_act = true, Beat natural = Beat::none)
    {
        const Beat beat = on_the_line[0] ? Beat::former : natural;
        const TakeoverOutput out = bench.step({wants, may_act, beat, 0.02F, false});
        on_the_line = {on_the_line[1], out.ask_heartbeat};
        questions += out.ask_heartbeat ? 1 : 0;
        return out;
    }
};

/// A second of waiting makes no difference to an intruder that is seen in time, and 0.06 s do to one that is not.
TEST(TakeoverContract, StandingByTheModeIsAskedForInTheStepInWhichItIsWanted)
{
    for (const auto stack : {link::AutopilotStack::px4, link::AutopilotStack::ardupilot}) {
        Answering a;
        a.bench.stack = stack;
        a.bench.stands_by = true;
        a.step(false, true, Beat::former);
        for (int i = 0; i < 500; ++i) {
            ASSERT_EQ(a.step(false).action, TakeoverAction::none);
            Answering now = a;
            ASSERT_EQ(now.step(true).action, TakeoverAction::request_external) << i;
        }
        EXPECT_LE(a.questions, 120) << "of ten seconds";
    }
}

TEST(TakeoverContract, AHeartbeatIsKeptReadyOnlyWhereItMayBeNeeded)
{
    for (const auto stack : {link::AutopilotStack::px4, link::AutopilotStack::ardupilot}) {
        for (const bool stands_by : {false, true}) {
            for (const bool may_act : {false, true}) {
                for (const Beat mode : {Beat::former, Beat::manual, Beat::hold, Beat::disarmed}) {
                    Bench b;
                    b.stack = stack;
                    b.stands_by = stands_by;
                    b.step({false, may_act, mode, 0.02F, false});
                    int questions = 0;
                    for (int i = 0; i < 50; ++i) {
                        questions += b.step({false, may_act, Beat::none, 0.02F, false}).ask_heartbeat ? 1 : 0;
                    }
                    EXPECT_EQ(questions > 0, stands_by && may_act && mode == Beat::former);
                    EXPECT_LE(questions, 10) << "a second without an answer";
                }
            }
        }
    }
}

TEST(TakeoverContract, NoStreamIsProvenWhileAnAnswerIsOpenOrAfterTheSticksMoved)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.stands_by = true;
    b.step(wants(Beat::former));
    ASSERT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    b.step(fault(Beat::none));
    b.step(calm(Beat::former));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_FALSE(b.takeover.proving()) << "its grant may be on the way";
    b.step(wants(Beat::former));
    ASSERT_TRUE(b.takeover.streaming());
    varied(b, wants(Beat::former), kSticks);
    EXPECT_EQ(b.control(), Control::overruled);
    EXPECT_FALSE(b.takeover.proving());
}

TEST(TakeoverContract, DropByAFaultKeepsTheClaimAndCountsAsALossInControlAlone)
{
    Bench b = awaiting();
    b.takeover.drop(true);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::took_over);
    b.takeover.drop(true);
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 1U);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.takeover.diagnostics().taken, 1U) << "taken up again, not taken";
    b.takeover.drop(false);
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 1U);
}

TEST(TakeoverContract, DropEndsTheStreamThatIsProvenAndForgetsTheModeSeen)
{
    for (const bool by_fault : {false, true}) {
        Bench b;
        b.stack = link::AutopilotStack::px4;
        b.stands_by = true;
        b.step(calm(Beat::former));
        ASSERT_TRUE(b.takeover.proving());
        b.takeover.drop(by_fault);
        EXPECT_FALSE(b.takeover.proving());
        b.step(kWant);
        EXPECT_FALSE(b.takeover.streaming()) << "which mode it is in is not known any more";
        b.step(wants(Beat::former));
        EXPECT_TRUE(b.takeover.streaming());
    }
}

TEST(TakeoverContract, RebootedAutopilotOwesNothingToTheOneBefore)
{
    Bench lost = commanding();
    ASSERT_EQ(lost.step(fault(Beat::external)).action, TakeoverAction::request_hold);
    lost.takeover.drop(false);
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(lost.step(fault(Beat::external, 0.5F)).action, TakeoverAction::none);
    }
    EXPECT_EQ(lost.step(calm(Beat::external)).event, TakeoverEvent::none);
    EXPECT_FALSE(lost.takeover.streaming());

    Bench tried = awaiting();
    tried.step(wants(Beat::former, 1.01F));
    tried.takeover.drop(false);
    int requests = 0;
    for (int i = 0; i < 100 && tried.control() != Control::refused; ++i) {
        requests += tried.step(wants(Beat::former, 0.1F)).action == TakeoverAction::request_external ? 1 : 0;
    }
    EXPECT_EQ(requests, Takeover::kTries);

    Bench unfollowed = commanding();
    ASSERT_EQ(varied(unfollowed, kWant, kUnfollowed).event, TakeoverEvent::unfollowed);
    unfollowed.takeover.drop(false);
    unfollowed.step(wants(Beat::former));
    EXPECT_TRUE(unfollowed.takeover.streaming());

    Bench sticks = commanding();
    ASSERT_EQ(varied(sticks, wants(Beat::external), kSticks).action, TakeoverAction::request_former);
    sticks.takeover.drop(false);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(sticks.step(wants(Beat::external, 1.0F)).action, TakeoverAction::none);
    }
}

TEST(TakeoverContract, HoldMayBeAskedForInControlOnFreshEvidenceAlone)
{
    Bench b = awaiting();
    EXPECT_FALSE(b.takeover.may_ask_to_hold(b.now)) << "not in control";
    b.step(wants(Beat::external));
    EXPECT_TRUE(b.takeover.may_ask_to_hold(b.now));
    EXPECT_TRUE(b.takeover.may_ask_to_hold(b.now + 1.4F));
    EXPECT_FALSE(b.takeover.may_ask_to_hold(b.now + 1.6F)) << "the HEARTBEAT is old";
    EXPECT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    EXPECT_FALSE(b.takeover.may_ask_to_hold(b.now)) << "no HEARTBEAT since the request";
    b.step(calm(Beat::external));
    ASSERT_EQ(b.control(), Control::returning);
    EXPECT_TRUE(b.takeover.may_ask_to_hold(b.now));
    b.step(fault(Beat::none));
    EXPECT_FALSE(b.takeover.may_ask_to_hold(b.now));
}

}  // namespace
}  // namespace jink::app
