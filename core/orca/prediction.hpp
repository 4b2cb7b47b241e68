// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/orca/command_ring.hpp"
#include "core/vehicle/vehicle.hpp"

// Where vehicles are when a new command begins to act. A plan that is made from what was measured dances (Alejo 8.4:
// half a second of delay, found by the flights of 8.3): the commands that are on their way have to be flown first.

namespace jink::orca {

/// How a vehicle follows its commands.
struct VelocityLoop {
    Seconds act = 0.0F;  ///< from issuing a command to its first effect, >= 0 (T_act)
    Seconds lag = 0.0F;  ///< time constant of the velocity loop, >= 0 (T_v); 0: at once
};

struct Predicted {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    bool clipped = false;          ///< the commands do not cover all of the time: the measured velocity was held there
};

/// Where a vehicle is at `at`: from the measured state on, each command flown for as long as it acts before `at`
/// (G-ORCA 11.3). Of its own accord for `at` = now + loop.act; for neighbours at the time that theirs are wanted.
///
/// * No command known that acts at the state's stamp: the measured velocity holds until the first one does, and
///   `clipped` says so (DELAY_CLIPPED).
/// * Past the last command that one holds on.
/// * `at` before the stamp: back along the measured velocity.
///
/// @param measured  stamp, position, velocity, finite; the rest is not used
/// @param issued    in the order of their times
/// Accuracy: exact for a vehicle that is as `loop` says; rounding below 1e-4 m within 100 m and 2 s (property tests).
/// O(commands).
[[nodiscard]] Predicted predict(const vehicle::VehicleState& measured, const CommandRing& issued,
                                const VelocityLoop& loop, TimePoint at) noexcept;

}  // namespace jink::orca
