// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/settings.hpp"
#include "core/world/world.hpp"

namespace jink::avoid {

/// Tracks and obstacles whose surface is nearer than `radius` [m] to the centre of the own box; solids that are no
/// spheres count as the spheres about them. O(tracks + obstacles).
[[nodiscard]] std::size_t count_near(const world::Situation& situation, float radius) noexcept;

/// The order for a situation: Settings::order, or Settings::order_in_clutter. O(tracks + obstacles) with
/// Settings::clutter, else O(1).
[[nodiscard]] const MethodOrder& order_for(const world::Situation& situation, const Settings& settings) noexcept;

}  // namespace jink::avoid
