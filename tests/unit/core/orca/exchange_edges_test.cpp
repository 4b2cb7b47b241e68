// SPDX-License-Identifier: BSD-3-Clause
// Corners of four half-spaces whose numbers are exact: which are found, which are too blunt, and when a fifth one
// joins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/work_units.hpp"
#include "core/orca/exchange.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

using test::above;
using test::below;

/// Half-spaces, the first four of which are the corner that is begun with.
template <class Real>
class ExchangeEdges : public ::testing::Test {
protected:
    static constexpr float kOutside = test::kTolerance<Real>;
    /// Volume of normals times yields below which a corner is too blunt.
    static constexpr float kBlunt = std::is_same_v<Real, float> ? 1e-3F : 1e-10F;

    void add(const Vec3& normal, float offset, float yield = 1.0F)
    {
        rows.push_back({normal, offset});
        yields.push_back(yield);
    }
    /// x >= 0.75 and x <= -0.25, beside y >= 0.5 and z >= 0: broken by 0.5 m/s where x is 0.25.
    void add_opposites()
    {
        add(Vec3::UnitX(), 0.75F);
        add(-Vec3::UnitX(), 0.25F);
        add(Vec3::UnitY(), 0.5F);
        add(Vec3::UnitZ(), 0.0F);
    }
    /// x >= 0.25 and x <= 0.25, which just hold together, beside y >= 0 and z >= 0.
    void add_touching()
    {
        add(Vec3::UnitX(), 0.25F);
        add(-Vec3::UnitX(), -0.25F);
        add(Vec3::UnitY(), 0.0F);
        add(Vec3::UnitZ(), 0.0F);
    }
    bool found(std::size_t soft = 0, std::uint32_t units = 10'000)
    {
        corner = {};
        corner.rows = {0, 1, 2, 3};
        return exchanged(soft, units);
    }
    /// Begun with `corner`.
    bool exchanged(std::size_t soft, std::uint32_t units = 10'000)
    {
        WorkBudget budget(units);
        return exchange<Real>(rows, yields, soft, spheres, Tolerance<Real>(test::exact_scale<Real>()), budget, corner);
    }
    [[nodiscard]] float d() const { return static_cast<float>(corner.d); }
    [[nodiscard]] Vec3 x() const { return corner.x.template cast<float>(); }
    [[nodiscard]] bool holds(std::uint16_t row) const
    {
        return std::find(corner.rows.begin(), corner.rows.end(), row) != corner.rows.end();
    }

    std::vector<Row> rows;
    std::vector<float> yields;
    std::vector<Sphere> spheres{{Vec3::Zero(), 1000.0F}};
    Corner<Real> corner;
};
using ExchangePrecisions = ::testing::Types<float, DoubleFloat>;
TYPED_TEST_SUITE(ExchangeEdges, ExchangePrecisions);

TYPED_TEST(ExchangeEdges, OppositeOnesAreACornerBesideTwoThatHoldNothing)
{
    this->add_opposites();
    ASSERT_TRUE(this->found());
    EXPECT_EQ(this->d(), 0.5F);
    EXPECT_EQ(this->x(), Vec3(0.25F, 0.0F, -0.5F));
    EXPECT_TRUE(this->corner.is_alone);
    const auto& shares = this->corner.shares;
    EXPECT_EQ(static_cast<float>(shares[0]), 0.5F);
    EXPECT_EQ(static_cast<float>(shares[1]), 0.5F);
    EXPECT_EQ(static_cast<float>(shares[2]), 0.0F);
    EXPECT_EQ(static_cast<float>(shares[3]), 0.0F);
}

/// If the first corner is optimal, the work is one check per row.
TYPED_TEST(ExchangeEdges, ACornerThatDecidesTakesOneTurn)
{
    this->add_opposites();
    const std::uint32_t turn = cost<TypeParam>(units::kOrcaExchange + units::orca_rows(4));
    EXPECT_TRUE(this->found(0, turn));
    EXPECT_FALSE(this->found(0, turn - 1));
}

/// A fifth one that is as far broken, but for four times the tolerance.
TYPED_TEST(ExchangeEdges, AFifthWithinRoundingIsNotAlone)
{
    this->add_touching();
    const float near = -4.0F * this->kOutside;
    this->add(-Vec3::UnitY(), 0.0F);
    for (const float offset : {below(near), near, above(near)}) {
        this->rows.back().offset = offset;
        ASSERT_TRUE(this->found());
        EXPECT_EQ(this->corner.is_alone, offset <= near) << offset;
    }
}

/// y <= -2 times the tolerance and a bit contradicts y >= 0 by more than rounding.
TYPED_TEST(ExchangeEdges, AFifthJoinsWhereItIsBrokenByMoreThanTwiceTheTolerance)
{
    this->add_touching();
    const float let_be = 2.0F * this->kOutside;
    this->add(-Vec3::UnitY(), let_be);
    ASSERT_TRUE(this->found());
    EXPECT_EQ(this->d(), 0.0F);
    EXPECT_FALSE(this->holds(4));
    this->rows.back().offset = above(let_be);
    ASSERT_TRUE(this->found());
    EXPECT_EQ(this->d(), 0.5F * above(let_be)) << "half of what the two lack";
    EXPECT_TRUE(this->holds(4));
    this->rows.back().offset = 1.0F;
    ASSERT_TRUE(this->found());
    EXPECT_EQ(this->d(), 0.5F);
    EXPECT_EQ(this->x().y(), -0.5F);
}

/// An exchange must raise the violation: y >= 0.75 replaces y >= 0.5, and x stays decisive.
TYPED_TEST(ExchangeEdges, ATurnThatRaisesNothingGivesUp)
{
    this->add_opposites();
    this->add(Vec3::UnitY(), 0.75F);
    EXPECT_FALSE(this->found());
}

/// y, z and x >= 0 hold, and the fourth yields to them. A fifth hard row replaces the third: replacing the first or the
/// second would need negative shares. If it contradicts the three there is no corner.
TYPED_TEST(ExchangeEdges, AFifthTakesThePlaceThatMakesACornerOfIt)
{
    const float part = -1.0F / std::sqrt(3.0F);
    for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)}) {
        this->add(normal, 0.0F);
    }
    this->add({0.8F, -0.6F, 0}, 0.25F);
    this->add({part, part, part}, 0.5F);
    const auto begun = [&] {
        this->corner = {};
        this->corner.rows = {0, 1, 2, 4};
        return this->exchanged(4);
    };
    ASSERT_TRUE(begun());
    EXPECT_NEAR(this->d(), 0.5F - 0.3125F * part, 1e-6F);
    EXPECT_LT((this->x() - Vec3(0.3125F, 0, 0)).norm(), 1e-6F);
    EXPECT_TRUE(this->holds(0) && this->holds(1) && this->holds(3) && this->holds(4));
    this->rows[3] = {-Vec3::UnitX(), 0.25F};
    EXPECT_FALSE(begun());
}

/// Shares of a thousand are found, more are not.
TYPED_TEST(ExchangeEdges, YieldsThatAreTooSmallAreTooBlunt)
{
    const float least = 0.5F * this->kBlunt;
    this->add(Vec3::UnitY(), 0.5F);
    this->add(Vec3::UnitZ(), 0.25F);
    this->add(Vec3::UnitX(), this->kBlunt, least);
    this->add(-Vec3::UnitX(), this->kBlunt, least);
    ASSERT_TRUE(this->found(2));
    EXPECT_FLOAT_EQ(this->d(), 2.0F);
    EXPECT_LT((this->x() - Vec3(0.0F, 0.5F, 0.25F)).norm(), 1e-6F) << "those that may not give way hold";
    this->yields[3] = below(least);
    EXPECT_FALSE(this->found(2));
}

/// Three of the four planes must intersect in a computable point.
TYPED_TEST(ExchangeEdges, NormalsThatNearlyLieInAPlaneAreTooBlunt)
{
    const auto with_height = [&](float height) {
        this->rows.clear();
        this->yields.clear();
        this->add({1, 0, 0}, 0.5F);
        this->add({0, 1, 0}, 0.5F);
        this->add({-1, 0, height}, 0.5F);
        this->add({0.6F, -0.8F, -0.8F * this->kBlunt}, 0.5F);  // four fifths of two others and one of the first hold it
    };
    with_height(this->kBlunt);
    ASSERT_TRUE(this->found());
    EXPECT_NEAR(this->d(), 0.5F, 1e-5F);
    with_height(below(this->kBlunt));
    EXPECT_FALSE(this->found());
    // A corner that is too blunt to begin with stays unknown, even where a fifth one would make a better one of it.
    this->add({0, 0, 1}, 0.75F);
    EXPECT_FALSE(this->found());
}

/// A sphere decides too where the answer lies outside of it.
TYPED_TEST(ExchangeEdges, AnAnswerOutsideOfASphereIsUnknown)
{
    this->add_opposites();
    this->rows[2].offset = this->rows[3].offset = 0.5F;
    this->spheres = {{Vec3::Zero(), 1.0F}, {{1.25F, 0, 0}, 1.0F}};
    EXPECT_TRUE(this->found()) << "at the rim of the second one";
    this->spheres[1].radius = 0.99F;
    EXPECT_FALSE(this->found());
}

}  // namespace
}  // namespace jink::orca
