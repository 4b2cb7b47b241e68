// SPDX-License-Identifier: BSD-3-Clause
// The incremental programs alone, in both precisions: results are feasible, and no nearby point is better.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "core/orca/optimum.hpp"
#include "tests/property/core/orca/precision.hpp"

namespace jink::orca {
namespace {

using namespace precision;

/// Half-spaces and spheres about a point that is inside all of them by `room`.
struct Roomy {
    Vec3 inside = Vec3::Zero();
    std::vector<Row> rows;
    std::vector<Sphere> spheres;
    Vec3 goal = Vec3::Zero();
    bool farthest = false;

    explicit Roomy(Random& random, float room)
    {
        inside = unit_vector(random) * random.uniform(0.0F, 1.0F);
        spheres.push_back({inside + unit_vector(random) * random.uniform(0.0F, 0.9F), 1.0F + room});
        if (random.below(2) == 0) {
            spheres.push_back({inside + unit_vector(random) * random.uniform(0.0F, 1.9F), 2.0F + room});
        }
        for (std::uint64_t n = random.below(8); n > 0; --n) {
            const Vec3 normal = unit_vector(random);
            rows.push_back({normal, normal.dot(inside) - room - random.uniform(0.0F, 0.6F)});
        }
        farthest = random.below(3) == 0;
        goal = farthest ? unit_vector(random) : Vec3(inside + unit_vector(random) * random.uniform(0.0F, 3.0F));
    }

    [[nodiscard]] double objective(const Eigen::Vector3d& x) const
    {
        const Eigen::Vector3d g = goal.cast<double>();
        return farthest ? -g.dot(x) : (x - g).norm();
    }
    /// Beyond the worst row or sphere.
    [[nodiscard]] double outside(const Eigen::Vector3d& x, std::ptrdiff_t on = -1) const
    {
        double worst = -1e9;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const double by = static_cast<double>(rows[i].offset) - rows[i].normal.cast<double>().dot(x);
            worst = std::max(worst, static_cast<std::ptrdiff_t>(i) == on ? std::fabs(by) : by);
        }
        for (const Sphere& sphere : spheres) {
            worst = std::max(worst, (x - sphere.centre.cast<double>()).norm() - static_cast<double>(sphere.radius));
        }
        return worst;
    }
    /// The best of many feasible points about `x`, on a plane where one is named: no better where `x` is the optimum.
    [[nodiscard]] double best_near(const Eigen::Vector3d& x, Random& random, std::ptrdiff_t on = -1) const
    {
        double best = 1e9;
        for (int k = 0; k < 120; ++k) {
            Eigen::Vector3d way = unit_vector(random).cast<double>();
            // Towards the feasible set, more often than by chance.
            if (k % 3 == 0) {
                way = (way * 0.5 + (inside.cast<double>() - x)).normalized();
            }
            if (k % 3 == 1 && !farthest) {
                way = (way * 0.7 + (goal.cast<double>() - x).normalized()).normalized();
            }
            Eigen::Vector3d p = x + way * std::pow(10.0, -static_cast<double>(random.uniform(0.3F, 3.0F)));
            if (on >= 0) {
                const Row& row = rows[static_cast<std::size_t>(on)];
                const Eigen::Vector3d normal = row.normal.cast<double>();
                p -= normal * ((normal.dot(p) - static_cast<double>(row.offset)) / normal.squaredNorm());
            }
            if (outside(p, on) <= 1e-7) {
                best = std::min(best, objective(p));
            }
        }
        return best;
    }
};

template <class Real>
std::vector<RowOf<Real>> rows_as(const std::vector<Row>& rows)
{
    std::vector<RowOf<Real>> out;
    for (const Row& row : rows) {
        out.push_back({row.normal.template cast<Real>(), Real(row.offset)});
    }
    return out;
}

template <class Real>
class OptimumLaws : public Precision<Real> {
};
TYPED_TEST_SUITE(OptimumLaws, Precisions);

TYPED_TEST(OptimumLaws, TheOptimumIsFeasibleAndNothingNearItIsBetter)
{
    Random random(kOptimumSeed);
    int held = 0;
    int differ = 0;
    for (int i = 0; i < 1500; ++i) {
        const Roomy c(random, 0.05F);
        WorkBudget budget(kEnoughWork);
        const GoalOf<TypeParam> goal{c.goal.template cast<TypeParam>(), c.farthest};
        const std::vector<RowOf<TypeParam>> rows = rows_as<TypeParam>(c.rows);
        const Optimum<TypeParam> found = optimum<TypeParam>(rows, c.spheres, goal, Tolerance<TypeParam>(4.0F), budget);
        ASSERT_EQ(found.found, Found::optimum) << "seed " << kOptimumSeed << ", case " << i;
        ASSERT_EQ(found.satisfied, rows.size());
        const Eigen::Vector3d x = as_double<TypeParam>(found.x);
        ASSERT_LE(c.outside(x), TestFixture::kOutside) << "seed " << kOptimumSeed << ", case " << i;
        ASSERT_LE(c.objective(x), c.best_near(x, random) + TestFixture::kWorse)
            << "seed " << kOptimumSeed << ", case " << i;
        // The active constraints alone give the same result.
        std::vector<RowOf<TypeParam>> alone;
        for (std::size_t k = 0; k < found.basis.size; ++k) {
            ASSERT_LT(found.basis.rows[k], rows.size());
            alone.push_back(rows[found.basis.rows[k]]);
            ASSERT_LE(std::fabs(as_double(alone.back().violation(found.x))), TestFixture::kOutside)
                << "it lies on it, case " << i;
        }
        const Optimum<TypeParam> again = optimum<TypeParam>(alone, c.spheres, goal, Tolerance<TypeParam>(4.0F), budget);
        ASSERT_EQ(again.found, Found::optimum);
        differ += std::fabs(c.objective(as_double<TypeParam>(again.x)) - c.objective(x)) > TestFixture::kWorse ? 1 : 0;
        held += found.basis.size > 0 ? 1 : 0;
    }
    EXPECT_GT(held, 400);
    EXPECT_LE(differ, 5) << "but for degenerate corners";
}

TYPED_TEST(OptimumLaws, OnAPlaneTheOptimumLiesOnIt)
{
    Random random(kOptimumSeed + 1);
    int found_some = 0;
    for (int i = 0; i < 3000; ++i) {
        Roomy c(random, 0.05F);
        if (c.rows.empty()) {
            continue;
        }
        // Through the point that all others leave free.
        const std::size_t on = c.rows.size() - 1;
        c.rows[on].offset = c.rows[on].normal.dot(c.inside);
        WorkBudget budget(kEnoughWork);
        const std::vector<RowOf<TypeParam>> rows = rows_as<TypeParam>(c.rows);
        Vec3Of<TypeParam> found;
        Basis basis;
        ASSERT_EQ(optimum_on_plane<TypeParam>(rows, on, on, c.spheres, {c.goal.template cast<TypeParam>(), c.farthest},
                                              Tolerance<TypeParam>(4.0F), budget, found, basis),
                  Found::optimum)
            << "seed " << kOptimumSeed << ", case " << i;
        const Eigen::Vector3d x = as_double<TypeParam>(found);
        const auto plane = static_cast<std::ptrdiff_t>(on);
        ASSERT_LE(c.outside(x, plane), TestFixture::kOutside) << "seed " << kOptimumSeed << ", case " << i;
        ASSERT_LE(c.objective(x), c.best_near(x, random, plane) + TestFixture::kWorse)
            << "seed " << kOptimumSeed << ", case " << i;
        ASSERT_GE(basis.size, 1);
        ASSERT_EQ(basis.rows[0], on);
        ++found_some;
    }
    EXPECT_GT(found_some, 2000);
}

TYPED_TEST(OptimumLaws, WhatContradictsItselfHasNoOptimum)
{
    Random random(kOptimumSeed + 2);
    for (int i = 0; i < 1500; ++i) {
        Roomy c(random, 0.05F);
        const float gap = std::pow(10.0F, random.uniform(-3.0F, -0.5F));
        const std::size_t kept = c.rows.size();
        switch (i % 4) {
        case 0: {  // two opposite half-spaces
            const Vec3 normal = unit_vector(random);
            c.rows.push_back({normal, normal.dot(c.inside)});
            c.rows.push_back({-normal, -normal.dot(c.inside) + gap});
            break;
        }
        case 1: {  // beyond the first sphere
            const Vec3 normal = unit_vector(random);
            c.rows.push_back({normal, normal.dot(c.spheres[0].centre) + c.spheres[0].radius + gap});
            break;
        }
        case 2: {  // three that leave nothing, their normals in a plane
            const Vec3 a = unit_vector(random);
            const Vec3 b = a.cross(unit_vector(random)).normalized();
            for (const Vec3& normal : {a, Vec3(-0.5F * a + 0.8660254F * b), Vec3(-0.5F * a - 0.8660254F * b)}) {
                c.rows.push_back({normal, normal.dot(c.inside) + gap});
            }
            break;
        }
        default:  // spheres apart
            c.spheres = {{c.inside, 1.0F}, {c.inside + (2.0F + gap) * unit_vector(random), 1.0F}};
            break;
        }
        WorkBudget budget(kEnoughWork);
        const std::vector<RowOf<TypeParam>> rows = rows_as<TypeParam>(c.rows);
        const Optimum<TypeParam> found = optimum<TypeParam>(
            rows, c.spheres, {c.goal.template cast<TypeParam>(), c.farthest}, Tolerance<TypeParam>(4.0F), budget);
        ASSERT_EQ(found.found, Found::nothing) << "seed " << kOptimumSeed << ", case " << i;
        if (i % 4 != 3) {
            ASSERT_GE(found.satisfied, kept) << "rows that hold are satisfied, case " << i;
            ASSERT_LT(found.satisfied, rows.size());
        }
    }
}

/// Two spheres, and a goal on the line through their centres: any point of the circle where they cut.
TYPED_TEST(OptimumLaws, WhereAllDirectionsAreAsGoodOneIsTaken)
{
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.6F, 0.8F, 0)}) {
        const std::vector<Sphere> spheres{{Vec3::Zero(), 1.0F}, {1.2F * axis, 1.0F}};
        // The nearest point of a sphere to a goal on the axis lies in the other one; farthest across it does not.
        for (const bool farthest : {false, true}) {
            const Vec3 across = axis.cross(Vec3(0.3F, -0.5F, 0.81F)).normalized();
            const Vec3 goal = farthest ? across : Vec3(0.6F * axis + 5.0F * across);
            Vec3Of<TypeParam> x;
            ASSERT_TRUE(optimum_in_spheres<TypeParam>(spheres, {goal.template cast<TypeParam>(), farthest},
                                                      Tolerance<TypeParam>(2.0F), x));
            const Eigen::Vector3d got = as_double<TypeParam>(x);
            const Eigen::Vector3d wanted = (0.6F * axis + 0.8F * across).template cast<double>();
            EXPECT_LT((got - wanted).norm(), 2e-6) << farthest;
        }
        // A plane across the axis, and a goal along its normal: every point of the cut is equally good.
        const std::vector<RowOf<TypeParam>> rows = rows_as<TypeParam>({{axis, 0.5F}});
        WorkBudget budget(kEnoughWork);
        Vec3Of<TypeParam> x;
        Basis basis;
        ASSERT_EQ(optimum_on_plane<TypeParam>(rows, 0, 0, spheres, {axis.template cast<TypeParam>(), true},
                                              Tolerance<TypeParam>(2.0F), budget, x, basis),
                  Found::optimum);
        const Eigen::Vector3d got = as_double<TypeParam>(x);
        EXPECT_NEAR(axis.cast<double>().dot(got), 0.5, 2e-6);
        EXPECT_LE(got.norm(), 1.0 + 2e-6);
    }
    // Discs of one plane that overlap only beside both centres: the middle of their overlap.
    const std::vector<Sphere> beside{{Vec3(-1, 0, 0), 1.2F}, {Vec3(1.5F, 0, 0), 1.7F}};
    const std::vector<RowOf<TypeParam>> level = rows_as<TypeParam>({{Vec3::UnitZ(), 0.0F}});
    WorkBudget budget(kEnoughWork);
    Vec3Of<TypeParam> x;
    Basis basis;
    ASSERT_EQ(optimum_on_plane<TypeParam>(level, 0, 0, beside, {Vec3(Vec3::UnitZ()).template cast<TypeParam>(), true},
                                          Tolerance<TypeParam>(2.0F), budget, x, basis),
              Found::optimum);
    EXPECT_LT((as_double<TypeParam>(x) - Eigen::Vector3d(0.0, 0, 0)).norm(), 2e-6) << "between -0.2 and 0.2";
    const std::vector<Sphere> apart{{Vec3(-1, 0, 0), 1.2F}, {Vec3(1.5F, 0, 0), 1.2F}};
    EXPECT_EQ(optimum_on_plane<TypeParam>(level, 0, 0, apart, {Vec3(Vec3::UnitZ()).template cast<TypeParam>(), true},
                                          Tolerance<TypeParam>(2.0F), budget, x, basis),
              Found::nothing);
}

}  // namespace
}  // namespace jink::orca
