// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/obstacle_plane.hpp"

#include <gtest/gtest.h>

#include <vector>

#include <Eigen/Geometry>

#include "core/orca/obstacle_way.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/oracle/points.hpp"

namespace jink::orca {
namespace {

constexpr float kTolerance = 1e-5F;

std::vector<Vec3> corners(const Vec3& low, const Vec3& high)
{
    std::vector<Vec3> out;
    for (int i = 0; i < 8; ++i) {
        out.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                         (i & 4) != 0 ? high.z() : low.z());
    }
    return out;
}

/// Check values: R_A 0.9 m, tau_obs 2 s, no stretch.
ObstacleSettings check_settings()
{
    ObstacleSettings settings;
    settings.horizontal = 0.9F;
    settings.vertical = 0.9F;
    settings.horizon = 2.0F;
    return settings;
}

OwnMotion at(float x, float y = 0.0F, float z = 0.0F)
{
    OwnMotion own;
    own.position = {x, y, z};
    own.reach_speed = 5.0F;
    return own;
}

ObstaclePlanes planes_of(Obstacles scene, const OwnMotion& own, const ObstacleSettings& settings)
{
    WorkBudget budget(1'000'000);
    return obstacle_planes(scene, own, settings, budget);
}

/// The box [2,3] x [-1,1] x [-1,1] of the check values, in each form that obstacles come in.
class CheckBox : public ::testing::TestWithParam<int> {
protected:
    [[nodiscard]] ObstaclePlanes planes(const OwnMotion& own, const ObstacleSettings& settings) const
    {
        return planes_of(scene(), own, settings);
    }
    [[nodiscard]] Obstacles scene() const { return threats_; }

private:
    std::vector<Point3> corners_ = oracle::points_of(corners({-0.5F, -1.0F, -1.0F}, {0.5F, 1.0F, 1.0F}));
    world::Obstacle obstacle_{1, GetParam() == 0 ? geometry::make_box({2.5F, 0.0F, 0.0F}, {0.5F, 1.0F, 1.0F})
                                                 : geometry::make_hull(corners_, {2.5F, 0.0F, 0.0F})};
    std::vector<world::Threat> threats_ = oracle::threats_of({&obstacle_, 1});
};

INSTANTIATE_TEST_SUITE_P(BoxHull, CheckBox, ::testing::Values(0, 1));

TEST_P(CheckBox, CheckValueBoxAhead)
{
    const ObstaclePlanes found = planes(at(0.0F), check_settings());
    ASSERT_EQ(found.planes.size(), 1U);
    EXPECT_NEAR(found.margin, 1.1F, kTolerance);
    EXPECT_TRUE(found.planes[0].normal.isApprox(-Vec3::UnitX(), kTolerance));
    EXPECT_NEAR(found.planes[0].offset, -0.55F, kTolerance);
    EXPECT_EQ(found.planes[0].level, Level::obstacles);
    EXPECT_EQ(found.planes[0].source, 0);
    EXPECT_FALSE(found.penetrating || found.truncated || found.bounded);
}

TEST_P(CheckBox, CheckValueRecoversFromPenetration)
{
    const ObstaclePlanes found = planes(at(1.5F), check_settings());
    ASSERT_EQ(found.planes.size(), 1U);
    EXPECT_NEAR(found.margin, -0.4F, kTolerance);
    EXPECT_TRUE(found.planes[0].normal.isApprox(-Vec3::UnitX(), kTolerance));
    EXPECT_NEAR(found.planes[0].offset, 0.3F, kTolerance);
    EXPECT_TRUE(found.penetrating);
}

TEST_P(CheckBox, CheckValueTouching)
{
    const ObstaclePlanes found = planes(at(1.1F), check_settings());
    ASSERT_EQ(found.planes.size(), 1U);
    EXPECT_TRUE(found.planes[0].normal.isApprox(-Vec3::UnitX(), kTolerance));
    EXPECT_NEAR(found.planes[0].offset, 0.0F, kTolerance);
}

/// Slightly inside, recovery demands little: the half-space has no jump at the end of the margin.
TEST_P(CheckBox, RecoversAsDeepAsItIs)
{
    EXPECT_NEAR(planes(at(1.2F), check_settings()).planes[0].offset, 0.1F, kTolerance);
    EXPECT_NEAR(planes(at(1.1001F), check_settings()).planes[0].offset, 1e-4F, kTolerance);
    EXPECT_NEAR(planes(at(1.0999F), check_settings()).planes[0].offset, -0.5e-4F, kTolerance);
}

TEST_P(CheckBox, ACentreInsideLeavesByTheNearestFace)
{
    for (const Vec3& place :
         {Vec3(2.1F, 0.0F, 0.0F), Vec3(2.9F, 0.2F, 0.1F), Vec3(2.5F, 0.9F, 0.0F), Vec3(2.5F, 0.1F, -0.9F)}) {
        OwnMotion own = at(0.0F);
        own.position = place;
        const ObstaclePlanes found = planes(own, check_settings());
        ASSERT_EQ(found.planes.size(), 1U);
        const Vec3 local = place - Vec3(2.5F, 0.0F, 0.0F);
        const Vec3 out = std::abs(local.x()) > 0.3F   ? Vec3(std::copysign(1.0F, local.x()), 0.0F, 0.0F)
                         : std::abs(local.y()) > 0.5F ? Vec3(0.0F, std::copysign(1.0F, local.y()), 0.0F)
                                                      : Vec3(0.0F, 0.0F, std::copysign(1.0F, local.z()));
        EXPECT_TRUE(found.planes[0].normal.isApprox(out, 1e-4F));
        EXPECT_NEAR(found.planes[0].offset, 0.3F, kTolerance);
        EXPECT_NEAR(found.margin, -1.0F, 0.01F + kTolerance);  // 0.1 m deep and the envelope's 0.9 m
        EXPECT_TRUE(found.penetrating);
    }
}

TEST_P(CheckBox, OutOfReachSaysNothing)
{
    OwnMotion own = at(-20.0F);
    EXPECT_TRUE(planes(own, check_settings()).planes.empty());
    // 22 m away, 21.1 m of margin: within reach from 10.55 m/s on.
    own.reach_speed = 10.5F;
    EXPECT_TRUE(planes(own, check_settings()).planes.empty());
    own.reach_speed = 10.6F;
    EXPECT_EQ(planes(own, check_settings()).planes.size(), 1U);
}

TEST_P(CheckBox, BrakingBoundsTheSpeed)
{
    ObstacleSettings settings = check_settings();
    settings.braking = 0.1F;
    EXPECT_NEAR(-planes(at(0.0F), settings).planes[0].offset, std::sqrt(2.0F * 0.1F * 1.1F), 1e-4F);
    OwnMotion own = at(0.0F);
    own.velocity = {1.0F, 0.0F, 0.0F};
    settings.delay = 0.5F;  // flies half a metre before it brakes
    EXPECT_NEAR(-planes(own, settings).planes[0].offset, std::sqrt(2.0F * 0.1F * 0.6F), 1e-4F);
    settings.delay = 2.0F;
    EXPECT_NEAR(planes(own, settings).planes[0].offset, 0.0F, 1e-4F);
    settings.braking = 5.0F;
    settings.delay = 0.0F;
    EXPECT_NEAR(-planes(own, settings).planes[0].offset, 0.55F, 1e-4F);  // the horizon bounds first
}

TEST_P(CheckBox, TheWayAheadEndsAtTheMargin)
{
    WorkBudget budget(1'000'000);
    const WayClearance met = clearance_along(scene(), Vec3::Zero(), {1.0F, 0.0F, 0.0F}, 5.0F, check_settings(), budget);
    EXPECT_FALSE(met.clear || met.bounded);
    EXPECT_LE(met.clear_until, 1.1F);
    EXPECT_NEAR(met.clear_until, 1.1F, 3e-4F);
    EXPECT_EQ(met.source, 0);
    const WayClearance before =
        clearance_along(scene(), Vec3::Zero(), {1.0F, 0.0F, 0.0F}, 1.09F, check_settings(), budget);
    EXPECT_TRUE(before.clear);
    EXPECT_EQ(before.clear_until, 1.09F);
    const WayClearance past =
        clearance_along(scene(), {0.0F, 2.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, 9.0F, check_settings(), budget);
    EXPECT_TRUE(past.clear);  // 1 m beside it
    const WayClearance grazing =
        clearance_along(scene(), {0.0F, 1.8F, 0.0F}, {1.0F, 0.0F, 0.0F}, 9.0F, check_settings(), budget);
    EXPECT_FALSE(grazing.clear);  // 0.8 m beside it
    EXPECT_NEAR(grazing.clear_until, 2.0F - std::sqrt(0.81F - 0.64F), 2e-3F);
}

TEST_P(CheckBox, InTheMarginAWayOutIsClearAndAWayInIsNot)
{
    WorkBudget budget(1'000'000);
    for (const float x : {1.5F, 2.1F}) {
        EXPECT_TRUE(
            clearance_along(scene(), {x, 0.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}, 2.0F, check_settings(), budget).clear);
        const WayClearance in =
            clearance_along(scene(), {x, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, 2.0F, check_settings(), budget);
        EXPECT_FALSE(in.clear);
        EXPECT_EQ(in.clear_until, 0.0F);
    }
}

TEST(ObstaclePlanes, StretchIsMappedBackToVelocities)
{
    // A ceiling 4 m above, with 0.8 m required vertically and 1.1 m level: a climb of 3.2 m in 2.4 s is permitted.
    const world::Obstacle ceiling{1, geometry::make_box({0.0F, 0.0F, 5.0F}, {50.0F, 50.0F, 1.0F})};
    const ObstacleSettings settings;
    const ObstaclePlanes found = planes_of(oracle::threats_of({&ceiling, 1}), at(0.0F), settings);
    ASSERT_EQ(found.planes.size(), 1U);
    EXPECT_TRUE(found.planes[0].normal.isApprox(-Vec3::UnitZ(), 1e-4F));
    EXPECT_NEAR(found.planes[0].offset, -3.2F / 2.4F, 1e-4F);
}

TEST(ObstaclePlanes, CoveringTheCylinderTakesRootTwoOfBoth)
{
    const world::Obstacle wall{1, geometry::make_box({5.0F, 0.0F, 0.0F}, {1.0F, 50.0F, 50.0F})};
    ObstacleSettings settings;
    settings.covers_cylinder = true;
    const ObstaclePlanes found = planes_of(oracle::threats_of({&wall, 1}), at(0.0F), settings);
    ASSERT_EQ(found.planes.size(), 1U);
    EXPECT_NEAR(found.planes[0].offset, -(4.0F - 1.1F * std::sqrt(2.0F)) / 2.4F, 1e-4F);
}

/// Seventeen columns about the vehicle, one more than there are planes.
std::vector<world::Obstacle> ring(std::size_t count, float radius)
{
    std::vector<world::Obstacle> out;
    for (std::size_t i = 0; i < count; ++i) {
        const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(count);
        const Vec3 foot((radius + 0.01F * static_cast<float>(i)) * Vec3(std::cos(angle), std::sin(angle), 0.0F));
        out.push_back({static_cast<world::ObstacleId>(i),
                       geometry::make_capsule(foot - Vec3::UnitZ(), foot + Vec3::UnitZ(), 0.1F)});
    }
    return out;
}

TEST(ObstaclePlanes, TheSeventeenthObstacleBecomesASpeedCap)
{
    const std::vector<world::Obstacle> sixteen = ring(kMaxObstaclePlanes, 4.0F);
    const ObstacleSettings settings = check_settings();
    const ObstaclePlanes all = planes_of(oracle::threats_of(sixteen), at(0.0F), settings);
    EXPECT_EQ(all.planes.size(), kMaxObstaclePlanes);
    EXPECT_FALSE(all.truncated);
    EXPECT_EQ(all.speed_cap, std::numeric_limits<float>::infinity());

    const std::vector<world::Obstacle> more = ring(kMaxObstaclePlanes + 1, 4.0F);
    const ObstaclePlanes some = planes_of(oracle::threats_of(more), at(0.0F), settings);
    EXPECT_EQ(some.planes.size(), kMaxObstaclePlanes);
    EXPECT_TRUE(some.truncated);
    EXPECT_NEAR(some.speed_cap, (4.16F - 0.1F - 0.9F) / 2.0F, 1e-4F);
    for (std::size_t i = 1; i < some.planes.size(); ++i) {
        EXPECT_LE(some.planes[i].offset, some.planes[i - 1].offset + 1e-6F) << "nearest first";
    }
}

TEST(ObstaclePlanes, ABudgetThatRunsOutIsASpeedCapAndNotSilence)
{
    const std::vector<world::Obstacle> obstacles = ring(10, 4.0F);
    const ObstacleSettings settings;  // stretched: every capsule is searched
    for (const std::uint32_t units : {0U, 9U, 40U, 100U}) {
        WorkBudget budget(units);
        const ObstaclePlanes found = obstacle_planes(oracle::threats_of(obstacles), at(0.0F), settings, budget);
        ASSERT_TRUE(found.truncated) << units;
        const float stretch = envelope_of(settings).stretch;
        EXPECT_LE(found.speed_cap, (4.09F - 0.1F - 1.1F) / settings.horizon / stretch) << units;
    }
}

TEST(ObstaclePlanes, WhatIsImpliedIsLeftOut)
{
    // A wall in front of another one that is as wide and as high.
    const std::vector<world::Obstacle> walls{{1, geometry::make_box({3.0F, 0.0F, 0.0F}, {0.5F, 9.0F, 9.0F})},
                                             {2, geometry::make_box({5.0F, 0.0F, 0.0F}, {0.5F, 9.0F, 9.0F})}};
    EXPECT_EQ(planes_of(oracle::threats_of(walls), at(0.0F), check_settings()).planes.size(), 1U);
    // Turned a little, it is not: fast enough sideways, the farther wall is met first.
    const Mat3 turned = Eigen::AngleAxisf(0.5F, Vec3::UnitZ()).toRotationMatrix();
    const std::vector<world::Obstacle> askew{walls[0],
                                             {2, geometry::make_box({4.0F, 4.0F, 0.0F}, {0.5F, 9.0F, 9.0F}, turned)}};
    EXPECT_EQ(planes_of(oracle::threats_of(askew), at(0.0F), check_settings()).planes.size(), 2U);
}

TEST(ObstacleSettings, RefusesWhatIsOutOfRange)
{
    EXPECT_TRUE(is_valid(ObstacleSettings{}));
    const auto refused = [](auto change) {
        ObstacleSettings settings;
        change(settings);
        return !is_valid(settings);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refused([](auto& s) { s.horizontal = 0.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.vertical = -1.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.vertical = 0.2F; }));    // stretched by more than 4
    EXPECT_TRUE(refused([](auto& s) { s.horizontal = 0.3F; }));  // by less than half
    EXPECT_TRUE(refused([](auto& s) { s.horizon = 0.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.recovery_speed = -0.1F; }));
    EXPECT_TRUE(refused([](auto& s) { s.recovery_time = 0.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.braking = -1.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.delay = -1.0F; }));
    EXPECT_TRUE(refused([](auto& s) { s.resolution = 0.0F; }));
    EXPECT_TRUE(refused([nan](auto& s) { s.horizon = nan; }));
    EXPECT_TRUE(refused([nan](auto& s) { s.horizontal = nan; }));
}

}  // namespace
}  // namespace jink::orca
