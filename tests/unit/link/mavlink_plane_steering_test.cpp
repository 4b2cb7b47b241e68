// SPDX-License-Identifier: BSD-3-Clause
// Commands to ArduPlane in place of velocities: DO_REPOSITION, its times and targets, and when it is omitted.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/link/mavlink/plane_steering.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
constexpr std::uint32_t kPlaneAuto = 10;
constexpr std::uint32_t kPlaneGuided = 15;
constexpr std::uint8_t kPlaneType = 1;

class MavlinkPlane : public EndpointTest {
protected:
    void SetUp() override
    {
        plane_state(0);
        plane_in(kPlaneGuided);
        origin();
        local_position({100.0F, 50.0F, -80.0F}, {18.0F, 0.0F, 0.0F});  // north
        static_cast<void>(sent());
    }
    void plane_in(std::uint32_t mode) { heartbeat(3, mode, true, kPlaneType); }
    void plane_state(std::uint8_t vtol)
    {
        heartbeat(3, kPlaneAuto, true, kPlaneType);
        ExtendedSysState m;
        m.vtol_state = vtol;
        m.landed_state = 2;
        autopilot(m);
    }
    int points_in(float seconds, const Vec3& velocity)
    {
        int n = 0;
        for (const TimePoint end = now + seconds; now < end; wait(0.02F)) {
            endpoint->send_velocity(velocity, now);
            n += static_cast<int>(sent().size());
        }
        return n;
    }
};

TEST_F(MavlinkPlane, AVelocityGoesOutAsAGuidedPointAhead)
{
    endpoint->send_velocity({0.0F, 20.0F, 2.0F}, now);
    const CommandInt m = sent_one<CommandInt>();
    EXPECT_EQ(m.command, 192) << "DO_REPOSITION";
    EXPECT_EQ(m.target_system, kSystem);
    EXPECT_EQ(m.target_component, 1);
    EXPECT_EQ(m.frame, 5) << "MAV_FRAME_GLOBAL_INT";
    EXPECT_EQ(m.param1, -1.0F) << "speed as it is";
    EXPECT_EQ(m.param2, 0.0F) << "no change of mode";
    EXPECT_EQ(m.param3, 0.0F);
    EXPECT_EQ(m.param4, 0.0F);
    EXPECT_EQ(m.current, 0);
    EXPECT_EQ(m.autocontinue, 0);
    // 100 m north of the origin, 500 m further north; 50 m east. 1e-7 degree of latitude: 0.0111319 m.
    EXPECT_NEAR(m.x, 473977420 + 600.0 / 0.0111319491, 20.0);
    EXPECT_NEAR(m.y, 85455940 + 50.0 / (0.0111319491 * std::cos(47.397742 * 3.14159265358979 / 180.0)), 20.0);
    EXPECT_NEAR(m.z, 488.0F + 80.0F + 8.0F, 0.01F);
}

TEST_F(MavlinkPlane, NothingIsSentOutsideOfGuidedOrWithoutAnOrigin)
{
    for (const std::uint32_t mode : {kPlaneAuto, 0U, 6U, 11U, 12U, 21U}) {
        plane_in(mode);
        EXPECT_EQ(points_in(3.0F, {18.0F, 0.0F, 0.0F}), 0) << mode;
    }
    endpoint = std::make_unique<Endpoint>();
    plane_state(0);
    plane_in(kPlaneGuided);
    local_position();
    static_cast<void>(sent());
    EXPECT_EQ(points_in(3.0F, {18.0F, 0.0F, 0.0F}), 0);
    origin();
    EXPECT_GT(points_in(1.0F, {18.0F, 0.0F, 0.0F}), 0);
}

TEST_F(MavlinkPlane, AtMostTwoPointsASecondAndOneWithoutNews)
{
    EXPECT_EQ(points_in(10.0F, {18.0F, 0.0F, 0.0F}), 10);
    int n = 0;
    for (int i = 0; i < 1000; ++i, wait(0.02F)) {
        const float course = 0.02F * static_cast<float>(i) * 0.3F;
        endpoint->send_velocity({18.0F * std::cos(course), 18.0F * std::sin(course), 0.0F}, now);
        n += static_cast<int>(sent().size());
    }
    EXPECT_LE(n, 41) << "20 s of a turn";
    EXPECT_GE(n, 36);
}

TEST_F(MavlinkPlane, APointThatWasTakenBackFromTheLineIsFollowedByTheNextAtOnce)
{
    endpoint->send_velocity({18.0F, 0.0F, 0.0F}, now);
    endpoint->drop_setpoint();
    EXPECT_TRUE(sent().empty());
    wait(0.05F);
    endpoint->send_velocity({18.0F, 0.0F, 0.0F}, now);
    EXPECT_EQ(sent_one<CommandInt>().command, 192);
    EXPECT_EQ(count().setpoints_dropped, 1U);
}

TEST_F(MavlinkPlane, ARefusedPointIsFollowedByANearerOne)
{
    const Vec3 north(0.0F, 20.0F, 0.0F);
    CommandAck ack;
    ack.command = 192;
    ack.result = 2;
    ack.target_system = kSystem;
    ack.target_component = kUs;
    double before = 500.0;
    for (const double ahead : {500.0, 250.0, 150.0, 150.0}) {
        endpoint->send_velocity(north, now);
        const CommandInt m = sent_one<CommandInt>();
        EXPECT_NEAR((m.x - 473977420) * 0.0111319491 - 100.0, ahead, 0.5);
        EXPECT_LE(ahead, before);
        before = ahead;
        autopilot(ack);
    }
    ack.result = 4;
    endpoint->send_velocity(north, now);
    static_cast<void>(sent());
    autopilot(ack);
    endpoint->send_velocity(north, now);
    EXPECT_TRUE(sent().empty()) << "FAILED says that the mode was another one";
    EXPECT_TRUE(inbox->mode_answers.empty());
    plane_in(kPlaneAuto);
    endpoint->send_velocity(north, now);
    plane_in(kPlaneGuided);
    endpoint->send_velocity(north, now);
    EXPECT_NEAR((sent_one<CommandInt>().x - 473977420) * 0.0111319491 - 100.0, 500.0, 0.5) << "the next take-over";
}

TEST_F(MavlinkPlane, ACopterStillGetsVelocities)
{
    heartbeat(3, 4, true, 2);
    endpoint->send_velocity({1.0F, 2.0F, 3.0F}, now);
    EXPECT_EQ(sent_one<SetPositionTargetLocalNed>().type_mask, 0x0DC7);
}

TEST_F(MavlinkPlane, IsSteerableOnlyWhileItSaysThatItIsNoVtol)
{
    clear();
    plane_in(kPlaneAuto);
    EXPECT_TRUE(inbox->autopilot.steerable);
    for (std::uint8_t state = 1; state <= 4; ++state) {
        plane_state(state);
        plane_in(kPlaneAuto);
        EXPECT_FALSE(inbox->autopilot.steerable) << "a QuadPlane, " << int{state};
    }
    endpoint = std::make_unique<Endpoint>();
    plane_in(kPlaneAuto);
    EXPECT_FALSE(inbox->autopilot.steerable) << "not known yet";
    EXPECT_FALSE(is_steerable(AutopilotStack::px4, kPlaneType, 0));
    EXPECT_FALSE(is_steerable(AutopilotStack::unknown, kPlaneType, 0));
}

TEST(PlaneSteering, WithoutACourseOrFiniteNumbersNothingIsDue)
{
    PlaneSteering steering;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(steering.next({0.0F, 0.0F, 2.0F}, Vec3::Zero(), {1'000'000}));
    EXPECT_FALSE(steering.next({0.7F, 0.7F, 0.0F}, Vec3::Zero(), {1'000'000}));
    EXPECT_FALSE(steering.next({nan, 18.0F, 0.0F}, Vec3::Zero(), {1'000'000}));
    EXPECT_FALSE(steering.next({18.0F, 0.0F, 0.0F}, {0.0F, nan, 0.0F}, {1'000'000}));
    EXPECT_TRUE(steering.next({18.0F, 0.0F, 0.0F}, Vec3::Zero(), {1'000'000}));
}

TEST(PlaneSteering, ADescentNeverAimsFarBelow)
{
    PlaneSteering steering;
    const auto point = steering.next({18.0F, 0.0F, -30.0F}, {0.0F, 0.0F, 60.0F}, {1'000'000});
    ASSERT_TRUE(point);
    EXPECT_FLOAT_EQ(point->z(), 46.0F) << "less than ALT_SLOPE_MIN, and where it levels off when jink falls silent";
}

}  // namespace
}  // namespace jink::link::mavlink
