// SPDX-License-Identifier: BSD-3-Clause
// The simulated autopilot, tested from the co-processor's end of the cable: as strict as the real autopilots.
#include <gtest/gtest.h>

#include "tests/scenario/autopilot_line.hpp"

#include <cmath>

#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/modes.hpp"

namespace jink::sim {
namespace {

TEST(Modes, AreTheStacksOwnNumbers)
{
    EXPECT_EQ(custom_mode(Stack::ardupilot, Mode::mission), 3U);
    EXPECT_EQ(custom_mode(Stack::ardupilot, Mode::external), 4U);
    EXPECT_EQ(custom_mode(Stack::ardupilot, Mode::hold), 5U);
    EXPECT_EQ(custom_mode(Stack::ardupilot, Mode::home), 6U);
    EXPECT_EQ(custom_mode(Stack::ardupilot, Mode::brake), 17U);
    EXPECT_EQ(custom_mode(Stack::px4, Mode::mission), 0x04040000U);
    EXPECT_EQ(custom_mode(Stack::px4, Mode::external), 0x00060000U);
    EXPECT_EQ(custom_mode(Stack::px4, Mode::hold), 0x03040000U);
    EXPECT_EQ(custom_mode(Stack::px4, Mode::home), 0x05040000U);
    EXPECT_EQ(custom_mode(Stack::px4, Mode::pilot), 0x00030000U);
}

// Rates of both: recorded from the real ones (docs/evidence/recordings.md).
TEST(SimAutopilot, ArdupilotStreamsWhatTheCoprocessorAsksFor)
{
    Line line(kArdupilotFlight);
    line.run(10.0);
    EXPECT_EQ(line.count<Heartbeat>(), 10);
    EXPECT_EQ(line.count<LocalPositionNed>(), 500);
    EXPECT_EQ(line.count<AttitudeQuaternion>(), 100);
    EXPECT_EQ(line.count<GlobalPositionInt>(), 0);
    EXPECT_EQ(line.count<PositionTargetLocalNed>(), 0);  // not in AUTO
    EXPECT_EQ(line.count<MissionCurrent>(), 20);
    EXPECT_EQ(line.count<ExtendedSysState>(), 10);
    EXPECT_EQ(line.count<GpsGlobalOrigin>(), 2);
    EXPECT_EQ(line.count<HomePosition>(), 2);
    EXPECT_EQ(line.count<Timesync>(), 1);
    const auto position = line.heard<LocalPositionNed>();
    ASSERT_TRUE(position);
    EXPECT_NEAR(static_cast<double>(position->y), 49.9, 0.2);  // east
    EXPECT_NEAR(static_cast<double>(position->x), 0.0, 1e-3);
    EXPECT_NEAR(static_cast<double>(position->z), -30.0, 1e-3);
    EXPECT_NEAR(static_cast<double>(position->vy), 5.0, 0.05);
    const auto attitude = line.heard<AttitudeQuaternion>();
    ASSERT_TRUE(attitude);
    EXPECT_NEAR(2.0 * std::atan2(static_cast<double>(attitude->q4), static_cast<double>(attitude->q1)), M_PI / 2.0,
                1e-6);
}

TEST(SimAutopilot, Px4StreamsByItself)
{
    Line line(kPx4Flight);
    line.run(10.0);
    EXPECT_EQ(line.count<Heartbeat>(), 10);
    EXPECT_EQ(line.count<LocalPositionNed>(), 300);
    EXPECT_EQ(line.count<Odometry>(), 300);
    EXPECT_EQ(line.count<AttitudeQuaternion>(), 500);
    EXPECT_EQ(line.count<Attitude>(), 1000);
    EXPECT_EQ(line.count<GlobalPositionInt>(), 500);
    EXPECT_EQ(line.count<ExtendedSysState>(), 50);
    EXPECT_EQ(line.count<GpsGlobalOrigin>(), 1);
    EXPECT_EQ(line.count<HomePosition>(), 5);
    EXPECT_EQ(line.count<Timesync>(), 100);
    EXPECT_EQ(line.count<PositionTargetLocalNed>(), 100);
    EXPECT_EQ(line.count<MissionCurrent>(), 10);
    const auto odometry = line.heard<Odometry>();
    const auto position = line.heard<LocalPositionNed>();
    ASSERT_TRUE(odometry && position);
    EXPECT_NEAR(static_cast<double>(odometry->y), static_cast<double>(position->y), 0.2);
    EXPECT_NEAR(static_cast<double>(odometry->vy), static_cast<double>(position->vy), 0.05);
}

TEST(SimAutopilot, Px4RefusesOffboardWithoutARecentSetpoint)
{
    Line line(kPx4Flight);
    line.run(1.0);
    EXPECT_EQ(line.ask(6.0F), 1);  // temporarily rejected
    line.send_velocity(0.0F, 3.0F, 0.0F);
    line.run(0.6);
    EXPECT_EQ(line.ask(6.0F), 1);  // too long ago
    line.run(0.1, true);
    EXPECT_EQ(line.ask(6.0F), 0);
}

TEST(SimAutopilot, Px4AsDocumentedRefusesOffboardUntilTheStreamIsASecondOld)
{
    Scenario documented = kPx4Flight;
    documented.faults.offboard_proof = 1.0;
    Line line(documented);
    line.run(1.0);
    EXPECT_EQ(line.ask(6.0F), 1);  // temporarily rejected
    EXPECT_EQ(line.autopilot.mode(), Mode::mission);
    line.send_velocity(0.0F, 3.0F, 0.0F);
    line.run(0.6);
    EXPECT_EQ(line.ask(6.0F), 1);  // seen, but too long ago
    line.run(0.9, true);
    EXPECT_EQ(line.ask(6.0F), 1);  // not for more than a second
    line.run(0.7);
    line.run(0.5, true);
    EXPECT_EQ(line.ask(6.0F), 1);  // with a gap
    line.run(0.6, true);
    EXPECT_EQ(line.ask(6.0F), 0);
    EXPECT_EQ(line.autopilot.mode(), Mode::external);
    line.run(1.0, true);
    const auto heartbeat = line.heard<Heartbeat>();
    ASSERT_TRUE(heartbeat);
    EXPECT_EQ(heartbeat->custom_mode, 6U << 16U);
    EXPECT_EQ(heartbeat->autopilot, 12);
}

TEST(SimAutopilot, Px4LeavesOffboardOneSecondAfterTheLastSetpoint)
{
    Line line(kPx4Flight);
    line.run(1.1, true);
    ASSERT_EQ(line.ask(6.0F), 0);
    line.run(5.0, true);
    EXPECT_EQ(line.autopilot.mode(), Mode::external);
    EXPECT_NEAR(line.world.own().velocity.x(), 2.0, 0.01);
    line.run(0.9);
    EXPECT_EQ(line.autopilot.mode(), Mode::external);
    line.run(0.2);
    EXPECT_EQ(line.autopilot.mode(), Mode::hold);
    EXPECT_FALSE(line.autopilot.last_change_was_asked());
    line.run(4.0);
    EXPECT_LT(line.world.own().velocity.norm(), 0.05);
}

TEST(SimAutopilot, ArdupilotGoesIntoGuidedAtOnceHoldsAndStopsAfterThreeSeconds)
{
    Line line(kArdupilotFlight);
    line.run(0.5, true);  // set-points outside GUIDED mean nothing to it
    ASSERT_EQ(line.ask(4.0F), 0);
    line.run(1.0);
    EXPECT_EQ(line.autopilot.command(), Vec(Vec::Zero()));
    line.send_velocity(1.0F, 0.0F, -0.5F);
    line.run(2.9);
    EXPECT_EQ(line.autopilot.command(), Vec(0.0, 1.0, 0.5));
    line.run(0.2);
    EXPECT_EQ(line.autopilot.mode(), Mode::external);
    EXPECT_LT(line.autopilot.command().norm(), 1e-9);
}

TEST(SimAutopilot, SetpointsWithAnotherMaskFrameOrTargetAreNotFollowed)
{
    Line line(kArdupilotFlight);
    ASSERT_EQ(line.ask(4.0F), 0);
    line.send_velocity(1.0F, 0.0F, 0.0F, 0x0DF8);
    line.send_velocity(1.0F, 0.0F, 0.0F, kVelocityMask, 8);
    line.send_velocity(std::nanf(""), 0.0F, 0.0F);
    SetPositionTargetLocalNed other;
    other.type_mask = kVelocityMask;
    other.coordinate_frame = 1;
    other.target_system = 2;
    other.target_component = 1;
    line.send(other);
    EXPECT_EQ(line.autopilot.heard().bad_setpoints, 4U);
    line.run(0.1);
    EXPECT_EQ(line.autopilot.command(), Vec(Vec::Zero()));
}

TEST(SimAutopilot, ModesThatDoNotExistAreRefused)
{
    Line line(kArdupilotFlight);
    EXPECT_EQ(line.ask(99.0F), 3);
    EXPECT_EQ(line.ask(4.0F, 0.0F, 0.0F), 2);  // without the custom-mode bit
    EXPECT_EQ(line.autopilot.heard().refused_requests, 2U);
    Scenario refusing = kArdupilotFlight;
    refusing.faults.refuse_external = true;
    Line denied(refusing);
    EXPECT_EQ(denied.ask(4.0F), 2);
    EXPECT_EQ(denied.ask(5.0F), 0);
    EXPECT_EQ(denied.autopilot.mode(), Mode::hold);
}

TEST(SimAutopilot, ThePilotsChoiceIsNoticedInWhatIsSentAfterwards)
{
    Scenario s = kArdupilotFlight;
    s.faults.pilot_takes_over = 1.0;
    s.faults.pilot_mode = Mode::home;
    Line line(s);
    ASSERT_EQ(line.ask(4.0F), 0);
    line.run(1.01, true);
    EXPECT_EQ(line.autopilot.mode(), Mode::home);
    line.run(0.15, true);
    EXPECT_EQ(line.autopilot.heard().setpoints_overruled, 0U);  // in transit
    line.run(0.3, true);
    EXPECT_GT(line.autopilot.heard().setpoints_overruled, 0U);
}

TEST(SimAutopilot, RebootSilencesItAndStartsItsClockAgain)
{
    Scenario s = kPx4Flight;
    s.faults.reboot_at = 2.0;
    s.faults.reboot_lasts = 1.0;
    Line line(s);
    line.run(1.9);
    ASSERT_GT(line.heard<LocalPositionNed>()->time_boot_ms, 61000U);
    line.run(0.2);
    line.forget();
    line.run(0.8);
    EXPECT_EQ(line.count<LocalPositionNed>(), 0);
    line.run(0.5);
    const auto position = line.heard<LocalPositionNed>();
    ASSERT_TRUE(position);
    EXPECT_LT(position->time_boot_ms, 2000U);
}

TEST(SimAutopilot, ClockJumpsAndTimesyncTellTheSameClock)
{
    Scenario s = kArdupilotFlight;
    s.faults.clock_jump_at = 1.0;
    s.faults.clock_jump_by = 30.0;
    Line line(s);
    line.run(1.5);
    line.forget();
    line.send(Timesync{0, 12345, 1, 1});
    const auto answer = line.heard<Timesync>();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->ts1, 12345);
    EXPECT_EQ(answer->tc1, 91'500'000'000);
}

TEST(SimAutopilot, ParametersAreSetUntilTheyAreVerified)
{
    Scenario s = kArdupilotFlight;
    s.parameters["TRK_RADIUS"] = 1.5;
    Line line(s);
    line.run(0.7);
    EXPECT_EQ(line.count<ParamSet>(), 3);
    EXPECT_EQ(line.autopilot.parameters_missing().size(), 1U);
    ParamValue value;
    value.param_value = 1.0F;
    ASSERT_TRUE(set_text(value.param_id, "TRK_RADIUS"));
    line.send(value);
    EXPECT_EQ(line.autopilot.parameters_missing().size(), 1U);
    value.param_value = 1.5F;
    line.send(value);
    EXPECT_TRUE(line.autopilot.parameters_missing().empty());
    line.forget();
    line.run(1.0);
    EXPECT_EQ(line.count<ParamSet>(), 0);
}

TEST(SimAutopilot, TrafficIsReportedWithItsSpeedAndPointsAsObstacles)
{
    Scenario s = kPx4Flight;
    Threat flies;
    flies.velocity = Vec(3, -4, 1);
    flies.position = Vec(100, 100, 50);
    Threat stands;
    stands.position = Vec(150, 0, 30);
    stands.sensed_by = SensedBy::point;
    s.threats = {flies, stands};
    Line line(s);
    line.run(0.2);
    Parser parser;
    EXPECT_EQ(line.count<AdsbVehicle>(), 2);
    const auto point = line.heard<AdsbVehicle>();
    ASSERT_TRUE(point);
    EXPECT_EQ(point->emitter_type, 19);
    EXPECT_EQ(point->hor_velocity, 0);
    s.threats = {flies};
    Line alone(s);
    alone.run(0.2);
    const auto aircraft = alone.heard<AdsbVehicle>();
    ASSERT_TRUE(aircraft);
    EXPECT_EQ(aircraft->hor_velocity, 500);
    EXPECT_EQ(aircraft->ver_velocity, 100);
    EXPECT_EQ(aircraft->heading, 14313);  // atan2(3, -4) clockwise from north
    EXPECT_EQ(aircraft->flags & 0x8FU, 0x8FU);
}

}  // namespace
}  // namespace jink::sim
