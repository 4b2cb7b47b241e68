// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/planner.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;
using world::ThreatKind;

TEST(CandidateStatuses, HitsStatic)
{
    Scene scene;
    scene.threats.push_back(Scene::still(Vec3(20.0F, -4.0F, 50.0F), 2.0F));
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.side.y(), 0.0F);
    for (const Candidate& c : scene.result.candidates) {
        if (c.shape.plane == 0.0F && c.shape.offset < 0.0F && c.status != CandidateStatus::not_flyable) {
            EXPECT_EQ(c.status, CandidateStatus::hits_static);
            EXPECT_EQ(c.hit, (world::ThreatRef{ThreatKind::track, 1}));
        }
    }
}

TEST(CandidateStatuses, HitsObstacle)
{
    Scene scene;
    scene.obstacles = {{7, geometry::make_box(Vec3(20.0F, -10.0F, 50.0F), Vec3(8.0F, 8.5F, 30.0F))}};
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.side.y(), -0.1F);
    std::size_t hits = 0;
    for (const Candidate& c : scene.result.candidates) {
        hits +=
            c.status == CandidateStatus::hits_static && c.hit == world::ThreatRef{ThreatKind::obstacle, 0} ? 1U : 0U;
    }
    EXPECT_GT(hits, 0U);
    // A clearance from obstacles takes more of them.
    const std::size_t before = scene.count(CandidateStatus::hits_static);
    scene.uncertainty = 2.0F;
    static_cast<void>(scene.run());
    EXPECT_GT(scene.count(CandidateStatus::hits_static), before);
}

TEST(CandidateStatuses, HitsMoving)
{
    Scene scene;
    // Crosses the path to the right 1 s after the vehicle has left the leg's abeam point.
    scene.threats.push_back({{Vec3(20.0F, -3.0F - 4.0F * 2.0F, 50.0F), Vec3(0.0F, 2.0F, 0.0F)}, 1.5F});
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.count(CandidateStatus::hits_moving), 0U);
    for (const Candidate& c : scene.result.candidates) {
        if (c.status == CandidateStatus::hits_moving) {
            EXPECT_EQ(c.hit, (world::ThreatRef{ThreatKind::track, 1}));
        }
    }
}

TEST(CandidateStatuses, StaticCauseComesBeforeMovingOne)
{
    Scene scene;
    const Sphere moving{{Vec3(20.0F, -11.0F, 50.0F), Vec3(0.0F, 2.0F, 0.0F)}, 1.5F};
    const Sphere still = Scene::still(Vec3(20.0F, -4.0F, 50.0F), 3.0F);
    scene.threats.push_back(moving);
    scene.threats.push_back(still);
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const auto first = scene.result.candidates;
    std::swap(scene.threats[1], scene.threats[2]);
    ASSERT_EQ(scene.run(), PlanStatus::found);
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].status, scene.result.candidates[i].status) << i;
    }
}

TEST(CandidateStatuses, HitsAirspace)
{
    Scene scene;
    scene.airspace.has_floor = true;
    scene.airspace.floor = 48.5F;  // half a metre of clearance below the box
    scene.airspace.has_ceiling = true;
    scene.airspace.ceiling = 51.5F;
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(0.0F, 42.0F, 0.0F);
    scene.airspace.keep_in_radius = 70.0F;
    scene.settings.check_acceleration = false;
    scene.settings.verify_flight = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    bool floor = false;
    bool ceiling = false;
    for (const Candidate& c : scene.result.candidates) {
        floor = floor || c.hit.kind == ThreatKind::floor;
        ceiling = ceiling || c.hit.kind == ThreatKind::ceiling;
        EXPECT_EQ(c.status == CandidateStatus::hits_airspace, c.hit.kind == ThreatKind::floor ||
                                                                  c.hit.kind == ThreatKind::ceiling ||
                                                                  c.hit.kind == ThreatKind::keep_in);
        if (c.shape.plane > 0.1F) {
            EXPECT_EQ(c.status, CandidateStatus::hits_airspace);
        }
    }
    EXPECT_TRUE(floor);
    EXPECT_TRUE(ceiling);
    scene.airspace.keep_in_radius = 43.0F;  // contact of the box's corner when the vehicle is far enough ahead
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_GT(static_cast<int>(std::count_if(scene.result.candidates.begin(), scene.result.candidates.end(),
                                             [](const Candidate& c) { return c.hit.kind == ThreatKind::keep_in; })),
              0);
}

TEST(CandidateStatuses, NotFlyable)
{
    Scene scene;
    scene.problem.distance = 6.0F;
    scene.threats = {Scene::still(Vec3(6.0F, 0.0F, 50.0F), 1.0F)};
    // 6 w v^2 / D^2 = 6 * 2 * 25 / 36 = 8.3 m/s2 > 5 m/s2 already for the smallest offset.
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_EQ(scene.count(CandidateStatus::not_flyable), scene.result.candidates.size());
    scene.settings.check_acceleration = false;
    scene.settings.verify_flight = false;
    EXPECT_EQ(scene.run(), PlanStatus::found);
}

TEST(CandidateStatuses, FlyableLimitIsTheCurvatureAtTheStart)
{
    // Symmetric, level: 6 w v^2 / D^2 against 5 m/s2: w = 13.3 m at D = 20 m, v = 5 m/s, but for the discretisation.
    Scene scene;
    scene.settings.simple = false;
    scene.settings.extra_planes = 0;
    scene.settings.verify_flight = false;
    scene.settings.waypoints = 64;
    scene.settings.offsets = 2;
    scene.settings.offset_rule = OffsetRule::source;
    for (const float offset : {12.6F, 14.2F}) {
        scene.problem.main_radius = offset / 3.2F;
        scene.threats = {Scene::still(Vec3(20.0F, 0.0F, 50.0F), 1.0F)};
        EXPECT_EQ(scene.run(), offset < 13.0F ? PlanStatus::found : PlanStatus::none_available) << offset;
    }
}

TEST(CandidateStatuses, SteepReturnToTheLegIsNotFlyable)
{
    Scene scene;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    // At D = 20 m and |w| > 2 m the simple candidate rejoins the leg at 24 degrees: it would overshoot by more than
    // half a metre.
    for (const Candidate& c : scene.result.candidates) {
        if (c.shape.family == Family::simple) {
            EXPECT_EQ(c.status, CandidateStatus::not_flyable);
        }
    }
    scene.problem.distance = 60.0F;
    scene.threats = {Scene::still(Vec3(60.0F, 0.0F, 50.0F), 1.0F)};
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_NE(scene.result.candidates[2].status, CandidateStatus::not_flyable);
}

TEST(VerifyFlight, AStandingVehicleIsNotWhereThePlanSays)
{
    // A threat passes behind the planned path; a vehicle that has yet to gain speed is still there.
    Scene scene;
    scene.settings.simple = false;
    scene.threats.push_back({{Vec3(2.5F, 9.0F, 50.0F), Vec3(0.0F, -8.0F, 0.0F)}, 0.5F});
    scene.settings.verify_flight = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    scene.settings.verify_flight = true;
    scene.problem.start_velocity = Vec3::Zero();
    const PlanStatus standing = scene.run();
    EXPECT_EQ(standing, PlanStatus::none_available);
    EXPECT_GT(scene.count(CandidateStatus::hits_moving), 0U);
    scene.problem.start_velocity = Vec3(5.0F, 0.0F, 0.0F);
    EXPECT_EQ(scene.run(), PlanStatus::found);
}

TEST(VerifyFlight, BrakingAtTheEndMustBeClear)
{
    Scene scene;
    scene.settings.simple = false;
    // A wall behind the end of every candidate: the path itself is clear, stopping at its end is not.
    scene.obstacles = {{1, geometry::make_box(Vec3(43.0F, 0.0F, 50.0F), Vec3(1.0F, 60.0F, 60.0F))}};
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    scene.settings.verify_flight = false;
    EXPECT_EQ(scene.run(), PlanStatus::found);
}

TEST(FlipPenalty, TheOtherSideMustBeWorthIt)
{
    Scene scene;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    ASSERT_LT(scene.result.side.y(), -0.9F);
    scene.problem.preferred_side = Vec3::UnitY();
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.side.y(), 0.9F);
    for (const Candidate& c : scene.result.candidates) {
        const float left = c.shape.offset * std::cos(c.shape.plane);
        if (c.status == CandidateStatus::available && std::abs(left) > 0.1F) {
            EXPECT_EQ(c.flip_penalty, left < 0.0F ? scene.settings.flip_penalty : 0.0F);
        }
    }
    // With the preferred side blocked it flips all the same, penalty or not, and max_cost does not count the penalty.
    scene.threats.push_back(Scene::still(Vec3(20.0F, 8.0F, 50.0F), 7.0F));
    scene.settings.flip_penalty = 5.0F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_LT(scene.result.side.y(), 0.1F);
}

TEST(Closeness, OnlyTheNearestCountWhenAsked)
{
    Scene scene;
    scene.threats.push_back({{Vec3(20.0F, 15.0F, 50.0F), Vec3(0.1F, 0.0F, 0.0F)}, 1.0F});
    scene.threats.push_back({{Vec3(200.0F, 15.0F, 50.0F), Vec3(0.1F, 0.0F, 0.0F)}, 1.0F});
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const float all = scene.result.candidates[scene.result.chosen].terms.closeness;
    scene.settings.closeness_nearest = 1;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const float nearest = scene.result.candidates[scene.result.chosen].terms.closeness;
    EXPECT_GT(nearest, all);  // the far one no longer lowers the mean
    std::swap(scene.threats[1], scene.threats[2]);
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.result.candidates[scene.result.chosen].terms.closeness, nearest);
}

TEST(EscapeFromMargin, AStartInsideAMarginHasAWayOut)
{
    Scene scene;
    // A hovering drone whose grown sphere holds the start's box corner.
    scene.threats.push_back(Scene::still(Vec3(-1.5F, -1.0F, 50.0F), 1.0F));
    ASSERT_EQ(scene.run(), PlanStatus::found);
    scene.settings.escape_from_margin = false;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
}

TEST(EscapeFromMargin, ObstaclesAndAirspaceToo)
{
    for (const geometry::Shape& shape : {geometry::make_box(Vec3(-2.0F, 0.0F, 50.0F), Vec3(1.5F, 3.0F, 3.0F)),
                                         geometry::make_sphere(Vec3(-2.0F, 0.0F, 50.0F), 1.5F)}) {
        Scene scene;
        scene.obstacles = {{1, shape}};
        EXPECT_EQ(scene.run(), PlanStatus::found);
        scene.settings.escape_from_margin = false;
        EXPECT_EQ(scene.run(), PlanStatus::none_available);
    }
    Scene scene;
    scene.airspace.has_floor = true;
    scene.airspace.floor = 49.5F;  // the box's lower half a metre is below it already
    scene.problem.frame = make_path_frame(scene.problem.frame.origin, Vec3(1.0F, 0.0F, 0.3F));
    scene.threats = {Scene::still(scene.problem.frame.origin + 20.0F * scene.problem.frame.axes.col(0), 1.0F)};
    EXPECT_EQ(scene.run(), PlanStatus::found);
    scene.settings.escape_from_margin = false;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
}

TEST(Growth, AGrowingThreatTakesMoreRoom)
{
    Scene scene;
    scene.threats.push_back(Scene::still(Vec3(20.0F, -8.0F, 50.0F), 1.0F));
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const std::size_t before = scene.count(CandidateStatus::hits_static);
    scene.threats[1].radius_rate = 0.5F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.count(CandidateStatus::hits_static), before);
    scene.threats[1].radius_rate = 0.0F;
    scene.threats[1].radius_acceleration = 0.25F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.count(CandidateStatus::hits_static), before);
}

TEST(SweptMode, TheVolumeOfTheMainThreatMayEndAtTheCollisionPoint)
{
    Scene scene;
    scene.settings = source_settings();
    // Crossing at right angles, meeting the vehicle at the collision point.
    scene.threats = {{{Vec3(20.0F, -12.0F, 50.0F), Vec3(0.0F, 3.0F, 0.0F)}, 1.0F}};
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.side.y(), 0.0F);  // behind the collision point its volume ends
    const std::size_t with_end = scene.count(CandidateStatus::hits_moving);
    scene.settings.main_swept_to_collision_point = false;
    static_cast<void>(scene.run());
    EXPECT_GT(scene.count(CandidateStatus::hits_moving), with_end);
}

}  // namespace
}  // namespace jink::geometric
