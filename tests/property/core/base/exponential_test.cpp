// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "tests/property/core/geometry/oracle.hpp"

// Exponential and logarithm against the C library in double precision.

namespace jink {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;

void expect_faded(float x)
{
    const double exact = -std::expm1(-double(x));
    ASSERT_LE(std::abs(double(faded_share(x)) - exact), 2e-7 * exact) << x;
}

TEST(Exponential, FadedShareKeepsItsAccuracy)
{
    const std::uint64_t seed = seed_of(20261129);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(200'000); ++i) {
        expect_faded(random.uniform(0.0F, 2.0F));
        expect_faded(random.uniform(0.0F, 30.0F));
        expect_faded(std::pow(10.0F, random.uniform(-30.0F, 38.0F)));
    }
}

TEST(Exponential, FadedShareKeepsItNextToEveryHalfOfADoubling)
{
    for (int i = 0; i < 60; ++i) {
        auto x = static_cast<float>(0.5 * i * std::log(2.0));
        for (int k = 0; k < 4; ++k) {
            expect_faded(x);
            x = std::nextafter(x, 100.0F);
        }
    }
}

TEST(Exponential, FadedShareStaysWithinZeroAndOne)
{
    for (float x = 0.0F; x < 25.0F; x += 1e-4F) {
        const float share = faded_share(x);
        ASSERT_GE(share, 0.0F) << x;
        ASSERT_LE(share, 1.0F) << x;
    }
    EXPECT_EQ(faded_share(0.0F), 0.0F);
    EXPECT_EQ(faded_share(20.0F), 1.0F);
    EXPECT_EQ(faded_share(std::numeric_limits<float>::infinity()), 1.0F);
    EXPECT_EQ(faded_share(std::numeric_limits<float>::denorm_min()), std::numeric_limits<float>::denorm_min());
    EXPECT_TRUE(std::isnan(faded_share(std::nanf(""))));
}

void expect_log(float value)
{
    const double exact = std::log(double(value));
    ASSERT_LE(std::abs(double(natural_log(value)) - exact), 1e-7 + 1e-7 * std::abs(exact)) << value;
}

TEST(Exponential, LogarithmKeepsItsAccuracy)
{
    const std::uint64_t seed = seed_of(20261130);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(200'000); ++i) {
        expect_log(random.uniform(0.5F, 2.0F));
        expect_log(std::pow(10.0F, random.uniform(-37.0F, 38.0F)));
        expect_log(std::pow(10.0F, random.uniform(-3.0F, 3.0F)));
    }
}

TEST(Exponential, LogarithmsAtTheEdgesOfItsPieces)
{
    EXPECT_EQ(natural_log(1.0F), 0.0F);
    for (const float value : {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(),
                              std::numeric_limits<float>::max(), 1e-40F, 0.70710678F, 1.41421356F, 0.5F, 2.0F}) {
        expect_log(value);
        expect_log(std::nextafter(value, 1.0F));
    }
}

}  // namespace
}  // namespace jink
