// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "core/geometric/planner.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// The status that `solve` gives each candidate, against distances by minimisation and dense sampling in double.

namespace jink::geometric {
namespace {

/// Between these margins float and double may differ [m]: coordinates of up to 400 m.
constexpr double kGrazing = 2e-3;

Settings bare(Random& random)
{
    Settings settings;
    settings.check_acceleration = false;
    settings.verify_flight = false;
    settings.evaluate_all = true;
    settings.escape_from_margin = false;
    settings.waypoints = static_cast<std::uint16_t>(8 + random.below(8));
    settings.offsets = 4;
    settings.extra_planes = static_cast<std::uint16_t>(random.below(4));
    settings.simple = random.uniform() < 0.5F;
    settings.symmetric = !settings.simple || random.uniform() < 0.5F;
    settings.offset_rule = random.uniform() < 0.5F ? OffsetRule::source : OffsetRule::clearing;
    return settings;
}

bool available(const Candidate& c)
{
    return c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
}

TEST(Availability, TimeAwareAgreesWithMinimisationInDouble)
{
    std::size_t free = 0;
    std::size_t hits = 0;
    static Result result;
    const std::size_t cases = case_count(10000);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        const RandomProblem p(seed);
        Random random(seed * 7919);
        const Settings settings = bare(random);
        WorkBudget budget(10'000'000);
        const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, budget, result);
        bool any = false;
        for (const Candidate& c : result.candidates) {
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            double worst = 1e9;
            for (std::size_t i = 0; i < p.threats.size() && (available(c) || worst > 0.0); ++i) {
                worst = std::min(worst, oracle::margin(flight, p.moving(i), p.box()));
            }
            if (available(c)) {
                ASSERT_GT(worst, -kGrazing / 10.0) << "seed " << seed;
                ++free;
                any = true;
            } else {
                ASSERT_LT(worst, kGrazing) << "seed " << seed;
                ++hits;
                const std::size_t i = c.hit.index;
                ASSERT_EQ(c.hit.kind, world::ThreatKind::track) << "seed " << seed;
                ASSERT_LT(oracle::margin(flight, p.moving(i), p.box()), kGrazing) << "seed " << seed;
                const bool moves = p.threats[i].motion.velocity.squaredNorm() > 0.0F;
                ASSERT_EQ(c.status, moves ? CandidateStatus::hits_moving : CandidateStatus::hits_static)
                    << "seed " << seed;
            }
        }
        ASSERT_EQ(status, any ? world::PlanStatus::found : world::PlanStatus::none_available) << "seed " << seed;
    }
    EXPECT_GT(free, cases);
    EXPECT_GT(hits, cases);
    std::printf("[ measured ] %zu candidates free, %zu in contact\n", free, hits);
}

TEST(Availability, GrowingThreatsAreNeverTouched)
{
    static Result result;
    std::size_t checked = 0;
    const std::size_t cases = case_count(3000);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 104729);
        for (Sphere& threat : p.threats) {
            threat.radius_rate = random.uniform(0.0F, 0.6F);
            threat.radius_acceleration = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 0.3F);
        }
        p.put_into(p.problem);
        const Settings settings = bare(random);
        WorkBudget budget(10'000'000);
        static_cast<void>(solve(p.problem, settings, p.limits, p.airframe, budget, result));
        for (const Candidate& c : result.candidates) {
            if (!available(c)) {
                continue;
            }
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            for (std::size_t i = 0; i < p.threats.size(); ++i) {
                const oracle::Moving m = p.moving(i);
                const auto rate = static_cast<double>(p.threats[i].radius_rate);
                const auto acceleration = static_cast<double>(p.threats[i].radius_acceleration);
                for (std::size_t k = 0; k + 1 < flight.p.size(); ++k) {
                    for (int part = 0; part <= 8; ++part) {
                        const double s = part / 8.0;
                        const double t = flight.t[k] + s * (flight.t[k + 1] - flight.t[k]);
                        const oracle::P3 own = flight.p[k] + s * (flight.p[k + 1] - flight.p[k]);
                        const double radius = m.radius + rate * t + 0.5 * acceleration * t * t;
                        ASSERT_GT(oracle::box_distance(p.box(), own - (m.p + t * m.v)) - radius, -kGrazing)
                            << "seed " << seed;
                        ++checked;
                    }
                }
            }
        }
    }
    EXPECT_GT(checked, 100 * cases / 3);
}

TEST(Availability, SweptAgreesWithMinimisationInDouble)
{
    static Result result;
    std::size_t free = 0;
    std::size_t hits = 0;
    const std::size_t cases = case_count(400);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        const RandomProblem p(seed);
        Random random(seed * 31337);
        Settings settings = bare(random);
        settings.waypoints = 9;
        settings.extra_planes = 1;
        settings.security = SecurityMode::swept;
        settings.main_swept_to_collision_point = random.uniform() < 0.5F;
        WorkBudget budget(10'000'000);
        static_cast<void>(solve(p.problem, settings, p.limits, p.airframe, budget, result));
        double longest = 0.0;
        for (const Candidate& c : result.candidates) {
            longest = std::max(longest, p.flight(c.shape, settings.waypoints).t.back());
        }
        const double arrival = static_cast<double>(p.problem.distance) / static_cast<double>(p.problem.speed);
        for (const Candidate& c : result.candidates) {
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            double worst = 1e9;
            for (std::size_t i = 0; i < p.threats.size(); ++i) {
                // The generator lets the main threat reach the collision point when the vehicle would without a climb
                // limit.
                const double end =
                    i == 0 && settings.main_swept_to_collision_point ? std::min(arrival, longest) : longest;
                worst = std::min(worst, oracle::swept_margin(flight, p.moving(i), end, p.box()));
            }
            if (available(c)) {
                ASSERT_GT(worst, -kGrazing / 10.0) << "seed " << seed;
                ++free;
            } else {
                ASSERT_LT(worst, kGrazing) << "seed " << seed;
                ++hits;
            }
        }
    }
    EXPECT_GT(free, cases / 2);
    EXPECT_GT(hits, cases / 2);
}

geometry::Shape random_solid(Random& random, const Vec3& near)
{
    const Vec3 a = near + RandomProblem::vector(random, 6.0F);
    const Vec3 b = a + RandomProblem::vector(random, 5.0F);
    switch (random.below(3)) {
    case 0:
        return geometry::make_box(
            a, Vec3(random.uniform(0.2F, 4.0F), random.uniform(0.2F, 4.0F), random.uniform(0.2F, 4.0F)));
    case 1: return geometry::make_capsule(a, b, random.uniform(0.1F, 2.0F));
    default: return geometry::make_cylinder(a, b, random.uniform(0.2F, 2.0F));
    }
}

/// Distance of a point from a solid, in double.
double solid_distance(const geometry::Shape& shape, const oracle::P3& point)
{
    using oracle::to_double;
    const oracle::P3 d = point - to_double(shape.centre);
    const oracle::P3 x = to_double(Vec3(shape.axes.col(0)));
    const oracle::P3 y = to_double(Vec3(shape.axes.col(1)));
    const oracle::P3 z = to_double(Vec3(shape.axes.col(2)));
    const oracle::P3 local{oracle::dot(d, x), oracle::dot(d, y), oracle::dot(d, z)};
    const oracle::P3 half = to_double(shape.half);
    const auto radius = static_cast<double>(shape.radius);
    const double along = std::max(std::abs(local[2]) - half[2], 0.0);
    const double aside = std::hypot(local[0], local[1]);
    switch (shape.kind) {
    case geometry::ShapeKind::box: return oracle::box_distance({half}, local);
    case geometry::ShapeKind::capsule: return std::hypot(aside, along) - radius;
    case geometry::ShapeKind::cylinder: return std::hypot(std::max(aside - radius, 0.0), along);
    default: return oracle::length(d) - radius;
    }
}

TEST(Availability, ObstaclesAreNeverTouched)
{
    static Result result;
    std::size_t free = 0;
    std::size_t hits = 0;
    const std::size_t cases = case_count(1500);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 65537);
        p.uncertainty = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 1.0F);
        for (std::uint64_t i = 0, n = 1 + random.below(4); i < n; ++i) {
            const Vec3 on_leg =
                p.problem.frame.origin + random.uniform(0.2F, 2.0F) * p.problem.distance * p.problem.frame.axes.col(0);
            p.obstacles.push_back({static_cast<world::ObstacleId>(i), random_solid(random, on_leg)});
        }
        p.put_into(p.problem);
        const Settings settings = bare(random);
        WorkBudget budget(10'000'000);
        static_cast<void>(solve(p.problem, settings, p.limits, p.airframe, budget, result));
        for (const Candidate& c : result.candidates) {
            hits += c.hit.kind == world::ThreatKind::obstacle ? 1U : 0U;
            if (!available(c)) {
                continue;
            }
            ++free;
            // Points of the box's surface and inside, at points of the path: a sample of the swept volume.
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            const oracle::Box box = p.box();
            for (const world::Obstacle& obstacle : p.obstacles) {
                for (std::size_t k = 0; k + 1 < flight.p.size(); ++k) {
                    for (int part = 0; part < 5; ++part) {
                        const oracle::P3 own = flight.p[k] + (part / 4.0) * (flight.p[k + 1] - flight.p[k]);
                        for (int n = 0; n < 27; ++n) {
                            const oracle::P3 at{own[0] + (n % 3 - 1) * box.half[0],
                                                own[1] + (n / 3 % 3 - 1) * box.half[1],
                                                own[2] + (n / 9 - 1) * box.half[2]};
                            ASSERT_GT(solid_distance(obstacle.shape, at), static_cast<double>(p.uncertainty) -
                                                                              kGrazing -
                                                                              (p.uncertainty > 0.0F ? 0.0 : kGrazing))
                                << "seed " << seed;
                        }
                    }
                }
            }
        }
    }
    EXPECT_GT(free, 2 * cases);
    EXPECT_GT(hits, 2 * cases);
}

/// 60 points on a sphere, evenly spread: a hull inside of it.
std::vector<Point3> sphere_vertices(float radius)
{
    std::vector<Point3> vertices;
    for (int i = 0; i < 60; ++i) {
        const float z = 1.0F - 2.0F * (static_cast<float>(i) + 0.5F) / 60.0F;
        const float angle = 2.39996323F * static_cast<float>(i);
        const float r = std::sqrt(1.0F - z * z);
        vertices.push_back({radius * r * std::cos(angle), radius * r * std::sin(angle), radius * z});
    }
    return vertices;
}

TEST(Availability, LibccdAndTheClosedFormBracketEachOther)
{
    static Result as_threat;
    static Result as_sphere;
    static Result as_inner_hull;
    static Result as_outer_hull;
    std::size_t hits = 0;
    const std::size_t cases = case_count(1500);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 17);
        const Settings settings = bare(random);
        const Vec3 centre = p.problem.frame.origin + p.problem.distance * p.problem.frame.axes.col(0) +
                            RandomProblem::vector(random, 4.0F);
        const float radius = random.uniform(0.5F, 3.0F);
        const std::vector<Point3> inner = sphere_vertices(radius);
        const std::vector<Point3> outer = sphere_vertices(1.3F * radius);
        const auto solve_with = [&](std::vector<Sphere> threats, std::vector<world::Obstacle> obstacles,
                                    Result& result) {
            p.threats = std::move(threats);
            p.obstacles = std::move(obstacles);
            p.put_into(p.problem);
            p.problem.main = kNoThreat;
            WorkBudget budget(10'000'000);
            static_cast<void>(solve(p.problem, settings, p.limits, p.airframe, budget, result));
        };
        solve_with({{{centre, Vec3::Zero()}, radius}}, {}, as_threat);
        solve_with({}, {{1, geometry::make_sphere(centre, radius)}}, as_sphere);
        solve_with({}, {{1, geometry::make_hull(inner, centre)}}, as_inner_hull);
        solve_with({}, {{1, geometry::make_hull(outer, centre)}}, as_outer_hull);
        for (std::size_t i = 0; i < as_threat.candidates.size(); ++i) {
            const bool clear = available(as_threat.candidates[i]);
            hits += clear ? 0U : 1U;
            ASSERT_EQ(clear, available(as_sphere.candidates[i])) << "seed " << seed;
            ASSERT_TRUE(!clear || available(as_inner_hull.candidates[i])) << "seed " << seed;
            ASSERT_TRUE(clear || !available(as_outer_hull.candidates[i])) << "seed " << seed;
        }
    }
    EXPECT_GT(hits, 4 * cases / 3);
}

}  // namespace
}  // namespace jink::geometric
