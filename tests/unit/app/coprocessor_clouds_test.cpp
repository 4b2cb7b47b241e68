// SPDX-License-Identifier: BSD-3-Clause
// Point clouds through the whole step: from the wire to the avoided obstacle.
#include <gtest/gtest.h>

#include "tests/unit/app/cloud_bench.hpp"

namespace jink::app {
namespace {

using namespace test;
using cloud::test::joined;

std::unique_ptr<CloudFlight> quiet_flight(bool has_port = true)
{
    auto f = std::make_unique<CloudFlight>(has_port);
    f->fly(60);
    EXPECT_EQ(f->flight.last.obstacles, 0);
    return f;
}

TEST(CoprocessorClouds, HitsBecomeObstaclesAndExpire)
{
    const auto f = quiet_flight();
    f->line.feed(joined(f->driver.scan(std::vector<cloud::RawPoint>{raw(5, 5, 40), raw(95, 5, 30)}, f->driver_ms())));
    EXPECT_EQ(f->tick().obstacles, 2);
    EXPECT_EQ(f->input.port_diagnostics().kept, 2U);
    f->fly(49);
    EXPECT_EQ(f->tick().obstacles, 2);
    f->fly(2);
    EXPECT_EQ(f->tick().obstacles, 0);  // OBS_KEEP is a second
}

/// 30 m ahead, 6 m wide and high, a metre to the side so that one side is better. Static.
void fly_past_a_wall(CloudFlight& flight)
{
    CloudFlight* const f = &flight;
    std::vector<cloud::RawPoint> wall;
    const float stands = f->flight.position.y() + 30.0F;
    bool took_over = false;
    for (int i = 0; i < 1500 && f->flight.position.y() < stands + 30.0F; ++i) {
        if (i % 5 == 0) {
            wall.clear();
            for (float x = -2.0F; x <= 4.0F; x += 0.25F) {
                for (float z = 47.0F; z <= 53.0F; z += 0.25F) {
                    const Vec3 d = Vec3(x, stands, z) - f->flight.position;
                    const float ahead = std::atan2(-d.x(), d.y()) * 180.0F / kPi;
                    wall.push_back(raw(ahead, std::asin(d.z() / d.norm()) * 180.0F / kPi, d.norm()));
                }
            }
            f->line.feed(joined(f->driver.scan(wall, f->driver_ms())));
        }
        const StepReport report = f->tick();
        took_over = took_over || report.control == Control::ours;
        const Vec3 p = f->flight.position;
        const Vec3 nearest(std::clamp(p.x(), -2.0F, 4.0F), stands, std::clamp(p.z(), 47.0F, 53.0F));
        ASSERT_GT((p - nearest).norm(), 1.0F) << "at " << p.x() << " " << p.y() << " " << p.z();
    }
    EXPECT_TRUE(took_over);
    EXPECT_GT(f->flight.position.y(), stands + 20.0F);
}

TEST(CoprocessorClouds, AWallInTheWayIsAvoided) { fly_past_a_wall(*quiet_flight()); }

/// A mission downhill of the home position flies below the floor.
TEST(CoprocessorClouds, AWallInTheWayIsAvoidedBelowTheFloor)
{
    const auto f = quiet_flight();
    HomePosition home;
    home.latitude = 473'977'420;
    home.longitude = 85'455'940;
    home.altitude = 488'000 + 100'000;
    f->flight.feed(home);
    f->fly(5);
    ASSERT_NEAR(f->flight.coprocessor.home().z(), 100.0F, 0.1F);
    fly_past_a_wall(*f);
    EXPECT_EQ(f->input.port_diagnostics().hits,
              f->input.port_diagnostics().kept + f->input.port_diagnostics().below_floor);
}

TEST(CoprocessorClouds, SinglePointsOfTheLink)
{
    for (const bool has_port : {false, true}) {
        const auto f = quiet_flight(has_port);
        ObstacleDistance3d m;
        m.time_boot_ms = 5;
        m.x = 30.0F;
        m.y = 2.0F;
        m.max_distance = 50.0F;
        m.frame = 12;
        f->flight.feed(m, 158);
        f->fly(5);
        EXPECT_EQ(f->tick().obstacles, 1);
        EXPECT_EQ(f->input.link_diagnostics().kept, 1U);
        EXPECT_EQ(f->input.port_diagnostics().hits, 0U);
    }
}

TEST(CoprocessorClouds, WithoutThemNothingIsTaken)
{
    Flight f;
    f.fly(10);
    ObstacleDistance3d m;
    m.x = 30.0F;
    m.max_distance = 50.0F;
    m.frame = 12;
    const std::uint32_t ignored = f.endpoint.diagnostics().frames_ignored;
    f.feed(m, 158);
    f.fly(10);
    EXPECT_EQ(f.last.obstacles, 0);
    EXPECT_EQ(f.endpoint.diagnostics().frames_ignored, ignored + 1);
    cloud::test::Counter counter;
    f.coprocessor.forward_clouds_to(counter);  // nothing to forward
    f.fly(1);
    EXPECT_EQ(counter.begun, 0U);
}

TEST(CoprocessorClouds, WithoutAHeadingNothingIsPlaced)
{
    const auto f = quiet_flight();
    f->attitude = false;
    f->fly(60);
    f->line.feed(joined(f->driver.scan(std::vector<cloud::RawPoint>{raw(5, 5, 40)}, f->driver_ms())));
    EXPECT_EQ(f->tick().obstacles, 0);
    EXPECT_EQ(f->input.port_diagnostics().scans_unplaced, 1U);
}

TEST(CoprocessorClouds, WithoutAnOwnStateNothingIsPlaced)
{
    const auto f = quiet_flight();
    f->flight.own_state = false;
    f->fly(30);
    f->line.feed(joined(f->driver.scan(std::vector<cloud::RawPoint>{raw(5, 5, 40)}, f->driver_ms())));
    f->fly(1);
    EXPECT_EQ(f->input.port_diagnostics().scans_unplaced, 1U);
}

TEST(CoprocessorClouds, ForwardedScanByScan)
{
    const auto f = quiet_flight();
    const std::vector<cloud::RawPoint> points{raw(5, 5, 40), raw(50, 5, 655.35F), raw(95, 5, 0)};
    const auto halves = f->driver.scan(points, f->driver_ms(), 2);
    f->line.feed(halves[0]);
    f->fly(1);
    cloud::test::Recorder taker;
    f->flight.coprocessor.forward_clouds_to(taker);  // amid a scan: that one is not for it
    f->line.feed(halves[1]);
    f->fly(1);
    EXPECT_TRUE(taker.scans.empty());
    f->line.feed(joined(f->driver.scan(points, f->driver_ms())));
    f->fly(1);
    ASSERT_EQ(taker.scans.size(), 1U);
    EXPECT_FALSE(taker.broken);
    EXPECT_TRUE(taker.scans[0].ended);
    ASSERT_EQ(taker.scans[0].rays.size(), 3U);
    EXPECT_EQ(taker.scans[0].rays[0].first, link::Ray::hit);
    EXPECT_EQ(taker.scans[0].rays[1].first, link::Ray::nothing);
    EXPECT_EQ(taker.scans[0].rays[2].first, link::Ray::invalid);
    // Points of the link overlap in time with the port's: not for a taker of one scan at a time.
    ObstacleDistance3d m;
    m.x = 30.0F;
    m.max_distance = 50.0F;
    m.frame = 12;
    f->flight.feed(m, 158);
    f->fly(10);
    EXPECT_EQ(taker.scans.size(), 1U);
    EXPECT_EQ(f->input.link_diagnostics().hits, 1U);
}

TEST(CoprocessorClouds, PointsOfTheLinkAreForwardedWhereThereIsNoPort)
{
    const auto f = quiet_flight(false);
    cloud::test::Recorder taker;
    f->flight.coprocessor.forward_clouds_to(taker);
    ObstacleDistance3d m;
    m.x = 30.0F;
    m.max_distance = 50.0F;
    m.frame = 12;
    f->flight.feed(m, 158);
    f->fly(10);
    ASSERT_EQ(taker.scans.size(), 1U);
    EXPECT_TRUE(taker.scans[0].ended);
}

TEST(CoprocessorClouds, MoreThanAStepMayReadWaitsAndIsCounted)
{
    const auto f = quiet_flight();
    std::vector<cloud::RawPoint> points(100'000, raw(5, 5, 40));
    const auto bytes = joined(f->driver.scan(points, f->driver_ms()));
    ASSERT_GT(bytes.size(), 3 * kMaxCloudBytesPerStep);
    f->line.feed(bytes);
    for (std::size_t step = 1; step <= 3; ++step) {
        f->fly(1);
        EXPECT_EQ(f->input.bytes_in(), step * kMaxCloudBytesPerStep);
        EXPECT_EQ(f->input.full_steps(), step);
        EXPECT_EQ(f->line.waiting(), bytes.size() - f->input.bytes_in());
    }
    f->fly(1);
    EXPECT_EQ(f->input.full_steps(), 3U);
    EXPECT_EQ(f->line.waiting(), 0U);
    EXPECT_EQ(f->input.receiver_diagnostics().points, 100'000U);  // frames cut by the budget are whole again
    EXPECT_EQ(f->input.receiver_diagnostics().noise_bytes, 0U);
    EXPECT_EQ(f->input.receiver_diagnostics().scans_complete, 1U);
}

TEST(CoprocessorClouds, LiveWithALevelScanInOneTable)
{
    // A ring of 72 sectors and a cloud that is full in every direction: both are reported.
    const auto f = quiet_flight();
    f->flight.ring = 38.0F;
    std::vector<cloud::RawPoint> points;
    for (float azimuth = -175.0F; azimuth < 180.0F; azimuth += 10.0F) {
        for (float elevation = -40.0F; elevation <= 40.0F; elevation += 10.0F) {
            points.push_back(raw(azimuth, elevation, 40.0F));
        }
    }
    for (int i = 0; i < 10; ++i) {
        f->line.feed(joined(f->driver.scan(points, f->driver_ms())));
        f->fly(5);
    }
    const CloudDiagnostics& d = f->input.port_diagnostics();
    EXPECT_EQ(d.left_out, 0U);
    EXPECT_LE(d.obstacles, 10U * kMaxCloudObstacles);
    EXPECT_GE(f->tick().obstacles, 72U);
    EXPECT_LE(f->tick().obstacles, kMaxObstacles);
}

}  // namespace
}  // namespace jink::app
