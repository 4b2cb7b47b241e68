// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step: inputs reach the deciding modules, and data invalidated by a jump of the frame are forgotten
// everywhere.
#include <gtest/gtest.h>

#include "tests/unit/app/step_flight.hpp"
#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

const Vec3 kMastAhead(0.4F, 60.0F, 50.0F);

link::AutopilotReport& beat_in(StepFlight& f, link::FlightMode mode)
{
    link::AutopilotReport& r = f.hear_autopilot();
    r.mode = mode;
    r.custom_mode = static_cast<std::uint32_t>(mode) + 10;
    return r;
}

void let_pass(StepFlight& f, int ticks)
{
    for (int i = 0; i < ticks; ++i) {
        f.tick();
    }
}

/// A pilot's mode that came and went between two steps ends control all the same.
TEST(StepWiring, AModeSeenBetweenTwoStepsIsAChoiceOfSomebodyElse)
{
    StepFlight f;
    f.mast = kMastAhead;
    ASSERT_TRUE(f.until(StepFlight::ours));
    let_pass(f, 3);
    ASSERT_EQ(f.last.control, Control::ours);
    f.wire.in.earlier_autopilot.unchecked_push_back(beat_in(f, link::FlightMode::hold));
    static_cast<void>(beat_in(f, link::FlightMode::external));
    f.tick();
    EXPECT_EQ(f.last.control, Control::overruled);
    EXPECT_EQ(f.said("jink: mode changed by others, hands off"), 1);
    EXPECT_EQ(f.coprocessor.flying(), nullptr);
    const std::size_t commands = f.wire.velocities.size();
    const int asked = f.asked_for("external") + f.asked_for("hold") + f.asked_for("11");
    let_pass(f, 100);
    EXPECT_EQ(f.wire.velocities.size(), commands) << "the external mode is not ours any more";
    EXPECT_EQ(f.asked_for("external") + f.asked_for("hold") + f.asked_for("11"), asked);
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().overruled, 1U);
    // It counts once: after the conflict, and back in the mission, the next one is avoided.
    f.mast.reset();
    f.mode = link::FlightMode::mission;
    let_pass(f, 300);
    f.mast = f.position + Vec3(0.4F, 60.0F, 0.0F);
    ASSERT_TRUE(f.until(StepFlight::ours));
    let_pass(f, 30);
    EXPECT_EQ(f.last.control, Control::ours);
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().overruled, 1U);
}

/// Hands off while any conflict is predicted, also one that is too far away yet to be avoided.
TEST(StepWiring, HandsStayOffWhileAConflictIsPredicted)
{
    StepFlight f;
    f.mast = kMastAhead;
    ASSERT_TRUE(f.until(StepFlight::ours));
    f.intruder = f.position + Vec3(0.0F, 50.0F, 0.0F);
    f.intruder_velocity = Vec3(0.0F, -6.0F, 0.0F);
    let_pass(f, 11);
    ASSERT_EQ(f.last.control, Control::ours);
    f.mode = link::FlightMode::hold;
    static_cast<void>(beat_in(f, f.mode));
    f.tick();
    ASSERT_EQ(f.last.control, Control::overruled);
    EXPECT_EQ(f.said("jink: mode changed by others, hands off"), 1) << "a hold that nobody asked for";
    int waits = 0;
    for (int i = 0; i < 75; ++i) {
        f.tick();
        ASSERT_TRUE(f.last.guidance.conflict.has_value()) << i;
        EXPECT_EQ(f.last.control, Control::overruled) << i;
        waits += f.last.guidance.wants_control ? 0 : 1;
    }
    EXPECT_GT(waits, 5) << "the vehicle stands, and the intruder is far";
    f.intruder.reset();
    let_pass(f, 400);
    EXPECT_EQ(f.last.control, Control::autopilot) << "over";
}

/// A link that breaks its promise: every number that it hands over is finite.
TEST(StepWiring, NoCommandThatIsNotFiniteGoesOutWhateverTheOwnStateSays)
{
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (int field = 0; field < 8; ++field) {
            SCOPED_TRACE(testing::Message() << bad << " in field " << field);
            StepFlight f;
            f.mast = kMastAhead;
            ASSERT_TRUE(f.until(StepFlight::ours));
            for (int i = 0; i < 12; ++i) {
                vehicle::VehicleState& own = f.hear_own().state;
                if (field < 3) {
                    own.position[field] = bad;
                } else if (field < 6) {
                    own.velocity[field - 3] = bad;
                } else {
                    (field == 6 ? own.yaw : own.sigma_position) = bad;
                }
                if (i % 10 == 0) {
                    f.hear_mast(1, kMastAhead);
                }
                f.step();
                EXPECT_TRUE(is_finite(f.wire.velocities.back())) << i;
                if (field >= 3 && field < 6) {
                    EXPECT_TRUE(f.has(Fault::not_finite)) << i;
                    EXPECT_NE(f.last.control, Control::ours) << i;
                    EXPECT_FALSE(f.last.setpoint_sent) << i;
                }
            }
        }
    }
}

/// A HEARTBEAT that is found after a stall may have waited for us: no mode is asked for because of it.
TEST(StepWiring, AHeartbeatThatWaitedForUsIsNoEvidence)
{
    StepFlight f;
    f.mast = kMastAhead;
    ASSERT_TRUE(f.until(StepFlight::ours));
    let_pass(f, 3);
    f.coming_us = 3'000'000;
    static_cast<void>(beat_in(f, link::FlightMode::external));
    f.hear_own();
    f.step(3'000'000);
    ASSERT_TRUE(f.has(Fault::late));
    EXPECT_NE(f.last.control, Control::ours);
    EXPECT_EQ(f.asked_for("hold"), 0);
    EXPECT_EQ(f.wire.requests.back(), "heartbeat");
}

/// An accepted request of the hold mode is given a second, one without an answer half of it.
TEST(StepWiring, AnAcceptedHoldIsNotAskedForAgainAtOnce)
{
    for (const bool accepted : {false, true}) {
        const auto t = in_command();
        t->grants = false;
        t->own_state = false;
        ASSERT_TRUE(t->until([](const StepReport& r) { return r.control != Control::ours; }, 60));
        ASSERT_EQ(t->link.asked, std::vector<link::FlightMode>(1, link::FlightMode::hold));
        if (accepted) {
            t->link.next.mode_answers.unchecked_push_back({true, 0});
        }
        std::size_t again = 0;
        for (int i = 0; i < 40; ++i) {
            t->step();
            again += t->link.asked.size();
        }
        EXPECT_EQ(again, accepted ? 0U : 1U) << "within 0.8 s";
    }
}

int ticks_until_unfollowed(StepFlight& f)
{
    int ticks = 0;
    while (ticks < 400 && f.last.control == Control::ours) {
        f.tick();
        ++ticks;
    }
    return ticks;
}

/// A failure of an earlier take-over does not affect the next one.
TEST(StepWiring, EachTakeOverIsFollowedFromItsOwnBeginning)
{
    StepFlight alone;
    alone.mast = kMastAhead;
    alone.deaf = true;
    ASSERT_TRUE(alone.until(StepFlight::ours));
    const int first = ticks_until_unfollowed(alone);
    ASSERT_LT(first, 400);
    StepFlight f;
    f.mast = kMastAhead;
    f.deaf = true;
    ASSERT_TRUE(f.until(StepFlight::ours));
    let_pass(f, first - 8);
    ASSERT_EQ(f.last.control, Control::ours);
    // The pilot flies the mission on, past it, and on to the next one.
    f.mode = link::FlightMode::mission;
    f.mast.reset();
    static_cast<void>(beat_in(f, link::FlightMode::mission));
    let_pass(f, 300);
    ASSERT_EQ(f.last.control, Control::autopilot);
    f.mast = f.position + Vec3(0.4F, 60.0F, 0.0F);
    ASSERT_TRUE(f.until(StepFlight::ours));
    EXPECT_GT(ticks_until_unfollowed(f), first - 8);
}

/// Doubts about a leg are doubts about places in the frame that was.
TEST(StepWiring, AJumpOfTheFrameForgetsTheDoubtedLegAndTheObstaclesOfAScan)
{
    StepBench b({{Param::mode, 1.0F}});
    b.wire.in.has_leg = true;
    b.wire.in.leg.leg = {b.position, b.position + Vec3(500.0F, 0.0F, 0.0F), 5.0F};
    b.fly(100);
    ASSERT_FALSE(b.coprocessor.nominal_paths().believes_leg()) << "north, and the leg leads east";
    b.wire.in.scans.unchecked_push_back({});
    link::RangeScan& scan = b.wire.in.scans.back();
    scan.stamp = b.next();
    scan.increment = 0.1F;
    scan.ranges.unchecked_push_back(20.0F);
    b.fly(1);
    ASSERT_EQ(b.last.obstacles, 1U);
    b.hear_own().estimator_reset = true;
    b.step();
    EXPECT_EQ(b.last.obstacles, 0U);
    EXPECT_TRUE(b.coprocessor.nominal_paths().believes_leg());
}

TEST(StepWiring, AnOwnPlaceFromElsewhereBeginsTheJudgementOfTheLegAnew)
{
    StepBench b({{Param::mode, 1.0F}, {Param::own_age, 0.1F}}, StepBench::Bus::there);
    b.wire.in.has_leg = true;
    b.wire.in.leg.leg = {b.position, b.position + Vec3(500.0F, 0.0F, 0.0F), 5.0F};
    b.fly(100);
    ASSERT_FALSE(b.coprocessor.nominal_paths().believes_leg());
    b.coming_us = 120'000;
    b.hear_bus_own();
    b.step(120'000);
    ASSERT_EQ(b.last.own_source, OwnSource::bus);
    EXPECT_TRUE(b.coprocessor.nominal_paths().believes_leg());
}

TEST(StepWiring, AShutDownTellsTheBusTheFaultsOfTheLastStep)
{
    StepBench b({}, StepBench::Bus::there);
    b.hear_autopilot();
    b.step();
    ASSERT_EQ(b.last.faults, bit(Fault::own_state_missing));
    b.coprocessor.shut_down(b.now);
    EXPECT_EQ(b.bus.statuses.back().faults, bit(Fault::own_state_missing));
    EXPECT_FALSE(b.bus.statuses.back().advising_only);
}

}  // namespace
}  // namespace jink::app::test
