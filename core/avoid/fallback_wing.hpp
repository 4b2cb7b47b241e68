// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/fallback.hpp"

// Fallbacks of a fixed wing, which cannot stop. Private to this module.

namespace jink::avoid::detail {

/// A fallback that was chosen stays unless another is better by this much [m].
inline constexpr float kFallbackHysteresis = 0.1F;

/// A command at cruise speed: `climb` [m/s] of it upwards, the rest on a course (counter-clockwise from `ahead`).
[[nodiscard]] Vec3 command_on(const Vec3& ahead, float course, float climb,
                              const vehicle::VehicleLimits& limits) noexcept;

/// Least separation of a fixed wing that turns to the command's course at its lateral limit, and flies on. Without the
/// units for it, contact. O(setpoints + points * threats).
[[nodiscard]] float wing_margin(const world::Situation& s, const Vec3& command, Seconds horizon,
                                const Settings& settings, WorkBudget& budget) noexcept;

/// choose_fallback() of a fixed wing.
[[nodiscard]] Fallback wing_fallback(const world::Situation& s, const Fallback* previous, const Settings& settings,
                                     WorkBudget& budget) noexcept;

}  // namespace jink::avoid::detail
