// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace jink::sim {

/// A share with the limits of its two-sided 95 % confidence interval.
struct Share {
    double value = 0.0;
    double low = 0.0;
    double high = 1.0;
};

/// Share of `count` in `all`, with Wilson's score interval without continuity correction (Wilson 1927; method 3 of
/// Newcombe 1998). At 0 the upper limit is 3 / all instead, and at `all` the lower one 1 - 3 / all: the rule of three
/// (Hanley & Lippman-Hand 1983), which is one-sided, 95 %. If `all` is 0: share 0, limits 0 and 1.
///
/// @param count  0..all
[[nodiscard]] Share share_of(std::size_t count, std::size_t all);

/// Quantile of sorted values, linear between neighbours (type 7 of Hyndman & Fan 1996). @param share  0..1. `sorted` is
/// not empty. O(1).
template <class T>
[[nodiscard]] double quantile(const std::vector<T>& sorted, double share)
{
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(static_cast<double>(sorted[below]), static_cast<double>(sorted[above]),
                     at - static_cast<double>(below));
}

}  // namespace jink::sim
