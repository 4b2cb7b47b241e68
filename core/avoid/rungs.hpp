// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/pilot.hpp"

namespace jink::avoid {

/// Which of the methods are asked, in their order.
struct Rungs {
    std::size_t from = 0;  ///< the first to be asked
    std::size_t count = 0;
    bool backwards = false;

    [[nodiscard]] std::size_t method(std::size_t rung) const noexcept { return backwards ? from - rung : from + rung; }
};

/// Tracks and obstacles whose surface is nearer than `radius` [m] to the centre of the own box; solids that are no
/// balls as the balls about them. O(tracks + obstacles).
[[nodiscard]] std::size_t count_near(const world::Situation& situation, float radius) noexcept;

/// Of `methods` >= 1. O(tracks + obstacles) with Settings::clutter, else O(1).
[[nodiscard]] Rungs rungs_of(std::size_t methods, const world::Situation& situation, const Settings& settings) noexcept;

}  // namespace jink::avoid
