// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/state_machine.hpp"

// Private to the sources of StateMachine.

namespace jink::avoid {

/// Distance from the route [m]. O(segments).
[[nodiscard]] float cross_track(const world::Situation& situation) noexcept;

/// Flight parallel to the route from where the vehicle is, along the tangent abeam.
struct ParallelOffset {
    Vec3 off = Vec3::Zero();      ///< from the tangent to the vehicle [m]
    Vec3 command = Vec3::Zero();  ///< [m/s]
    float left = 0.0F;            ///< until abeam of the route's end [m]
};

/// A route without a length gives zeros. O(segments).
[[nodiscard]] ParallelOffset parallel_offset(const world::Situation& situation) noexcept;

/// Whether the vehicle is as near to its leg as the bounds of the airspace let it be. Bounds take `removed` [m/s] off
/// its velocity back and leave `left` [m/s]. True above or below the leg, at the keep-in radius, or where floor or
/// ceiling leave next to nothing: above the continuation of a steep leg below the floor. O(segments).
[[nodiscard]] bool is_held_by_bounds(const world::Situation& situation, const Vec3& removed, const Vec3& left,
                                     float on_leg) noexcept;

/// Only the sign of a margin is asked for.
inline constexpr world::Cutoff kSignAlone{0.0F, 0.0F, {}};

/// Whether the conflict is with traffic: traffic that stands may move on. O(1).
[[nodiscard]] inline bool is_traffic(const world::Conflict& conflict) noexcept
{
    return conflict.threat.kind == world::ThreatKind::track;
}

struct StateMachine::Tick {
    const world::Situation& s;
    const world::Situation* other = nullptr;  ///< with the other nominal path; null without one
    bool in_control = false;
    const Planning& planning;
    WorkBudget budget;        ///< of the mandatory part
    std::uint32_t slice = 0;  ///< left for planning [work units]
    world::Way nominal;
    Guidance out;
    Vec3 removed = Vec3::Zero();         ///< off the velocity back to the leg, by bounds of the airspace [m/s]
    std::optional<float> back_margin{};  ///< of the flight back to the nominal path, once it is checked [m]
    bool ran_out = false;                ///< of work units, planning or altogether
    bool planned = false;                ///< a plan was asked for: in slices, this update's has been made
};

}  // namespace jink::avoid
