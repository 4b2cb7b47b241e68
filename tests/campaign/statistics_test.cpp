// SPDX-License-Identifier: BSD-3-Clause
// Intervals against published ones, and against the tail of the distribution itself.
#include "toolchain/sim/statistics.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

/// Newcombe 1998, table I, method 3 (score without continuity correction), to the four digits printed there.
TEST(Statistics, WilsonIntervalsAreThoseOfNewcombe)
{
    constexpr double kPrinted = 0.5e-4;
    const Share most = share_of(81, 263);
    EXPECT_NEAR(most.low, 0.2553, kPrinted);
    EXPECT_NEAR(most.high, 0.3662, kPrinted);
    const Share some = share_of(15, 148);
    EXPECT_NEAR(some.low, 0.0624, kPrinted);
    EXPECT_NEAR(some.high, 0.1605, kPrinted);
    const Share one = share_of(1, 29);
    EXPECT_NEAR(one.low, 0.0061, kPrinted);
    EXPECT_NEAR(one.high, 0.1718, kPrinted);
    EXPECT_NEAR(one.value, 1.0 / 29.0, 1e-15);
}

/// The score interval holds the shares p whose own standard error puts the one observed within z of them: its limits
/// solve |x/n - p| = z sqrt(p (1 - p) / n). Found here by bisection.
TEST(Statistics, WilsonLimitsSolveTheScoreEquation)
{
    const auto excess = [](double x, double n, double p) {
        return std::abs(x / n - p) - 1.959963984540054 * std::sqrt(p * (1.0 - p) / n);
    };
    for (const auto& [count, all] : std::vector<std::pair<std::size_t, std::size_t>>{
             {1, 2}, {1, 1000}, {7, 3000}, {2999, 3000}, {500, 1000}, {3, 100'000}}) {
        const auto x = static_cast<double>(count);
        const auto n = static_cast<double>(all);
        const auto root = [&](double outside, double inside) {
            for (int i = 0; i < 200; ++i) {
                const double middle = 0.5 * (outside + inside);
                (excess(x, n, middle) > 0.0 ? outside : inside) = middle;
            }
            return inside;
        };
        const Share share = share_of(count, all);
        EXPECT_NEAR(share.low, root(0.0, x / n), 1e-12) << count << " of " << all;
        EXPECT_NEAR(share.high, root(1.0, x / n), 1e-12) << count << " of " << all;
    }
}

/// With 3 / n, none in n comes about with a probability of 5 % at most (and of hardly less).
TEST(Statistics, NoneAtAllIsTheRuleOfThree)
{
    for (const std::size_t n : {std::size_t{30}, std::size_t{1000}, std::size_t{100'000}}) {
        const Share none = share_of(0, n);
        EXPECT_EQ(none.low, 0.0);
        EXPECT_EQ(none.value, 0.0);
        const double by_chance = std::pow(1.0 - none.high, static_cast<double>(n));
        EXPECT_LT(by_chance, 0.05);
        EXPECT_GT(by_chance, 0.04);
        const Share every = share_of(n, n);
        EXPECT_EQ(every.high, 1.0);
        EXPECT_NEAR(1.0 - every.low, none.high, 1e-15);
    }
    EXPECT_EQ(share_of(0, 1).high, 1.0);
    EXPECT_EQ(share_of(0, 0).high, 1.0);
    EXPECT_EQ(share_of(0, 0).low, 0.0);
}

/// R: quantile(c(1, 2, 4, 8), c(0, .25, .5, .9, 1)) gives 1, 1.75, 3, 6.8, 8.
TEST(Statistics, QuantilesAreOfType7)
{
    const std::vector<double> values{1.0, 2.0, 4.0, 8.0};
    EXPECT_DOUBLE_EQ(quantile(values, 0.0), 1.0);
    EXPECT_DOUBLE_EQ(quantile(values, 0.25), 1.75);
    EXPECT_DOUBLE_EQ(quantile(values, 0.5), 3.0);
    EXPECT_DOUBLE_EQ(quantile(values, 0.9), 6.8);
    EXPECT_DOUBLE_EQ(quantile(values, 1.0), 8.0);
    EXPECT_DOUBLE_EQ(quantile(std::vector<double>{5.0}, 0.3), 5.0);
}

}  // namespace
}  // namespace jink::sim
