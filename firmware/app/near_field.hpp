// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/static_vector.hpp"
#include "core/world/world.hpp"
#include "firmware/link/sensor_bus.hpp"

namespace jink::app {

/// Sectors of the horizon, as ArduPilot's proximity boundary has them, centred on the nose: the nearest in each is
/// reported.
inline constexpr std::size_t kNearSectors = 8;
/// What is farther is nobody's business yet [m]: the reach of a good range finder.
inline constexpr float kNearReach = 50.0F;
/// What touches is said to be this far [m]: a receiver may take 0 for "no reading".
inline constexpr float kNearLeast = 0.1F;

using NearObjects = StaticVector<link::NearObject, kNearSectors>;

/// The nearest thing in each sector within kNearReach, from a vehicle taken for level.
///
/// @param own      position [m] and yaw count
/// @param tracks   at the same instant as `own`; each reaches k_sigma standard deviations beyond its radius
/// O(tracks + obstacles).
[[nodiscard]] NearObjects find_near(const vehicle::VehicleState& own, std::span<const world::Track> tracks,
                                    std::span<const world::Obstacle> obstacles, float k_sigma) noexcept;

}  // namespace jink::app
