// SPDX-License-Identifier: BSD-3-Clause
// The safety margin: the check values of the avoidance specification, section 8.
#include "core/reach/safety_margin.hpp"

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

/// CHECK VALUE: v = 10 m/s, a frame of 1 s: 10 m.
TEST(SafetyMargins, AClockThatIsOffByAFrameCostsTenMetres)
{
    EXPECT_FLOAT_EQ(synchronization_bloat(10.0F, 1.0F), 10.0F);
    MarginTerms terms;
    terms.intruder_speed = 10.0F;
    terms.intruder_frame = 1.0F;
    EXPECT_FLOAT_EQ(safety_margin(terms).margin, 10.0F);
}

/// CHECK VALUE: margin 5, L = 1: 0.0251 m.
TEST(SafetyMargins, PointsOneMetreApartCostTwoAndAHalfCentimetres)
{
    EXPECT_NEAR(discretization_bloat(5.0F, 1.0F), 0.0251F, 5e-5F);
    EXPECT_EQ(discretization_bloat(5.0F, 0.0F), 0.0F);
    EXPECT_EQ(discretization_bloat(0.3F, 1.0F), 0.3F) << "all of it";
}

/// With the bloat, points that are clear make a way that is: half-way is the nearest that it can be.
TEST(SafetyMargins, WithTheBloatTheWayBetweenPointsIsClear)
{
    for (float margin = 0.29F; margin < 20.0F; margin *= 1.01F) {
        const float kept = margin + discretization_bloat(margin, 1.0F);
        EXPECT_GE(std::sqrt(kept * kept - 0.25F), margin * (1.0F - 1e-5F)) << margin;
    }
}

TEST(SafetyMargins, TermsAddUpAndADirectiveOverrides)
{
    MarginTerms terms;
    terms.body_radius = 2.0F;
    terms.base = 1.0F;
    EXPECT_FLOAT_EQ(safety_margin(terms).margin, 2.0F) << "never less than the body";
    terms.base = 4.0F;
    terms.own_sigma = 0.5F;
    terms.intruder_sigma = 1.5F;
    terms.intruder_speed = 20.0F;
    terms.intruder_frame = 0.25F;
    terms.weather = 0.5F;
    terms.airspace = 1.5F;
    EXPECT_FLOAT_EQ(safety_margin(terms).margin, 4.0F + 6.0F + 5.0F + 2.0F);
    EXPECT_EQ(safety_margin(terms).directive, 0.0F) << "there is none";
    terms.directive = 10.0F;
    EXPECT_FLOAT_EQ(safety_margin(terms).margin, 17.0F);
    EXPECT_FLOAT_EQ(safety_margin(terms).directive, -7.0F);
    terms.directive = 20.0F;
    EXPECT_FLOAT_EQ(safety_margin(terms).margin, 20.0F);
    EXPECT_FLOAT_EQ(safety_margin(terms).directive, 3.0F);
}

/// Each term by itself makes a margin larger, sigmas threefold, and none stands for another.
TEST(SafetyMargins, EveryTermCounts)
{
    const auto with = [](auto MarginTerms::*term, float value) {
        MarginTerms terms;
        terms.intruder_speed = 2.0F;
        terms.intruder_frame = 0.5F;
        terms.*term = value;
        return safety_margin(terms).margin;
    };
    EXPECT_FLOAT_EQ(with(&MarginTerms::weather, 0.0F), 1.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::body_radius, 4.0F), 5.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::base, 4.0F), 5.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::own_sigma, 4.0F), 13.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::intruder_sigma, 4.0F), 13.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::intruder_speed, 4.0F), 2.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::intruder_frame, 4.0F), 8.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::weather, 4.0F), 5.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::airspace, 4.0F), 5.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::directive, 4.0F), 4.0F);
    EXPECT_FLOAT_EQ(with(&MarginTerms::directive, 0.5F), 1.0F);
}

}  // namespace
}  // namespace jink::reach
