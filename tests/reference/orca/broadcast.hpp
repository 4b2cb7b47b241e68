// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/orca/prediction.hpp"

// Neighbours that broadcast their last commands, as in the published flights (Alejo 8.4, G-ORCA 11.4). No message that
// a product receives carries these commands.

namespace jink::orca {

/// Commands that a broadcast carries. Each holds until the next one, so eight bridge half a second where a vehicle
/// leaves out those that hardly differ from the one before; what they do not cover is flown at the measured velocity.
inline constexpr std::size_t kMaxBroadcastCommands = 8;

/// What another vehicle says of itself, all times on our clock (G-ORCA 11.4).
///
/// BROADCAST: with its last commands. CONST_VEL: without any. REPLICATE, its commands worked out instead of heard, is
/// this as well: a CommandRing of its own for each neighbour, filled by solving for it with `preferred`, and `predict`
/// by that ring.
struct Broadcast {
    std::uint16_t id = 0;
    vehicle::VehicleState state;    ///< stamp, position, velocity
    Vec3 preferred = Vec3::Zero();  ///< what it would fly if it were alone [m/s]
    VelocityLoop loop;              ///< as it knows itself
    float max_speed = 1.5F;         ///< [m/s], > 0
    float max_acceleration = 2.0F;  ///< [m/s2], > 0
    StaticVector<IssuedCommand, kMaxBroadcastCommands> commands;
};

/// How far what was heard is believed (G-ORCA 11.4; the error of the velocity is ours).
struct AgeRules {
    Seconds stale = 1.0F;         ///< older: it is not counted on to do its half
    Seconds lost = 3.0F;          ///< older: it stands where it would be then, and its ball grows
    float velocity_error = 0.1F;  ///< of what is broadcast [m/s], >= 0
    float most = 3.0F;            ///< bound of the inflation of what is not lost [m]
};

enum class Freshness : std::uint8_t {
    fresh,  ///< cooperative if it says so
    stale,  ///< avoid it alone: a reaction weight of 1 (NEIGHBOUR_STALE)
    lost,   ///< and it may be anywhere within its ball
    gone,   ///< to be dropped, and told (NEIGHBOUR_LOST): its ball is larger than all that is looked at
};

struct PredictedNeighbour {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]; 0 where it is lost
    float inflation = 0.0F;        ///< to be added to the required distance [m]
    Freshness freshness = Freshness::fresh;
};

/// By how much the required distance grows with age: velocity_error * age + max_acceleration * age^2 / 2, bounded. Once
/// lost by max_speed a second more, without bound. Never smaller for an older report. An age below 0 counts as 0. O(1).
[[nodiscard]] float inflation_of(Seconds age, float max_speed, float max_acceleration, const AgeRules& rules) noexcept;

/// A neighbour at `at`. Once lost it stands where it would have been at rules.lost; the bound of the inflation makes
/// its ball smaller than all that it could reach by then.
///
/// @param reach  within which neighbours matter [m]: required distance + horizon * both greatest speeds (G-ORCA 3.8)
/// O(kMaxBroadcastCommands).
[[nodiscard]] PredictedNeighbour predict_neighbour(const Broadcast& heard, TimePoint at, const AgeRules& rules,
                                                   float reach) noexcept;

}  // namespace jink::orca
