// SPDX-License-Identifier: BSD-3-Clause
// Solids of range returns: every point at the measured range within the beam is covered, no solid extends much nearer,
// and none contains the vehicle. Distances to the solids are computed here, in double precision.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "firmware/app/range_return.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

using Point = Eigen::Vector3d;

/// Distance of a point from the solid's surface; below 0 inside.
double distance(const geometry::Shape& s, const Point& p)
{
    const Point local = s.axes.cast<double>().transpose() * (p - s.centre.cast<double>());
    const Point half = s.half.cast<double>();
    switch (s.kind) {
    case geometry::ShapeKind::sphere: return local.norm() - static_cast<double>(s.radius);
    case geometry::ShapeKind::capsule: {
        const Point axis(0.0, 0.0, std::clamp(local.z(), -half.z(), half.z()));
        return (local - axis).norm() - static_cast<double>(s.radius);
    }
    case geometry::ShapeKind::box: {
        const Point q = local.cwiseAbs() - half;
        return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
    }
    default: ADD_FAILURE() << "not an echo"; return 0.0;
    }
}

constexpr int kRounds = 20'000;
constexpr double kRounding = 1e-3;

struct Draw {
    explicit Draw(std::uint64_t seed) : random(seed) {}
    double within(double low, double high) { return low + (high - low) * static_cast<double>(random.uniform()); }
    Random random;
};

TEST(RangeReturn, LevelPartCoversItsArcAndReachesLittleNearer)
{
    Draw draw(11);
    for (int i = 0; i < kRounds; ++i) {
        const Vec3 origin(static_cast<float>(draw.within(-500, 500)), static_cast<float>(draw.within(-500, 500)),
                          static_cast<float>(draw.within(0, 200)));
        const double yaw = draw.within(-7.0, 7.0);
        const double range = draw.within(0.0, 40.0);
        const double half = draw.within(0.002, 0.5 * static_cast<double>(kWidestPart));
        const geometry::Shape s =
            level_return(origin, static_cast<float>(yaw), static_cast<float>(range), static_cast<float>(half), 10.0F);
        const Point from = origin.cast<double>();
        for (int k = 0; k <= 10; ++k) {
            const double at = yaw + half * (0.2 * k - 1.0);
            const Point p = from + range * Point(std::cos(at), std::sin(at), 0.0);
            ASSERT_LE(distance(s, p), kRounding) << "seed 11, round " << i << ", " << k;
        }
        const double nearest = range * (std::cos(half) - 0.5 * std::sin(half));
        ASSERT_GE(distance(s, from), nearest - kRounding) << "seed 11, round " << i;
    }
}

TEST(RangeReturn, PartsTileTheBeam)
{
    for (int tenth = 1; tenth <= 900; ++tenth) {
        const float half = static_cast<float>(tenth) * 0.1F * kPi / 180.0F;
        const std::size_t n = return_parts(half);
        ASSERT_GE(n, 1U);
        ASSERT_LE(n, kMaxReturnParts);
        ASSERT_LE(2.0F * half / static_cast<float>(n), kWidestPart * 1.002F) << tenth;
    }
}

/// A direction `away` from `axis`, turned by `about` around it.
Point within_beam(const Point& axis, double away, double about)
{
    const Point side = axis.unitOrthogonal();
    const Point up = axis.cross(side);
    return std::cos(away) * axis + std::sin(away) * (std::cos(about) * side + std::sin(about) * up);
}

TEST(RangeReturn, SlantedSphereCoversItsCapAndReachesLittleNearer)
{
    Draw draw(12);
    for (int i = 0; i < kRounds; ++i) {
        const double elevation = draw.within(-0.77, 1.37);
        const double yaw = draw.within(-3.2, 3.2);
        const Point axis(std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw), std::sin(elevation));
        const double range = draw.within(0.0, 40.0);
        const double half = draw.within(0.002, static_cast<double>(kWidestSteep));
        const geometry::Shape s =
            slanted_return(Vec3(1, 2, 3), axis.cast<float>(), static_cast<float>(range), static_cast<float>(half));
        const Point from(1, 2, 3);
        for (int k = 0; k < 10; ++k) {
            const Point p = from + range * within_beam(axis, draw.within(0.0, half), draw.within(0.0, 6.3));
            ASSERT_LE(distance(s, p), kRounding) << "seed 12, round " << i;
        }
        ASSERT_GE(distance(s, from), range * (std::cos(half) - 0.27 * std::sin(half)) - kRounding) << "round " << i;
    }
}

TEST(RangeReturn, CeilingCoversItsCapAndLiesWhollyAtTheRangeOrBehindIt)
{
    Draw draw(13);
    for (int i = 0; i < kRounds; ++i) {
        const double range = draw.within(0.0, 40.0);
        const double half = draw.within(0.002, static_cast<double>(kWidestSteep));
        const geometry::Shape s =
            ceiling_return(Vec3(1, 2, 3), static_cast<float>(range), static_cast<float>(half), 10.0F);
        const Point from(1, 2, 3);
        for (int k = 0; k < 10; ++k) {
            const Point p = from + range * within_beam(Point::UnitZ(), draw.within(0.0, half), draw.within(0.0, 6.3));
            ASSERT_LE(distance(s, p), kRounding) << "seed 13, round " << i;
        }
        ASSERT_GE(distance(s, from), range * std::cos(half) - kRounding) << "seed 13, round " << i;
        ASSERT_GT(distance(s, from + Point(5.0, -5.0, range * std::cos(half) - 0.5)), 0.4) << "a slab, not a column";
    }
}

TEST(RangeReturn, LevelPartIsAsHighAsSaidAndLooksWhereTheBeamDoes)
{
    const Vec3 origin(100.0F, -50.0F, 30.0F);
    for (const float yaw : {0.0F, 0.5F * kPi, kPi, -0.5F * kPi, 2.0F}) {
        const geometry::Shape s = level_return(origin, yaw, 20.0F, 0.05F, 7.0F);
        ASSERT_EQ(s.kind, geometry::ShapeKind::capsule);
        const Vec3 off = s.centre - origin;
        EXPECT_NEAR(off.z(), 0.0F, 1e-4F);
        EXPECT_NEAR(std::cos(yaw) * off.y() - std::sin(yaw) * off.x(), 0.0F, 1e-3F) << yaw;
        EXPECT_GT(std::cos(yaw) * off.x() + std::sin(yaw) * off.y(), 20.0F) << "behind the arc";
        EXPECT_NEAR(s.half.z(), 7.0F, 1e-4F);
        EXPECT_NEAR(std::abs(s.axes.col(2).z()), 1.0F, 1e-5F) << "upright";
        // The top and the bottom are 7 m and the radius away.
        EXPECT_LT(distance(s, (s.centre + Vec3(0, 0, 7.0F + s.radius - 0.01F)).cast<double>()), 0.0);
        EXPECT_GT(distance(s, (s.centre - Vec3(0, 0, 7.0F + s.radius + 0.01F)).cast<double>()), 0.0);
    }
}

TEST(RangeReturn, EvenAThinBeamGivesABodyOfTheLeastRadius)
{
    for (const float range : {0.0F, 0.1F, 1.0F}) {
        EXPECT_EQ(level_return(Vec3::Zero(), 0.0F, range, 0.001F, 1.0F).radius, kMinReturnRadius) << range;
        EXPECT_EQ(slanted_return(Vec3::Zero(), Vec3::UnitZ(), range, 0.001F).radius, kMinReturnRadius) << range;
    }
    EXPECT_GT(level_return(Vec3::Zero(), 0.0F, 40.0F, 0.08F, 1.0F).radius, 40.0F * std::sin(0.08F));
    EXPECT_GT(slanted_return(Vec3::Zero(), Vec3::UnitZ(), 40.0F, 0.5F).radius, 40.0F * std::sin(0.5F));
}

/// The ends of the arc lie on the surface: nothing is covered in vain beside the beam.
TEST(RangeReturn, EndsOfTheArcLieOnTheSurface)
{
    Draw draw(15);
    for (int i = 0; i < 200; ++i) {
        const double range = draw.within(5.0, 40.0);
        const double half = draw.within(0.06, 0.5 * static_cast<double>(kWidestPart));
        const geometry::Shape level =
            level_return(Vec3::Zero(), 0.0F, static_cast<float>(range), static_cast<float>(half), 5.0F);
        EXPECT_NEAR(distance(level, range * Point(std::cos(half), std::sin(half), 0.0)), 0.0, kRounding) << i;
        const geometry::Shape sphere =
            slanted_return(Vec3::Zero(), Vec3::UnitX(), static_cast<float>(range), static_cast<float>(half));
        EXPECT_NEAR(distance(sphere, range * Point(std::cos(half), 0.0, std::sin(half))), 0.0, kRounding) << i;
        EXPECT_GT(level.centre.x(), range * std::cos(half)) << "the centre lies behind the arc";
        EXPECT_GT(sphere.centre.x(), range * std::cos(half));
    }
}

TEST(RangeReturn, PartsAreAsFewAsTheWidestAllows)
{
    EXPECT_EQ(return_parts(0.0F), 1U);
    EXPECT_EQ(return_parts(0.5F * kWidestPart), 1U) << "the widest part itself";
    EXPECT_EQ(return_parts(0.51F * kWidestPart), 2U);
    EXPECT_EQ(return_parts(kWidestPart), 2U);
    EXPECT_EQ(return_parts(1.6F * kWidestPart), 4U);
    EXPECT_EQ(return_parts(0.5F * kPi), kMaxReturnParts);
    EXPECT_EQ(return_parts(2.0F), kMaxReturnParts) << "half angles beyond a half circle do not exist";
}

TEST(RangeReturn, CeilingIsAsThickAsItIsWideAndNeverNarrowerThanTheBeam)
{
    for (const float half_width : {2.0F, 10.0F}) {
        for (const float half_angle : {0.1F, 1.0F}) {
            const geometry::Shape s = ceiling_return(Vec3(1, 2, 3), 6.0F, half_angle, half_width);
            const float wide = std::max(half_width, 6.0F * std::sin(half_angle));
            ASSERT_EQ(s.kind, geometry::ShapeKind::box);
            EXPECT_TRUE(s.half.isApprox(Vec3(wide, wide, wide), 1e-6F)) << s.half.x() << " for " << wide;
            EXPECT_EQ(s.centre.head<2>(), (Vec3(1, 2, 3).head<2>()));
            EXPECT_NEAR(s.centre.z() - s.half.z(), 3.0F + 6.0F * std::cos(half_angle), 1e-4F) << "its lower face";
        }
    }
}

class RangeSensors : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.fly(60);
    }
    void see(std::uint8_t orientation, float range, float fov = 0.0F)
    {
        f.feed(wire::attitude(f.boot_ms(), 0.5F * kPi));
        DistanceSensor m;
        m.time_boot_ms = f.boot_ms();
        m.min_distance = 10;
        m.max_distance = 4000;
        m.current_distance = static_cast<std::uint16_t>(range * 100.0F);
        m.orientation = orientation;
        m.horizontal_fov = fov;
        f.feed(m);
        f.fly(1);
    }
    Flight f;
};

TEST_F(RangeSensors, ACeilingAboveDoesNotStandInTheWay)
{
    for (int i = 0; i < 50; ++i) {
        see(24, 3.0F);
        ASSERT_EQ(f.last.obstacles, 1U);
        ASSERT_FALSE(f.last.guidance.conflict.has_value()) << "flying level, 2 m below it";
    }
    EXPECT_EQ(f.setpoints, 0);
}

TEST_F(RangeSensors, WhatIsAheadDoes)
{
    see(0, 20.0F);
    EXPECT_GE(f.last.obstacles, 1U);
    EXPECT_TRUE(f.last.guidance.conflict.has_value());
}

TEST_F(RangeSensors, AWideBeamAheadIsPlacedInPartsAndForgottenWhole)
{
    see(0, 20.0F, 1.0F);
    EXPECT_EQ(f.last.obstacles, 6U);
    EXPECT_TRUE(f.last.guidance.conflict.has_value());
    see(0, 60.0F, 1.0F);  // beyond max_distance: nothing there
    EXPECT_EQ(f.last.obstacles, 0U);
}

TEST_F(RangeSensors, AnUpwardBeamTooWideToBePlacedIsRefusedAndCounted)
{
    see(24, 3.0F, 2.2F);
    EXPECT_EQ(f.last.obstacles, 0U);
    EXPECT_EQ(f.coprocessor.diagnostics().readings_refused, 1U);
    EXPECT_EQ(f.coprocessor.diagnostics().readings, 1U);
}

/// A scanner of eight sectors: a return at 20 m somewhere in the forward sector is on the path, and no solid contains
/// the vehicle.
TEST_F(RangeSensors, WideSectorsOfAScanAreCoveredToTheirEdges)
{
    f.feed(wire::attitude(f.boot_ms(), 0.5F * kPi));
    ObstacleDistance m;
    m.distances.fill(4001);
    m.distances[0] = 2000;
    m.min_distance = 20;
    m.max_distance = 4000;
    m.increment = 45;
    m.frame = 12;
    f.feed(m);
    f.fly(1);
    EXPECT_EQ(f.last.obstacles, 5U);
    EXPECT_TRUE(f.last.guidance.conflict.has_value());
    EXPECT_GT(f.last.guidance.conflict->time_to_loss, 2.5F) << "20 m less 5 % and the own box, at 5 m/s";
    m.distances[0] = 4001;
    f.feed(m);
    f.fly(1);
    EXPECT_EQ(f.last.obstacles, 0U);
}

TEST_F(RangeSensors, AScanAllAroundAtTheWidestSectorsLeavesTheVehicleOutside)
{
    for (const std::uint8_t increment : {10, 11, 45, 90, 180}) {
        f.feed(wire::attitude(f.boot_ms(), 0.5F * kPi));
        ObstacleDistance m;
        m.distances.fill(3900);
        m.min_distance = 20;
        m.max_distance = 4000;
        m.increment = increment;
        m.frame = 12;
        f.feed(m);
        f.fly(1);
        ASSERT_TRUE(f.last.guidance.conflict.has_value()) << int(increment);
        EXPECT_GT(f.last.guidance.conflict->time_to_loss, 6.5F) << int(increment);
        f.fly(60);  // forgotten
    }
}

}  // namespace
}  // namespace jink::app::test
