// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/avoid/final_check.hpp"
#include "core/world/conflict.hpp"
#include "tests/oracle/collected.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/property/core/geometric/random_problem.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Candidates along references with bends and corners, against the reference in double precision.

namespace jink::geometric {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;
using jink::oracle::TwinRoute;
using jink::oracle::Vec3d;

/// A start on a random route and a collision point on it, 5 to 30 m ahead.
struct AlongRoute {
    TwinRoute twin;
    double start = 0.0;
    Problem problem;
    vehicle::VehicleLimits limits;

    AlongRoute(Random& random, bool level, float corner)
        : twin(jink::oracle::random_route(random, RandomProblem::vector(random, 300.0F), level, corner))
    {
        start = double(random.uniform(0.0F, 0.7F * static_cast<float>(twin.length())));
        const path::RoutePoint from = twin.route.at(static_cast<float>(start));
        problem.frame = make_path_frame(from.position, from.along);
        problem.ahead = {twin.route, 0.0F, static_cast<float>(start)};
        problem.distance = random.uniform(5.0F, 30.0F);
        problem.main_radius = 1.0F;
        problem.speed = random.uniform(2.0F, 8.0F);
    }
    AlongRoute(const AlongRoute&) = delete;
    AlongRoute& operator=(const AlongRoute&) = delete;

    [[nodiscard]] Vec3d at(double way) const { return twin.at(start + way); }
};

CandidateShape any_shape(Random& random)
{
    CandidateShape shape;
    shape.family = kCurves[random.below(kCurves.size())];
    shape.plane = random.uniform(0.0F, kPi);
    shape.offset = random.uniform(-6.0F, 6.0F);
    return shape;
}

TEST(AlongReference, BeginsAtTheVehicleAndEndsOnTheReference)
{
    const std::uint64_t seed = seed_of(20261129);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const AlongRoute p(random, random.below(2) == 0, random.below(2) == 0 ? 0.0F : 1.2F);
        const CandidateShape shape = any_shape(random);
        path::TimedPath path;
        ASSERT_TRUE(make_candidate_path(p.problem, shape, 25, p.limits, path));
        ASSERT_EQ(path.points.size(), 25U);
        ASSERT_LE((path.points.front().position - p.problem.frame.origin).norm(), 1e-3F);
        const double length = double(curve_length_x(shape.family, p.problem.distance));
        ASSERT_LE((path.points.back().position.cast<double>() - p.at(length)).norm(), 5e-3) << "case " << i;
        for (std::size_t k = 1; k < path.points.size(); ++k) {
            ASSERT_GT(path.points[k].time, path.points[k - 1].time);
            const Vec3& v = path.points[k - 1].velocity;
            ASSERT_LE(v.norm(), p.problem.speed * 1.001F);
            ASSERT_LE(v.z(), p.limits.max_climb * 1.001F);
            ASSERT_GE(v.z(), -p.limits.max_descent * 1.001F);
        }
    }
}

/// Without corners: waypoint i lies w f(u_i) beside the reference's point at the same arc length, across it.
TEST(AlongReference, OffsetsAreAppliedAcrossTheReference)
{
    const std::uint64_t seed = seed_of(20261130);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const AlongRoute p(random, random.below(2) == 0, 0.0F);
        const CandidateShape shape = any_shape(random);
        path::TimedPath path;
        ASSERT_TRUE(make_candidate_path(p.problem, shape, 25, p.limits, path));
        const double length = double(curve_length_x(shape.family, p.problem.distance));
        for (std::size_t k = 0; k < 25; ++k) {
            const double way = length * static_cast<double>(k) / 24.0;
            const Vec3d beside = path.points[k].position.cast<double>() - p.at(way);
            const double offset = double(curve_offset(shape, p.problem.distance, static_cast<float>(way)));
            ASSERT_NEAR(beside.norm(), std::abs(offset), 5e-3) << "case " << i << " at " << k;
            // Where a bend begins or ends the tangent is taken between neighbours: half of one step's turn.
            const double turn = length / 24.0 / 8.0;
            ASSERT_LE(std::abs(beside.dot(p.twin.along(p.start + way))), std::abs(offset) * 0.55 * turn + 5e-3)
                << "case " << i << " at " << k;
        }
    }
}

/// On a level reference with corners, vertical offsets stay vertical, and lateral offsets stay level.
TEST(AlongReference, PlanesDoNotTwist)
{
    const std::uint64_t seed = seed_of(20261131);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(1000); ++i) {
        const AlongRoute p(random, true, 1.2F);
        CandidateShape shape = any_shape(random);
        path::TimedPath base;
        path::TimedPath path;
        shape.plane = 0.5F * kPi;
        ASSERT_TRUE(make_candidate_path(p.problem, {shape.family, 0.0F, 0.0F}, 25, p.limits, base));
        ASSERT_TRUE(make_candidate_path(p.problem, shape, 25, p.limits, path));
        for (std::size_t k = 0; k < 25; ++k) {
            const Vec3 beside = path.points[k].position - base.points[k].position;
            const float way = curve_length_x(shape.family, p.problem.distance) * static_cast<float>(k) / 24.0F;
            ASSERT_LE((beside - Vec3(0.0F, 0.0F, curve_offset(shape, p.problem.distance, way))).norm(), 2e-3F);
        }
        shape.plane = 0.0F;
        ASSERT_TRUE(make_candidate_path(p.problem, shape, 25, p.limits, path));
        for (const path::PathPoint& point : path.points) {
            ASSERT_NEAR(point.position.z(), p.problem.frame.origin.z(), 2e-3F) << "case " << i;
        }
    }
}

/// A rounded corner passes inside of it: nearer than the parabola's height, and with no sharper turn anywhere than the
/// share of the acceleration that it is rounded for.
TEST(AlongReference, CornersAreRounded)
{
    Random random(20261132);
    for (std::size_t i = 0; i < case_count(500); ++i) {
        const float turn = random.uniform(0.3F, 2.0F);
        TwinRoute twin;
        const Vec3 corner(40.0F, 0.0F, 50.0F);
        ASSERT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), corner));
        ASSERT_TRUE(twin.leg(corner, corner + 60.0F * Vec3(std::cos(turn), std::sin(turn), 0.0F)));
        Problem problem;
        problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), Vec3::UnitX());
        problem.ahead = {twin.route, 0.0F, 0.0F};
        problem.distance = 35.0F;
        problem.main_radius = 1.0F;
        problem.speed = random.uniform(2.0F, 6.0F);
        const vehicle::VehicleLimits limits;
        path::TimedPath path;
        ASSERT_TRUE(make_candidate_path(problem, {Family::symmetric, 0.0F, 0.0F}, 60, limits, path));
        const double change = 2.0 * std::sin(0.5 * double(turn));
        const double half = double(problem.speed) * double(problem.speed) * change / double(limits.max_acceleration);
        double nearest = 1e9;
        for (const path::PathPoint& point : path.points) {
            const Vec3d position = point.position.cast<double>();
            const double off = twin.distance(position, 1.0);
            ASSERT_LE(off, 0.25 * change * half + 0.02);
            if ((position - corner.cast<double>()).norm() > half + 0.02) {
                ASSERT_LE(off, 0.012);
            }
            nearest = std::min(nearest, (position - corner.cast<double>()).norm());
        }
        ASSERT_GE(nearest, 0.25 * change * half - 0.02);
        float sharpest = 0.0F;
        for (std::size_t k = 1; k + 1 < path.points.size(); ++k) {
            const Seconds time = 0.5F * (path.points[k + 1].time - path.points[k - 1].time);
            sharpest = std::max(sharpest, (path.points[k].velocity - path.points[k - 1].velocity).norm() / time);
        }
        // Inside the bend the path is shorter than its arc length parameter, and flown at the same speed.
        ASSERT_LE(sharpest, 1.05F * 0.5F * limits.max_acceleration / std::pow(std::cos(0.5F * turn), 2.0F) + 0.05F);
    }
}

/// A corner just before the end leaves no space for rounding: at full speed the family that ends there is not flyable,
/// the one that ends well past it is, and slow ones are.
TEST(AlongReference, SharpCornersAreNotFlyable)
{
    TwinRoute twin;
    ASSERT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(29.0F, 0.0F, 50.0F)));
    ASSERT_TRUE(twin.leg(Vec3(29.0F, 0.0F, 50.0F), Vec3(29.0F, 80.0F, 50.0F)));
    const world::Threat main = world::track_threat(0, {Vec3(20.0F, 0.0F, 50.0F), Vec3::Zero()}, {1.0F});
    Problem problem;
    problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), Vec3::UnitX());
    problem.ahead = {twin.route, 0.0F, 0.0F};
    problem.distance = 20.0F;
    problem.main_radius = 1.0F;
    problem.main = 0;
    problem.threats = {&main, 1};
    problem.start_velocity = Vec3(5.0F, 0.0F, 0.0F);
    const vehicle::VehicleLimits limits;
    Settings settings;
    settings.evaluate_all = true;
    settings.check_units = 1'000'000;
    const auto flyable = [&](Family family) {
        auto result = std::make_unique<Result>();
        WorkBudget budget(1'000'000);
        static_cast<void>(solve(problem, settings, limits, {}, budget, *result));
        std::size_t count = 0;
        for (const Candidate& c : result->candidates) {
            count += c.shape.family == family && c.status != CandidateStatus::not_flyable ? 1U : 0U;
        }
        return count;
    };
    EXPECT_EQ(flyable(Family::simple), 0U);  // ends 1 m past the corner
    EXPECT_GT(flyable(Family::symmetric), 0U);
    problem.speed = 1.5F;
    EXPECT_GT(flyable(Family::simple), 0U);
}

/// A route that is one long leg changes nothing but rounding.
TEST(AlongReference, OneLegIsALeg)
{
    std::size_t found = 0;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
        RandomProblem p(seed);
        const Vec3 along = p.problem.frame.axes.col(0);
        path::Route route;
        ASSERT_EQ(route.add_leg(p.problem.frame.origin, p.problem.frame.origin + 20.0F * along), path::RouteStatus::ok);
        Settings settings;
        settings.wait = true;
        settings.check_units = 100'000;  // curves along a route are more expensive
        auto straight = std::make_unique<Result>();
        auto bent = std::make_unique<Result>();
        WorkBudget first(1'000'000);
        WorkBudget second(1'000'000);
        const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, first, *straight);
        Problem routed = p.problem;
        routed.ahead.route = route;
        ASSERT_EQ(solve(routed, settings, p.limits, p.airframe, second, *bent), status) << "seed " << seed;
        if (status != world::PlanStatus::found) {
            continue;
        }
        ++found;
        ASSERT_EQ(bent->candidates.size(), straight->candidates.size());
        const float cost = straight->candidates[straight->chosen].total;
        ASSERT_NEAR(bent->candidates[bent->chosen].total, cost, 1e-3F) << "seed " << seed;
        if (bent->chosen == straight->chosen) {
            for (std::size_t k = 0; k < straight->path.points.size(); ++k) {
                ASSERT_LE((straight->path.points[k].position - bent->path.points[k].position).norm(), 0.01F);
            }
        }
    }
    EXPECT_GT(found, 500U);
}

/// The method's results along random routes pass the supervisor's check, and end on the route.
TEST(AlongReference, WhatIsFoundPassesTheFinalCheck)
{
    static Planner planner{Settings{}};
    const std::uint64_t seed = seed_of(20261133);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t found = 0;
    std::size_t none = 0;
    std::size_t bent = 0;
    std::size_t lines = 0;
    std::size_t rejected = 0;
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const TwinRoute twin = jink::oracle::random_route(random, Vec3(0.0F, 0.0F, 60.0F), random.below(2) == 0, 1.0F);
        vehicle::VehicleState own;
        vehicle::VehicleLimits limits;
        world::Reference reference(twin.route, random.uniform(2.0F, 6.0F));
        reference.segment = random.below(twin.pieces.size());
        const auto segment = twin.route.segments()[reference.segment];
        const path::RoutePoint from = path::point_of(segment, random.uniform() * segment.length);
        own.position = from.position + RandomProblem::vector(random, random.below(4) == 0 ? 2.0F : 0.1F);
        own.velocity = vehicle::clamped_velocity(from.along, reference.speed, limits);
        std::vector<world::Track> tracks(1 + random.below(3));
        const world::Airspace airspace;
        const vehicle::Airframe airframe;
        const world::FlightRules rules{.lookahead = 10.0F};
        const world::Situation empty{TimePoint{50'000'000}, own, limits, airframe, reference, rules};
        const world::Way way = world::way_of(empty);
        for (world::Track& track : tracks) {
            track.stamp = empty.now;
            track.velocity = random.below(3) == 0 ? Vec3(Vec3::Zero()) : RandomProblem::vector(random, 5.0F);
            const float t = random.uniform(2.0F, 8.0F);
            const float there = std::min(way.speed * t, way.length);
            track.position = path::point_of(way.ahead, way.origin, way.direction, there).position - t * track.velocity +
                             RandomProblem::vector(random, 2.0F);
            track.radius = random.uniform(0.2F, 1.5F);
            track.sigma_velocity = random.uniform(0.0F, 0.1F);
        }
        const oracle::Collected situation(empty, {tracks, {}, airspace});
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        const world::PlanStatus status = planner.plan(situation, budget, manoeuvre);
        ASSERT_NE(status, world::PlanStatus::bad_input);
        none += status == world::PlanStatus::none_available ? 1U : 0U;
        if (status != world::PlanStatus::found) {
            continue;
        }
        ++found;
        ASSERT_GE(world::least_separation(situation, manoeuvre.path, 100.0F, budget).margin, -1e-2F) << "case " << i;
        ASSERT_LE((manoeuvre.path.points.front().position - own.position).norm(), 1e-3F);
        const Vec3d end = manoeuvre.path.points.back().position.cast<double>();
        const double reach = double(path::arc_length(manoeuvre.path)) + 10.0;
        const Vec3 to_end = manoeuvre.path.points.back().position - way.origin;
        const bool is_leg = twin.pieces.size() == 1 && !twin.pieces.front().is_arc;
        if (is_leg || way.ahead.joined_at >= way.ahead.route.length()) {
            ++lines;  // about a straight line from the start, which need not be the leg's own
        } else if (to_end.dot(way.direction) > way.ahead.straight + 0.1F || to_end.cross(way.direction).norm() > 0.5F) {
            ++bent;
            ASSERT_LE(twin.distance(end, reach), 0.02) << "case " << i;
        } else {
            ASSERT_LE(to_end.cross(way.direction).norm(), 0.5F) << "case " << i;  // on the straight beginning
        }
        rejected += avoid::check_manoeuvre(situation, manoeuvre, avoid::Settings{}, budget).margin < 0.0F ? 1U : 0U;
    }
    std::printf("[ measured ] %zu plans, %zu of them on routes with bends; %zu rejected by the final check; %zu times "
                "nothing\n",
                found, bent, rejected, none);
    EXPECT_GT(found, case_count(3000) / 3);
    EXPECT_LE(rejected * 30, found);
    EXPECT_LT(lines * 2, found);
}

}  // namespace
}  // namespace jink::geometric
