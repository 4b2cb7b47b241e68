// SPDX-License-Identifier: BSD-3-Clause
// OBSTACLE_DISTANCE_3D: frames, units, scans, refusals.
#include <cmath>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/numbers.hpp"
#include "tests/unit/link/cloud_tools.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink::test {
namespace {

class EndpointPoints : public HeardEndpointTest {
protected:
    void SetUp() override
    {
        HeardEndpointTest::SetUp();
        endpoint->report_points_to(sink);
    }
    static ObstacleDistance3d body(float x, float y, float z, std::uint32_t ms = 1000)
    {
        ObstacleDistance3d m;
        m.time_boot_ms = ms;
        m.x = x;
        m.y = y;
        m.z = z;
        m.min_distance = 0.2F;
        m.max_distance = 40.0F;
        m.obstacle_id = 65535;
        m.frame = 12;
        return m;
    }
    void point(const ObstacleDistance3d& m, std::uint8_t component = 158) { from(kSystem, component, m); }
    void attitude_of(float roll, float pitch, float yaw)
    {
        Attitude m;
        m.time_boot_ms = boot_ms();
        m.roll = roll;
        m.pitch = pitch;
        m.yaw = yaw;
        autopilot(m);
    }
    void silence(float seconds)
    {
        wait(seconds);
        endpoint->receive({}, now, *inbox);
    }
    /// The newest ray.
    [[nodiscard]] Vec3 seen() const { return sink.scans.back().rays.back().second; }

    cloud::test::Recorder sink;
};

TEST_F(EndpointPoints, BodyFrameIsForwardRightDown)
{
    attitude(1.0F);  // the heading does not matter: the level frame is the nose's
    point(body(10, 2, 3));
    ASSERT_EQ(sink.scans.size(), 1U);
    EXPECT_EQ(sink.scans[0].rays.at(0).first, Ray::hit);
    expect_near(seen(), Vec3(10, -2, -3), 1e-5F);
    EXPECT_EQ(sink.scans[0].scan.stamp, now);
    EXPECT_EQ(sink.scans[0].scan.max_range, 40.0F);
    EXPECT_EQ(sink.scans[0].scan.ray_pitch_level, 0.0F);
}

TEST_F(EndpointPoints, RollAndPitchOfEveryAttitudeMessageLevelIt)
{
    // Nose up: points ahead of the body are above. Right side down: points to its right are below.
    const float s = std::sin(0.3F);
    const float c = std::cos(0.3F);
    attitude_of(0.0F, 0.3F, 2.0F);
    point(body(10, 0, 0));
    expect_near(seen(), Vec3(10 * c, 0, 10 * s), 1e-4F);
    attitude_of(0.3F, 0.0F, -2.0F);
    point(body(0, 10, 0));
    expect_near(seen(), Vec3(0, -10 * c, -10 * s), 1e-4F);

    // A quaternion of roll 0.2, pitch -0.4, heading 1.1 turns body to NED: take the heading off and change the axes.
    const Eigen::Quaternionf q = Eigen::AngleAxisf(1.1F, Vec3::UnitZ()) * Eigen::AngleAxisf(-0.4F, Vec3::UnitY()) *
                                 Eigen::AngleAxisf(0.2F, Vec3::UnitX());
    const Vec3 reported(5, -3, 2);
    const Vec3 north_east_down = q * reported;
    const Vec3 unturned = Eigen::AngleAxisf(-1.1F, Vec3::UnitZ()) * north_east_down;
    const Vec3 expected(unturned.x(), -unturned.y(), -unturned.z());
    attitude_of(0, 0, 0);
    AttitudeQuaternion a;
    a.q1 = q.w();
    a.q2 = q.x();
    a.q3 = q.y();
    a.q4 = q.z();
    autopilot(a);
    point(body(5, -3, 2));
    expect_near(seen(), expected, 1e-4F);

    attitude_of(0, 0, 0);
    Odometry o;
    o.time_usec = static_cast<std::uint64_t>(boot_ms()) * 1000;
    o.q = {q.w(), q.x(), q.y(), q.z()};
    o.frame_id = 1;
    o.child_frame_id = 12;
    autopilot(o);
    point(body(5, -3, 2));
    expect_near(seen(), expected, 1e-4F);
}

TEST_F(EndpointPoints, LocalFrameIsAPlaceOnTheMap)
{
    attitude(0.5F * kPi);                       // nose to the east
    local_position({100, 50, -20}, {0, 8, 0});  // and flying there
    ObstacleDistance3d m = body(100, 70, -25);
    m.frame = 1;
    point(m);
    expect_near(seen(), Vec3(20, 0, 5), 1e-3F);
    m.x = 110;  // to the north: to the left
    point(m);
    expect_near(seen(), Vec3(20, 10, 5), 1e-3F);
    wait(0.25F);  // flown 2 m on
    point(m);
    expect_near(seen(), Vec3(18, 10, 5), 1e-2F);
}

TEST_F(EndpointPoints, OtherFramesAreRefused)
{
    attitude(0);
    local_position();
    for (unsigned frame = 0; frame < 256; ++frame) {
        ObstacleDistance3d m = body(1, 2, 3);
        m.frame = static_cast<std::uint8_t>(frame);
        point(m);
    }
    EXPECT_EQ(count().out_of_range, 254U);
    EXPECT_EQ(sink.rays(), 2U);
}

TEST_F(EndpointPoints, NumbersThatAreNoneAreRefused)
{
    attitude(0);
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (float ObstacleDistance3d::*const field :
             {&ObstacleDistance3d::x, &ObstacleDistance3d::y, &ObstacleDistance3d::z, &ObstacleDistance3d::min_distance,
              &ObstacleDistance3d::max_distance}) {
            ObstacleDistance3d m = body(1, 2, 3);
            m.*field = bad;
            point(m);
        }
    }
    EXPECT_EQ(count().not_finite, 15U);
    EXPECT_TRUE(sink.scans.empty());
}

TEST_F(EndpointPoints, RangesThatCannotBeAreRefused)
{
    attitude(0);
    const auto with = [&](float x, float low, float high) {
        ObstacleDistance3d m = body(x, 0, 0);
        m.min_distance = low;
        m.max_distance = high;
        point(m);
    };
    with(1, 0, 0);
    with(1, -1, 10);
    with(1, 11, 10);
    with(0, 0, 10);       // in no direction
    with(1e-30F, 0, 10);  // its square is nothing
    with(1e30F, 0, 10);   // its square is infinite
    EXPECT_EQ(count().out_of_range, 6U);
    EXPECT_TRUE(sink.scans.empty());
    with(1, 0, 10);
    EXPECT_EQ(sink.rays(), 1U);
}

TEST_F(EndpointPoints, BeyondReachIsNothingAndTooNearIsAtLeastDistance)
{
    attitude(0);
    point(body(0, -40.1F, 0));
    EXPECT_EQ(sink.scans[0].rays[0].first, Ray::nothing);
    expect_near(seen(), Vec3(0, 1, 0), 1e-5F);
    point(body(0, 0, 0.1F));
    EXPECT_EQ(sink.scans[0].rays[1].first, Ray::hit);
    expect_near(seen(), Vec3(0, 0, -0.2F), 1e-5F);
    point(body(40, 0, 0));
    EXPECT_EQ(sink.scans[0].rays[2].first, Ray::hit);
}

TEST_F(EndpointPoints, OldAttitudePlacesNothing)
{
    point(body(1, 2, 3));
    EXPECT_EQ(count().no_origin, 1U);
    attitude(0);
    wait(0.3F);
    point(body(1, 2, 3));
    EXPECT_EQ(sink.rays(), 1U);
    wait(0.02F);
    point(body(1, 2, 3));
    EXPECT_EQ(count().no_origin, 2U);
    // The local frame asks for a place too.
    attitude(0);
    ObstacleDistance3d m = body(1, 2, 3);
    m.frame = 1;
    point(m);
    EXPECT_EQ(count().no_origin, 3U);
    local_position();
    point(m);
    EXPECT_EQ(sink.rays(), 2U);
    wait(0.52F);
    attitude(0);
    point(m);
    EXPECT_EQ(count().no_origin, 4U);
    EXPECT_EQ(sink.rays(), 2U);
}

TEST_F(EndpointPoints, AttitudeThatIsNoneIsRefusedWhole)
{
    attitude_of(0.1F, 0.2F, 0.3F);
    attitude_of(kNan, 0, 0);
    attitude_of(0, kNan, 0);
    EXPECT_EQ(count().not_finite, 2U);
    attitude_of(7, 0, 0);
    attitude_of(0, -7, 0);
    EXPECT_EQ(count().out_of_range, 2U);
    point(body(0, 0, -10));
    expect_near(seen(), level_of_frd(0.1F, 0.2F) * Vec3(0, 0, -10), 1e-4F);
}

TEST_F(EndpointPoints, ScansEndWithTheStampTheSensorAndAPause)
{
    attitude(0);
    point(body(1, 0, 0));
    point(body(2, 0, 0));
    EXPECT_EQ(sink.scans.size(), 1U);
    EXPECT_FALSE(sink.scans[0].ended);
    wait(0.02F);
    point(body(3, 0, 0, 1100));
    ASSERT_EQ(sink.scans.size(), 2U);
    EXPECT_TRUE(sink.scans[0].ended);
    EXPECT_EQ(sink.scans[0].rays.size(), 2U);
    ObstacleDistance3d other = body(4, 0, 0, 1100);
    other.sensor_type = 3;
    point(other);
    ASSERT_EQ(sink.scans.size(), 3U);
    EXPECT_EQ(sink.scans[2].scan.sensor, 3);
    silence(0.05F);
    EXPECT_FALSE(sink.scans[2].ended);
    silence(0.01F);
    EXPECT_TRUE(sink.scans[2].ended);
    point(body(5, 0, 0, 1100));  // the same stamp again: a scan of its own
    EXPECT_EQ(sink.scans.size(), 4U);
    EXPECT_FALSE(sink.broken);
}

/// Some senders stamp each point, and some take turns: the end of a scan is costly.
TEST_F(EndpointPoints, AStepEndsFewScansWhateverTheStamps)
{
    attitude(0);
    std::uint32_t stamp = 1;
    std::size_t steps = 0;
    for (const unsigned sensors : {1U, 2U}) {
        sink = {};
        for (steps = 0; steps < 3; ++steps, wait(0.02F)) {
            for (unsigned i = 0; i < 100; ++i) {
                ObstacleDistance3d m = body(5, 0, 0, stamp++);
                m.sensor_type = static_cast<std::uint8_t>(i % sensors);
                point(m);
            }
        }
        EXPECT_LE(sink.scans.size(), sensors == 1 ? steps : 4 * steps);
        EXPECT_EQ(sink.rays(), 100 * steps);
        EXPECT_FALSE(sink.broken);
        silence(0.06F);
    }
}

TEST_F(EndpointPoints, OtherSystemsAreIgnored)
{
    attitude(0);
    const std::uint32_t ignored = count().frames_ignored;
    from(kSystem + 1, 158, body(1, 2, 3));
    EXPECT_EQ(count().frames_ignored, ignored + 1);
    EXPECT_TRUE(sink.scans.empty());
}

TEST_F(HeardEndpointTest, PointsThatNobodyTakesAreIgnored)
{
    attitude(0);
    ObstacleDistance3d m;
    m.x = kNan;
    m.frame = 12;
    const std::uint32_t ignored = count().frames_ignored;
    from(kSystem, 158, m);
    EXPECT_EQ(count().frames_ignored, ignored + 1);
    EXPECT_EQ(count().not_finite, 0U);
}

/// The frame that the official C library makes of t = 1000, laser, frame 12, id 7, (1.5, -2.25, 0.5), 0.2 to 40.
TEST_F(EndpointPoints, GoldenFrame)
{
    attitude(0);
    endpoint.reset();  // system 1 sent it
    endpoint = std::make_unique<Endpoint>(EndpointOptions{1, 196, 1.0F});
    endpoint->report_points_to(sink);
    AttitudeQuaternion level;
    level.q1 = 1;
    from(1, 1, level);
    endpoint->receive(from_hex("fd1c00000001c41d2b00e80300000000c03f000010c00000003fcdcc4c3e000020420700000c3f04"), now,
                      *inbox);
    expect_near(seen(), Vec3(1.5F, 2.25F, -0.5F), 1e-6F);
}

}  // namespace
}  // namespace jink::link::mavlink::test
