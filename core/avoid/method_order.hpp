// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/state_machine.hpp"

namespace jink::avoid {

/// Which of the methods are asked, in their order.
struct MethodOrder {
    std::size_t from = 0;  ///< the first to be asked
    std::size_t count = 0;
    bool backwards = false;

    [[nodiscard]] std::size_t method(std::size_t i) const noexcept { return backwards ? from - i : from + i; }
};

/// Tracks and obstacles whose surface is nearer than `radius` [m] to the centre of the own box; solids that are no
/// balls as the balls about them. O(tracks + obstacles).
[[nodiscard]] std::size_t count_near(const world::Situation& situation, float radius) noexcept;

/// Of `methods` >= 1. O(tracks + obstacles) with Settings::clutter, else O(1).
[[nodiscard]] MethodOrder method_order_of(std::size_t methods, const world::Situation& situation,
                                          const Settings& settings) noexcept;

}  // namespace jink::avoid
