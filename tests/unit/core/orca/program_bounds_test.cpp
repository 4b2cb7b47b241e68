// SPDX-License-Identifier: BSD-3-Clause
// A program's reports on velocities on a rim, or violating a level by just the rounding tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/program.hpp"
#include "tests/unit/core/orca/enumerated.hpp"
#include "tests/unit/core/orca/half_space.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

using test::above;
using test::at_least;

Solution solved(const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres, const Vec3& preferred,
                std::uint32_t units = 10'000'000)
{
    Scratch<24> scratch;
    WorkBudget budget(units);
    return solve({planes, spheres, preferred, Vec3::Zero()}, scratch.view(), budget);
}

/// A point that comes to lie on a rim to the bit is not moved again.
TEST(ProgramBounds, APointOnTheRimStaysThere)
{
    const std::vector<Sphere> spheres{{Vec3::Zero(), 2.0F}, {Vec3::UnitX(), 1.0F}};
    EXPECT_EQ(into_spheres(spheres, {5, 0, 0}), Vec3(2, 0, 0));
    EXPECT_EQ(into_spheres({spheres.data(), 1}, {0, -7, 0}), Vec3(0, -2, 0));
    EXPECT_EQ(into_spheres(spheres, {2, 0, 0}), Vec3(2, 0, 0));
}

/// Without a budget the velocity is the reference; violations within rounding are not reported.
TEST(ProgramBounds, WithoutTimeRoundingBreaksNothing)
{
    const float speed = test::exact_scale<float>();
    const float rounding = 4.0F * test::kTolerance<float>;
    for (const float by : {rounding, above(rounding)}) {
        const Solution solution = solved({at_least(Vec3::UnitX(), by)}, {{Vec3::Zero(), speed}}, Vec3::Zero(), 0);
        EXPECT_EQ(solution.velocity, Vec3::Zero());
        EXPECT_EQ(solution.broken[3], by);
        EXPECT_EQ(solution.status, by > rounding ? kWorkLimit | kRelaxedWarning : std::uint32_t{kWorkLimit});
    }
}

/// Programs of round numbers, in which ties are the rule: many half-spaces through one point, opposite ones,
/// duplicates, levels with equal gaps in several places. Results are checked against all sets of half-spaces, in
/// doubles.
class RoundPrograms : public ::testing::Test {
protected:
    static Vec3 direction(Random& random)
    {
        static const Vec3 kPythagorean[] = {{0.6F, 0.8F, 0}, {0.8F, 0, -0.6F}, {0, -0.6F, 0.8F}};
        if (random.below(3) == 0) {
            return (random.below(2) == 0 ? 1.0F : -1.0F) * kPythagorean[random.below(3)];
        }
        Vec3 out;
        do {
            for (float& part : out) {
                part = static_cast<float>(random.below(3)) - 1.0F;
            }
        } while (out.norm() < 0.5F);
        return out.normalized();
    }
    static float quarter(Random& random, int low, int high)
    {
        return 0.25F *
               static_cast<float>(low + static_cast<int>(random.below(static_cast<std::uint64_t>(high - low) + 1)));
    }
};

TEST_F(RoundPrograms, TheNearestPointIsFoundWhereThereIsOne)
{
    Random random(20261205);
    int feasible = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<HalfSpace> planes;
        for (std::uint64_t n = 1 + random.below(9); n > 0; --n) {
            planes.push_back(at_least(direction(random), quarter(random, -4, 1)));
        }
        const Vec3 preferred(quarter(random, -8, 8), quarter(random, -8, 8), quarter(random, -8, 8));
        const auto exact = enumerated::nearest(enumerated::planes_of(planes), preferred.cast<double>());
        const Solution solution = solved(planes, {{Vec3::Zero(), 40.0F}}, preferred);
        ASSERT_EQ(solution.status & ~std::uint32_t{kRelaxedWarning}, 0U) << i;
        if (!exact.has_value()) {
            continue;
        }
        ++feasible;
        ASSERT_EQ(solution.status, 0U) << i;
        ASSERT_LT((solution.velocity.cast<double>() - *exact).norm(), 2e-4) << i;
        // The reported active set is active, and the point is the optimum of this set alone.
        std::vector<HalfSpace> active;
        for (std::size_t k = 0; k < solution.actives; ++k) {
            active.push_back(planes[solution.active[k]]);
            ASSERT_NEAR(active.back().violation(solution.velocity), 0.0F, 2e-4F) << i;
        }
        ASSERT_EQ(solution.actives == 0, (preferred.cast<double>() - *exact).norm() < 1e-4) << i;
    }
    EXPECT_GT(feasible, 130);
}

/// Hard rows beside yielding ones: the least violation is the largest over all sets of four.
TEST_F(RoundPrograms, ALevelGivesWayByTheLeastThatItHasTo)
{
    Random random(20261206);
    int broken = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<HalfSpace> planes;
        const std::size_t hards = random.below(4);
        for (std::size_t k = 0; k < hards; ++k) {
            planes.push_back(at_least(direction(random), quarter(random, -4, 0), Level::obstacles));
        }
        // Six that bound everything, and some across.
        for (int axis = 0; axis < 3; ++axis) {
            for (const float sign : {-1.0F, 1.0F}) {
                planes.push_back(at_least(sign * Vec3::Unit(axis), quarter(random, -2, 3), Level::warning,
                                          random.below(3) == 0 ? 0.5F : 1.0F));
            }
        }
        for (std::uint64_t n = random.below(4); n > 0; --n) {
            planes.push_back(at_least(direction(random), quarter(random, -2, 3), Level::warning,
                                      random.below(3) == 0 ? 2.0F : 1.0F));
        }
        const Vec3 preferred(quarter(random, -8, 8), quarter(random, -8, 8), quarter(random, -8, 8));
        const auto least = enumerated::least_violation(enumerated::planes_of(planes, hards));
        const Solution solution = solved(planes, {{Vec3::Zero(), 40.0F}}, preferred);
        ASSERT_EQ(solution.status & ~std::uint32_t{kRelaxedWarning}, 0U) << i;
        if (least.d < 1e-3) {
            ASSERT_LE(solution.broken[3], 2e-4F) << i;
            continue;
        }
        ++broken;
        ASSERT_EQ(solution.status, kRelaxedWarning) << i;
        ASSERT_NEAR(static_cast<double>(solution.broken[3]), least.d, 2e-4) << i;
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const float allowed = k < hards ? 2e-4F : (solution.broken[3] + 2.1e-4F) * planes[k].yield;
            ASSERT_LE(planes[k].violation(solution.velocity), allowed) << i;
        }
        // Of all that break no more the nearest to the preferred one.
        std::vector<HalfSpace> given = planes;
        for (std::size_t k = hards; k < given.size(); ++k) {
            given[k].offset -= (static_cast<float>(least.d) + 1e-4F) * given[k].yield;
        }
        const auto nearest = enumerated::nearest(enumerated::planes_of(given), preferred.cast<double>());
        ASSERT_TRUE(nearest.has_value()) << i;
        ASSERT_NEAR((solution.velocity.cast<double>() - preferred.cast<double>()).norm(),
                    (*nearest - preferred.cast<double>()).norm(), 3e-3)
            << i;
    }
    EXPECT_GT(broken, 130);
}

}  // namespace
}  // namespace jink::orca
