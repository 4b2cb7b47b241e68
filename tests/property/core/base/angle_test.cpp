// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/angle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/vec3.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Sine, cosine and direction against the C library in double precision.

namespace jink {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

void expect_sine_cosine(float angle)
{
    const SineCosine ours = sine_cosine(angle);
    const double exact = double(angle);
    ASSERT_LT(std::abs(double(ours.sine) - std::sin(exact)), 1e-7) << angle;
    ASSERT_LT(std::abs(double(ours.cosine) - std::cos(exact)), 1e-7) << angle;
    if (std::abs(angle) < 0.5F) {
        ASSERT_LE(std::abs(double(ours.sine) - std::sin(exact)), 1e-7 * std::abs(std::sin(exact))) << angle;
    }
}

TEST(Angle, SineAndCosineKeepTheirAccuracy)
{
    const std::uint64_t seed = seed_of(20261125);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(100'000); ++i) {
        expect_sine_cosine(random.uniform(-6.2831855F, 6.2831855F));
        expect_sine_cosine(random.uniform(-kMaxAngle, kMaxAngle));
        expect_sine_cosine(std::pow(10.0F, random.uniform(-30.0F, 0.0F)));
    }
}

TEST(Angle, NextToEveryEighthOfATurnTooTheyKeepIt)
{
    for (int eighth = -1270; eighth <= 1270; ++eighth) {  // kMaxAngle is 1273 eighths
        const auto angle = static_cast<float>(eighth * (0.25 * 3.14159265358979323846));
        float below = angle;
        float above = angle;
        for (int i = 0; i < 4; ++i) {
            expect_sine_cosine(below);
            expect_sine_cosine(above);
            below = std::nextafter(below, -kInfinite);
            above = std::nextafter(above, kInfinite);
        }
    }
}

TEST(Angle, SquaresOfSineAndCosineSumToOne)
{
    for (float angle = -10.0F; angle < 10.0F; angle += 1e-3F) {
        const SineCosine ours = sine_cosine(angle);
        const double sum = double(ours.sine) * double(ours.sine) + double(ours.cosine) * double(ours.cosine);
        ASSERT_NEAR(sum, 1.0, 3e-7) << angle;
        const SineCosine other = sine_cosine(-angle);
        ASSERT_EQ(other.sine, -ours.sine) << angle;
        ASSERT_EQ(other.cosine, ours.cosine) << angle;
    }
}

TEST(Angle, NoAngleGivesNoNumbers)
{
    const float too_large = std::nextafter(kMaxAngle, kInfinite);
    for (const float angle : {too_large, -too_large, kInfinite, -kInfinite, std::nanf("")}) {
        EXPECT_TRUE(std::isnan(sine_cosine(angle).sine)) << angle;
        EXPECT_TRUE(std::isnan(sine_cosine(angle).cosine)) << angle;
    }
    EXPECT_EQ(sine_cosine(0.0F).sine, 0.0F);
    EXPECT_EQ(sine_cosine(0.0F).cosine, 1.0F);
}

void expect_direction(float y, float x)
{
    ASSERT_LT(std::abs(double(direction_angle(y, x)) - std::atan2(double(y), double(x))), 3e-7) << y << " " << x;
}

TEST(Angle, DirectionKeepsItsAccuracy)
{
    const std::uint64_t seed = seed_of(20261126);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(100'000); ++i) {
        expect_direction(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
        const float size = std::pow(10.0F, random.uniform(-18.0F, 18.0F));
        expect_direction(random.uniform(0.0F, 1.0F) * size, (random.below(2) == 0 ? -1.0F : 1.0F) * size);
        const float other = std::pow(10.0F, random.uniform(-18.0F, 18.0F));
        expect_direction(size, other);
        expect_direction(-size, -other);
    }
}

TEST(Angle, DirectionUndoesSineAndCosine)
{
    for (float angle = -3.14F; angle < 3.14F; angle += 1e-3F) {
        const SineCosine on = sine_cosine(angle);
        ASSERT_NEAR(direction_angle(on.sine, on.cosine), angle, 6e-7F);
        ASSERT_EQ(direction_angle(-on.sine, on.cosine), -direction_angle(on.sine, on.cosine));
    }
}

TEST(Angle, DirectionsOfTheAxesAreExact)
{
    EXPECT_EQ(direction_angle(0.0F, 0.0F), 0.0F);
    EXPECT_EQ(direction_angle(0.0F, 2.0F), 0.0F);
    EXPECT_EQ(direction_angle(2.0F, 0.0F), 0.5F * kPi);
    EXPECT_EQ(direction_angle(-2.0F, 0.0F), -0.5F * kPi);
    EXPECT_EQ(direction_angle(0.0F, -2.0F), kPi);
    EXPECT_EQ(direction_angle(-0.0F, -2.0F), kPi) << "a signed zero counts as zero";
    EXPECT_EQ(direction_angle(0.0F, -0.0F), 0.0F);
    EXPECT_EQ(direction_angle(2.0F, 2.0F), 0.25F * kPi);
    EXPECT_TRUE(std::isnan(direction_angle(std::nanf(""), 1.0F)));
    EXPECT_TRUE(std::isnan(direction_angle(1.0F, std::nanf(""))));
    EXPECT_TRUE(std::isnan(direction_angle(kInfinite, kInfinite)));
    EXPECT_EQ(direction_angle(kInfinite, 1.0F), 0.5F * kPi);
}

}  // namespace
}  // namespace jink
