// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/work_budget.hpp"
#include "core/world/world.hpp"

// Vehicles that avoid each other keep one way out in common: all of them stop.

namespace jink::avoid {

/// The command that is flown in place of `wanted`, so that the own vehicle and all cooperative tracks can still stop
/// without contact: `wanted` where it leaves that, else so much of it, in eighths, as does; where none does, a stop.
/// A part of `wanted` is never faster than `fastest` [m/s], which does not limit `wanted` flown whole: the age of
/// reports rises and falls, and what is clear with it; a command that has been held back comes up again no faster than
/// the vehicle can.
///
/// The own vehicle flies a command for `ahead` and FlightRules::latency, and stops then. A track flies on for the
/// latency, or for `ahead` as well, and stops then: both have to be clear. In the age of its report and the latency it
/// may have changed its velocity by what the own vehicle could in that time, or by more where it has shown more
/// (world::unheard_acceleration); it flies no faster than the own cruise speed, or than it was reported to. Level and
/// vertical deceleration by themselves, k_sigma of places and velocities and the own loop's lag included; the lag of a
/// track's loop is left to the safety box.
///
/// Two vehicles that command no more than this never touch, as long as both are steered so, fly as the vehicle model
/// says, and hear each other's reports: of their two newest commands the later one was found clear of all that the
/// earlier one may lead to; and one who finds none that is clear stops, which the other one has counted on. So do any
/// number of vehicles. What this assumes: docs/guides/common_stop.md.
///
/// A vehicle that stands where not even that is clear of a track leaves its reach at 0.3 m/s, else all would stand for
/// ever. One that moves flies a `wanted` that `evades` (a manoeuvre's, or the fallback's) where control came too late:
/// a stop is not clear of a track even if that one has flown as reported since and stops as well. Then `wanted` has to
/// be clear of all tracks that a stop is clear of, and to come less near to the others. `wanted` where stopping is not
/// clear of anything else and no better than `wanted` there; and for a fixed wing, which cannot stop. Without budget: a
/// stop. O(tracks), six times for each track that slows the vehicle down.
[[nodiscard]] Vec3 stoppable_command(const world::Situation& situation, const Vec3& wanted, float fastest,
                                     WorkBudget& budget, bool evades = false, Seconds ahead = 0.0F) noexcept;

}  // namespace jink::avoid
