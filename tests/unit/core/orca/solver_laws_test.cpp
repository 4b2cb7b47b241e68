// SPDX-License-Identifier: BSD-3-Clause
// Velocity programs against an enumeration in doubles: the optimum, the least violation, and their reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/orca/exchange.hpp"
#include "core/orca/program.hpp"
#include "tests/unit/core/orca/enumerated.hpp"

namespace jink::orca {
namespace {

using enumerated::unit;
using enumerated::Vec3d;

constexpr std::uint64_t kSolverSeed = 20261127;
constexpr std::uint32_t kWorkEnough = 10'000'000;

/// Half-spaces of a family about a point, each at most `room` [m/s] off.
std::vector<HalfSpace> about(Random& random, const Vec3& point, int family, float room, std::size_t count)
{
    std::vector<HalfSpace> out;
    for (std::size_t i = 0; i < count; ++i) {
        HalfSpace plane;
        plane.level = Level::warning;
        plane.normal = unit(random);
        if (family > 0 && i > 0 && random.below(2) == 0) {
            // Nearly in the direction of another one, or nearly opposite to it.
            const float turn = std::pow(10.0F, random.uniform(-3.5F, -1.0F));
            const float sign = family == 2 ? -1.0F : 1.0F;
            plane.normal = (sign * out[random.below(i)].normal + turn * unit(random)).normalized();
        }
        plane.offset = plane.normal.dot(point) - random.uniform(0.2F * room, room);
        plane.yield = random.below(3) == 0 ? random.uniform(0.5F, 3.0F) : 1.0F;
        out.push_back(plane);
    }
    return out;
}

Solution solved(const std::vector<HalfSpace>& planes, const Vec3& preferred, float radius = 50.0F,
                std::uint32_t units = kWorkEnough)
{
    const std::array<Sphere, 1> sphere{{{Vec3::Zero(), radius}}};
    Scratch<24> scratch;
    WorkBudget budget(units);
    return solve({planes, sphere, preferred, Vec3::Zero()}, scratch.view(), budget);
}

/// Feasible programs: no level yields, and the nearest point is found to 1e-4 m/s, in any order of the half-spaces.
TEST(SolverLaws, TheNearestPointIsFound)
{
    Random random(kSolverSeed);
    std::array<int, 4> held{};
    for (int i = 0; i < 420; ++i) {
        const Vec3 point = random.uniform(0.0F, 1.5F) * unit(random);
        std::vector<HalfSpace> planes = about(random, point, i % 3, 0.4F, 2 + random.below(6));
        const Vec3 preferred = point + random.uniform(0.2F, 3.0F) * unit(random);
        const auto exact = enumerated::nearest(enumerated::planes_of(planes), preferred.cast<double>());
        ASSERT_TRUE(exact.has_value()) << i;
        for (int order = 0; order < 2; ++order) {
            const Solution solution = solved(planes, preferred, 8.0F);
            ASSERT_EQ(solution.status, 0U) << "seed " << kSolverSeed << ", case " << i;
            ASSERT_LT((solution.velocity.cast<double>() - *exact).norm(), 1e-4)
                << "seed " << kSolverSeed << ", case " << i;
            ++held[solution.actives];
            for (std::size_t k = 0; k < solution.actives; ++k) {
                ASSERT_LT(std::fabs(planes[solution.active[k]].violation(solution.velocity)), 1e-4F) << i;
            }
            std::reverse(planes.begin(), planes.end());
        }
    }
    for (const int count : held) {
        EXPECT_GT(count, 40) << "by none, one, two and three half-spaces";
    }
}

/// Contradicting half-spaces: the least violation is reported exactly, and no half-space is violated by more.
TEST(SolverLaws, TheLeastViolationIsFound)
{
    Random random(kSolverSeed + 1);
    int relaxed = 0;
    int corners = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 point = random.uniform(0.0F, 1.0F) * unit(random);
        std::vector<HalfSpace> planes = about(random, point, i % 3, -0.5F, 5 + random.below(4));
        std::size_t hard = 0;
        if (i % 2 == 0) {
            hard = 1 + random.below(2);
            for (std::size_t k = 0; k < hard; ++k) {
                planes[k].level = Level::conflict;
                planes[k].offset -= 0.8F;  // they are jointly feasible
            }
        }
        const std::vector<enumerated::Plane> exact = enumerated::planes_of(planes, hard);
        const enumerated::Least least = enumerated::least_violation(exact);
        if (least.d < 1e-3 || least.x.norm() > 20.0) {
            continue;
        }
        ++relaxed;
        const Vec3 preferred = point + random.uniform(0.0F, 2.0F) * unit(random);
        const Solution solution = solved(planes, preferred);
        ASSERT_EQ(solution.status, kRelaxedWarning) << "seed " << kSolverSeed << ", case " << i;
        ASSERT_EQ(solution.level, Level::warning);
        ASSERT_NEAR(static_cast<double>(solution.broken[3]), least.d, 1e-4) << "seed " << kSolverSeed << ", case " << i;
        ASSERT_EQ(solution.broken[2], 0.0F) << i;
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const float by = planes[k].violation(solution.velocity);
            ASSERT_LE(by, k < hard ? 4e-5F : (solution.broken[3] + 2.1e-4F) * planes[k].yield)
                << "seed " << kSolverSeed << ", case " << i;
        }
        // One point alone breaks no more, where each of the four decides.
        if (i % 3 == 0 && least.least_share > 0.1 && least.shares < 10.0) {
            ++corners;
            ASSERT_LT((solution.velocity.cast<double>() - least.x).norm(), 5e-3) << i;
        }
    }
    EXPECT_GT(relaxed, 200);
    EXPECT_GT(corners, 20);
}

/// Two contradicting opposite half-spaces among feasible others: halfway between them, and as near to the preferred
/// velocity as the others allow.
TEST(SolverLaws, BetweenOppositeOnesTheRestIsAsPreferred)
{
    Random random(kSolverSeed + 2);
    for (int i = 0; i < 250; ++i) {
        const Vec3 point = random.uniform(0.0F, 1.0F) * unit(random);
        const float gap = random.uniform(0.05F, 0.6F);
        std::vector<HalfSpace> planes = about(random, point, 0, 0.4F, 1 + random.below(4));
        for (HalfSpace& plane : planes) {
            plane.level = i % 2 == 0 ? Level::warning : Level::obstacles;
        }
        const Vec3 normal = unit(random);
        for (const float sign : {-1.0F, 1.0F}) {
            HalfSpace plane;
            plane.normal = sign * normal;
            plane.offset = plane.normal.dot(point) + gap;
            plane.level = Level::warning;
            planes.push_back(plane);
        }
        const Vec3 preferred = point + random.uniform(0.2F, 3.0F) * unit(random);
        const Solution solution = solved(planes, preferred);
        ASSERT_EQ(solution.status, kRelaxedWarning) << i;
        ASSERT_NEAR(solution.broken[3], gap, 2e-5F) << "case " << i;
        // All yielding ones yield by the same amount.
        std::vector<enumerated::Plane> given = enumerated::planes_of(planes);
        for (std::size_t k = 0; k < planes.size(); ++k) {
            given[k].offset -=
                planes[k].level == Level::warning ? (static_cast<double>(gap) + 1e-4) * given[k].yield : 0;
        }
        const auto exact = enumerated::nearest(given, preferred.cast<double>());
        ASSERT_TRUE(exact.has_value());
        ASSERT_LT((solution.velocity.cast<double>() - *exact).norm(), 1e-3) << "seed " << kSolverSeed << ", case " << i;
    }
}

// --- four that contradict each other ---

template <class Real>
struct Cornered {
    std::vector<Row> rows;
    std::vector<float> yields;
    std::array<Sphere, 1> spheres{{{Vec3::Zero(), 100.0F}}};
    Corner<Real> corner;

    bool ends(std::size_t soft, std::uint32_t units = kWorkEnough)
    {
        WorkBudget budget(units);
        corner.rows = {0, 1, 2, 3};
        return exchange<Real>(rows, yields, soft, spheres, Tolerance<Real>(4.0F), budget, corner);
    }
};

/// An exchange of corners ends at the least violation of all, from any four that contradict each other.
template <class Real>
void expect_least_of_all(double tolerance)
{
    Random random(kSolverSeed + 3);
    int ended = 0;
    int started = 0;
    for (int i = 0; i < 400; ++i) {
        Cornered<Real> c;
        const std::size_t count = 4 + random.below(5);
        const std::size_t soft = i % 3 == 0 ? 1 : 0;
        std::vector<enumerated::Plane> planes;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 normal = unit(random);
            const float offset = k < soft ? -0.5F : random.uniform(0.1F, 1.0F);
            const float yield = random.below(2) == 0 ? random.uniform(0.5F, 3.0F) : 1.0F;
            c.rows.push_back({normal, offset});
            c.yields.push_back(yield);
            planes.push_back(
                {normal.cast<double>(), static_cast<double>(offset), k < soft ? 0.0 : static_cast<double>(yield)});
        }
        const enumerated::Least first =
            enumerated::least_violation(std::vector<enumerated::Plane>(planes.begin(), planes.begin() + 4));
        if (first.least_share < 0.05 || first.shares > 20.0) {
            continue;  // no corner to begin with, or a blunt one
        }
        ++started;
        const enumerated::Least least = enumerated::least_violation(planes);
        if (!c.ends(soft)) {
            continue;
        }
        ++ended;
        ASSERT_NEAR(static_cast<double>(static_cast<float>(c.corner.d)), least.d, tolerance) << i;
        const Vec3 x = c.corner.x.template cast<float>();
        ASSERT_LT((x.cast<double>() - least.x).norm(), 50.0 * tolerance * least.shares) << i;
        float yields = 0.0F;
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
            const float share = static_cast<float>(c.corner.shares[k]);
            ASSERT_GE(share, 0.0F);
            yields += c.corner.rows[k] < soft ? 0.0F : share * c.yields[c.corner.rows[k]];
            sum += share * c.rows[c.corner.rows[k]].normal;
        }
        ASSERT_NEAR(yields, 1.0F, 1e-4F);
        ASSERT_LT(sum.norm(), 1e-4F * static_cast<float>(least.shares + 1.0));
        if (i % 10 == 0) {
            // Wherever the budget runs out nothing is known.
            std::uint32_t needed = 0;
            while (!c.ends(soft, needed)) {
                ++needed;
            }
            for (std::uint32_t units = needed; units < needed + 40; ++units) {
                ASSERT_TRUE(c.ends(soft, units));
            }
            ASSERT_GT(needed, 0U);
        }
    }
    EXPECT_GT(started, 30);
    EXPECT_GE(ended, started - started / 20) << "of " << started;
}

TEST(SolverLaws, AnExchangeEndsAtTheLeastViolationOfAll) { expect_least_of_all<float>(1e-4); }
TEST(SolverLaws, AnExchangeInTwiceThePrecisionDoesTheSame) { expect_least_of_all<DoubleFloat>(2e-6); }

/// A regular corner, each violated by 0.5 m/s: non-corners, corners limited by a sphere, and corners with further rows.
TEST(SolverLaws, WhatIsNoCornerIsRefused)
{
    const float s = 1.0F / std::sqrt(3.0F);
    Cornered<float> c;
    c.rows = {{{s, s, s}, 0.5F}, {{s, -s, -s}, 0.5F}, {{-s, s, -s}, 0.5F}, {{-s, -s, s}, 0.5F}};
    c.yields.assign(4, 1.0F);
    ASSERT_TRUE(c.ends(0));
    EXPECT_NEAR(c.corner.d, 0.5F, 1e-6F);
    EXPECT_LT(c.corner.x.norm(), 1e-6F);
    EXPECT_TRUE(c.corner.is_alone);
    for (const float share : c.corner.shares) {
        EXPECT_NEAR(share, 0.25F, 1e-6F);
    }
    EXPECT_TRUE(c.ends(3)) << "one that gives way is enough";
    EXPECT_NEAR(c.corner.d, 2.0F, 1e-5F) << "it alone for all of them";
    EXPECT_FALSE(c.ends(4)) << "none gives way";
    // A fifth one as far broken, and one that is not.
    c.rows.push_back({Vec3::UnitX(), 0.5F});
    c.yields.push_back(1.0F);
    ASSERT_TRUE(c.ends(0));
    EXPECT_FALSE(c.corner.is_alone);
    c.rows[4].offset = 0.49F;
    ASSERT_TRUE(c.ends(0));
    EXPECT_TRUE(c.corner.is_alone);
    // A hard, satisfied row: near, or not.
    c.rows.insert(c.rows.begin(), {Vec3::UnitY(), 0.0F});
    c.yields.insert(c.yields.begin(), 1.0F);
    const auto from_one = [&] {
        WorkBudget budget(kWorkEnough);
        c.corner.rows = {1, 2, 3, 4};
        return exchange<float>(c.rows, c.yields, 1, c.spheres, Tolerance<float>(4.0F), budget, c.corner);
    };
    ASSERT_TRUE(from_one());
    EXPECT_FALSE(c.corner.is_alone) << "it holds the point as well";
    c.rows[0].offset = -0.1F;
    ASSERT_TRUE(from_one());
    EXPECT_TRUE(c.corner.is_alone);
    // Outside of a sphere nothing is known.
    c.spheres[0] = {{3, 0, 0}, 2.0F};
    EXPECT_FALSE(from_one());
    c.spheres[0].radius = 3.1F;
    EXPECT_TRUE(from_one());
}

}  // namespace
}  // namespace jink::orca
