// SPDX-License-Identifier: BSD-3-Clause
// The search among half-spaces with near, blunt or violated rows decided by one bit.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/search.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

using test::above;
using test::below;

/// Rows and spheres that are searched with a tolerance of kTolerance.
template <class Real>
class SearchEdges : public ::testing::Test {
protected:
    static constexpr float kOutside = test::kTolerance<Real>;
    /// Tolerance of "near", in either precision: four times the tolerance of single precision.
    float rounding() const { return 4.0F * Tolerance<float>(scale).outside; }

    /// Every velocity whose part along `direction` is `most` at most.
    void add_below(const Vec3& direction, float most, float yield = 1.0F)
    {
        rows.push_back({-direction, -most});
        yields.push_back(yield);
    }
    void clear()
    {
        rows.clear();
        yields.clear();
    }
    Search<Real> search(const Vec3& goal)
    {
        const std::size_t n = rows.size();
        derived.resize(n);
        held.resize(n + 8);
        return Search<Real>(spheres, goal, {rows, derived, yields, held}, scale, budget);
    }
    /// Whether the active set of the point nearest to `goal` is reported as blunt.
    bool blunt(const Vec3& goal)
    {
        Search<Real> s = search(goal);
        EXPECT_EQ(s.nearest(rows.size()), Found::optimum);
        s.judge(rows.size());
        return s.is_blunt();
    }

    float scale = test::exact_scale<Real>();
    std::vector<Row> rows;
    std::vector<Row> derived;
    std::vector<float> yields;
    std::vector<std::uint16_t> held;
    std::vector<Sphere> spheres{{Vec3::Zero(), 16.0F}};
    WorkBudget budget{1'000'000};
};
using SearchPrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(SearchEdges, SearchPrecisions);

TYPED_TEST(SearchEdges, ARowThatIsBrokenByTheToleranceHoldsNothing)
{
    for (const float by : {this->kOutside, above(this->kOutside)}) {
        this->rows = {{Vec3::UnitX(), by}};
        this->yields = {1.0F};
        Search<TypeParam> s = this->search(Vec3::Zero());
        ASSERT_EQ(s.nearest(1), Found::optimum);
        const bool is_held = by > this->kOutside;
        EXPECT_EQ(s.basis().size, is_held ? 1U : 0U);
        EXPECT_EQ(s.x(), is_held ? Vec3(by, 0, 0) : Vec3(Vec3::Zero()));
    }
}

/// In twice the precision a millionth is no rounding.
TEST(SearchInTwiceThePrecision, ARowThatIsBrokenByAMillionthHolds)
{
    std::vector<Row> rows{{Vec3::UnitX(), 1e-6F}, {Vec3::UnitY(), -1.0F}};
    std::vector<Row> derived(2);
    std::vector<float> yields(2, 1.0F);
    std::vector<std::uint16_t> held(8);
    const std::vector<Sphere> spheres{{Vec3::Zero(), 1.0F}};
    WorkBudget budget(10'000);
    Search<DoubleFloat> s(spheres, Vec3::Zero(), {rows, derived, yields, held}, 1.0F, budget);
    ASSERT_EQ(s.nearest(2), Found::optimum);
    EXPECT_NEAR(s.x().x(), 1e-6F, 1e-9F);
    EXPECT_EQ(s.basis().size, 1U);
}

// --- near rows at too small an angle: tested in single precision ---

class BluntEdges : public SearchEdges<float> {};

/// Of two in one direction the second counts within the rounding of single precision.
TEST_F(BluntEdges, ARowIsNearWithinRounding)
{
    const float far = 1.0F + rounding();
    for (const float most : {far, below(far)}) {
        clear();
        add_below(Vec3::UnitX(), 1.0F);
        add_below(Vec3::UnitX(), most);
        EXPECT_EQ(blunt({5, 0, 0}), most < far);
    }
}

TEST_F(BluntEdges, ASphereIsNearWithinRounding)
{
    const float far = 1.0F + rounding();
    for (const float radius : {far, below(far)}) {
        clear();
        add_below(Vec3::UnitX(), 1.0F);
        spheres = {{Vec3::Zero(), 16.0F}, {Vec3::Zero(), radius}};
        EXPECT_EQ(blunt({1, 0, 0}), radius < far);
    }
}

/// A sphere no larger than rounding holds its centre from all sides.
TEST_F(BluntEdges, ASphereOfTheSizeOfRoundingHoldsItsCentre)
{
    add_below(Vec3::UnitX(), 1.0F);
    add_below(Vec3::UnitY(), 0.0F);
    for (const float radius : {rounding(), above(rounding())}) {
        spheres = {{Vec3::Zero(), 16.0F}, {Vec3::UnitX(), radius}};
        EXPECT_EQ(blunt({1, 0, 0}), radius == rounding());
    }
}

/// Two planes through one point, whose normals have this cosine.
TEST_F(BluntEdges, TwoThatMeetInATenthAreNotBlunt)
{
    constexpr float kLimit = 1.0F - 0.1F * 0.1F;
    float cosine = std::sqrt(kLimit);
    while (cosine * cosine > kLimit) {
        cosine = below(cosine);
    }
    ASSERT_EQ(cosine * cosine, kLimit);
    while (above(cosine) * above(cosine) == kLimit) {
        cosine = above(cosine);
    }
    for (const float c : {cosine, above(cosine)}) {
        clear();
        add_below(Vec3::UnitX(), 1.0F);
        add_below({c, 0.1F, 0}, c);
        EXPECT_EQ(blunt({1, 0, 0}), c > cosine);
    }
}

/// Three planes through one point, whose normals span this volume.
TEST_F(BluntEdges, ThreeThatSpanATenthAreNotBlunt)
{
    constexpr float kPart = 0.7035624F;  // with the height it is a unit vector
    for (const float height : {0.1F, below(0.1F)}) {
        clear();
        add_below(Vec3::UnitX(), 1.0F);
        add_below(Vec3::UnitY(), 1.0F);
        add_below({kPart, kPart, height}, kPart + kPart);
        EXPECT_EQ(blunt({1, 1, 0}), height < 0.1F);
    }
}

/// Planes through one point, at angles of 45 degrees and more: three need no higher precision, four do.
TEST_F(BluntEdges, MoreThanThreeThroughOnePointAreBlunt)
{
    add_below({0.6F, 0.8F, 0}, 1.0F);
    add_below({0.6F, -0.8F, 0}, 0.2F);
    const Vec3 at(1.0F, 0.5F, 0);
    EXPECT_FALSE(blunt(at));
    spheres = {{Vec3::Zero(), 16.0F}, {at - Vec3::UnitZ(), 1.0F}};
    EXPECT_FALSE(blunt(at)) << "two planes and a sphere";
    add_below({0, 0.6F, 0.8F}, 0.3F);
    EXPECT_TRUE(blunt(at)) << "three planes and a sphere";
    spheres.pop_back();
    EXPECT_FALSE(blunt(at)) << "three planes";
    add_below({0, 0.6F, -0.8F}, 0.3F);
    EXPECT_TRUE(blunt(at)) << "four planes";
    rows.pop_back();
    rows.pop_back();
    rows.pop_back();
    spheres = {{at - 16.0F * Vec3::UnitZ(), 16.0F}, {at + Vec3::UnitY(), 1.0F}};
    EXPECT_FALSE(blunt(at)) << "a plane and two spheres";
}

// --- four that contradict each other ---

/// y >= 0 and z >= 0 hold; x >= gap and x <= -gap yield in proportion to their yields.
template <class Real>
class FourRows : public SearchEdges<Real> {
protected:
    bool blunt_corner(float gap, float yield = 1.0F)
    {
        this->scale = test::exact_scale<float>();
        this->clear();
        this->add_below(-Vec3::UnitY(), 0.0F);
        this->add_below(-Vec3::UnitZ(), 0.0F);
        this->add_below(-Vec3::UnitX(), -gap, yield);
        this->add_below(Vec3::UnitX(), -gap, yield);
        Search<Real> s = this->search({-1, -1, -1});
        EXPECT_EQ(s.nearest(4), Found::nothing);
        d = -1.0F;
        EXPECT_TRUE(s.relax_at_corner(2, 4, d));
        x = s.x();
        return s.is_blunt();
    }
    float d = 0.0F;
    Vec3 x = Vec3::Zero();
};
TYPED_TEST_SUITE(FourRows, SearchPrecisions);

/// A violation of no more than rounding times the shares is open; with shares of a half each that is rounding itself.
TYPED_TEST(FourRows, AViolationBelowRoundingIsBlunt)
{
    const float rounding = 4.0F * test::kTolerance<float>;
    EXPECT_FALSE(this->blunt_corner(rounding));
    EXPECT_EQ(this->d, rounding);
    EXPECT_TRUE(this->blunt_corner(below(rounding)));
    EXPECT_FALSE(this->blunt_corner(0.25F));
    EXPECT_EQ(this->d, 0.25F);
    EXPECT_LT(this->x.norm(), 1e-3F);
}

/// Shares that add up to twenty are exact enough.
TYPED_TEST(FourRows, SharesAboveTwentyAreBlunt)
{
    EXPECT_FALSE(this->blunt_corner(0.25F, 0.05F));
    EXPECT_FLOAT_EQ(this->d, 5.0F);
    EXPECT_TRUE(this->blunt_corner(0.25F, 0.0499F));
}

/// An earlier blunt result stays blunt, for any corner.
TYPED_TEST(SearchEdges, ACornerAfterABluntAnswerIsBlunt)
{
    for (const float inner : {15.0F, 14.0F}) {
        this->clear();
        this->add_below(-Vec3::UnitY(), -1.0F);
        this->add_below(-Vec3::UnitZ(), -1.0F);
        this->add_below(-Vec3::UnitX(), -0.25F);
        this->add_below(Vec3::UnitX(), -0.25F);
        // The second sphere contacts the first from inside, or is inside it.
        this->spheres = {{Vec3::Zero(), 16.0F}, {Vec3::UnitX(), inner}};
        Search<TypeParam> s = this->search({20, 0, 0});
        ASSERT_EQ(s.nearest(0), Found::optimum);
        s.judge(0);
        EXPECT_EQ(s.is_blunt(), inner == 15.0F);
        ASSERT_EQ(s.nearest(4), Found::nothing);
        float d = 0.0F;
        ASSERT_TRUE(s.relax_at_corner(2, 4, d));
        EXPECT_EQ(d, 0.25F);
        EXPECT_EQ(s.is_blunt(), inner == 15.0F);
    }
}

/// With nothing but two opposite ones there is no corner.
TYPED_TEST(SearchEdges, TwoThatContradictEachOtherAreNoCorner)
{
    this->add_below(-Vec3::UnitX(), -0.25F);
    this->add_below(Vec3::UnitX(), -0.25F);
    Search<TypeParam> s = this->search({-1, -1, -1});
    ASSERT_EQ(s.nearest(2), Found::nothing);
    float d = 7.0F;
    EXPECT_FALSE(s.relax_at_corner(0, 2, d));
    EXPECT_EQ(d, 7.0F);
}

}  // namespace
}  // namespace jink::orca
