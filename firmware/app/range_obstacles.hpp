// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/obstacle_table.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/link/messages.hpp"

// What range sensors see becomes obstacles about `own`, the own place at that time (range_return.hpp), which expire
// OBS_KEEP after their arrival. Ids: scans 0x01000000, single readings 0x02000000 on. Each refusal is counted in the
// table.

namespace jink::app {

/// A level scan: each sector that sees something becomes obstacles, each that sees nothing removes those of its
/// direction; sectors without a reading leave theirs to expire, and so does a sensor that has turned away.
/// O(sectors * parts * kMaxObstacles).
void place_scan(const link::RangeScan& scan, const Vec3& own, const Configuration& c,
                world::ObstacleTable& table) noexcept;

/// The reading of a sensor that looks down: its ground, not an obstacle. O(1).
[[nodiscard]] bool sees_ground(const link::RangeReading& reading) noexcept;

/// A single reading that does not look down. O(parts * kMaxObstacles).
/// @return false: refused, neither level nor narrow enough (kWidestSteep)
[[nodiscard]] bool place_reading(const link::RangeReading& reading, const Vec3& own, const Configuration& c,
                                 world::ObstacleTable& table) noexcept;

}  // namespace jink::app
