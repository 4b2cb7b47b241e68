// SPDX-License-Identifier: BSD-3-Clause
// Velocity programs against an interior-point method in doubles: the same sets are contradictions, the same optimum,
// the same least violation (G-ORCA specification, T3). JINK_CASES=1000000 runs as many; JINK_SEED another sequence.
#include "core/orca/program.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/oracle/orca_oracle.hpp"

namespace jink::orca {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise)
{
    const char* const given = std::getenv(name);
    return given != nullptr ? std::strtoull(given, nullptr, 10) : otherwise;
}

Vec3 direction(Random& random)
{
    while (true) {
        const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (v.squaredNorm() > 1e-4F && v.squaredNorm() < 1.0F) {
            return v.normalized();
        }
    }
}

struct Case {
    std::vector<HalfSpace> planes;
    std::vector<Sphere> spheres;
    Vec3 preferred;
};

constexpr int kFamilies = 5;

/// Half-spaces of a family: about a point that they leave free or not, some through one point, some nearly parallel or
/// opposite to another one.
Case random_case(Random& random, int family)
{
    Case out;
    const float speed = random.uniform(0.5F, 4.0F);
    out.spheres.push_back({Vec3::Zero(), speed});
    if (random.below(2) == 0) {
        out.spheres.push_back({direction(random) * random.uniform(0.0F, speed), random.uniform(0.05F, 1.0F) * speed});
    }
    const Vec3 centre =
        out.spheres.back().centre + direction(random) * random.uniform(0.0F, 0.7F * out.spheres.back().radius);
    out.preferred = direction(random) * random.uniform(0.0F, 1.5F * speed);
    const std::size_t count = 1 + random.below(family == 4 ? 10 : 54);
    const float room = random.uniform(-0.6F, family == 1 ? 0.0F : 0.2F) * speed;
    for (std::size_t i = 0; i < count; ++i) {
        HalfSpace plane;
        plane.normal = direction(random);
        float at = random.uniform(room - 0.3F * speed, room);
        if (family == 2) {
            at = 0.0F;  // all through one point
        } else if ((family == 3 || family == 4) && i > 0 && random.below(2) == 0) {
            // Beside or opposite to one before, by 1e-1 to 1e-4 of an angle.
            const HalfSpace& other = out.planes[random.below(i)];
            const float turn = std::pow(10.0F, random.uniform(-4.0F, -1.0F));
            const float sign = random.below(3) == 0 ? -1.0F : 1.0F;
            plane.normal = (sign * other.normal + turn * direction(random)).normalized();
            at = sign * (other.offset - other.normal.dot(centre)) + turn * random.uniform(-1.0F, 1.0F) * speed;
        }
        plane.offset = plane.normal.dot(centre) + at;
        plane.yield = random.below(4) == 0 ? random.uniform(0.5F, 3.0F) : 1.0F;
        plane.level = Level::warning;
        out.planes.push_back(plane);
    }
    if (random.below(3) == 0) {
        const std::size_t hard = random.below(std::min<std::size_t>(count, 6) + 1);
        for (std::size_t i = 0; i < hard; ++i) {
            out.planes[i].level = Level::conflict;
        }
    }
    return out;
}

oracle::Question question_of(const Case& c)
{
    oracle::Question q;
    for (const HalfSpace& plane : c.planes) {
        const Eigen::Vector3d n = plane.normal.cast<double>();
        q.planes.push_back(
            {{n.x(), n.y(), n.z()}, static_cast<double>(plane.offset), static_cast<double>(plane.yield)});
    }
    for (const Sphere& sphere : c.spheres) {
        const Eigen::Vector3d p = sphere.centre.cast<double>();
        q.spheres.push_back({{p.x(), p.y(), p.z()}, static_cast<double>(sphere.radius), 0.0});
    }
    const Eigen::Vector3d g = c.preferred.cast<double>();
    q.goal = {g.x(), g.y(), g.z()};
    return q;
}

double distance(const Vec3& a, const std::array<double, 3>& b)
{
    return (a.cast<double>() - Eigen::Vector3d(b[0], b[1], b[2])).norm();
}

/// Worst values over many cases.
struct Tally {
    std::uint64_t cases = 0, feasible = 0, relaxed = 0, hard_relaxed = 0, on_edge = 0;
    double optimum = 0.0, objective = 0.0, violation = 0.0, least = 0.0;

    void print(const std::string& name, std::uint64_t seed) const
    {
        std::printf(
            "%s, seed %llu: %llu cases, %llu with room, %llu relaxed (%llu twice), %llu on the edge; optimum off "
            "by %.1e at most, least violation by %.1e; farther from the goal by %.1e, half-spaces broken by %.1e\n",
            name.c_str(), static_cast<unsigned long long>(seed), static_cast<unsigned long long>(cases),
            static_cast<unsigned long long>(feasible), static_cast<unsigned long long>(relaxed),
            static_cast<unsigned long long>(hard_relaxed), static_cast<unsigned long long>(on_edge), optimum, least,
            objective, violation);
    }
};

constexpr double kEdge = 1e-5;  // [m/s] of slack or contradiction, within which a level may yield or not

/// The question with every half-space moved by the rounding bound: into the feasible set, or out of it.
oracle::Question moved(const Case& c, oracle::Question q, double sign)
{
    for (oracle::Plane& plane : q.planes) {
        plane.b += sign * 2e-6 * static_cast<double>(c.spheres[0].radius + 1.0F);
    }
    return q;
}

constexpr double kOff = 1e-4;  // [m/s] that an optimum or a least violation may be off by

/// The least violation.
void compare_least(double broken, double exact, Tally& tally, const std::string& where)
{
    tally.least = std::max(tally.least, std::fabs(broken - exact));
    ASSERT_NEAR(broken, exact, kOff) << where;
}

/// Of the feasible ones: the optimum.
void compare_optimum(const Case& c, const oracle::Question& q, const Solution& solution, Tally& tally,
                     const std::string& where)
{
    ++tally.feasible;
    ASSERT_EQ(solution.status, 0U) << where;
    // From the point with the largest slack.
    const std::array<double, 3> inside = oracle::least_violation(q, 0, 1e-6).x;
    const std::array<double, 3> best = oracle::nearest(q, inside);
    const double off = distance(solution.velocity, best);
    tally.optimum = std::max(tally.optimum, off);
    const Eigen::Vector3d ideal(best[0], best[1], best[2]);
    const double farther = distance(solution.velocity, q.goal) - (ideal - c.preferred.cast<double>()).norm();
    tally.objective = std::max(tally.objective, farther);
    ASSERT_LE(off, kOff) << where;
}

void compare(const Case& c, Tally& tally, const std::string& where)
{
    Scratch<54> scratch;
    WorkBudget budget(10'000'000);
    const Solution solution = solve({c.planes, c.spheres, c.preferred, Vec3::Zero()}, scratch.view(), budget);
    ++tally.cases;
    ASSERT_TRUE(is_finite(solution.velocity)) << where;
    for (const Sphere& sphere : c.spheres) {
        ASSERT_LE((solution.velocity - sphere.centre).norm(), sphere.radius * (1.0F + 1e-6F) + 1e-6F) << where;
    }
    double scale = 1.0;
    for (const Sphere& sphere : c.spheres) {
        scale = std::max(scale, static_cast<double>(sphere.centre.norm() + sphere.radius));
    }
    for (const HalfSpace& plane : c.planes) {
        const float allowed = solution.broken[static_cast<std::size_t>(plane.level)];
        const double beyond = static_cast<double>(plane.violation(solution.velocity) / plane.yield - allowed);
        tally.violation = std::max(tally.violation, beyond);
        ASSERT_LE(beyond, allowed > 0.0F ? 2.1e-4 : 2e-6 * scale / static_cast<double>(plane.yield) + 1e-6) << where;
    }
    const oracle::Question q = question_of(c);
    std::size_t hard = 0;
    while (hard < c.planes.size() && c.planes[hard].level == Level::conflict) {
        ++hard;
    }
    oracle::Question first = q;
    first.planes.resize(hard);
    const oracle::Least hards = hard > 0 ? oracle::least_violation(first, 0) : oracle::Least{true, -1.0, {}};
    if (!hards.hard_hold) {
        ++tally.on_edge;  // the spheres have a single common point
        return;
    }
    if (std::fabs(hards.d) < kEdge) {
        ++tally.on_edge;
        compare_least(static_cast<double>(solution.broken[2]), std::max(hards.d, 0.0), tally, where);
        return;
    }
    if (hards.d > 0.0) {
        ++tally.hard_relaxed;
        ASSERT_NE(solution.status & kRelaxedConflict, 0U) << where;
        compare_least(static_cast<double>(solution.broken[2]), hards.d, tally, where);
        return;
    }
    ASSERT_EQ(solution.status & kRelaxedConflict, 0U) << where;
    const oracle::Least least = oracle::least_violation(q, hard);
    if (!least.hard_hold || std::fabs(least.d) < kEdge) {
        ++tally.on_edge;
        if (least.hard_hold) {
            compare_least(static_cast<double>(solution.broken[3]), std::max(least.d, 0.0), tally, where);
        }
        return;
    }
    if (least.d < 0.0) {
        compare_optimum(c, q, solution, tally, where);
        return;
    }
    if (solution.status == 0 && oracle::least_violation(moved(c, q, -1.0), hard).d < kEdge) {
        ++tally.on_edge;  // hard ones leave a point, to rounding
        return;
    }
    ++tally.relaxed;
    ASSERT_EQ(solution.status, kRelaxedWarning) << where;
    compare_least(static_cast<double>(solution.broken[3]), least.d, tally, where);
}

TEST(ProgramLaws, AsAnInteriorPointMethodHasIt)
{
    const std::uint64_t cases = from_environment("JINK_CASES", 20'000);
    const std::uint64_t seed = from_environment("JINK_SEED", 20261123);
    const std::array<std::string, kFamilies> names{"random", "crowded", "through one point", "nearly parallel",
                                                   "few and nearly parallel"};
    std::array<Tally, kFamilies> tallies;
    for (std::uint64_t i = 0; i < cases && !HasFatalFailure(); ++i) {
        Random random(seed + i * 0x9E3779B97F4A7C15ULL);
        const auto family = static_cast<int>(i % kFamilies);
        compare(random_case(random, family), tallies[i % kFamilies],
                "JINK_SEED=" + std::to_string(seed) + " case " + std::to_string(i));
    }
    for (std::size_t k = 0; k < kFamilies; ++k) {
        tallies[k].print(names[k], seed);
        EXPECT_GT(tallies[k].feasible + tallies[k].relaxed + tallies[k].hard_relaxed, tallies[k].cases / 20);
    }
}

/// With any budget: a finite velocity within the spheres, the usual result or kWorkLimit, no more spent than given, and
/// every violated half-space reported.
TEST(ProgramLaws, WhateverTheBudget)
{
    const std::uint64_t seed = from_environment("JINK_SEED", 20261123);
    Random random(seed);
    std::uint32_t most = 0;
    int limited = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Case c = random_case(random, i % kFamilies);
        const Problem problem{c.planes, c.spheres, c.preferred, c.spheres.back().centre};
        Scratch<54> scratch;
        WorkBudget plenty(10'000'000);
        const Solution whole = solve(problem, scratch.view(), plenty);
        most = std::max(most, plenty.spent());
        const auto units = static_cast<std::uint32_t>(random.below(i % 2 == 0 ? 60 : 600));
        WorkBudget budget(units);
        const Solution solution = solve(problem, scratch.view(), budget);
        const std::string where = "JINK_SEED=" + std::to_string(seed) + " case " + std::to_string(i);
        ASSERT_LE(budget.spent(), units) << where;
        ASSERT_TRUE(is_finite(solution.velocity)) << where;
        for (const Sphere& sphere : c.spheres) {
            ASSERT_LE((solution.velocity - sphere.centre).norm(), sphere.radius * (1.0F + 1e-6F) + 1e-6F) << where;
        }
        if ((solution.status & kWorkLimit) == 0) {
            ASSERT_EQ(solution.velocity, whole.velocity) << where;
            ASSERT_EQ(solution.status, whole.status) << where;
            continue;
        }
        ++limited;
        for (const HalfSpace& plane : c.planes) {
            ASSERT_LE(plane.violation(solution.velocity) / plane.yield,
                      solution.broken[static_cast<std::size_t>(plane.level)] + 1e-5F)
                << where;
        }
    }
    EXPECT_GT(limited, 1000);
    std::printf("at most %u units, seed %llu\n", most, static_cast<unsigned long long>(seed));
}

/// Repeated half-spaces, opposite ones, and those of two vehicles at one place.
TEST(ProgramLaws, SameAndOppositeHalfSpaces)
{
    Random random(20261124);
    for (int i = 0; i < 5'000; ++i) {
        Case c = random_case(random, 0);
        c.planes.resize(std::min<std::size_t>(c.planes.size(), 8));
        const std::size_t count = c.planes.size();
        for (std::size_t k = 0; k < count; ++k) {
            HalfSpace again = c.planes[k];
            again.level = Level::warning;
            c.planes.push_back(again);
            again.normal = -again.normal;
            again.offset = random.below(2) == 0 ? -again.offset : again.offset;
            c.planes.push_back(again);
        }
        Scratch<54> scratch;
        WorkBudget budget(10'000'000);
        const Solution solution = solve({c.planes, c.spheres, c.preferred, Vec3::Zero()}, scratch.view(), budget);
        ASSERT_TRUE(is_finite(solution.velocity)) << i;
        ASSERT_EQ(solution.status & (kWorkLimit | kBadInput | kInfeasibleDynamics), 0U) << i;
        for (const HalfSpace& plane : c.planes) {
            ASSERT_LE(plane.violation(solution.velocity) / plane.yield,
                      solution.broken[static_cast<std::size_t>(plane.level)] + 2.1e-4F)
                << i;
        }
    }
}

}  // namespace
}  // namespace jink::orca
