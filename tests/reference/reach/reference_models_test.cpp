// SPDX-License-Identifier: BSD-3-Clause
// The reference models themselves, by the check values of the avoidance specification, section 2.7.
#include "tests/reference/reach/reference_models.hpp"

#include <gtest/gtest.h>

namespace jink::reach::reference {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// CHECK VALUES, d_d = 100 m.
TEST(SpreadReference, LateralOffsetsOfBothLaws)
{
    const double degrees[] = {5.0, 15.0, 30.0, 45.0};
    const double sine[] = {8.716, 25.882, 50.000, 70.711};
    const double tangent[] = {8.749, 26.795, 57.735, 100.0};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(lateral(degrees[i] * kDegree, 100.0, SpreadLaw::sine), sine[i], 5e-4);
        EXPECT_NEAR(lateral(degrees[i] * kDegree, 100.0, SpreadLaw::tangent), tangent[i], 5e-4);
    }
}

/// CHECK VALUES, ellipse of 3 by 2, m = 1: 19 points, their sum and weights.
TEST(SpreadReference, AnEllipseOfThreeByTwoHasNineteenPoints)
{
    const std::vector<Weighted> raw = ellipse_cloud(3.0, 2.0, 1.0);
    ASSERT_EQ(raw.size(), 19U);
    EXPECT_NEAR(sum_of(raw), 2.809238, 1e-6);
    const Slice slice = slice_of(3.0, 2.0, 1.0);
    EXPECT_FALSE(slice.cloud_coarsened);
    double least = 1.0;
    int found = 0;
    for (const Weighted& w : slice.points) {
        least = std::min(least, w.weight);
        const auto is = [&](double p1, double p2) { return std::abs(w.p1) == p1 && std::abs(w.p2) == p2; };
        const double expected = is(0, 0)   ? 0.059171
                                : is(3, 0) ? 0.049858
                                : is(0, 2) ? 0.045202
                                : is(1, 1) ? 0.053720
                                           : 0.0;
        if (expected > 0.0) {
            EXPECT_NEAR(w.weight, expected, 1e-6) << w.p1 << " " << w.p2;
            ++found;
        }
    }
    EXPECT_EQ(found, 9);
    EXPECT_NEAR(least, 0.045202, 1e-6);
}

/// CHECK VALUES, 15 by 5 degrees with the sine at 100 m: 707 points of weights 1.15e-3 to 1.59e-3, at half the spacing
/// 2837, which is more than a slice may have.
TEST(SpreadReference, AConeOfFifteenByFiveDegreesHas707Points)
{
    const double a = lateral(15.0 * kDegree, 100.0, SpreadLaw::sine);
    const double b = lateral(5.0 * kDegree, 100.0, SpreadLaw::sine);
    const Slice slice = slice_of(a, b, 1.0);
    ASSERT_EQ(slice.points.size(), 707U);
    double least = 1.0;
    double most = 0.0;
    for (const Weighted& w : slice.points) {
        least = std::min(least, w.weight);
        most = std::max(most, w.weight);
    }
    EXPECT_NEAR(least, 1.15e-3, 5e-6);
    EXPECT_NEAR(most, 1.59e-3, 5e-6);
    EXPECT_EQ(ellipse_cloud(a, b, 0.5).size(), 2837U);
    const Slice coarse = slice_of(a, b, 0.5);
    EXPECT_TRUE(coarse.cloud_coarsened);
    EXPECT_EQ(coarse.points.size(), 707U);
}

/// An apex has one point, with all of the probability; so has an axis without extent only its middle.
TEST(SpreadReference, WithoutExtentThereIsOnePoint)
{
    const Slice apex = slice_of(0.0, 0.0, 0.5);
    ASSERT_EQ(apex.points.size(), 1U);
    EXPECT_EQ(apex.points[0].weight, 1.0);
    EXPECT_EQ(slice_of(2.0, 0.0, 0.5).points.size(), 9U);
}

/// Every cell that a cloud overlaps has a rate far beyond the threshold of a threat: the model is binary.
TEST(SpreadReference, EveryTouchedCellIsAThreat)
{
    Intruder intruder;
    intruder.position = P(14, 2, 0);
    intruder.velocity = P(-2, 0, 0);
    intruder.horizontal = 15.0 * kDegree;
    intruder.vertical = 5.0 * kDegree;
    const SpreadResult result = spread(Grid<double>(), intruder, 0.1, SpreadLaw::sine);
    EXPECT_GT(result.cells.size(), 40U);
    for (const auto& [cell, touch] : result.cells) {
        EXPECT_GT(touch.space(), 1e-4);
        EXPECT_LE(touch.space(), 1.0 + 1e-9);
    }
}

}  // namespace
}  // namespace jink::reach::reference
