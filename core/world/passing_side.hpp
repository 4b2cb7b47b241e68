// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/world.hpp"

// On which side two vehicles that avoid each other pass. Each applies the same rule to its own picture, without a
// message: the sides come out opposite.

namespace jink::world {

/// To the right of the line of sight `offset`, level; where it points straight up or down: across it, in the plane of
/// y and z. Unit length. side(-offset) = -side(offset), by the bit. |offset| > 0. O(1).
[[nodiscard]] Vec3 side(const Vec3& offset) noexcept;

/// Of two vehicles that know each other's id, whether the own one is the one to climb: the smaller id climbs.
[[nodiscard]] constexpr bool climbs(TrackId own, TrackId other) noexcept { return own < other; }

/// The side on which the own vehicle passes `threat`: to the right, and above or below by the order of the ids where
/// both vehicles know them (Situation::own_id, TrackSource::datalink). Unit vector, across the line of sight where ids
/// are unknown; zero for threats that do not avoid us, and at the same place. The other vehicle's is the opposite one:
/// exactly where both pictures agree, within the angle between the two lines of sight otherwise. It does not depend on
/// velocities, so an old report turns it by no more than the line of sight. O(1).
[[nodiscard]] Vec3 passing_side(const Situation& situation, const Threat& threat) noexcept;

}  // namespace jink::world
