// SPDX-License-Identifier: BSD-3-Clause
// A gap of exactly the tolerance to a sphere, a plane or a line counts as contact; one bit more does not. In both
// precisions.
#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

template <class Real>
class OptimumBounds : public ::testing::Test {
protected:
    static constexpr float kOutside = test::kTolerance<Real>;
    /// The least step from a number of 1 to 2.
    static Real step() { return std::is_same_v<Real, float> ? Real(0x1p-22F) : Real(0x1p-44F); }

    void add(const Vec3& normal, Real offset) { rows.push_back({normal.cast<Real>(), offset}); }
    Found all(const Vec3& goal)
    {
        WorkBudget budget(100'000);
        const Optimum<Real> out = optimum<Real>(std::span<const RowOf<Real>>(rows), spheres, {goal.cast<Real>(), false},
                                                Tolerance<Real>(test::exact_scale<Real>()), budget);
        x = out.x.template cast<float>();
        basis = out.basis;
        return out.found;
    }
    /// On the plane of the last row.
    Found on_last(const Vec3& goal, bool farthest = false)
    {
        WorkBudget budget(100'000);
        Vec3Of<Real> at = Vec3Of<Real>::Zero();
        const std::size_t on = rows.size() - 1;
        const Found found =
            optimum_on_plane<Real>(std::span<const RowOf<Real>>(rows), on, on, spheres, {goal.cast<Real>(), farthest},
                                   Tolerance<Real>(test::exact_scale<Real>()), budget, at, basis);
        x = at.template cast<float>();
        return found;
    }

    std::vector<RowOf<Real>> rows;
    std::vector<Sphere> spheres{{Vec3::Zero(), 1.0F}};
    Vec3 x = Vec3::Zero();
    Basis basis;
};
using BoundPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(OptimumBounds, BoundPrecisions);

TYPED_TEST(OptimumBounds, ARowThatIsBrokenByTheToleranceHoldsNothing)
{
    const TypeParam just(this->kOutside);
    for (const bool more : {false, true}) {
        this->rows.clear();
        this->add(Vec3::UnitX(), more ? just * TypeParam(1.0F + 0x1p-20F) : just);
        ASSERT_EQ(this->all(Vec3::Zero()), Found::optimum);
        EXPECT_EQ(this->basis.size, more ? 1U : 0U);
        EXPECT_EQ(this->x.x() > 0.0F, more);
        this->add(Vec3::UnitY(), TypeParam(0.0F));
        ASSERT_EQ(this->on_last(Vec3::Zero()), Found::optimum);
        EXPECT_EQ(this->basis.size, more ? 2U : 1U) << "on a plane as well";
        EXPECT_EQ(this->x.x() > 0.0F, more);
    }
}

TYPED_TEST(OptimumBounds, APlaneBesideASphere)
{
    const TypeParam rim = TypeParam(1.0F) + TypeParam(this->kOutside);
    this->add(Vec3::UnitX(), rim);
    EXPECT_EQ(this->all({0, 2, 0}), Found::optimum);
    EXPECT_LT((this->x - Vec3::UnitX()).norm(), 1e-5F);
    this->rows[0].offset = rim + this->step();
    EXPECT_EQ(this->all({0, 2, 0}), Found::nothing);
}

TYPED_TEST(OptimumBounds, ALineBesideASphere)
{
    const TypeParam rim = TypeParam(1.0F) + TypeParam(this->kOutside);
    this->add(Vec3::UnitX(), rim);
    this->add(Vec3::UnitY(), TypeParam(0.0F));
    EXPECT_EQ(this->on_last({0, -1, 3}), Found::optimum);
    EXPECT_LT((this->x - Vec3::UnitX()).norm(), 1e-5F);
    this->rows[0].offset = rim + this->step();
    EXPECT_EQ(this->on_last({0, -1, 3}), Found::nothing);
}

/// Discs of one plane may miss each other by twice the tolerance, one for each; also where every point is as good.
TYPED_TEST(OptimumBounds, ADiscBesideADisc)
{
    this->add(Vec3::UnitZ(), TypeParam(0.0F));
    // A float that is 2 m/s and twice the tolerance; in twice the precision the tolerance is below its last place.
    const float apart = std::is_same_v<TypeParam, float> ? 2.0F + 2.0F * this->kOutside : 2.0F;
    for (const bool farthest : {false, true}) {
        const Vec3 goal = farthest ? Vec3(Vec3::UnitZ()) : Vec3(1, 9, 0);
        this->spheres = {{Vec3::Zero(), 1.0F}, {{apart, 0, 0}, 1.0F}};
        EXPECT_EQ(this->on_last(goal, farthest), Found::optimum) << farthest;
        EXPECT_LT((this->x - Vec3::UnitX()).norm(), 1e-5F);
        this->spheres[1].centre.x() = test::above(apart);
        EXPECT_EQ(this->on_last(goal, farthest), Found::nothing) << farthest;
    }
}

/// Opposite rows that miss each other by twice the tolerance leave the line between them.
TYPED_TEST(OptimumBounds, OppositeRows)
{
    const TypeParam half(this->kOutside);
    this->add(Vec3::UnitX(), half);
    this->add(-Vec3::UnitX(), half);
    this->add(Vec3::UnitY(), TypeParam(0.5F));
    ASSERT_EQ(this->on_last({0.3F, 0, 0}), Found::optimum);
    EXPECT_LT((this->x - Vec3(0, 0.5F, 0)).norm(), 1e-5F);
    this->rows[0].offset = half * TypeParam(1.0F + 0x1p-20F);
    EXPECT_EQ(this->on_last({0.3F, 0, 0}), Found::nothing);
}

}  // namespace
}  // namespace jink::orca
