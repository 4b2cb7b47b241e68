// SPDX-License-Identifier: BSD-3-Clause
// The autopilot that the simulator plays, seen from the co-processor's end of the cable: it must be as strict as the
// real ones.
#include <gtest/gtest.h>

#include "toolchain/sim/autopilot.hpp"

#include <cmath>
#include <optional>

#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/modes.hpp"

namespace jink::sim {
namespace {

using namespace link::mavlink;

constexpr std::uint16_t kVelocityMask = 0x0DC7;

/// The autopilot with a hand at the other end of the cable.
class Line {
public:
    explicit Line(const Scenario& scenario) : world(scenario), autopilot(world) {}

    World world;
    Autopilot autopilot;

    template <Message M>
    void send(const M& message)
    {
        std::array<std::byte, kMaxFrame> frame{};
        const std::size_t n = encode(message, {1, 196, sequence_++}, frame);
        autopilot.receive({frame.data(), n});
    }
    void send_velocity(float north, float east, float down, std::uint16_t mask = kVelocityMask, std::uint8_t frame = 1)
    {
        SetPositionTargetLocalNed m;
        m.vx = north;
        m.vy = east;
        m.vz = down;
        m.type_mask = mask;
        m.coordinate_frame = frame;
        m.target_system = m.target_component = 1;
        send(m);
    }
    /// Asks for a mode; the result of the acknowledgement.
    std::optional<int> ask(float param2, float param3 = 0.0F, float param1 = 129.0F)
    {
        CommandLong m;
        m.command = 176;
        m.param1 = param1;
        m.param2 = param2;
        m.param3 = param3;
        m.target_system = m.target_component = 1;
        send(m);
        const auto ack = heard<CommandAck>();
        return ack ? std::optional<int>(ack->result) : std::nullopt;
    }
    void run(double seconds, bool stream = false)
    {
        for (Micros i = 0; i < to_micros(seconds); i += kStep) {
            if (stream && i % 50'000 == 0) {
                send_velocity(0.0F, 2.0F, 0.0F);
            }
            autopilot.step();
            static_cast<void>(keep());
        }
    }
    /// The newest message of a kind since this was last asked for, or since `run` began.
    template <Message M>
    std::optional<M> heard()
    {
        static_cast<void>(keep());
        std::optional<M> newest;
        M message;
        Parser parser;
        std::span<const std::byte> bytes(kept_);
        while (const auto frame = parser.next(bytes)) {
            if (decode(*frame, message)) {
                newest = message;
            }
        }
        return newest;
    }
    template <Message M>
    int count()
    {
        static_cast<void>(keep());
        int n = 0;
        Parser parser;
        std::span<const std::byte> bytes(kept_);
        while (const auto frame = parser.next(bytes)) {
            n += frame->message_id == M::kInfo.id ? 1 : 0;
        }
        return n;
    }
    void forget() { kept_.clear(); }

private:
    std::size_t keep()
    {
        const auto out = autopilot.take_output();
        kept_.insert(kept_.end(), out.begin(), out.end());
        return kept_.size();
    }

    std::uint8_t sequence_ = 0;
    std::vector<std::byte> kept_;
};

Scenario scenario_of(Stack stack)
{
    Scenario s;
    s.name = "test";
    s.stack = stack;
    s.mission = {Vec(0, 0, 30), Vec(200, 0, 30)};
    s.start_position = s.mission[0];
    s.start_velocity = Vec(5, 0, 0);
    return s;
}

const Scenario kArdupilotFlight = scenario_of(Stack::ardupilot);
const Scenario kPx4Flight = scenario_of(Stack::px4);

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

// Rates of both: recorded from the real ones (docs/closed_loop.md).
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

TEST(SimAutopilot, TheMissionIsHandedOutAsEachStackDoes)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        const bool ardupilot = s->stack == Stack::ardupilot;
        Line line(*s);
        line.run(0.6);
        const auto current = line.heard<MissionCurrent>();
        ASSERT_TRUE(current);
        EXPECT_EQ(current->seq, ardupilot ? 2 : 1);
        line.send(MissionRequestList{1, 1, 0});
        const auto count = line.heard<MissionCount>();
        ASSERT_TRUE(count);
        EXPECT_EQ(count->count, ardupilot ? 3 : 2);
        EXPECT_EQ(count->opaque_id, current->mission_id);
        for (std::uint16_t k = 0; k < count->count; ++k) {
            line.send(MissionRequestInt{k, 1, 1, 0});
            ASSERT_TRUE(line.heard<MissionItemInt>());
            EXPECT_EQ(line.heard<MissionItemInt>()->seq, k);
        }
        const auto item = line.heard<MissionItemInt>();
        EXPECT_EQ(item->frame, ardupilot ? 3 : 6);
        EXPECT_EQ(item->z, 30.0F);
        EXPECT_EQ(item->current, 1);
        line.send(MissionAck{1, 1, 0, 0, 0});
        line.run(6.0);
        EXPECT_TRUE(line.autopilot.critical_texts().empty());
    }
}

TEST(SimAutopilot, ArdupilotHandsOutSingleItems)
{
    Line line(kArdupilotFlight);
    line.send(MissionRequestInt{2, 1, 1, 0});
    ASSERT_TRUE(line.heard<MissionItemInt>());
    EXPECT_EQ(line.heard<MissionItemInt>()->seq, 2);
    line.forget();
    line.send(MissionRequestInt{7, 1, 1, 0});
    EXPECT_FALSE(line.heard<MissionItemInt>());
    EXPECT_TRUE(line.heard<MissionAck>());
    EXPECT_TRUE(line.autopilot.critical_texts().empty());
}

TEST(SimAutopilot, Px4AnswersItemsOutOfOrderWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionRequestList{1, 1, 0});
    line.send(MissionRequestInt{1, 1, 1, 0});
    EXPECT_FALSE(line.heard<MissionItemInt>());
    ASSERT_TRUE(line.heard<Statustext>());
    EXPECT_EQ(line.heard<Statustext>()->severity, 2);
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "WPM: REJ. CMD: Req. WP was unexpected");
    line.send(MissionRequestInt{0, 1, 1, 0});  // the transfer is over
    EXPECT_FALSE(line.heard<MissionItemInt>());
    line.run(10.0);
    EXPECT_EQ(line.autopilot.critical_texts().size(), 1U);
}

TEST(SimAutopilot, Px4EndsATransferThatRestsWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionRequestList{1, 1, 0});
    line.run(3.0);
    line.send(MissionRequestInt{0, 1, 1, 0});
    line.run(4.9);
    EXPECT_TRUE(line.autopilot.critical_texts().empty());
    line.run(0.2);
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "Operation timeout");
}

TEST(SimAutopilot, Px4AnswersAMissionAckOfAStrangerWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionAck{1, 1, 0, 0, 0});
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "REJ. WP CMD: partner id mismatch");
}

// Counted in the recordings: PX4 103 in 103 s with every change of mode; ArduCopter 246 in 237 s.
TEST(SimAutopilot, ArdupilotTellsAChangeOfModeAtOncePx4WithItsNextHeartbeat)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        const bool px4 = s->stack == Stack::px4;
        Line line(*s);
        line.run(1.5, true);
        line.forget();
        ASSERT_EQ(line.ask(px4 ? 6.0F : 4.0F), 0);
        EXPECT_EQ(line.count<Heartbeat>(), px4 ? 0 : 1);
        EXPECT_EQ(line.count<CommandAck>(), px4 ? 2 : 1);
        line.run(0.6, true);
        EXPECT_EQ(line.count<Heartbeat>(), px4 ? 1 : 2);
    }
}

TEST(SimAutopilot, AHeartbeatIsSentWhenAskedForAndItsIntervalIsFixedInPx4)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        Line line(*s);
        line.run(0.5);
        line.forget();
        CommandLong m;
        m.command = 512;
        m.target_system = m.target_component = 1;
        line.send(m);
        EXPECT_EQ(line.count<Heartbeat>(), 1);
        EXPECT_EQ(line.heard<CommandAck>()->result, 0);
        m.command = 511;
        line.send(m);
        EXPECT_EQ(line.heard<CommandAck>()->result, s->stack == Stack::px4 ? 4 : 0);
    }
}

TEST(SimAutopilot, HomeLiesApartFromTheOrigin)
{
    for (const Scenario* given : {&kArdupilotFlight, &kPx4Flight}) {
        const bool px4 = given->stack == Stack::px4;
        Scenario s = *given;
        s.home = Vec(30.0, -20.0, 12.0);
        Line line(s);
        line.run(0.1);
        const auto home = line.heard<HomePosition>();
        const auto origin = line.heard<GpsGlobalOrigin>();
        ASSERT_TRUE(home && origin);
        EXPECT_NEAR(home->altitude - origin->altitude, 12'000, px4 ? 1'000 : 0);
        EXPECT_NEAR(static_cast<double>(home->latitude - origin->latitude) * 0.0111, -20.0, 0.1);
        // ArduPilot's local values are 0 always.
        EXPECT_NEAR(static_cast<double>(home->y), px4 ? 30.0 : 0.0, 1e-6);
        EXPECT_NEAR(static_cast<double>(home->z), px4 ? -12.0 : 0.0, px4 ? 1.0 : 0.0);
        line.send(MissionRequestList{1, 1, 0});
        line.send(MissionRequestInt{0, 1, 1, 0});
        if (px4) {
            EXPECT_EQ(line.heard<MissionItemInt>()->z, 18.0F);  // above home
        }
    }
}

TEST(SimAutopilot, Px4TellsItsControllersSetpointAndNotTheLeg)
{
    Line line(kPx4Flight);
    line.run(5.0);
    const auto target = line.heard<PositionTargetLocalNed>();
    const auto own = line.heard<LocalPositionNed>();
    ASSERT_TRUE(target && own);
    EXPECT_EQ(target->type_mask, 0);
    EXPECT_NEAR(static_cast<double>(target->y), static_cast<double>(own->y), 1.0);
    EXPECT_NEAR(static_cast<double>(target->vy), 5.0, 0.1);
    ASSERT_EQ((line.run(1.0, true), line.ask(6.0F)), 0);
    line.run(0.2, true);
    EXPECT_EQ(line.heard<PositionTargetLocalNed>()->type_mask, 7);
    EXPECT_TRUE(std::isnan(line.heard<PositionTargetLocalNed>()->x));
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
    EXPECT_EQ(line.autopilot.heard().setpoints_overruled, 0U);  // under way
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

TEST(SimAutopilot, TrafficIsToldWithItsSpeedAndPointsAsObstacles)
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
