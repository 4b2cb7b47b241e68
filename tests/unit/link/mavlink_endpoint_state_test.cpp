// SPDX-License-Identifier: BSD-3-Clause
// The endpoint's handling of the autopilot's reports on itself: mode, own state.
#include <gtest/gtest.h>
#include <limits>

#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkEndpointState = EndpointTest;

TEST_F(MavlinkEndpointState, NothingCountsBeforeAnAutopilotIsHeard)
{
    local_position();
    attitude(0.0F);
    origin();
    EXPECT_FALSE(inbox->has_own_state);
    EXPECT_FALSE(endpoint->has_origin());
    EXPECT_EQ(count().frames_ignored, 3U);
    EXPECT_EQ(endpoint->system_id(), 0);
    endpoint->send_velocity({1, 2, 3}, now);
    endpoint->request_external_mode();
    endpoint->send_text(Severity::info, "hello");
    endpoint->service(now);
    EXPECT_TRUE(endpoint->pending().empty()) << "nobody known to speak to";
    endpoint->send_heartbeat(SystemState::boot);
    const std::vector<Received> frames = sent();
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].message_id, Heartbeat::kInfo.id);
    EXPECT_EQ(frames[0].header.system_id, 1) << "0 is nobody's";
}

TEST_F(MavlinkEndpointState, LearnsItsSystemFromTheFirstAutopilot)
{
    Heartbeat ground_station;
    ground_station.type = 6;
    ground_station.autopilot = 8;
    from(255, 190, ground_station);
    Heartbeat gimbal;
    gimbal.type = 26;
    gimbal.autopilot = 8;
    from(kSystem, 154, gimbal);
    Heartbeat companion;
    companion.autopilot = 8;
    from(kSystem, 1, companion);
    EXPECT_EQ(endpoint->system_id(), 0);
    EXPECT_EQ(endpoint->own_track(), 0U);
    heartbeat();
    EXPECT_EQ(endpoint->system_id(), kSystem);
    Heartbeat other;
    other.autopilot = 3;
    from(9, 1, other);
    EXPECT_EQ(endpoint->system_id(), kSystem) << "stays with the first";
    EXPECT_TRUE(inbox->has_autopilot);
    EXPECT_EQ(count().frames_ignored, 3U) << "another vehicle is not of no interest";
    EXPECT_EQ(endpoint->own_track(), 0x05000000U + kSystem);
}

TEST_F(MavlinkEndpointState, SystemIdMayBeFixed)
{
    EndpointOptions options;
    options.system_id = 9;
    endpoint = std::make_unique<Endpoint>(options);
    heartbeat();
    EXPECT_FALSE(inbox->has_autopilot);
    Heartbeat m;
    m.autopilot = 12;
    from(9, 1, m);
    EXPECT_TRUE(inbox->has_autopilot);
    EXPECT_EQ(inbox->autopilot.stack, AutopilotStack::px4);
}

TEST_F(MavlinkEndpointState, HeartbeatTellsStackModeAndArming)
{
    heartbeat(3, 3, true, 2);
    EXPECT_EQ(inbox->autopilot.stack, AutopilotStack::ardupilot);
    EXPECT_EQ(inbox->autopilot.mode, FlightMode::mission);
    EXPECT_TRUE(inbox->autopilot.armed);
    EXPECT_FALSE(inbox->autopilot.fixed_wing);
    EXPECT_EQ(inbox->autopilot.stamp, now);
    heartbeat(12, 4U << 16U | 4U << 24U, false, 1);
    EXPECT_EQ(inbox->autopilot.stack, AutopilotStack::px4);
    EXPECT_EQ(inbox->autopilot.mode, FlightMode::mission);
    EXPECT_EQ(inbox->autopilot.custom_mode, 0x04040000U);
    EXPECT_FALSE(inbox->autopilot.armed);
    EXPECT_TRUE(inbox->autopilot.fixed_wing);
    heartbeat(99, 3);
    EXPECT_EQ(inbox->autopilot.stack, AutopilotStack::unknown);
    EXPECT_EQ(inbox->autopilot.mode, FlightMode::unknown);
}

TEST_F(MavlinkEndpointState, LandedStateGoesWithTheNextHeartbeat)
{
    heartbeat();
    EXPECT_FALSE(inbox->autopilot.landed);
    ExtendedSysState m;
    m.landed_state = 1;
    autopilot(m);
    heartbeat();
    EXPECT_TRUE(inbox->autopilot.landed);
    for (const std::uint8_t airborne : {0, 2, 3, 4}) {
        m.landed_state = airborne;
        autopilot(m);
        heartbeat();
        EXPECT_FALSE(inbox->autopilot.landed);
    }
}

TEST_F(MavlinkEndpointState, LocalPositionIsTurnedToEnu)
{
    heartbeat();
    local_position({1, 2, -3}, {4, 5, -6});
    ASSERT_TRUE(inbox->has_own_state);
    EXPECT_EQ(inbox->own_state.state.position, Vec3(2, 1, 3));
    EXPECT_EQ(inbox->own_state.state.velocity, Vec3(5, 4, 6));
    EXPECT_EQ(inbox->own_state.state.stamp, now);
    EXPECT_FALSE(inbox->own_state.estimator_reset);
}

TEST_F(MavlinkEndpointState, YawIsCounterClockwiseFromEast)
{
    heartbeat();
    constexpr float kRight = kPi / 2;
    const std::array<std::array<float, 2>, 4> cases{
        {{0.0F, kRight}, {kRight, 0.0F}, {-kRight, kPi}, {0.5F, kRight - 0.5F}}};
    for (const auto& [heading, yaw] : cases) {
        attitude(heading);
        local_position();
        EXPECT_NEAR(inbox->own_state.state.yaw, yaw, 1e-5F);
        Attitude euler;
        euler.yaw = heading + 0.25F;
        autopilot(euler);
        local_position();
        EXPECT_NEAR(inbox->own_state.state.yaw, yaw - 0.25F, 1e-5F);
    }
}

TEST_F(MavlinkEndpointState, OdometryWinsOverLocalPositionWhileFresh)
{
    heartbeat();
    Odometry m;
    m.time_usec = static_cast<std::uint64_t>(now.us - kBootOffset);
    m.frame_id = 1;
    m.child_frame_id = 12;
    m.x = 10;
    m.y = 20;
    m.z = -30;
    m.vx = 2;                                        // forward
    m.vz = 1;                                        // down
    m.q = {std::sqrt(0.5F), 0, 0, std::sqrt(0.5F)};  // heading east
    m.pose_covariance[0] = 0.25F;
    m.pose_covariance[6] = 1.0F;
    m.pose_covariance[11] = 0.01F;
    m.velocity_covariance[0] = kNan;
    autopilot(m);
    ASSERT_TRUE(inbox->has_own_state);
    const auto& state = inbox->own_state.state;
    expect_near(state.position, {20, 10, 30}, 0.0F);
    expect_near(state.velocity, {2, 0, -1}, 1e-6F);
    EXPECT_NEAR(state.yaw, 0.0F, 1e-6F);
    EXPECT_EQ(state.sigma_position, 1.0F);
    EXPECT_EQ(state.sigma_velocity, 0.0F);
    clear();
    wait(0.15F);
    local_position({1, 1, 1});
    EXPECT_FALSE(inbox->has_own_state);
    wait(0.1F);
    local_position({1, 1, 1});
    EXPECT_TRUE(inbox->has_own_state) << "well before the own state is stale";
    EXPECT_EQ(inbox->own_state.state.sigma_position, 0.0F);
}

TEST_F(MavlinkEndpointState, OdometryVelocityKeepsItsLengthWhateverTheScaleOfQ)
{
    heartbeat();
    for (const float scale : {0.96F, 1.0F, 1.04F}) {
        Odometry m;
        m.time_usec = static_cast<std::uint64_t>(now.us - kBootOffset);
        m.frame_id = 1;
        m.child_frame_id = 8;
        m.vx = 10;
        m.q = {0, 0, 0, scale};  // heading south
        autopilot(m);
        expect_near(inbox->own_state.state.velocity, {0, -10, 0}, 1e-4F);
    }
    Odometry world;
    world.frame_id = world.child_frame_id = 1;
    world.q = {0, 0, 0, 1};
    world.vx = 10;
    world.time_usec = 2'000'000'000'000'000;  // since 1970: cannot be mapped, counts as just arrived
    autopilot(world);
    expect_near(inbox->own_state.state.velocity, {0, 10, 0}, 0.0F);
    EXPECT_EQ(inbox->own_state.state.stamp, now);
}

TEST_F(MavlinkEndpointState, ResetCounterIsReportedOnceAndKeptUntilTheInboxIsEmptied)
{
    heartbeat();
    Odometry m;
    m.frame_id = m.child_frame_id = 1;
    m.q = {1, 0, 0, 0};
    const auto send = [&](std::uint8_t counter) {
        m.reset_counter = counter;
        m.time_usec = static_cast<std::uint64_t>(now.us - kBootOffset);
        autopilot(m);
    };
    send(5);
    EXPECT_FALSE(inbox->own_state.estimator_reset) << "the first value is no change";
    send(6);
    EXPECT_TRUE(inbox->own_state.estimator_reset);
    send(6);
    EXPECT_TRUE(inbox->own_state.estimator_reset) << "not read yet";
    clear();
    send(6);
    EXPECT_FALSE(inbox->own_state.estimator_reset);
    send(255);
    clear();
    send(0);
    EXPECT_TRUE(inbox->own_state.estimator_reset) << "wraps";
}

TEST_F(MavlinkEndpointState, OwnStateThatIsNotFiniteIsRefused)
{
    heartbeat();
    std::uint32_t refused = 0;
    for (const float bad : {kNan, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
        for (const Vec3& v : {Vec3(bad, 0, 0), Vec3(0, bad, 0), Vec3(0, 0, bad)}) {
            local_position(v);
            local_position(Vec3::Zero(), v);
            EXPECT_EQ(count().not_finite, refused += 2);
        }
        AttitudeQuaternion q;
        q.q1 = 1;
        q.q3 = bad;
        autopilot(q);
        Attitude euler;
        euler.yaw = bad;
        autopilot(euler);
        Odometry m;
        m.frame_id = m.child_frame_id = 1;
        m.q = {1, 0, 0, bad};
        autopilot(m);
        m.q = {1, 0, 0, 0};
        m.vy = bad;
        autopilot(m);
        EXPECT_EQ(count().not_finite, refused += 4);
    }
    EXPECT_FALSE(inbox->has_own_state);
}

TEST_F(MavlinkEndpointState, AbsurdOwnStateIsRefused)
{
    heartbeat();
    local_position({3e5F, 0, 0});
    local_position({0, 0, 0}, {0, 500, 0});
    local_position({3e38F, 3e38F, 0});
    EXPECT_EQ(count().out_of_range, 3U);
    AttitudeQuaternion q;
    q.q1 = 0.5F;
    autopilot(q);
    Attitude euler;
    euler.yaw = 100.0F;
    autopilot(euler);
    EXPECT_EQ(count().out_of_range, 5U);
    Odometry m;
    m.q = {1, 0, 0, 0};
    m.frame_id = 20;  // LOCAL_FRD: turned against north by an unknown angle
    m.child_frame_id = 1;
    autopilot(m);
    m.frame_id = 1;
    m.child_frame_id = 20;
    autopilot(m);
    m.child_frame_id = 1;
    m.q = {0, 0, 0, 0};
    autopilot(m);
    m.q = {1, 0, 0, 0};
    m.x = 1e6F;
    autopilot(m);
    EXPECT_EQ(count().out_of_range, 9U);
    EXPECT_FALSE(inbox->has_own_state);
}

TEST_F(MavlinkEndpointState, OwnStateIsTheAutopilotsAlone)
{
    heartbeat();
    LocalPositionNed m;
    m.time_boot_ms = boot_ms();
    from(kSystem, 2, m);
    from(8, 1, m);
    EXPECT_FALSE(inbox->has_own_state);
    EXPECT_EQ(count().frames_ignored, 2U);
}

TEST_F(MavlinkEndpointState, AFrameHeldUpByAFalseStartComesOutAfterSilence)
{
    heartbeat();
    local_position({1, 0, 0});
    clear();
    Bytes bytes = from_hex("fdff00000001016e0000");  // claims 267 bytes
    LocalPositionNed m;
    m.time_boot_ms = boot_ms();
    m.x = 2;
    const Bytes good = frame_of(m, {kSystem, 1, sequence++});
    bytes.insert(bytes.end(), good.begin(), good.end());
    endpoint->receive(bytes, now, *inbox);
    EXPECT_FALSE(inbox->has_own_state);
    wait(0.05F);
    endpoint->receive({}, now, *inbox);
    EXPECT_FALSE(inbox->has_own_state);
    wait(0.1F);
    endpoint->receive({}, now, *inbox);
    ASSERT_TRUE(inbox->has_own_state);
    EXPECT_EQ(inbox->own_state.state.position, Vec3(0, 2, 0));
    EXPECT_EQ(count().frames_refused, 1U);
}

}  // namespace
}  // namespace jink::link::mavlink
