// SPDX-License-Identifier: BSD-3-Clause
// Along a route: when it counts as straight, the position of a moved start, flyable waits, and a family's curve where
// it hardly moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "core/geometric/along_reference.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/unit/core/geometric/flight.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using oracle::TwinRoute;
using world::PlanStatus;

/// 20 m east, a corner, 80 m north.
TwinRoute corner()
{
    TwinRoute twin;
    EXPECT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(20.0F, 0.0F, 50.0F)));
    EXPECT_TRUE(twin.leg(Vec3(20.0F, 0.0F, 50.0F), Vec3(20.0F, 80.0F, 50.0F)));
    return twin;
}

TEST(AlongBorder, ARouteAsStraightAsAnyManoeuvreIsLongIsALeg)
{
    const TwinRoute twin = corner();
    Flight flight;
    flight.reference = world::Reference(twin.route, flight.reference.speed);
    world::Conflict conflict;
    conflict.way_at_closest = 10.0F;
    conflict.threat_at_closest = Vec3(10.0F, 1.0F, 50.0F);
    world::Way way;
    // Twice the scale, which is 1.5 D at most.
    way.ahead = {twin.route, 30.0F, 20.0F};
    Problem problem;
    detail::follow_route(flight.situation(), way, conflict, problem);
    EXPECT_TRUE(problem.ahead.route.empty());
    EXPECT_EQ(problem.straight, 30.0F);
    way.ahead.straight = std::nextafter(30.0F, 0.0F);
    problem = {};
    detail::follow_route(flight.situation(), way, conflict, problem);
    EXPECT_EQ(problem.ahead.route.segments().data(), twin.route.segments().data());
    EXPECT_EQ(problem.distance, 10.0F);
    EXPECT_LT((collision_point(problem) + problem.main_centre_offset - conflict.threat_at_closest).norm(), 1e-5F);
}

TEST(AlongBorder, AStartIsMovedWhereItIsLeftWithTheLeast)
{
    const TwinRoute twin = corner();
    Flight flight;
    flight.reference = world::Reference(twin.route, flight.reference.speed);
    const Vec3 by(1.0F, 0.0F, 0.0F);
    Problem problem = problem_along(flight, 30.0F);
    EXPECT_FALSE(detail::move_start_along(flight.situation(), by, std::nextafter(29.0F, 30.0F), problem));
    EXPECT_EQ(problem.distance, 30.0F) << "nothing has changed";
    EXPECT_TRUE(detail::move_start_along(flight.situation(), by, 29.0F, problem));
    EXPECT_EQ(problem.distance, 29.0F);
    // Past the collision point nothing is left, however little is asked for.
    Problem near = problem_along(flight, 10.0F);
    EXPECT_FALSE(detail::move_start_along(flight.situation(), Vec3(10.5F, 0.0F, 0.0F), 1e-6F, near));
}

/// Level for 12 m, then up or down at 45 degrees: at the leg's speed it rises at 3.5 m/s there.
TEST(AlongBorder, WaitsThatRiseFasterThanTheVehicleAreNotFlyable)
{
    for (const float up : {1.0F, -1.0F}) {
        TwinRoute twin;
        ASSERT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(12.0F, 0.0F, 50.0F)));
        ASSERT_TRUE(twin.leg(Vec3(12.0F, 0.0F, 50.0F), Vec3(52.0F, 0.0F, 50.0F + 40.0F * up)));
        const auto flyable = [&](float climb, float descent) {
            Scene scene;
            scene.settings.simple = scene.settings.symmetric = scene.settings.verify_flight = false;
            scene.settings.wait = true;
            scene.limits.max_climb = climb;
            scene.limits.max_descent = descent;
            scene.problem.ahead.route = twin.route;
            scene.problem.main = kNoThreat;
            scene.threats.clear();
            static_cast<void>(scene.run());
            return kWaits - scene.count(CandidateStatus::not_flyable);
        };
        EXPECT_EQ(flyable(4.0F, 4.0F), kWaits);
        EXPECT_EQ(flyable(up > 0.0F ? 3.0F : 4.0F, up > 0.0F ? 4.0F : 3.0F), 0U) << up;
        EXPECT_EQ(flyable(up > 0.0F ? 4.0F : 3.0F, up > 0.0F ? 3.0F : 4.0F), kWaits) << up;
    }
}

/// Curves start from flight along the path, as along a leg; the vehicle's motion at the start belongs to the flight.
TEST(AlongBorder, CurvesAreFlyableFromFlightAlongTheWay)
{
    TwinRoute twin;
    ASSERT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(200.0F, 0.0F, 50.0F)));
    for (const float speed : {0.0F, 5.0F}) {
        Scene scene;
        scene.settings.verify_flight = false;
        scene.threats.clear();
        scene.problem.main = kNoThreat;
        scene.problem.start_velocity = Vec3(speed, 0.0F, 0.0F);
        static_cast<void>(scene.run());
        const std::size_t along_a_leg = scene.count(CandidateStatus::not_flyable);
        EXPECT_LT(along_a_leg, scene.result.candidates.size());
        scene.problem.ahead.route = twin.route;
        static_cast<void>(scene.run());
        EXPECT_EQ(scene.count(CandidateStatus::not_flyable), along_a_leg);
    }
}

/// About the centre of a bend a plateau with an offset equal to the radius is stationary.
TEST(AlongBorder, TimesRiseWhereACurveStandsStill)
{
    TwinRoute twin;
    ASSERT_TRUE(twin.arc(Vec3(0.0F, 0.0F, 50.0F), Vec3(0.0F, 16.0F, 50.0F), Vec3::UnitZ(), 3.0F));
    Problem problem;
    problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), Vec3::UnitX());
    problem.ahead.route = twin.route;
    problem.distance = 20.0F;
    problem.main_radius = 1.0F;
    path::TimedPath path;
    ASSERT_TRUE(
        make_candidate_path(problem, {Family::plateau, 0.0F, 16.0F}, kMaxPathPoints, vehicle::VehicleLimits{}, path));
    std::size_t standing = 0;
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
        const Vec3 step = path.points[i + 1].position - path.points[i].position;
        standing += step.norm() < 1e-4F ? 1U : 0U;
        ASSERT_GT(path.points[i + 1].time - path.points[i].time, 0.99e-3F) << i;
        ASSERT_LE(path.points[i].velocity.norm(), 1.01F * problem.speed) << i;
    }
    EXPECT_GT(standing, 10U);
}

/// Working memory carries no state between calls: for any contents, the answer is the same.
TEST(AlongBorder, WhatTheWorkspaceHeldIsNotRead)
{
    const TwinRoute bent = corner();
    for (const path::RouteView route : {path::RouteView(), path::RouteView(bent.route)}) {
        std::vector<std::unique_ptr<Result>> results;
        for (const int held : {0x00, 0xFF}) {  // all bits set: no number at all
            auto scene = std::make_unique<Scene>();
            scene->settings.wait = scene->settings.smooth = scene->settings.plateau = true;
            scene->problem.ahead.route = route;
            scene->problem.speed = 2.0F;
            scene->problem.start_velocity = Vec3(2.0F, 0.0F, 0.0F);
            scene->put_into(scene->problem);
            auto workspace = std::make_unique<Workspace>();
            std::memset(workspace->bytes(), held, Workspace::kBytes);
            results.push_back(std::make_unique<Result>());
            ASSERT_EQ(solve(scene->problem, scene->settings, scene->limits, scene->airframe, scene->budget, *workspace,
                            *results.back()),
                      PlanStatus::found);
        }
        const Result& a = *results[0];
        const Result& b = *results[1];
        ASSERT_EQ(a.candidates.size(), b.candidates.size());
        std::size_t available = 0;
        for (std::size_t i = 0; i < a.candidates.size(); ++i) {
            ASSERT_EQ(a.candidates[i].status, b.candidates[i].status) << i;
            ASSERT_EQ(a.candidates[i].total, b.candidates[i].total) << i;
            available += a.candidates[i].status == CandidateStatus::available ? 1U : 0U;
        }
        EXPECT_GT(available, 10U);
        ASSERT_EQ(a.chosen, b.chosen);
        for (std::size_t i = 0; i < a.path.points.size(); ++i) {
            ASSERT_EQ(a.path.points[i].position, b.path.points[i].position);
        }
    }
}

}  // namespace
}  // namespace jink::geometric
