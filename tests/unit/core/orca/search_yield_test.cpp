// SPDX-License-Identifier: BSD-3-Clause
// How a level yields: reports, rounding, and the capacity limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/core/orca/enumerated.hpp"
#include "tests/unit/core/orca/search_rows.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

using enumerated::unit;
using test::above;
using test::below;

constexpr std::uint32_t kAmple = 100'000'000;

/// Rows; those from `hards` on yield.
template <class Real>
class SearchYield : public test::SearchRows {
protected:
    SearchYield() : SearchRows(60.0F) {}

    void clear()
    {
        SearchRows::clear();
        hards = 0;
    }
    /// Of random directions, at `speed` [m/s].
    void some_rows(Random& random, float speed)
    {
        clear();
        hards = random.below(4);
        for (std::size_t n = hards + 3 + random.below(6); n > 0; --n) {
            add(unit(random), speed * (rows.size() < hards ? random.uniform(-1.0F, 0.0F) : random.uniform(-0.2F, 1.0F)),
                random.below(2) == 0 ? 1.0F : random.uniform(0.3F, 3.0F));
        }
        goal = random.uniform(0.0F, 3.0F * speed) * unit(random);
    }
    template <class R = Real>
    Search<R> search(WorkBudget& budget)
    {
        return search_for<R>(goal, budget);
    }
    /// No point satisfies all rows, but the non-yielding rows are feasible: then the others yield. Returns whether this
    /// occurred.
    template <class R = Real>
    bool relaxes(Search<R>& s)
    {
        return s.nearest(rows.size()) == Found::nothing && s.nearest(hards) == Found::optimum;
    }
    [[nodiscard]] float outside(const Vec3& x) const { return SearchRows::outside(hards, x); }
    [[nodiscard]] float yielded(const Vec3& x) const { return given_way(hards, x); }

    std::size_t hards = 0;
    Vec3 goal = Vec3::Zero();
};
using YieldPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(SearchYield, YieldPrecisions);
using YieldOfFloats = SearchYield<float>;
using YieldOfWides = SearchYield<DoubleFloat>;

/// The reported violation is complete: at the found point no row is violated by more, not even by rounding.
TEST_F(YieldOfFloats, WhatIsBrokenIsSaidInFull)
{
    Random random(20270103);
    int relaxed = 0;
    for (int i = 0; i < 300; ++i) {
        some_rows(random, 1.0F);
        WorkBudget budget(kAmple);
        Search<float> s = search(budget);
        float broken = 0.0F;
        if (relaxes(s) && s.relax(hards, rows.size(), broken) == Found::optimum) {
            ++relaxed;
            ASSERT_LE(yielded(s.x()), broken * (1.0F + 3e-7F)) << i;
        }
    }
    EXPECT_GT(relaxed, 50);
}

/// At thousands of metres per second the excess yield is below rounding: the rows yield further, and a point exists.
TYPED_TEST(SearchYield, WhereRoundingLeavesNoPointRowsGiveWayFurther)
{
    Random random(20270104);
    this->scale = 20'000.0F;
    this->spheres = {{Vec3::Zero(), 100'000.0F}};
    int relaxed = 0;
    for (int i = 0; i < 300; ++i) {
        this->some_rows(random, 5000.0F);
        WorkBudget budget(kAmple);
        Search<TypeParam> s = this->search(budget);
        float broken = 0.0F;
        if (this->relaxes(s) && s.relax(this->hards, this->rows.size(), broken) == Found::optimum) {
            ++relaxed;
            ASSERT_EQ(s.nearest_relaxed(this->hards, this->rows.size()), Found::optimum) << i;
        }
    }
    EXPECT_GT(relaxed, 50);
}

/// If the earlier rows contradict each other, yielding does not help: detected early.
TYPED_TEST(SearchYield, RowsThatDoNotGiveWayAndContradictEachOtherLeaveNothing)
{
    this->add(Vec3::UnitX(), 1.0F);
    this->add(-Vec3::UnitX(), 1.0F);
    this->add(Vec3::UnitY(), 1.0F);
    WorkBudget budget(10'000);
    EXPECT_EQ(this->search(budget).nearest_relaxed(2, 3), Found::nothing);
    EXPECT_FALSE(budget.exhausted());
}

// --- corners of four rows ---

/// x, y and z >= 0 hold, and the fourth row, a combination of them, yields.
template <class Real>
class CornerYield : public SearchYield<Real> {
protected:
    void add_corner(float part)
    {
        this->clear();
        this->hards = 3;
        for (int axis = 0; axis < 3; ++axis) {
            this->add(Vec3::Unit(axis), 0.0F);
        }
        this->add({-part, -0.6F, -0.8F}, 0.25F);
        this->goal = {1, 0, 0};
        // Without the first one the others intersect far off.
        this->spheres = {{Vec3::Zero(), 10'000.0F}};
    }
};
TYPED_TEST_SUITE(CornerYield, YieldPrecisions);

/// A thousandth is no hold: on the edge that it leaves free the nearest point is taken. A bit more is.
TYPED_TEST(CornerYield, AShareOfAThousandthLeavesAnEdge)
{
    for (const float part : {1e-3F, above(1e-3F)}) {
        this->add_corner(part);
        WorkBudget budget(kAmple);
        Search<TypeParam> s = this->search(budget);
        ASSERT_EQ(s.nearest(4), Found::nothing);
        float d = 0.0F;
        ASSERT_TRUE(s.relax_at_corner(3, 4, d));
        EXPECT_FLOAT_EQ(d, 0.25F);
        if (part > 1e-3F) {
            EXPECT_LT(s.x().norm(), 1e-5F);
        } else {
            EXPECT_NEAR(s.x().x(), kShifted / part, 1e-2F);
        }
    }
}

/// Whenever it reports the least violation, the point attains it, also if the budget then runs out.
TYPED_TEST(CornerYield, ABudgetThatRunsOutLeavesAPointOfTheLeastViolation)
{
    this->add_corner(1e-4F);
    this->goal = {1, 2, 3};
    WorkBudget plenty(kAmple);
    Search<TypeParam> whole = this->search(plenty);
    ASSERT_EQ(whole.nearest(4), Found::nothing);
    float d = 0.0F;
    ASSERT_TRUE(whole.relax_at_corner(3, 4, d));
    int known = 0;
    for (std::uint32_t units = 0; units <= plenty.spent(); ++units) {
        WorkBudget budget(units);
        Search<TypeParam> s = this->search(budget);
        if (s.nearest(4) != Found::nothing || !s.relax_at_corner(3, 4, d)) {
            continue;
        }
        ++known;
        EXPECT_FLOAT_EQ(d, 0.25F);
        EXPECT_LE(this->outside(s.x()), 1e-5F) << units;
        EXPECT_LE(this->yielded(s.x()), 0.25F + 2.0F * kShifted) << units;
    }
    EXPECT_GT(known, 1);
}

/// Three rows are no corner, independent of the active rows of an earlier search.
TYPED_TEST(CornerYield, RowsOfAnEarlierSearchMakeNoCorner)
{
    // Across the diagonal, which the others lie along.
    const Vec3 one = Vec3(1, -1, 0).normalized();
    const Vec3 other = Vec3(1, 1, -2).normalized();
    this->add(one, 0.25F);
    this->add(-0.5F * one + std::sqrt(0.75F) * other, 0.25F);
    this->add(-0.5F * one - std::sqrt(0.75F) * other, 0.25F);
    this->add(-Vec3(1, 1, 1).normalized(), 0.0F);
    for (int axis = 0; axis < 3; ++axis) {
        this->add(Vec3::Unit(axis), 5.0F);
    }
    this->goal = {-1, -1, -1};
    WorkBudget budget(kAmple);
    Search<TypeParam> s = this->search(budget);
    ASSERT_EQ(s.nearest(7), Found::nothing);
    ASSERT_EQ(s.nearest(3), Found::nothing);
    float d = 7.0F;
    EXPECT_FALSE(s.relax_at_corner(0, 3, d));
    EXPECT_EQ(d, 7.0F);
}

// --- more rows than the capacity of double-float ---

/// Planes about a sphere of 1 m/s within decades of angles to `axis`: each that is taken leaves another one broken.
class ManyYield : public YieldOfWides {
protected:
    Vec3 tangent(Random& random, const Vec3& axis)
    {
        const Vec3 to = unit(random);
        return -(axis + std::pow(10.0F, random.uniform(-3.0F, 0.0F)) * to).normalized();
    }
    /// All but the first yield.
    void one_against_all(Random& random, std::size_t count)
    {
        clear();
        hards = 1;
        const Vec3 axis = unit(random);
        add(axis, 3.0F);
        while (rows.size() < count) {
            add(tangent(random, axis), -1.0F);
        }
        goal = unit(random);
    }
    /// The last few yield.
    void all_against_few(Random& random, std::size_t count)
    {
        clear();
        const Vec3 axis = unit(random);
        const std::size_t few = 1 + random.below(3);
        hards = count - few;
        while (rows.size() < hards) {
            add(tangent(random, axis), -1.0F);
        }
        while (rows.size() < count) {
            add((axis + 0.2F * unit(random)).normalized(), 3.0F);
        }
        goal = unit(random);
    }
    /// Either it reports an unfinished search, or its result equals single precision, which has the capacity. Returns
    /// whether it finished.
    bool gives_way_by_the_least()
    {
        WorkBudget budget(2'000'000'000);
        Search<DoubleFloat> s = search(budget);
        EXPECT_TRUE(relaxes(s));
        float broken = 0.0F;
        const Found found = s.relax(hards, rows.size(), broken);
        EXPECT_FALSE(budget.exhausted());
        if (found == Found::exhausted) {
            return false;
        }
        WorkBudget more(2'000'000'000);
        Search<float> single = search<float>(more);
        EXPECT_TRUE(relaxes<float>(single));
        float wanted = 0.0F;
        EXPECT_EQ(single.relax(hards, rows.size(), wanted), Found::optimum);
        EXPECT_NEAR(broken, wanted, 1e-4F);
        return true;
    }
};

TEST_F(ManyYield, WhereThereIsNoRoomForAllThatGiveWayThatIsSaid)
{
    Random random(20270105);
    int ended = 0;
    for (int i = 0; i < 60; ++i) {
        one_against_all(random, 30);
        ended += gives_way_by_the_least() ? 1 : 0;
    }
    EXPECT_GT(ended, 0);
    EXPECT_LT(ended, 60);
}

TEST_F(ManyYield, WhereThereIsNoRoomForAllThatHoldThatIsSaid)
{
    Random random(20270106);
    for (int i = 0; i < 60; ++i) {
        all_against_few(random, 400);
        static_cast<void>(gives_way_by_the_least());
    }
}

/// Sixteen rows beside the removed one always fit.
TEST_F(ManyYield, SeventeenHaveRoom)
{
    Random random(20270107);
    for (int i = 0; i < 400; ++i) {
        one_against_all(random, 17);
        ASSERT_TRUE(gives_way_by_the_least()) << i;
    }
}

}  // namespace
}  // namespace jink::orca
