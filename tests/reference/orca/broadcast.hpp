// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/orca/prediction.hpp"

// Neighbours that broadcast their last commands, as in the published flights (Alejo 8.4, G-ORCA 11.4). No message
// received by the product carries these commands.

namespace jink::orca {

/// Commands that a broadcast carries. Each holds until the next command. If a vehicle omits commands close to the
/// previous one, eight cover half a second. Times that they do not cover are predicted at the measured velocity.
inline constexpr std::size_t kMaxBroadcastCommands = 8;

/// Another vehicle's broadcast state, all times on our clock (G-ORCA 11.4).
///
/// BROADCAST: with its last commands. CONST_VEL: without any. REPLICATE, its commands worked out instead of heard, is
/// this as well: a CommandRing of its own for each neighbour, filled by solving for it with `preferred`, and `predict`
/// by that ring.
struct Broadcast {
    std::uint16_t id = 0;
    vehicle::VehicleState state;    ///< stamp, position, velocity
    Vec3 preferred = Vec3::Zero();  ///< its preferred velocity without neighbours [m/s]
    VelocityLoop loop;              ///< its own velocity loop
    float max_speed = 1.5F;         ///< [m/s], > 0
    float max_acceleration = 2.0F;  ///< [m/s2], > 0
    StaticVector<IssuedCommand, kMaxBroadcastCommands> commands;
};

/// Rules for the age of a broadcast (G-ORCA 11.4; the velocity error is an addition).
struct AgeRules {
    Seconds stale = 1.0F;         ///< older: the neighbour counts as not cooperative
    Seconds lost = 3.0F;          ///< older: the neighbour is static at its position predicted for this age, and its
                                  ///< sphere grows
    float velocity_error = 0.1F;  ///< of the broadcast velocity [m/s], >= 0
    float most = 3.0F;            ///< bound of the inflation until lost [m]
};

enum class Freshness : std::uint8_t {
    fresh,  ///< cooperative if the broadcast says so
    stale,  ///< avoid it alone: a reaction weight of 1 (NEIGHBOUR_STALE)
    lost,   ///< also may be anywhere within its sphere
    gone,   ///< to be dropped and reported (NEIGHBOUR_LOST): its sphere exceeds the checked range
};

struct PredictedNeighbour {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]; 0 if lost
    float inflation = 0.0F;        ///< to be added to the required distance [m]
    Freshness freshness = Freshness::fresh;
};

/// Growth of the required distance with age: velocity_error * age + max_acceleration * age^2 / 2, bounded. Once lost,
/// it grows by max_speed per second, without bound. Non-decreasing in age. An age below 0 counts as 0. O(1).
[[nodiscard]] float inflation_of(Seconds age, float max_speed, float max_acceleration, const AgeRules& rules) noexcept;

/// A neighbour at time `at`. A lost neighbour is static at its predicted position of age rules.lost. Because the
/// inflation is bounded, its sphere is then smaller than its reachable set.
///
/// @param reach  within which neighbours matter [m]: required distance + horizon * both greatest speeds (G-ORCA 3.8)
/// O(kMaxBroadcastCommands).
[[nodiscard]] PredictedNeighbour predict_neighbour(const Broadcast& heard, TimePoint at, const AgeRules& rules,
                                                   float reach) noexcept;

}  // namespace jink::orca
