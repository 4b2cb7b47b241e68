// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's reports about control, vehicles that it cannot steer, and lost lines.
#include <gtest/gtest.h>

#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

using link::Severity;
using link::SystemState;

TEST(TellingControl, WhoFliesIsSaidOnceAsWhatItIs)
{
    const auto t = in_command();
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: avoiding, has control"));
    EXPECT_EQ(t->said("jink: avoiding"), 1);
    t->traffic.clear();
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.control == Control::autopilot; }, 3000));
    EXPECT_TRUE(t->said_as(Severity::notice, "jink: clear, mission resumed"));
    EXPECT_EQ(t->said("jink: clear"), 1);
    EXPECT_EQ(t->said("jink: mode"), 0);
}

TEST(TellingControl, PilotsChoice)
{
    const auto t = in_command();
    t->choose(link::FlightMode::manual);
    t->fly(50);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: mode changed by others, hands off"));
    EXPECT_EQ(t->said("jink: mode changed"), 1);
}

TEST(TellingControl, Refusal)
{
    const auto t = teller();
    t->grants = false;
    t->fly(60);
    t->put_ahead(60.0F, Vec3::Zero(), Vec3(0.0F, 0.4F, 0.0F));
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.control == Control::refused; }));
    t->fly(50);
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: control refused, advising only"));
    EXPECT_EQ(t->said("jink: control refused"), 1);
}

TEST(TellingControl, FaultInControlAndTheHoldThatFollows)
{
    const auto t = in_command();
    t->grants = false;
    t->own_state = false;
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.faults != 0; }));
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: fault while avoiding, control dropped"));
    EXPECT_EQ(t->said("jink: fault while"), 1);
    EXPECT_EQ(t->said("jink: line lost"), 0) << "the line is there";
    t->own_state = true;
    t->beat();
    t->step();
    ASSERT_TRUE(leads(t->last)) << "still in the external mode: taken up again";
    t->choose(link::FlightMode::hold);
    t->fly(3);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: autopilot holds, as asked"));
    EXPECT_EQ(t->said("jink: autopilot holds"), 1);
}

TEST(TellingControl, SticksThatMove)
{
    const auto t = in_command();
    for (const float roll : {0.0F, 0.9F, 0.9F}) {
        t->link.next.has_sticks = true;
        t->link.next.sticks.sticks[0] = roll;
        t->step();
    }
    t->fly(20);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: sticks moved, hands off"));
    EXPECT_EQ(t->said("jink: sticks moved"), 1);
}

TEST(TellingControl, CommandsThatAreNotFollowed)
{
    const auto t = in_command();
    t->follows = false;
    ASSERT_TRUE(t->until([](const StepReport& r) { return !leads(r); }, 500));
    t->fly(20);
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: set-points not followed, asks to hold"));
    EXPECT_EQ(t->said("jink: set-points"), 1);
}

TEST(TellingControl, ExternalModeFoundAtTheStart)
{
    const auto t = teller();
    t->autopilot.mode = link::FlightMode::external;
    t->fly(200);
    EXPECT_TRUE(t->said_as(Severity::notice, "jink: found in external mode, left alone"));
    EXPECT_EQ(t->said("jink: found"), 1);
}

TEST(TellingVehicle, ThatCannotBeSteeredIsSaidAtTheSixthHeartbeatAndOnce)
{
    const auto t = teller();
    t->autopilot.steerable = false;
    for (int beats = 1; beats <= 5; ++beats) {
        t->beat();
        t->fly(2);
        EXPECT_EQ(t->said("jink: cannot steer"), 0) << beats;
    }
    t->beat();
    t->step();
    EXPECT_TRUE(t->said_as(Severity::notice, "jink: cannot steer this vehicle, advising only"));
    for (int beats = 0; beats < 20; ++beats) {
        t->beat();
        t->fly(2);
    }
    EXPECT_EQ(t->said("jink: cannot steer"), 1);
}

TEST(TellingVehicle, ThatIsDisarmedOrBecomesSteerableIsNotComplainedOf)
{
    for (const bool steerable : {false, true}) {
        const auto t = teller();
        for (int beats = 1; beats <= 30; ++beats) {
            const bool fit = beats % 6 == 0;
            t->autopilot.steerable = steerable && fit;
            t->autopilot.armed = steerable || !fit;
            t->beat();
            t->fly(2);
        }
        EXPECT_EQ(t->said("jink: cannot steer"), 0) << steerable;
    }
    const auto advises = teller({{Param::mode, 1.0F}});
    advises->autopilot.steerable = false;
    for (int beats = 0; beats < 20; ++beats) {
        advises->beat();
        advises->fly(2);
    }
    EXPECT_EQ(advises->said("jink: cannot steer"), 0) << "it shall only advise";
}

TEST(TellingLine, ThatWasLostInControlIsSaidWhenItIsBackAndOnce)
{
    for (const bool silent : {false, true}) {
        const auto t = in_command();
        t->port.state = silent ? hal::PortState::open : hal::PortState::lost;
        t->heartbeats = t->own_state = false;
        ASSERT_TRUE(t->until([](const StepReport& r) { return r.control == Control::autopilot; }, 400));
        t->fly(silent ? 240 : 20);
        EXPECT_EQ(t->said("jink: line lost"), 0) << "nobody would hear it";
        t->port.state = hal::PortState::open;
        t->own_state = true;
        t->fly(5);
        EXPECT_EQ(t->said("jink: line lost"), 0) << "no HEARTBEAT yet";
        t->heartbeats = true;
        t->choose(link::FlightMode::hold);
        t->fly(100);
        EXPECT_EQ(t->said("jink: line lost while avoiding, control dropped"), silent ? 0 : 1)
            << "own state was lost first, and that was said while the line was there";
    }
}

TEST(TellingLine, ThatIsLostIsNotSaidOverWhileItIsLost)
{
    const auto t = in_command();
    t->port.state = hal::PortState::lost;
    t->autopilot.mode = link::FlightMode::hold;
    for (int i = 0; i < 50; ++i) {
        t->beat();  // received, but no output passes
        t->step();
        ASSERT_EQ(t->said("jink: line lost"), 0);
    }
    t->port.state = hal::PortState::open;
    t->fly(60);
    EXPECT_EQ(t->said("jink: line lost"), 0) << "the pilot chose another mode in the step of the loss";
    const auto silent = in_command();
    silent->port.state = hal::PortState::lost;
    for (int i = 0; i < 50; ++i) {
        silent->beat();
        silent->step();
        ASSERT_EQ(silent->said("jink: line lost"), 0) << i;
    }
    silent->port.state = hal::PortState::open;
    silent->beat();
    silent->step();
    EXPECT_TRUE(silent->said_as(Severity::warning, "jink: line lost while avoiding, control dropped"));
    silent->fly(100);
    EXPECT_EQ(silent->said("jink: line lost"), 1);
}

TEST(TellingBraking, NothingSafeIsAnEmergencyWhileTheVehicleBrakes)
{
    int emergencies = 0, safe_brakes = 0, unsafe_before = 0;
    for (const auto& [ahead, speed] : {std::pair{15.0F, 10.0F}, {25.0F, 30.0F}, {25.0F, 10.0F}, {40.0F, 30.0F}}) {
        const auto t = teller();
        t->fly(60);
        t->put_ahead(ahead, Vec3(-speed, 0.0F, 0.0F));
        for (int i = 0; i < 150; ++i) {
            t->step();
            const avoid::Guidance& g = t->last.guidance;
            const bool brakes = g.state == avoid::State::braking;
            const bool unsafe = g.wants_control && g.margin < 0.0F;
            ASSERT_EQ(t->last.faults, 0);
            EXPECT_EQ(t->last.state, brakes && unsafe ? SystemState::emergency : SystemState::active) << i;
            emergencies += brakes && unsafe ? 1 : 0;
            safe_brakes += brakes && !unsafe ? 1 : 0;
            unsafe_before += !brakes && unsafe ? 1 : 0;
        }
    }
    EXPECT_GT(emergencies, 0);
    EXPECT_GT(safe_brakes, 0);
    EXPECT_GT(unsafe_before, 0);
}

TEST(TellingBraking, ControlForACommonStopAloneIsANoticeOnce)
{
    const auto t = teller();
    t->fly(60);
    t->put_ahead(10.0F, Vec3(5.0F, 0.0F, 0.0F));
    t->traffic.back().source = world::TrackSource::datalink;
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.for_stop && !r.guidance.conflict; }, 400));
    EXPECT_TRUE(t->said_as(Severity::notice, "jink: slows for a neighbour, so that all can stop"));
    t->fly(50);
    EXPECT_EQ(t->said("jink: slows"), 1);
}

TEST(TellingBraking, NothingSafeIsCriticalOnceWhenTheVehicleBrakes)
{
    const auto t = teller();
    t->fly(60);
    t->put_ahead(25.0F, Vec3(-30.0F, 0.0F, 0.0F));
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.state == SystemState::emergency; }, 50));
    EXPECT_EQ(t->said("jink: nothing safe"), 1) << "in the step of the emergency";
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: nothing safe, braking"));
    t->fly(100);
    EXPECT_EQ(t->said("jink: nothing safe"), 1);
    EXPECT_EQ(t->said("jink: no way around"), 0) << "worse was said";
}

TEST(TellingBraking, FallbackThatKeepsClearIsAWarningOnceAndWorseIsSaidAfterIt)
{
    const auto t = teller({{Param::track_sigma_p, 0.5F}, {Param::methods, 3.0F}});
    t->own.velocity = Vec3::Zero();
    t->fly(60);
    t->put_ahead(1.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.state == avoid::State::braking; }, 50));
    ASSERT_EQ(t->last.state, SystemState::active);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: no way around, braking"));
    EXPECT_EQ(t->said("jink: nothing safe"), 0);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.state == SystemState::emergency; }, 50));
    EXPECT_EQ(t->said("jink: nothing safe"), 1);
    t->fly(30);
    EXPECT_EQ(t->said("jink: nothing safe"), 1);
    EXPECT_EQ(t->said("jink: no way around"), 1);
    const auto clear = teller({{Param::track_sigma_p, 0.5F}});
    clear->fly(60);
    clear->put_ahead(25.0F, Vec3(-10.0F, 0.0F, 0.0F));
    clear->fly(150);
    EXPECT_EQ(clear->said("jink: n"), 0) << "it never braked";
}

/// Steps since the last one of a conflict, the braking after it included.
int quiet_steps(Teller& t, int most)
{
    int quiet = 0;
    for (int i = 0; i < 600 && quiet < most; ++i) {
        t.step();
        const bool on = t.last.guidance.conflict.has_value() || t.last.guidance.state == avoid::State::braking;
        quiet = on ? 0 : quiet + 1;
    }
    return quiet;
}

TEST(TellingBraking, ConflictThatComesBackWithinFiveSecondsIsTheSame)
{
    for (const int pause : {235, 265}) {
        const auto t = teller();
        t->fly(60);
        t->put_ahead(25.0F, Vec3(-30.0F, 0.0F, 0.0F));
        t->fly(20);
        ASSERT_EQ(quiet_steps(*t, pause), pause);
        ASSERT_EQ(t->said("jink: nothing safe"), 1);
        t->traffic.clear();
        t->put_ahead(25.0F, Vec3(-30.0F, 0.0F, 0.0F));
        ASSERT_TRUE(t->until([](const StepReport& r) { return r.state == SystemState::emergency; }, 50)) << pause;
        EXPECT_EQ(t->said("jink: nothing safe"), pause < 250 ? 1 : 2);
    }
}

TEST(TellingBraking, ConflictThatGoesOnIsTheSameHoweverLong)
{
    const auto t = teller();
    t->fly(60);
    t->put_ahead(25.0F, Vec3(-30.0F, 0.0F, 0.0F));
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.state == SystemState::emergency; }, 50));
    t->put_ahead(38.0F, Vec3::Zero());
    int longest = 0, quiet = 0, braked = 0;
    for (int i = 0; i < 330; ++i) {
        t->step();
        const bool on = t->last.guidance.conflict.has_value() || t->last.guidance.state == avoid::State::braking;
        braked = t->last.guidance.state == avoid::State::braking ? i : braked;
        quiet = on ? 0 : quiet + 1;
        longest = std::max(longest, quiet);
    }
    ASSERT_EQ(longest, 0) << "in conflict all the time";
    ASSERT_LT(braked, 60) << "and for more than 5 s without braking";
    t->put_ahead(25.0F, Vec3(-30.0F, 0.0F, 0.0F));
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.state == SystemState::emergency; }, 50));
    EXPECT_EQ(t->said("jink: nothing safe"), 1);
}

}  // namespace
}  // namespace jink::app::test
