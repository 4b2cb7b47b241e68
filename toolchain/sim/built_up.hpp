// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// A random built-up area, seen by a LiDAR alone.
///
/// A level leg of 160 m in a random direction, 12, 15 or 20 m above the ground. 2 to 6 static boxes, which may overlap:
/// half extents 2 to 12 m, from the ground to 2 to 20 m above the leg. The first one is across the leg; the centres of
/// the others lie within 14 m of the leg. The flight ends at the goal or after 150 s. Either stack. The same seed gives
/// the same scenario on every machine.
///
/// A level path past all boxes with a clearance of 5 m always exists within 60 m of the leg: the boxes end at least
/// 13 m from both ends of the leg, and within 34 m of the leg.
[[nodiscard]] Scenario built_up_area(std::uint64_t seed);

}  // namespace jink::sim
