// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

Bench requesting()
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.control(), Control::requesting);
    return b;
}

Bench taken_over()
{
    Bench b = requesting();
    EXPECT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
    return b;
}

Bench returning()
{
    Bench b = taken_over();
    EXPECT_EQ(b.step(calm(Beat::external, 1.0F)).action, TakeoverAction::request_former);
    EXPECT_EQ(b.control(), Control::returning);
    return b;
}

Bench refused()
{
    Bench b = requesting();
    EXPECT_EQ(b.step(wants(Beat::former, 1.01F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former, 1.01F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.control(), Control::requesting);
    EXPECT_EQ(b.step(wants(Beat::none, 1.01F)).event, TakeoverEvent::refused);
    EXPECT_EQ(b.control(), Control::refused);
    return b;
}

TEST(Takeover, TakesOverAndGivesBack)
{
    Bench b;
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none);
    EXPECT_EQ(b.control(), Control::autopilot);  // nothing heard yet
    b.step(wants(Beat::former));
    EXPECT_TRUE(b.takeover.streaming());
    EXPECT_FALSE(b.takeover.in_control());
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.takeover.former_mode(), kMission);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
    EXPECT_EQ(b.step(calm(Beat::none, 0.5F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(calm(Beat::external, 0.51F)).action, TakeoverAction::request_former);  // asked again
    EXPECT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_FALSE(b.takeover.streaming());
    const TakeoverDiagnostics& d = b.takeover.diagnostics();
    EXPECT_EQ(d.requests, 1U);
    EXPECT_EQ(d.taken, 1U);
    EXPECT_EQ(d.given_back, 1U);
    EXPECT_EQ(d.refused + d.overruled + d.lost_by_fault, 0U);
}

TEST(Takeover, LeavesAVehicleAloneThatFliesNoMission)
{
    for (const Beat beat : {Beat::external, Beat::manual, Beat::hold, Beat::disarmed}) {
        Bench b;
        b.step(wants(beat));
        b.step(wants(beat, 1.0F));
        EXPECT_EQ(b.control(), Control::autopilot) << describe(wants(beat));
    }
    Takeover landed;
    TakeoverInput input = input_of(wants(Beat::former));
    input.report.landed = true;
    EXPECT_EQ(landed.update(input, TimePoint{1'000'000}).action, TakeoverAction::none);
    EXPECT_EQ(landed.control(), Control::autopilot);
}

TEST(Takeover, AnnouncementEndsWithTheWish)
{
    Bench b;
    b.step(wants(Beat::former));
    b.step(kCalm);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().requests, 0U);
}

TEST(Takeover, ExternalModeChosenByThePilotWhileAnnouncingIsThePilots)
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::overruled);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(Takeover, TriesThreeTimesThenAsksForHoldThreeTimes)
{
    Bench b = refused();
    EXPECT_EQ(b.takeover.diagnostics().requests, 3U);
    EXPECT_EQ(b.takeover.diagnostics().refused, 1U);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
    b.step(calm(Beat::former));
    EXPECT_EQ(b.control(), Control::autopilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);  // the next conflict, a new attempt
}

TEST(Takeover, DenialShortensTheWait)
{
    Bench b = requesting();
    EXPECT_EQ(b.step(denied(0.02F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::former, 0.05F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(denied(0.07F)).action, TakeoverAction::none) << "no HEARTBEAT since the request";
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(denied(0.07F)).event, TakeoverEvent::refused);
}

TEST(Takeover, HoldThatWasAskedForIsNobodysElse)
{
    Bench b = refused();
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::none);
    EXPECT_EQ(b.control(), Control::refused);
    b.step(wants(Beat::external));  // from the hold mode on it is a pilot who chooses
    EXPECT_EQ(b.control(), Control::refused);
}

TEST(Takeover, PilotsModeWhileRefusedEndsAllRequests)
{
    Bench b = refused();
    EXPECT_EQ(b.step(wants(Beat::manual)).event, TakeoverEvent::overruled);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
    }
}

TEST(Takeover, LateGrantIsTakenUp)
{
    Bench b = refused();
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
}

TEST(Takeover, LateGrantWaitsForTheEndOfAFault)
{
    Bench b = refused();
    b.step(fault(Beat::external));
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(b.step(kWant).event, TakeoverEvent::took_over);
}

TEST(Takeover, GrantAfterTheRefusedConflictIsGivenBack)
{
    Bench b = refused();
    b.step(kCalm);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
}

TEST(Takeover, PilotsModeIsFinalUntilTheConflictIsOver)
{
    for (const Beat beat : {Beat::manual, Beat::hold, Beat::disarmed}) {
        for (Bench b : {requesting(), taken_over(), returning()}) {
            EXPECT_EQ(b.step(wants(beat)).event, TakeoverEvent::overruled) << describe(wants(beat));
            EXPECT_FALSE(b.takeover.streaming());
            for (int i = 0; i < 3; ++i) {
                EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
            }
            EXPECT_EQ(b.control(), Control::overruled);
            b.step(calm(Beat::former));
            EXPECT_EQ(b.control(), Control::autopilot);
            b.step(wants(Beat::former));
            EXPECT_EQ(b.control(), Control::announcing);
        }
    }
}

TEST(Takeover, FormerModeNotAskedForIsThePilots)
{
    Bench b = taken_over();
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::overruled);
}

TEST(Takeover, NewConflictWhileReturningDoesNotMakeTheConfirmationThePilots)
{
    Bench b = returning();
    b.step(kWant);
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::gave_back);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().overruled, 0U);
    EXPECT_EQ(b.takeover.diagnostics().given_back, 1U);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
}

TEST(Takeover, FormerModeLongAfterALostRequestIsThePilots)
{
    Bench b = returning();
    b.step(kWant);
    b.step(wants(Beat::external, 0.5F));
    b.step(wants(Beat::external, 0.6F));  // a second later still external: the request for the former mode was lost
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::overruled);
}

TEST(Takeover, FaultBeforeControlFallsSilent)
{
    Bench announcing;
    announcing.step(wants(Beat::former));
    for (Bench b : {announcing, requesting()}) {
        const TakeoverOutput out = b.step(fault(Beat::none));
        EXPECT_EQ(out.event, TakeoverEvent::none);
        EXPECT_EQ(out.action, TakeoverAction::none);
        EXPECT_EQ(b.control(), Control::autopilot);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
    }
}

TEST(Takeover, FaultInControlIsLost)
{
    for (Bench b : {taken_over(), returning()}) {
        EXPECT_EQ(b.step(fault(Beat::none)).event, TakeoverEvent::lost);
        EXPECT_EQ(b.control(), Control::autopilot);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 1U);
        EXPECT_EQ(b.step(fault(Beat::external)).event, TakeoverEvent::none);
        EXPECT_EQ(b.step(kWant).event, TakeoverEvent::took_over);  // the mode has not changed since
    }
}

TEST(Takeover, HoldAfterALossIsNotResumed)
{
    Bench b = taken_over();
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::none);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(Takeover, PilotsModeOnTheTickOfAFaultIsThePilots)
{
    for (const Beat beat : {Beat::manual, Beat::former}) {
        Bench b = taken_over();
        EXPECT_EQ(b.step(fault(beat)).event, TakeoverEvent::overruled) << describe(fault(beat));
        EXPECT_FALSE(b.takeover.streaming());
    }
}

TEST(Takeover, GrantDuringAFaultIsTakenUpAndGivenBack)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    b.step(fault(Beat::former, 0.2F));  // sent before the request arrived
    b.step(fault(Beat::external, 0.5F));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(kCalm).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.takeover.diagnostics().taken, 1U);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
    EXPECT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
}

TEST(Takeover, ExternalModeLongAfterAnUnansweredRequestIsThePilots)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    b.step(fault(Beat::former, 1.1F));
    b.step(calm(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(Takeover, PilotsModeDuringAFaultAfterTheRequestIsThePilots)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(fault(Beat::manual)).event, TakeoverEvent::overruled);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::overruled);
}

TEST(Takeover, FlickeringFaultDoesNotMultiplyTheRequests)
{
    Bench b = requesting();
    for (int i = 0; i < 20; ++i) {
        b.step(fault(Beat::none));
        b.step(wants(Beat::former, 1.0F));
        b.step(wants(Beat::none, 0.1F));
    }
    EXPECT_EQ(b.takeover.diagnostics().requests, 3U);
    EXPECT_EQ(b.control(), Control::refused);
}

TEST(Takeover, DropForgetsAllUnlessByFault)
{
    Bench b = taken_over();
    b.takeover.drop(false);
    EXPECT_EQ(b.control(), Control::autopilot);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
}

}  // namespace
}  // namespace jink::app
