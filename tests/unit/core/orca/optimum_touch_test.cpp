// SPDX-License-Identifier: BSD-3-Clause
// Spheres, half-spaces and lines with a single common point, or apart by less than the tolerance: the point is found,
// and is finite. In both precisions.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/optimum.hpp"

namespace jink::orca {
namespace {

template <class Real>
class OptimumTouch : public ::testing::Test {
protected:
    using V = Vec3Of<Real>;
    static constexpr float kTolerance = Tolerance<Real>(1.0F).outside;

    static RowOf<Real> row(const Vec3& normal, Real offset) { return {normal.cast<Real>(), offset}; }
    Found solved(const Vec3& goal, bool farthest = false)
    {
        WorkBudget budget(1'000'000);
        const Optimum<Real> found = optimum<Real>(std::span<const RowOf<Real>>(rows), spheres,
                                                  {goal.cast<Real>(), farthest}, Tolerance<Real>(1.0F), budget);
        x = found.x.template cast<float>();
        return found.found;
    }
    Found on_plane(const Vec3& goal, bool farthest = false)
    {
        WorkBudget budget(1'000'000);
        V at = V::Zero();
        Basis basis;
        const std::size_t on = rows.size() - 1;
        const Found found =
            optimum_on_plane<Real>(std::span<const RowOf<Real>>(rows), on, on, spheres, {goal.cast<Real>(), farthest},
                                   Tolerance<Real>(1.0F), budget, at, basis);
        x = at.template cast<float>();
        return found;
    }
    [[nodiscard]] bool is_at(const Vec3& wanted, float within = 2e-3F) const { return (x - wanted).norm() <= within; }

    std::vector<RowOf<Real>> rows;
    std::vector<Sphere> spheres{{Vec3::Zero(), 1.0F}};
    Vec3 x = Vec3::Zero();
};
using TouchPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(OptimumTouch, TouchPrecisions);

/// By how much of the tolerance things miss each other: not at all, and by so little that it is rounding.
constexpr float kMisses[] = {0.0F, 0.6F};

TYPED_TEST(OptimumTouch, AHalfSpaceAndASphere)
{
    for (const float miss : kMisses) {
        this->rows = {this->row(Vec3::UnitX(), TypeParam(1.0F) + TypeParam(miss * this->kTolerance))};
        EXPECT_EQ(this->solved({0, 2, 0}), Found::optimum) << miss;
        EXPECT_TRUE(this->is_at(Vec3::UnitX()));
        EXPECT_EQ(this->solved({0, 1, 0}, true), Found::optimum) << miss;
        EXPECT_TRUE(this->is_at(Vec3::UnitX()));
    }
    this->rows = {this->row(Vec3::UnitX(), TypeParam(1.0F) + TypeParam(3.0F * this->kTolerance))};
    EXPECT_EQ(this->solved({0, 2, 0}), Found::nothing) << "three times the tolerance is none";
}

TYPED_TEST(OptimumTouch, ALineAndASphere)
{
    for (const float miss : kMisses) {
        // Both planes intersect in a vertical line, which contacts the sphere at 45 degrees.
        using std::sqrt;
        const TypeParam half = sqrt(TypeParam(0.5F)) * (TypeParam(1.0F) + TypeParam(miss * this->kTolerance));
        this->rows = {this->row(Vec3::UnitX(), half), this->row(Vec3::UnitY(), half)};
        EXPECT_EQ(this->solved({-1, -1, 3}), Found::optimum) << miss;
        EXPECT_TRUE(this->is_at(std::sqrt(0.5F) * Vec3(1, 1, 0)));
    }
}

TYPED_TEST(OptimumTouch, TwoSpheres)
{
    // 2 m apart; smaller by a thousandth of a thousandth, as far as a float can say it.
    for (const float miss : {0.0F, std::is_same_v<TypeParam, float> ? 1.8e-7F : 0.0F}) {
        this->spheres = {{Vec3::Zero(), 1.0F - miss}, {{2, 0, 0}, 1.0F - miss}};
        this->rows.clear();
        EXPECT_EQ(this->solved({1, 9, 0}), Found::optimum) << miss;
        EXPECT_TRUE(this->is_at(Vec3::UnitX()));
        // On a plane through both centres.
        this->rows = {this->row(Vec3::UnitZ(), TypeParam(0.0F))};
        EXPECT_EQ(this->on_plane({1, 9, 0}), Found::optimum) << miss;
        EXPECT_TRUE(this->is_at(Vec3::UnitX()));
        EXPECT_EQ(this->on_plane(Vec3::UnitZ(), true), Found::optimum)
            << "every point is as good, there is one " << miss;
        EXPECT_TRUE(this->is_at(Vec3::UnitX()));
    }
    this->spheres[1].centre.x() = 2.1F;
    this->rows.clear();
    EXPECT_EQ(this->solved({1, 9, 0}), Found::nothing);
}

/// The same sphere twice is one.
TYPED_TEST(OptimumTouch, TheSameSphereTwice)
{
    this->spheres = {{{0.25F, 0, 0}, 1.0F}, {{0.25F, 0, 0}, 1.0F}};
    EXPECT_EQ(this->solved({0.25F, 3, 0}), Found::optimum);
    EXPECT_TRUE(this->is_at({0.25F, 1, 0}, 1e-5F));
    this->rows = {this->row(Vec3::UnitZ(), TypeParam(0.6F))};
    EXPECT_EQ(this->solved({0.25F, 3, 0}), Found::optimum);
    EXPECT_TRUE(this->is_at({0.25F, 0.8F, 0.6F}, 1e-5F));
    EXPECT_EQ(this->on_plane({1, 0, 0}, true), Found::optimum);
    EXPECT_TRUE(this->is_at({1.05F, 0, 0.6F}, 1e-5F));
}

/// The preferred velocity 0 is a point like any other.
TYPED_TEST(OptimumTouch, TheNearestToZeroIsThat)
{
    this->spheres = {{{0.5F, 0, 0}, 1.0F}, {{-0.2F, 0, 0}, 1.0F}};
    this->rows = {this->row(Vec3::UnitZ(), TypeParam(0.0F))};
    EXPECT_EQ(this->on_plane(Vec3::Zero()), Found::optimum);
    EXPECT_TRUE(this->is_at(Vec3::Zero(), 1e-6F));
    this->spheres = {{{0.5F, 0, 0}, 1.0F}, {{1.2F, 0, 0}, 1.0F}};
    EXPECT_EQ(this->on_plane(Vec3::Zero()), Found::optimum);
    EXPECT_TRUE(this->is_at({0.2F, 0, 0}, 1e-5F)) << "the second one begins there ";
}

/// A disc within another one: of points that are all as good one within both, whichever is the smaller.
TYPED_TEST(OptimumTouch, ADiscWithinAnother)
{
    this->rows = {this->row(Vec3::UnitZ(), TypeParam(0.0F))};
    const Sphere small{{0.1F, 0, 0}, 0.5F};
    const Sphere large{{0, 0, 0}, 2.0F};
    for (const auto& both : {std::vector<Sphere>{small, large}, {large, small}}) {
        this->spheres = both;
        EXPECT_EQ(this->on_plane(Vec3::UnitZ(), true), Found::optimum);
        EXPECT_LE((this->x - small.centre).norm(), 0.5F);
        EXPECT_EQ(this->on_plane({5, 0, 0}), Found::optimum);
        EXPECT_TRUE(this->is_at({0.6F, 0, 0}, 1e-5F));
    }
}

/// Opposite half-spaces that contradict each other by less than rounding leave the line between them.
TYPED_TEST(OptimumTouch, OppositeOnesThatMissByRounding)
{
    for (const float miss : kMisses) {
        for (const bool swapped : {false, true}) {
            this->rows = {this->row(Vec3::UnitX(), TypeParam(0.0F)),
                          this->row(-Vec3::UnitX(), TypeParam(miss * this->kTolerance)),
                          this->row(Vec3::UnitZ(), TypeParam(0.0F)), this->row(Vec3::UnitY(), TypeParam(0.5F))};
            if (swapped) {
                std::swap(this->rows[0], this->rows[1]);
            }
            EXPECT_EQ(this->on_plane({0.3F, 0, -1}), Found::optimum) << miss;
            EXPECT_TRUE(this->is_at({0, 0.5F, 0}, 1e-5F));
        }
    }
    this->rows[0].offset = this->rows[1].offset = TypeParam(0.01F);
    EXPECT_EQ(this->on_plane({0.3F, 0, -1}), Found::nothing);
}

/// Of two ends as far off, between slopes that differ: where both are broken equally.
TYPED_TEST(OptimumTouch, AShortfallIsSharedByTheSlopes)
{
    const float lack = 1.5F * this->kTolerance;
    // Along x a steep one from the left and a shallow one from the right, that miss each other by `lack` over the
    // slope.
    const Vec3 shallow(-0.1F, 0, std::sqrt(0.99F));
    this->rows = {this->row(Vec3::UnitX(), TypeParam(0.0F)), this->row(shallow, TypeParam(lack)),
                  this->row(Vec3::UnitZ(), TypeParam(0.0F)), this->row(Vec3::UnitY(), TypeParam(0.5F))};
    WorkBudget budget(1'000'000);
    Vec3Of<TypeParam> at = Vec3Of<TypeParam>::Zero();
    Basis basis;
    ASSERT_EQ(optimum_on_plane<TypeParam>(std::span<const RowOf<TypeParam>>(this->rows), 3, 3, this->spheres,
                                          {Vec3(0, 0, -1).cast<TypeParam>(), false}, Tolerance<TypeParam>(1.0F), budget,
                                          at, basis),
              Found::optimum);
    const float left = static_cast<float>(this->rows[0].violation(at));
    const float right = static_cast<float>(this->rows[1].violation(at));
    EXPECT_LE(left, 2.0F * this->kTolerance);
    EXPECT_LE(right, 2.0F * this->kTolerance);
}

}  // namespace
}  // namespace jink::orca
