// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/dronecan_endpoint_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

TEST_F(DronecanEndpoint, OwnStateIsPlacedAboutTheOrigin)
{
    give(attitude(kHalfPi));  // east
    Fix2 m = fix(10000, 10000);
    m.covariance.resize(6);
    const float variances[] = {4.0F, 4.0F, 9.0F, 0.25F, 0.25F, 0.16F};
    std::copy(std::begin(variances), std::end(variances), m.covariance.begin());
    give(m);
    ASSERT_TRUE(inbox.has_bus_state);
    const vehicle::VehicleState& own = inbox.bus_state.state;
    const float metres = 1e-3F * kPi / 180.0F * mavlink::kEarthRadius;
    expect_near(own.position, {metres * std::cos(47.4F * kPi / 180.0F), metres, 20.0F}, 0.05F);
    expect_near(own.velocity, {1.0F, 3.0F, 0.5F}, 1e-6F);
    EXPECT_NEAR(own.yaw, 0.0F, 1e-3F);
    EXPECT_EQ(own.stamp, now);
    EXPECT_EQ(own.sigma_position, 3.0F);
    EXPECT_EQ(own.sigma_velocity, 0.5F);
}

TEST_F(DronecanEndpoint, CovariancesOfEachForm)
{
    struct Form {
        std::size_t size;
        std::array<std::size_t, 6> diagonal;
    };
    for (const Form& form : {Form{1, {0, 0, 0, 0, 0, 0}}, Form{6, {0, 1, 2, 3, 4, 5}}, Form{21, {0, 6, 11, 15, 18, 20}},
                             Form{36, {0, 7, 14, 21, 28, 35}}}) {
        for (std::size_t i = 0; i < 6; ++i) {
            Fix2 m = fix();
            m.covariance.resize(form.size);
            std::fill(m.covariance.begin(), m.covariance.end(), 0.0F);
            for (const std::size_t at : form.diagonal) {
                m.covariance[at] = 1.0F;
            }
            m.covariance[form.diagonal[i]] = 16.0F;
            give(m);
            const bool all = form.size == 1;
            EXPECT_EQ(inbox.bus_state.state.sigma_position, i < 3 || all ? 4.0F : 1.0F) << form.size;
            EXPECT_EQ(inbox.bus_state.state.sigma_velocity, i >= 3 || all ? 4.0F : 1.0F) << form.size;
        }
    }
    Fix2 m = fix();
    m.covariance.resize(6);
    std::fill(m.covariance.begin(), m.covariance.end(), 4.0F);
    m.covariance[1] = 0.0F;  // the others are unchanged
    give(m);
    EXPECT_EQ(inbox.bus_state.state.sigma_position, 2.0F);
    m.covariance[1] = -1.0F;
    give(m);
    EXPECT_EQ(inbox.bus_state.state.sigma_position, 0.0F);
    for (const float bad : {kNan, -1.0F, 0.0F, kInfinity}) {
        m.covariance.resize(1);
        m.covariance[0] = bad;
        give(m);
        EXPECT_EQ(inbox.bus_state.state.sigma_position, 0.0F);
    }
    m.covariance.resize(5);
    give(m);
    EXPECT_EQ(inbox.bus_state.state.sigma_position, 0.0F);
}

TEST_F(DronecanEndpoint, WithoutAnOriginTheFirstFixIsIt)
{
    Endpoint fresh(options_of(42), {});
    give(traffic());
    EXPECT_FALSE(inbox.tracks.empty());
    inbox.clear();
    const auto frames = frames_of(traffic(), 20);
    for (const Frame& frame : frames) {
        static_cast<void>(fresh.receive(frame, now, inbox));
    }
    EXPECT_TRUE(inbox.tracks.empty());
    EXPECT_EQ(fresh.diagnostics().no_origin, 1U);
    for (const Frame& frame : frames_of(fix(), 20)) {
        static_cast<void>(fresh.receive(frame, now, inbox));
    }
    EXPECT_TRUE(fresh.has_origin());
    expect_near(inbox.bus_state.state.position, Vec3::Zero(), 1e-6F);
}

TEST_F(DronecanEndpoint, OneOfSeveralReceiversIsFollowed)
{
    give(fix(), 20);
    give(fix(1000), 21);
    EXPECT_EQ(seen().frames_ignored, 1U);
    EXPECT_LT(inbox.bus_state.state.position.y(), 1.0F);
    EXPECT_FALSE(inbox.bus_state.estimator_reset);
    now = now + 0.6F;
    Fix2 lost = fix();
    lost.status = Fix2::Status::no_fix;
    give(lost, 20);  // a receiver without a fix is as good as none
    now = now + 0.6F;
    give(fix(1000), 21);
    EXPECT_GT(inbox.bus_state.state.position.y(), 10.0F);
    EXPECT_TRUE(inbox.bus_state.estimator_reset);
    inbox.clear();
    give(fix(1000), 21);
    EXPECT_FALSE(inbox.bus_state.estimator_reset);
    give(fix(), 20);
    EXPECT_EQ(seen().frames_ignored, 2U);

    give(attitude(0.0), 20);
    give(attitude(kHalfPi), 21);
    give(proximity(0.0F, 5.0F));
    expect_near(inbox.readings[0].direction, {0.0F, 1.0F, 0.0F}, 2e-3F);
    EXPECT_EQ(seen().frames_ignored, 3U);
}

TEST_F(DronecanEndpoint, BadFixesAreRefused)
{
    std::uint32_t refused = 0;
    for (const Fix2::Status status : {Fix2::Status::no_fix, Fix2::Status::time_only, Fix2::Status::fix_2d}) {
        Fix2 m = fix();
        m.status = status;
        give(m);
        EXPECT_EQ(seen().out_of_range, ++refused);
    }
    Fix2 m = fix();
    m.latitude = 8'500'000'010;
    give(m);
    EXPECT_EQ(seen().out_of_range, ++refused);
    m.latitude = 9'100'000'000;
    give(m);
    EXPECT_EQ(seen().out_of_range, ++refused);
    m = fix();
    m.longitude = 18'000'000'001;
    give(m);
    EXPECT_EQ(seen().out_of_range, ++refused);
    give(fix(20'000'000));  // 222 km away
    EXPECT_EQ(seen().out_of_range, ++refused);
    m = fix();
    m.velocity[0] = 401.0F;
    give(m);
    EXPECT_EQ(seen().out_of_range, ++refused);
    for (const float bad : {kNan, kInfinity}) {
        m.velocity[0] = bad;
        give(m);
    }
    EXPECT_EQ(seen().not_finite, 2U);
    EXPECT_FALSE(inbox.has_bus_state);
}

TEST_F(DronecanEndpoint, Traffic)
{
    give(traffic());
    ASSERT_EQ(inbox.tracks.size(), 1U);
    const TrackReport& track = inbox.tracks[0];
    EXPECT_EQ(track.id, 0xABCDEFU);
    EXPECT_EQ(track.stamp, now - 2.0F);
    expect_near(track.position, {0.0F, 111.32F, 50.0F}, 0.05F);
    EXPECT_TRUE(track.has_velocity);
    expect_near(track.velocity, {-20.0F, 10.0F, -2.0F}, 1e-2F);
    EXPECT_FALSE(track.at_rest);
    EXPECT_FALSE(track.unmanned);
    EXPECT_EQ(track.sigma_velocity, 0.0F) << "not said";

    TrafficReport m = traffic();
    m.vertical_velocity_valid = false;
    give(m);
    EXPECT_EQ(inbox.tracks[1].velocity.z(), 0.0F);
    EXPECT_GE(inbox.tracks[1].sigma_velocity, 5.0F) << "it may climb";
    m.velocity_valid = false;
    m.velocity[0] = kNan;  // not reported: no fault
    give(m);
    EXPECT_FALSE(inbox.tracks[2].has_velocity);
    m.traffic_type = TrafficReport::kPointObstacle;
    give(m);
    EXPECT_TRUE(inbox.tracks[3].at_rest);
    EXPECT_TRUE(inbox.tracks[3].has_velocity);
    expect_near(inbox.tracks[3].velocity, Vec3::Zero(), 0.0F);
    m.traffic_type = 14;
    m.icao = 0x05000007;  // no address of 24 bits, and not system 7
    give(m);
    EXPECT_TRUE(inbox.tracks[4].unmanned);
    EXPECT_EQ(inbox.tracks[4].id, 0x85000007U);
}

/// alt_type of the definition: 0 unknown, 1 pressure, 2 WGS84. An unknown kind of height is no geometric one.
TEST_F(DronecanEndpoint, OnlyAHeightOfSatellitesIsGeometric)
{
    TrafficReport m = traffic();
    for (std::uint8_t type = 0; type < 4; ++type) {
        m.altitude_type = type;
        give(m);
        EXPECT_EQ(inbox.tracks[type].height == HeightSource::geometric, type == 2) << int(type);
    }
    EXPECT_EQ(seen().pressure_heights, 3U);
}

TEST_F(DronecanEndpoint, BadTrafficIsRefused)
{
    TrafficReport m = traffic();
    m.position_valid = false;
    give(m);
    m = traffic();
    m.latitude = 900000001;
    give(m);
    m = traffic();
    m.altitude = 1.1e6F;
    give(m);
    EXPECT_EQ(seen().out_of_range, 3U);
    m.altitude = kInfinity;
    give(m);
    m = traffic();
    m.velocity[2] = kInfinity;
    give(m);
    EXPECT_EQ(seen().not_finite, 2U);
    EXPECT_TRUE(inbox.tracks.empty());
}

TEST_F(DronecanEndpoint, TheInboxHasItsLimits)
{
    for (std::size_t i = 0; i < inbox.tracks.capacity() + 2; ++i) {
        give(traffic());
    }
    EXPECT_EQ(seen().inbox_full, 2U);
    give(attitude(0.0));
    for (std::size_t i = 0; i < inbox.readings.capacity() + 1; ++i) {
        give(proximity(0.0F, 5.0F));
    }
    EXPECT_EQ(seen().inbox_full, 3U);
}

TEST_F(DronecanEndpoint, BadAttitudesAreRefused)
{
    AhrsSolution m = attitude(0.0);
    m.orientation[3] = 0.9F;
    give(m);
    m.orientation = {};
    give(m);
    EXPECT_EQ(seen().out_of_range, 2U);
    m.orientation[0] = kNan;
    give(m);
    EXPECT_EQ(seen().not_finite, 1U);
    give(proximity(0.0F, 5.0F));
    EXPECT_EQ(seen().no_origin, 1U);
}

TEST_F(DronecanEndpoint, StampsAreBelievedOnRequestOnly)
{
    const auto run = [&](bool believe, std::int64_t age) {
        EndpointOptions options = options_;
        options.believe_stamps = believe;
        Endpoint e(options_of(42), options);
        Inbox box;
        GlobalTimeSync sync;
        static_cast<void>(e.receive(frames_of(sync, 1, 0)[0], {8'000'000}, box));
        sync.previous_transmission = 500'000'000;  // that was at 8 s of ours
        static_cast<void>(e.receive(frames_of(sync, 1, 1)[0], {9'000'000}, box));
        Fix2 m = fix();
        m.stamp = static_cast<std::uint64_t>(502'000'000 - age);
        for (const Frame& frame : frames_of(m, 20)) {
            static_cast<void>(e.receive(frame, {10'000'000}, box));
        }
        EXPECT_EQ(e.diagnostics().stale_stamp, box.has_bus_state ? 0U : 1U);
        return box.has_bus_state ? box.bus_state.state.stamp.us : -1;
    };
    EXPECT_EQ(run(false, 300'000), 10'000'000);
    EXPECT_EQ(run(true, 300'000), 9'700'000);
    EXPECT_EQ(run(true, -40'000), 10'000'000);  // a little ahead
    EXPECT_EQ(run(true, -60'000), -1);
    EXPECT_EQ(run(true, 1'001'000), -1);
    EXPECT_EQ(run(true, 999'000), 9'001'000);
}

TEST_F(DronecanEndpoint, FramesGoOutOnceTaken)
{
    EXPECT_EQ(endpoint.pending(), nullptr);
    endpoint.service(now, SystemState::active);
    ASSERT_NE(endpoint.pending(), nullptr);
    endpoint.consume();
    EXPECT_EQ(endpoint.pending(), nullptr);
    EXPECT_EQ(seen().frames_out, 1U);
    endpoint.send_text(Severity::info, "one");
    EXPECT_NE(endpoint.pending(), nullptr);
    endpoint.discard_pending();
    EXPECT_EQ(endpoint.pending(), nullptr);
    EXPECT_EQ(seen().frames_out, 1U);
}

TEST(DronecanMavlinkTunnel, AMavlinkEndpointSpeaksThroughTheBus)
{
    // Our node with a MAVLink endpoint behind its tunnel; at the other end bytes are just bytes.
    Endpoint ours(options_of(42), {});
    Node theirs(options_of(1));
    Tunnel our_tunnel;
    Tunnel their_tunnel({42, 0, 1});
    mavlink::Endpoint mavlink;
    Inbox inbox;
    TimePoint now{1'000'000};

    // HEARTBEAT of an autopilot (system 1, component 1: ArduPilot copter in AUTO, armed), made by our own encoder.
    mavlink::Heartbeat heartbeat{};
    heartbeat.custom_mode = 3;
    heartbeat.type = 2;
    heartbeat.autopilot = 3;
    heartbeat.base_mode = 0x81;
    heartbeat.system_status = 4;
    heartbeat.mavlink_version = 3;
    Bytes bytes(mavlink::kMaxFrame);
    bytes.resize(mavlink::encode(heartbeat, {1, 1, 0}, bytes));
    ASSERT_EQ(their_tunnel.write(theirs, bytes), bytes.size());
    while (theirs.outgoing().front() != nullptr) {
        if (const Transfer* const t = ours.receive(*theirs.outgoing().front(), now, inbox)) {
            our_tunnel.receive(ours.node(), *t);
        }
        theirs.outgoing().pop();
    }
    Bytes arrived(512);
    arrived.resize(our_tunnel.read(arrived));
    EXPECT_EQ(to_hex(arrived), to_hex(bytes));
    mavlink.receive(arrived, now, inbox);
    EXPECT_TRUE(inbox.has_autopilot);
    EXPECT_EQ(inbox.autopilot.mode, FlightMode::mission);

    mavlink.send_heartbeat(SystemState::active);
    mavlink.send_velocity({1.0F, 2.0F, 0.5F}, now);
    const Bytes sent(mavlink.pending().begin(), mavlink.pending().end());
    mavlink.consume(our_tunnel.write(ours.node(), mavlink.pending()));
    EXPECT_TRUE(mavlink.pending().empty());
    while (ours.pending() != nullptr) {
        if (const Transfer* const t = theirs.receive(*ours.pending(), now)) {
            their_tunnel.receive(theirs, *t);
        }
        ours.consume();
    }
    arrived.resize(512);
    arrived.resize(their_tunnel.read(arrived));
    EXPECT_EQ(to_hex(arrived), to_hex(sent));
}

}  // namespace
}  // namespace jink::link::dronecan
