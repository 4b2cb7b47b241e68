// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/guidance.hpp"
#include "firmware/app/picture.hpp"
#include "firmware/app/text.hpp"
#include "firmware/link/link.hpp"

namespace jink::app {

/// COLLISION for the conflict of a guidance. Ids: of tracks and obstacles their own, of closed areas 0x04000000 on.
/// @param flying  the manoeuvre that is flown or offered; may be null
[[nodiscard]] link::CollisionWarning warning_of(const avoid::Guidance& guidance, const Picture& picture,
                                                const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                                bool in_control, const world::Manoeuvre* flying) noexcept;

/// The text of a new conflict, which the guidance has.
[[nodiscard]] Text text_of(const avoid::Guidance& guidance) noexcept;

/// The text of an alert of aircraft, not Alert::none.
[[nodiscard]] Text text_of_alert(world::Alert alert) noexcept;

/// Which method's answer is flown or offered, of how many checked ones it is the best, and what it costs (new in this
/// guidance).
[[nodiscard]] Text text_of_choice(const avoid::Guidance& guidance) noexcept;

}  // namespace jink::app
