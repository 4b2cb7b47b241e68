// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/statistics.hpp"

namespace jink::sim {
namespace {

/// 97.5 % quantile of the standard normal distribution.
constexpr double kZ = 1.9599639845400545;

}  // namespace

Share share_of(std::size_t count, std::size_t all)
{
    if (all == 0) {
        return {};
    }
    const auto n = static_cast<double>(all);
    const double p = static_cast<double>(count) / n;
    const double rule_of_three = std::min(1.0, 3.0 / n);
    if (count == 0) {
        return {0.0, 0.0, rule_of_three};
    }
    if (count >= all) {
        return {1.0, 1.0 - rule_of_three, 1.0};
    }
    constexpr double kZ2 = kZ * kZ;
    const double middle = (p + kZ2 / (2.0 * n)) / (1.0 + kZ2 / n);
    const double half = kZ / (1.0 + kZ2 / n) * std::sqrt(p * (1.0 - p) / n + kZ2 / (4.0 * n * n));
    return {p, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace jink::sim
