// SPDX-License-Identifier: BSD-3-Clause
// How a level yields in the search, tested directly and in both precisions: a whole program uses the shortcut of four
// rows where possible. Checked against all sets of four rows, in doubles.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/search.hpp"
#include "tests/unit/core/orca/enumerated.hpp"

namespace jink::orca {
namespace {

using enumerated::unit;

constexpr std::uint64_t kRelaxSeed = 20261207;
constexpr std::uint32_t kAllUnits = 10'000'000;

/// Rows that hold, and rows after them that contradict them or each other.
struct Contradiction {
    std::vector<HalfSpace> planes;
    std::size_t hards = 0;
    Vec3 goal;

    explicit Contradiction(Random& random)
    {
        hards = random.below(4);
        const std::size_t n = hards + 2 + random.below(6);
        // Every third one is made of few directions, so that rows are opposite, or the same twice.
        const bool round = random.below(3) == 0;
        for (std::size_t i = 0; i < n; ++i) {
            HalfSpace plane;
            plane.normal =
                round ? Vec3((random.below(2) == 0 ? 1.0F : -1.0F) * Vec3::Unit(static_cast<int>(random.below(3))))
                      : unit(random);
            plane.offset = i < hards ? random.uniform(-1.0F, 0.0F) : random.uniform(-0.2F, 1.0F);
            if (round) {
                plane.offset = 0.25F * std::round(4.0F * plane.offset);
            }
            plane.yield = random.below(2) == 0 ? 1.0F : random.uniform(0.3F, 3.0F);
            planes.push_back(plane);
        }
        goal = random.uniform(0.0F, 3.0F) * unit(random);
    }
};

template <class Real>
class SearchRelax : public ::testing::Test {
protected:
    static constexpr double kExact = std::is_same_v<Real, float> ? 1e-4 : 2e-5;

    /// Nearest, relaxed and nearest again, as far as the budget goes.
    Found run(const Contradiction& c, std::uint32_t units)
    {
        const std::size_t n = c.planes.size();
        rows.clear();
        yields.clear();
        for (const HalfSpace& plane : c.planes) {
            rows.push_back({plane.normal, plane.offset});
            yields.push_back(plane.yield);
        }
        derived.resize(n);
        held.resize(n);
        WorkBudget budget(units);
        Search<Real> search(spheres, c.goal, {rows, derived, yields, held}, 4.0F, budget);
        stage = 0;
        Found found = search.nearest(n);
        if (found == Found::nothing) {
            stage = 1;
            found = search.nearest(c.hards);
        } else {
            x = search.x();
        }
        if (stage == 1 && found == Found::optimum) {
            stage = 2;
            found = search.relax(c.hards, n, broken);
            least = search.x();
        }
        if (stage == 2 && found == Found::optimum) {
            stage = 3;
            found = search.nearest_relaxed(c.hards, n);
            x = search.x();
        }
        spent = budget.spent();
        return found;
    }

    std::vector<Sphere> spheres{{Vec3::Zero(), 60.0F}};
    std::vector<Row> rows;
    std::vector<Row> derived;
    std::vector<float> yields;
    std::vector<std::uint16_t> held;
    Vec3 x = Vec3::Zero();
    Vec3 least = Vec3::Zero();
    float broken = 0.0F;
    std::uint32_t spent = 0;
    int stage = 0;
};
using RelaxPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(SearchRelax, RelaxPrecisions);

TYPED_TEST(SearchRelax, TheLeastViolationAndTheNearestPointForIt)
{
    Random random(kRelaxSeed);
    int relaxed = 0;
    for (int i = 0; i < 150; ++i) {
        const Contradiction c(random);
        const auto planes = enumerated::planes_of(c.planes, c.hards);
        const Found found = this->run(c, kAllUnits);
        if (this->stage < 2) {
            continue;  // feasible, or the non-yielding rows contradict each other
        }
        ASSERT_EQ(found, Found::optimum) << "seed " << kRelaxSeed << ", case " << i;
        if (this->least.norm() > 50.0F || this->x.norm() > 50.0F) {
            continue;  // the sphere decides too
        }
        ++relaxed;
        const auto all = enumerated::least_violation(planes);
        ASSERT_GE(static_cast<double>(this->broken), all.d - this->kExact) << i;
        double worst = 0.0;
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const double by = planes[k].violation(this->least.template cast<double>());
            ASSERT_LE(k < c.hards ? by : by - static_cast<double>(this->broken) * planes[k].yield, this->kExact) << i;
            worst = k < c.hards ? worst : std::max(worst, by / planes[k].yield);
        }
        ASSERT_NEAR(worst, static_cast<double>(this->broken), this->kExact) << i;
        // A little less leaves no point.
        std::vector<HalfSpace> tighter = c.planes;
        std::vector<HalfSpace> given = c.planes;
        for (std::size_t k = c.hards; k < given.size(); ++k) {
            tighter[k].offset -= (this->broken - 1e-3F) * tighter[k].yield;
            given[k].offset -= (this->broken + 1e-4F) * given[k].yield;
        }
        ASSERT_FALSE(enumerated::nearest(enumerated::planes_of(tighter), c.goal.template cast<double>()).has_value())
            << i;
        const auto nearest = enumerated::nearest(enumerated::planes_of(given), c.goal.template cast<double>());
        ASSERT_TRUE(nearest.has_value()) << i;
        ASSERT_NEAR((this->x.template cast<double>() - c.goal.template cast<double>()).norm(),
                    (*nearest - c.goal.template cast<double>()).norm(), 3e-3)
            << i;
    }
    EXPECT_GT(relaxed, 40);
}

/// If the budget runs out anywhere, this is reported; the needed budget suffices.
TYPED_TEST(SearchRelax, ABudgetThatRunsOutIsSaid)
{
    Random random(kRelaxSeed + 1);
    for (int i = 0; i < 25; ++i) {
        const Contradiction c(random);
        const Found whole = this->run(c, kAllUnits);
        const std::uint32_t needed = this->spent;
        const Vec3 answer = this->x;
        for (std::uint32_t units = 0; units < needed; units += 1 + needed / 60) {
            ASSERT_EQ(this->run(c, units), Found::exhausted) << units << " of " << needed << ", case " << i;
            ASSERT_LE(this->spent, units);
        }
        ASSERT_EQ(this->run(c, needed), whole) << i;
        ASSERT_EQ(this->x, answer);
    }
}

}  // namespace
}  // namespace jink::orca
