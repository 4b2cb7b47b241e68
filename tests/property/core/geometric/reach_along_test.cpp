// SPDX-License-Identifier: BSD-3-Clause
// Along random routes: the considered region contains every candidate, and a moved start leaves the threat in place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/along_reference.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/property/core/geometric/random_problem.hpp"
#include "tests/unit/core/geometric/flight.hpp"

namespace jink::geometric {
namespace {

using geometry::oracle::seed_of;
using jink::oracle::TwinRoute;

/// Every candidate of `widest` at most is within reach and ends in time, however the route bends.
TEST(ReachAlong, HoldsEveryCandidate)
{
    const std::uint64_t seed = seed_of(20261202);
    SCOPED_TRACE(seed);
    Random random(seed);
    const vehicle::VehicleLimits limits;
    for (std::size_t i = 0; i < case_count(1500); ++i) {
        const TwinRoute twin = jink::oracle::random_route(random, Vec3(0.0F, 0.0F, 60.0F), random.below(2) == 0, 1.0F);
        Problem problem;
        const float start = random.uniform(0.0F, 0.7F * static_cast<float>(twin.length()));
        const path::RoutePoint from = twin.route.at(start);
        problem.frame = make_path_frame(from.position, from.along);
        problem.ahead = {twin.route, 0.0F, start};
        problem.distance = random.uniform(5.0F, 40.0F);
        problem.main_radius = 1.0F;
        problem.speed = random.uniform(1.0F, 5.0F);
        const float widest = random.uniform(0.5F, 6.0F);
        const float length = curve_length_x(Family::symmetric, problem.distance);
        const float slowest = std::min({problem.speed, limits.max_climb, limits.max_descent});
        Seconds longest = (length + 2.0F * widest) / slowest;  // along a straight leg
        const Seconds straight = longest;
        detail::Extent reach;
        detail::reach_along(problem, length, widest, slowest, reach, longest);
        // No arc of these turns further than 3 rad, no corner further than back.
        ASSERT_LE(longest, straight + widest / slowest * float(kMaxRouteSegments) * (kPi + 3.01F));
        for (const Family family : kCurves) {
            for (const float offset : {widest, -widest}) {
                path::TimedPath path;
                ASSERT_TRUE(make_candidate_path(problem, {family, random.uniform(0.0F, kPi), offset}, kMaxPathPoints,
                                                limits, path));
                ASSERT_LE(path.duration(), longest) << i;
                for (const path::PathPoint& point : path.points) {
                    const Vec3 about = point.position - problem.frame.origin;
                    ASSERT_TRUE((about.array() >= reach.low.array() - 1e-3F).all()) << i;
                    ASSERT_TRUE((about.array() <= reach.high.array() + 1e-3F).all()) << i;
                }
            }
        }
    }
}

/// Round and round: outside of bends curves are longer than along a leg by as much as these turn.
TEST(ReachAlong, HoldsWhatGoesRoundOutside)
{
    const float radius = 8.0F;
    TwinRoute twin;
    for (std::size_t i = 0; i < kMaxRouteSegments; ++i) {
        ASSERT_TRUE(twin.arc(Vec3(0.0F, 0.0F, 50.0F), Vec3(0.0F, radius, 50.0F), Vec3::UnitZ(), 2.0F * kPi));
    }
    Problem problem;
    problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), Vec3::UnitX());
    problem.ahead.route = twin.route;
    const float length = static_cast<float>(twin.length());
    problem.distance = 0.5F * length;
    problem.main_radius = 1.0F;
    const float widest = 6.0F;
    Seconds longest = (length + 2.0F * widest) / problem.speed;
    detail::Extent reach;
    detail::reach_along(problem, length, widest, problem.speed, reach, longest);
    path::TimedPath path;
    ASSERT_TRUE(
        make_candidate_path(problem, {Family::plateau, 0.0F, -widest}, kMaxPathPoints, vehicle::VehicleLimits{}, path));
    EXPECT_LE(path.duration(), longest);
    // Chords of 64 points are shorter than the bends: the curve itself is longer still.
    const float turned = 2.0F * kPi * static_cast<float>(kMaxRouteSegments);
    const float out = 1.0F - kPlateauRise;  // least share of the path at full offset
    EXPECT_GE(longest, (length + out * turned * widest) / problem.speed);
}

/// The collision point stays where it is on the route, or, if the path joins the route only past it, is the nearest
/// point of the path; the threat stays in place in any case.
TEST(ReachAlong, AMovedStartLeavesTheThreatWhereItIs)
{
    const std::uint64_t seed = seed_of(20261201);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t on_route = 0;
    std::size_t before_it = 0;
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const TwinRoute twin = jink::oracle::random_route(random, Vec3(0.0F, 0.0F, 60.0F), random.below(2) == 0, 1.2F);
        Flight flight;
        flight.reference = world::Reference(twin.route, flight.reference.speed);
        const float start = random.uniform(0.0F, 0.7F * static_cast<float>(twin.length()));
        flight.own.position = twin.route.at(start).position + RandomProblem::vector(random, 3.0F);
        Problem problem = problem_along(flight, random.uniform(5.0F, 30.0F));
        problem.main_centre_offset = RandomProblem::vector(random, 2.0F);
        const Vec3 point = collision_point(problem);
        const Vec3 threat = point + problem.main_centre_offset;
        const float of_route = problem.distance - problem.ahead.straight + problem.ahead.joined_at;
        const bool is_on_it = problem.distance >= problem.ahead.straight;
        const Vec3 by = RandomProblem::vector(random, 1.0F) + problem.frame.axes.col(0);
        if (!detail::move_start_along(flight.situation(), by, 1.0F, problem)) {
            continue;
        }
        ASSERT_GE(problem.distance, 1.0F);
        ASSERT_LT((collision_point(problem) + problem.main_centre_offset - threat).norm(), 1e-3F) << i;
        ASSERT_LT((problem.frame.origin - (flight.own.position + by)).norm(), 1e-4F) << i;
        if (of_route >= problem.ahead.joined_at) {
            on_route += is_on_it ? 1U : 0U;
            ASSERT_TRUE(!is_on_it || problem.distance >= problem.ahead.straight) << i;
            ASSERT_TRUE(!is_on_it || (collision_point(problem) - point).norm() < 2e-3F) << i;
        } else {
            ++before_it;
            const Vec3 off = point - (problem.frame.origin + problem.distance * problem.frame.axes.col(0));
            ASSERT_NEAR(off.dot(problem.frame.axes.col(0)), 0.0F, 2e-3F) << i;
        }
    }
    EXPECT_GT(on_route, case_count(3000) / 6);
    EXPECT_GT(before_it, case_count(3000) / 30);
}

}  // namespace
}  // namespace jink::geometric
