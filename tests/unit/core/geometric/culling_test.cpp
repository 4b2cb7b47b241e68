// SPDX-License-Identifier: BSD-3-Clause
// Cost of a plan, in work units of its budget: grows with the near threats, not with all threats.
#include <gtest/gtest.h>

#include <array>

#include <Eigen/Geometry>

#include "core/avoid/settings.hpp"
#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Walls, roof and ground of a straight tunnel about the leg, 300 m long, `gap` from the leg's line; turned about the
/// leg's start by `yaw`.
std::vector<world::Obstacle> tunnel(const Vec3& start, float gap, float yaw)
{
    const Mat3 turned = Eigen::AngleAxisf(yaw, Vec3::UnitZ()).toRotationMatrix();
    const float middle = gap + 0.5F;
    std::vector<world::Obstacle> walls;
    for (const Vec3& side :
         {Vec3(0.0F, middle, 0.0F), Vec3(0.0F, -middle, 0.0F), Vec3(0.0F, 0.0F, middle), Vec3(0.0F, 0.0F, -middle)}) {
        const Vec3 half = side.y() != 0.0F ? Vec3(150.0F, 0.5F, 8.0F) : Vec3(150.0F, 8.0F, 0.5F);
        walls.push_back({static_cast<world::ObstacleId>(walls.size()),
                         geometry::make_box(start + turned * (Vec3(100.0F, 0.0F, 0.0F) + side), half, turned)});
    }
    return walls;
}

/// A tunnel that something crosses through (walls do not stop it), on a leg at `yaw` from x.
Scene crossed_tunnel(float yaw)
{
    Scene scene;
    const Vec3 along(std::cos(yaw), std::sin(yaw), 0.0F);
    scene.settings = Settings{};
    scene.problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), along);
    scene.problem.start_velocity = 5.0F * along;
    const Vec3 across(-along.y(), along.x(), 0.0F);
    scene.threats = {{{scene.problem.frame.origin + 20.0F * along - 12.0F * across, 3.0F * across}, 1.0F}};
    scene.obstacles = tunnel(scene.problem.frame.origin, 2.5F, yaw);
    return scene;
}

PlanStatus run_with_retries(Scene& scene, std::size_t& attempts)
{
    static Workspace workspace;
    scene.put_into(scene.problem);
    return solve_with_retries(scene.problem, scene.settings, scene.limits, scene.airframe, scene.budget, workspace,
                              scene.result, attempts);
}

TEST(Culling, ATunnelOfLongBoxesIsWaitedInWithinOneAttemptsWork)
{
    for (const float yaw : {0.0F, 0.7F, -2.2F}) {
        Scene scene = crossed_tunnel(yaw);
        scene.settings.simple = scene.settings.symmetric = false;
        scene.settings.wait = true;
        scene.settings.check_units /= 5;  // one share, not the five of four solids
        scene.put_into(scene.problem);
        ASSERT_EQ(scene.run(), PlanStatus::found) << yaw;
        EXPECT_EQ(scene.result.candidates[scene.result.chosen].shape.family, Family::wait);
        EXPECT_FALSE(scene.result.cut_short);
        for (const path::PathPoint& point : scene.result.path.points) {
            const Vec3 off = point.position - scene.problem.frame.origin;
            EXPECT_LT((off - off.dot(scene.problem.frame.axes.col(0)) * scene.problem.frame.axes.col(0)).norm(), 1e-3F);
        }
    }
}

TEST(Culling, ATunnelIsPlannedInWithTheCoprocessorsBudget)
{
    for (const float yaw : {0.0F, 0.7F, -2.2F}) {
        Scene scene = crossed_tunnel(yaw);
        scene.budget = WorkBudget{avoid::Settings().plan_budget};
        std::size_t attempts = 0;
        ASSERT_EQ(run_with_retries(scene, attempts), PlanStatus::found) << yaw;
        EXPECT_EQ(scene.result.candidates[scene.result.chosen].shape.family, Family::wait);
        EXPECT_FALSE(scene.result.cut_short);
    }
}

/// Units of a plan, and that it ended.
std::uint32_t units_of(Scene scene)
{
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_FALSE(scene.result.cut_short);
    return scene.budget.spent();
}

/// How often threats are collected: once for all curves and once for each flight.
constexpr std::uint32_t kMaxCollections = 1 + 32;

TEST(Culling, WhatIsFarCostsItsBoundingTest)
{
    Scene scene;
    scene.settings = Settings{};
    const std::uint32_t alone = units_of(scene);
    const std::array<geometry::Shape, 4> far{
        geometry::make_sphere(Vec3(20.0F, 400.0F, 50.0F), 5.0F),
        geometry::make_box(Vec3(20.0F, -400.0F, 50.0F), Vec3(40.0F, 5.0F, 5.0F)),
        geometry::make_capsule(Vec3(0.0F, 300.0F, 50.0F), Vec3(60.0F, 310.0F, 70.0F), 3.0F),
        geometry::make_cylinder(Vec3(0.0F, -300.0F, 50.0F), Vec3(60.0F, -310.0F, 70.0F), 3.0F)};
    for (std::size_t i = 0; i < kMaxObstacles; ++i) {
        scene.obstacles.push_back({static_cast<world::ObstacleId>(i), far[i % far.size()]});
    }
    const std::uint32_t with_obstacles = units_of(scene);
    EXPECT_GT(with_obstacles, alone);
    EXPECT_LE(with_obstacles, alone + kMaxCollections * units::kCollected * kMaxObstacles);
    const std::size_t still = kMaxTracks - scene.threats.size();
    for (std::size_t i = 0; i < still; ++i) {
        scene.threats.push_back(Scene::still(Vec3(20.0F, 500.0F + static_cast<float>(i), 50.0F), 1.0F));
    }
    EXPECT_LE(units_of(scene), with_obstacles + kMaxCollections * units::kCollected * still);
}

/// A long wall off the leg, within reach of the candidates by its bounding sphere, is rejected as far by its faces.
TEST(Culling, ALongWallBesideTheLegCostsNoQuery)
{
    for (const float yaw : {0.0F, 0.4F, 2.0F}) {
        Scene scene;
        scene.settings = Settings{};
        const Mat3 turned = Eigen::AngleAxisf(yaw, Vec3::UnitZ()).toRotationMatrix();
        scene.problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), turned.col(0));
        scene.problem.start_velocity = 5.0F * turned.col(0);
        scene.threats = {Scene::still(Vec3(0.0F, 0.0F, 50.0F) + 20.0F * turned.col(0), 1.0F)};
        const std::uint32_t alone = units_of(scene);
        const Vec3 beside = scene.problem.frame.origin + turned * Vec3(0.0F, 12.0F, 0.0F);
        scene.obstacles = {{1, geometry::make_box(beside, Vec3(200.0F, 1.0F, 40.0F), turned)}};
        const std::uint32_t with_wall = units_of(scene);
        static_cast<void>(scene.run());
        const auto looked_at =
            static_cast<std::uint32_t>(scene.result.candidates.size() - scene.count(CandidateStatus::not_evaluated));
        // Each as a curve and in flight: two checks and all points once.
        const std::uint32_t each =
            units::kCollected + 4 * units::kSolidCheck + units::points_units(25) + units::points_units(kMaxPathPoints);
        EXPECT_LE(with_wall, alone + units::kCollected + looked_at * each) << yaw;
    }
}

/// A candidate on a straight line, at any speed: one query per solid that bounds do not separate from it.
TEST(Culling, AStraightCandidateTakesOneQueryForASolid)
{
    std::array<Point3, 6> prism{};
    for (std::size_t i = 0; i < prism.size(); ++i) {
        const float angle = kPi * static_cast<float>(i) / 3.0F + 0.3F;
        prism[i] = {i % 2 == 0 ? 12.0F : -12.0F, 2.0F * std::cos(angle), 2.0F * std::sin(angle)};
    }
    const auto units_for = [&](std::uint16_t waypoints) {
        Scene scene;
        scene.settings = Settings{};
        scene.settings.simple = scene.settings.symmetric = false;
        scene.settings.wait = scene.settings.evaluate_all = true;
        scene.settings.verify_flight = false;
        scene.settings.waypoints = waypoints;
        scene.threats = {{{Vec3(20.0F, -12.0F, 50.0F), Vec3(0.0F, 3.0F, 0.0F)}, 1.0F}};
        const std::uint32_t alone = units_of(scene);
        scene.obstacles = {{1, geometry::make_hull(prism, Vec3(15.0F, 2.2F, 53.0F))}};
        return units_of(scene) - alone;
    };
    // Without one query for the whole path, each further waypoint would add a query per candidate.
    const std::uint32_t few = units_for(13);
    const std::uint32_t many = units_for(61);
    EXPECT_GT(few, kWaits * (units::kSolidQuery + units::kExactTurn)) << "a query it is";
    EXPECT_LE(many, few + 48 * kWaits * (units::kSolidSegment + 1));
}

/// Within the common reach of the level candidates, and above each single one: many are rejected by a quick check.
TEST(Culling, OfManySpheresThoseFarFromACurveCostALook)
{
    constexpr std::uint32_t kMore = 6;
    for (const Vec3& velocity : {Vec3(0.0F, 0.0F, 0.0F), Vec3(0.0F, 0.01F, 0.0F)}) {
        for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
            Scene scene;
            scene.settings.security = security;
            scene.settings.verify_flight = false;
            scene.settings.extra_planes = 0;
            scene.settings.closeness_nearest = 1;
            const std::vector<Sphere> above(kMore, {{Vec3(20.0F, 0.0F, 53.2F), velocity}, 0.1F});
            const auto add = [&] { scene.threats.insert(scene.threats.end(), above.begin(), above.end()); };
            add();
            const std::uint32_t before = units_of(scene);
            add();
            const std::uint32_t added = units_of(scene) - before;
            const bool by_volume = velocity.y() > 0.0F && security == SecurityMode::swept;
            const std::uint32_t each = units::kFarItem + (by_volume ? units::kItem : 0);
            static_cast<void>(scene.run());
            // The others are not flyable, or in contact with an earlier threat.
            const auto looked_at = static_cast<std::uint32_t>(scene.count(CandidateStatus::available) +
                                                              scene.count(CandidateStatus::chosen));
            ASSERT_GT(looked_at, 1U);
            EXPECT_EQ(added, kMore * (units::kThreatValid + units::kCollected + looked_at * each)) << by_volume;
        }
    }
}

/// Threats beyond the end of all requested candidates cost their bounding test, independent of the reach of other
/// families.
TEST(Culling, ReachIsThatOfTheFamiliesThatAreAskedFor)
{
    for (const Family family : {Family::simple, Family::symmetric, Family::smooth}) {
        Scene scene;
        scene.settings.simple = family == Family::simple;
        scene.settings.symmetric = family == Family::symmetric;
        scene.settings.smooth = family == Family::smooth;
        scene.settings.verify_flight = scene.settings.check_acceleration = false;
        scene.problem.main = kNoThreat;
        scene.threats.clear();
        static_cast<void>(scene.run());
        const std::uint32_t alone = scene.budget.spent();
        float widest = 0.0F;
        for (const Candidate& candidate : scene.result.candidates) {
            widest = std::max(widest, std::abs(candidate.shape.offset));
        }
        const float end = curve_length_x(family, scene.problem.distance) + widest;
        constexpr std::uint32_t taken = units::kThreatValid + units::kCollected;
        const auto added = [&](float x) {
            scene.threats = {Scene::still(Vec3(x, 0.0F, 50.0F), 0.5F)};
            scene.budget = WorkBudget{1'000'000};
            static_cast<void>(scene.run());
            return scene.budget.spent() - alone;
        };
        EXPECT_EQ(added(end + 1.6F), taken) << to_string(family);
        EXPECT_GT(added(end + 1.4F), taken) << to_string(family);
    }
}

}  // namespace
}  // namespace jink::geometric
