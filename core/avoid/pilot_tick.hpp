// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/pilot.hpp"

// What the sources of Pilot share and nobody else sees.

namespace jink::avoid {

/// Distance from the leg [m], or from the route. O(1), O(segments).
[[nodiscard]] float cross_track(const world::Situation& situation) noexcept;

/// Flight along the leg, beside it where the vehicle is.
struct Beside {
    Vec3 off = Vec3::Zero();      ///< from the leg's line to the vehicle [m]
    Vec3 command = Vec3::Zero();  ///< [m/s]
    float left = 0.0F;            ///< until abeam of the leg's end [m]
};

/// A leg without a length gives zeros. With a route: along its tangent abeam of the vehicle, left until its end. O(1),
/// O(segments).
[[nodiscard]] Beside beside_leg(const world::Situation& situation) noexcept;

/// Whether the vehicle is as near to its leg as bounds let it be, which take `taken` [m/s] off its way there and leave
/// `left` [m/s]: above or below it, at the keep-in radius, or where floor or ceiling leave next to nothing. The last is
/// a steep leg: above its continuation below the floor the vehicle stays beside the leg. O(1), O(segments).
[[nodiscard]] bool is_held(const world::Situation& situation, const Vec3& taken, const Vec3& left,
                           float on_leg) noexcept;

/// The same situation for a vehicle with `extra` more to every side.
struct Wider {
    vehicle::VehicleLimits limits;
    world::Situation situation;

    Wider(const world::Situation& s, float extra) noexcept
        : limits(vehicle::widened(s.limits, extra)), situation(world::with_limits(s, limits))
    {
    }
    Wider(const Wider&) = delete;
    Wider& operator=(const Wider&) = delete;
};

struct Pilot::Tick {
    const world::Situation& s;
    const world::Situation* other = nullptr;  ///< with the other nominal path; null without one
    bool in_control = false;
    const Ladder& ladder;
    WorkBudget budget;
    world::Way way;
    Guidance out;
    bool wide_clear = false;
    Vec3 taken = Vec3::Zero();  ///< off the velocity of the way back, by bounds of the airspace [m/s]
    bool ran_out = false;       ///< of work, planning or altogether
};

}  // namespace jink::avoid
