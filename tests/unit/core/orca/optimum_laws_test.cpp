// SPDX-License-Identifier: BSD-3-Clause
// Optima within spheres and half-spaces, in both precisions: within all of them, and no feasible direction leads nearer
// to the goal. Checked by the conditions of optimality, in doubles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/orca/optimum.hpp"
#include "core/orca/program.hpp"
#include "tests/unit/core/orca/enumerated.hpp"

namespace jink::orca {
namespace {

using enumerated::unit;
using enumerated::Vec3d;

constexpr std::uint64_t kSphereSeed = 20261128;
constexpr std::uint32_t kAllTheWork = 10'000'000;

/// Half-spaces and one or two spheres, each of which leaves a point free by 0.05 m/s at least.
struct Constrained {
    Vec3 inside;
    std::vector<Row> rows;
    std::vector<Sphere> spheres;
    Vec3 goal;
    bool farthest;

    Constrained(Random& random, std::uint64_t most_rows)
    {
        inside = random.uniform(0.0F, 1.0F) * unit(random);
        spheres.push_back({inside + random.uniform(0.0F, 0.95F) * unit(random), 1.05F});
        if (random.below(2) == 0) {
            const float radius = random.uniform(0.3F, 2.0F);
            spheres.push_back({inside + random.uniform(0.5F, 0.95F) * radius * unit(random), radius + 0.05F});
        }
        for (std::uint64_t n = random.below(most_rows + 1); n > 0; --n) {
            const Vec3 normal = unit(random);
            rows.push_back({normal, normal.dot(inside) - random.uniform(0.05F, 0.6F)});
        }
        farthest = random.below(3) == 0;
        goal = farthest ? unit(random) : Vec3(inside + random.uniform(0.0F, 3.0F) * unit(random));
    }

    /// Largest violation at `x`, and the deviation of the direction to the goal from the cone of the active
    /// constraints: 0 at an optimum. Row `on`, if given, is an equality.
    struct Judged {
        double outside = 0.0;
        double unheld = 0.0;
        bool is_blunt = false;  ///< the active constraints' angle is too small to decide
    };
    [[nodiscard]] Judged judge(const Vec3d& x, double reached, std::ptrdiff_t on = -1) const
    {
        Judged out;
        std::vector<Vec3d> held;  // outward
        const auto look_at = [&](const Vec3d& outward, double beyond) {
            out.outside = std::max(out.outside, beyond);
            if (beyond > -reached) {
                held.push_back(outward);
            }
        };
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Vec3d normal = rows[i].normal.cast<double>();
            const double beyond = static_cast<double>(rows[i].offset) - normal.dot(x);
            if (static_cast<std::ptrdiff_t>(i) == on) {
                out.outside = std::max(out.outside, std::fabs(beyond));
                held.push_back(normal);
                held.emplace_back(-normal);
            } else if (on < 0 || static_cast<std::ptrdiff_t>(i) < on) {
                look_at(-normal, beyond);
            }
        }
        for (const Sphere& sphere : spheres) {
            const Vec3d away = x - sphere.centre.cast<double>();
            look_at(away.normalized(), away.norm() - static_cast<double>(sphere.radius));
        }
        const Vec3d way = farthest ? goal.cast<double>() : Vec3d(goal.cast<double>() - x);
        out.unheld = way.norm();
        const auto take = [&](const Eigen::Matrix<double, 3, Eigen::Dynamic>& normals) {
            const Eigen::VectorXd shares = enumerated::shares_of(normals, way);
            if (shares.minCoeff() >= -1e-9) {
                out.unheld = std::min(out.unheld, (way - normals * shares).norm());
            }
        };
        for (std::size_t i = 0; i < held.size(); ++i) {
            take(held[i]);
            for (std::size_t j = 0; j < i; ++j) {
                const double sine = held[i].cross(held[j]).norm();
                if (sine < 0.15) {
                    out.is_blunt = out.is_blunt || !(on >= 0 && held[i].dot(held[j]) < -1.0 + 1e-12);
                    continue;
                }
                Eigen::Matrix<double, 3, Eigen::Dynamic> two(3, 2);
                two << held[i], held[j];
                take(two);
                for (std::size_t k = 0; k < j; ++k) {
                    Eigen::Matrix<double, 3, Eigen::Dynamic> three(3, 3);
                    three << held[i], held[j], held[k];
                    const double volume = std::fabs(held[i].dot(held[j].cross(held[k])));
                    if (volume > 0.03) {
                        take(three);
                    } else if (on < 0) {
                        out.is_blunt = true;
                    }
                }
            }
        }
        return out;
    }
};

template <class Real>
Vec3d in_doubles(const Vec3Of<Real>& v)
{
    if constexpr (std::is_same_v<Real, float>) {
        return v.template cast<double>();
    } else {
        const auto value = [](const DoubleFloat& w) { return static_cast<double>(w.hi) + static_cast<double>(w.lo); };
        return {value(v.x()), value(v.y()), value(v.z())};
    }
}

template <class Real>
std::vector<RowOf<Real>> in_precision(const std::vector<Row>& rows)
{
    std::vector<RowOf<Real>> out;
    for (const Row& row : rows) {
        out.push_back({row.normal.template cast<Real>(), Real(row.offset)});
    }
    return out;
}

template <class Real>
struct UnitPrecision : public ::testing::Test {
    static constexpr double kExact = std::is_same_v<Real, float> ? 1e-4 : 1e-6;
};
using UnitPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(UnitPrecision, UnitPrecisions);

TYPED_TEST(UnitPrecision, AnOptimumIsHeldByWhatItReaches)
{
    Random random(kSphereSeed);
    std::array<int, 4> held{};
    for (int i = 0; i < 700; ++i) {
        const Constrained c(random, 7);
        const std::vector<RowOf<TypeParam>> rows = in_precision<TypeParam>(c.rows);
        const GoalOf<TypeParam> goal{c.goal.template cast<TypeParam>(), c.farthest};
        WorkBudget budget(kAllTheWork);
        const Optimum<TypeParam> found = optimum<TypeParam>(rows, c.spheres, goal, Tolerance<TypeParam>(4.0F), budget);
        ASSERT_EQ(found.found, Found::optimum) << "seed " << kSphereSeed << ", case " << i;
        ASSERT_EQ(found.satisfied, rows.size());
        const auto judged = c.judge(in_doubles<TypeParam>(found.x), TestFixture::kExact);
        ASSERT_LE(judged.outside, 0.3 * TestFixture::kExact) << "seed " << kSphereSeed << ", case " << i;
        if (!judged.is_blunt) {
            ASSERT_LE(judged.unheld, 20.0 * TestFixture::kExact) << "seed " << kSphereSeed << ", case " << i;
        }
        ++held[found.basis.size];
        for (std::size_t k = 0; k < found.basis.size; ++k) {
            const Row& row = c.rows[found.basis.rows[k]];
            ASSERT_NEAR(row.normal.template cast<double>().dot(in_doubles<TypeParam>(found.x)),
                        static_cast<double>(row.offset), TestFixture::kExact);
        }
    }
    for (const int count : held) {
        EXPECT_GT(count, 20);
    }
}

TYPED_TEST(UnitPrecision, OnAPlaneItIsHeldByWhatItReachesThere)
{
    Random random(kSphereSeed + 1);
    for (int i = 0; i < 700; ++i) {
        Constrained c(random, 5);
        const Vec3 normal = unit(random);
        c.rows.push_back({normal, normal.dot(c.inside)});
        const std::size_t on = c.rows.size() - 1;
        const std::vector<RowOf<TypeParam>> rows = in_precision<TypeParam>(c.rows);
        WorkBudget budget(kAllTheWork);
        Vec3Of<TypeParam> found;
        Basis basis;
        ASSERT_EQ(optimum_on_plane<TypeParam>(rows, on, on, c.spheres, {c.goal.template cast<TypeParam>(), c.farthest},
                                              Tolerance<TypeParam>(4.0F), budget, found, basis),
                  Found::optimum)
            << i;
        const auto judged = c.judge(in_doubles<TypeParam>(found), TestFixture::kExact, static_cast<std::ptrdiff_t>(on));
        ASSERT_LE(judged.outside, 0.3 * TestFixture::kExact) << "seed " << kSphereSeed << ", case " << i;
        if (!judged.is_blunt) {
            ASSERT_LE(judged.unheld, 20.0 * TestFixture::kExact) << "seed " << kSphereSeed << ", case " << i;
        }
        ASSERT_GE(basis.size, 1U);
        ASSERT_EQ(basis.rows[0], on);
    }
}

/// An infeasible constraint gives no optimum, and the earlier constraints are satisfied.
TYPED_TEST(UnitPrecision, WhatLeavesNothingIsSaid)
{
    Random random(kSphereSeed + 2);
    for (int i = 0; i < 400; ++i) {
        Constrained c(random, 4);
        const float gap = std::pow(10.0F, random.uniform(-3.0F, -0.5F));
        const std::size_t kept = c.rows.size();
        const Vec3 normal = unit(random);
        if (i % 3 == 0) {
            c.rows.push_back({normal, normal.dot(c.inside)});
            c.rows.push_back({-normal, -normal.dot(c.inside) + gap});
        } else if (i % 3 == 1) {
            const Sphere& sphere = c.spheres.back();
            c.rows.push_back({normal, normal.dot(sphere.centre) + sphere.radius + gap});
        } else {
            c.spheres = {{c.inside, 0.5F}, {c.inside + (1.0F + gap) * normal, 0.5F}};
        }
        const std::vector<RowOf<TypeParam>> rows = in_precision<TypeParam>(c.rows);
        WorkBudget budget(kAllTheWork);
        const Optimum<TypeParam> found = optimum<TypeParam>(
            rows, c.spheres, {c.goal.template cast<TypeParam>(), c.farthest}, Tolerance<TypeParam>(4.0F), budget);
        ASSERT_EQ(found.found, Found::nothing) << "seed " << kSphereSeed << ", case " << i;
        if (i % 3 != 2) {
            ASSERT_GE(found.satisfied, kept);
            ASSERT_LT(found.satisfied, rows.size());
        }
    }
}

/// If the budget runs out anywhere, this is reported; with exactly the needed budget the answer is the same.
TYPED_TEST(UnitPrecision, ABudgetThatRunsOutIsSaid)
{
    Random random(kSphereSeed + 3);
    for (int i = 0; i < 40; ++i) {
        const Constrained c(random, 7);
        const std::vector<RowOf<TypeParam>> rows = in_precision<TypeParam>(c.rows);
        const auto run = [&](WorkBudget& budget) {
            return optimum<TypeParam>(rows, c.spheres, {c.goal.template cast<TypeParam>(), c.farthest},
                                      Tolerance<TypeParam>(4.0F), budget);
        };
        WorkBudget plenty(kAllTheWork);
        const Optimum<TypeParam> whole = run(plenty);
        for (std::uint32_t units = 0; units < plenty.spent(); units += 1 + plenty.spent() / 40) {
            WorkBudget some(units);
            ASSERT_EQ(run(some).found, Found::exhausted) << units;
        }
        WorkBudget enough(plenty.spent());
        ASSERT_EQ(run(enough).found, Found::optimum);
        WorkBudget again(plenty.spent());
        ASSERT_EQ(in_doubles<TypeParam>(run(again).x), in_doubles<TypeParam>(whole.x));
    }
}

/// The whole solver within one or two spheres, by the same conditions: a few half-spaces, most of the time by its
/// search.
TEST(SolverInSpheres, WhatIsFoundIsHeldByWhatItReaches)
{
    Random random(kSphereSeed + 4);
    for (int i = 0; i < 700; ++i) {
        Constrained c(random, 9);
        c.farthest = false;
        c.goal = c.inside + random.uniform(0.0F, 3.0F) * unit(random);
        std::vector<HalfSpace> planes;
        for (const Row& row : c.rows) {
            planes.push_back({row.normal, row.offset, Level::conflict, 0, 1.0F});
        }
        Scratch<16> scratch;
        WorkBudget budget(kAllTheWork);
        const Solution solution = solve({planes, c.spheres, c.goal, c.inside}, scratch.view(), budget);
        ASSERT_EQ(solution.status, 0U) << "seed " << kSphereSeed << ", case " << i;
        const auto judged = c.judge(solution.velocity.cast<double>(), 1e-4);
        ASSERT_LE(judged.outside, 1.2e-5) << "seed " << kSphereSeed << ", case " << i;
        if (!judged.is_blunt) {
            ASSERT_LE(judged.unheld, 2e-3) << "seed " << kSphereSeed << ", case " << i;
        }
    }
}

/// With any budget: the usual result, or reported as limited with the best of a few points within the spheres.
TEST(SolverInSpheres, AnyBudgetIsEnoughOrSaid)
{
    Random random(kSphereSeed + 5);
    for (int i = 0; i < 60; ++i) {
        const Constrained c(random, 9);
        std::vector<HalfSpace> planes;
        for (const Row& row : c.rows) {
            planes.push_back({row.normal, row.offset + (i % 2 == 0 ? 0.0F : 0.7F), Level::conflict, 0, 1.0F});
        }
        Scratch<16> scratch;
        const auto with = [&](std::uint32_t units, std::uint32_t& spent) {
            WorkBudget budget(units);
            const Solution out = solve({planes, c.spheres, c.goal, c.inside}, scratch.view(), budget);
            spent = budget.spent();
            return out;
        };
        std::uint32_t needed = 0;
        std::uint32_t spent = 0;
        const Solution whole = with(kAllTheWork, needed);
        ASSERT_EQ(whole.status & kWorkLimit, 0U);
        for (std::uint32_t units = 0; units < needed; units += 1 + needed / 50) {
            const Solution some = with(units, spent);
            ASSERT_NE(some.status & kWorkLimit, 0U) << units << " of " << needed << ", case " << i;
            ASSERT_LE(spent, units);
            for (const Sphere& sphere : c.spheres) {
                ASSERT_LE((some.velocity - sphere.centre).norm(), sphere.radius * 1.000001F);
            }
            for (const HalfSpace& plane : planes) {
                ASSERT_LE(plane.violation(some.velocity), some.broken[2] + 1e-5F);
            }
        }
        const Solution enough = with(needed, spent);
        ASSERT_EQ(enough.status, whole.status);
        ASSERT_EQ(enough.velocity, whole.velocity);
    }
}

/// Numbers of twice the precision, each operation to 2^-43 of its result.
TEST(WideNumbers, EachOperationIsExact)
{
    Random random(kSphereSeed + 6);
    const auto value = [](const DoubleFloat& w) { return static_cast<double>(w.hi) + static_cast<double>(w.lo); };
    const auto any = [&] {
        const float high = random.uniform(-1.0F, 1.0F) * std::pow(10.0F, random.uniform(-4.0F, 4.0F));
        return DoubleFloat(high) + DoubleFloat(high * random.uniform(-1.0F, 1.0F) * 0x1p-24F);
    };
    const auto expect_exact = [&](const DoubleFloat& found, double exact) {
        ASSERT_LE(std::fabs(value(found) - exact), 0x1p-43 * std::fabs(exact));
        ASSERT_EQ(found.hi, static_cast<float>(value(found)));
    };
    for (int i = 0; i < 3000; ++i) {
        const DoubleFloat a = any();
        DoubleFloat b = any();
        if (i % 3 == 0) {
            b = DoubleFloat(a.hi * (1.0F + random.uniform(-1.0F, 1.0F) * 1e-6F)) + DoubleFloat(a.lo);
            b = i % 2 == 0 ? -b : b;
        }
        expect_exact(a + b, value(a) + value(b));
        expect_exact(a - b, value(a) - value(b));
        expect_exact(a * b, value(a) * value(b));
        expect_exact(a / b, value(a) / value(b));
        expect_exact(sqrt(fabs(a)), std::sqrt(std::fabs(value(a))));
    }
}

}  // namespace
}  // namespace jink::orca
