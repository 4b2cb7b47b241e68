// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/time.hpp"
#include "core/world/cylinder.hpp"
#include "firmware/link/global_position.hpp"

namespace jink::link {

/// Closed volume or storm cell: an upright cylinder between two heights, at rest or in straight level motion.
struct Constraint {
    /// Where the volume was at `stamp`, relative to `about`, heights above it; without `about` in the autopilot's local
    /// frame (ENU).
    world::Cylinder cylinder;
    TimePoint stamp{};                                         ///< on the co-processor's clock
    TimePoint ends{std::numeric_limits<std::int64_t>::max()};  ///< the volume is open after this instant
    std::optional<GlobalPosition> about;
};

/// Constraints that one set may have over a link. A board keeps fewer apart (kMaxCylinders) and merges the rest.
inline constexpr std::size_t kMaxReportedConstraints = 8;

/// One constraint of a set as a link received it, and its sender.
struct ConstraintPart {
    Constraint constraint;   ///< empty if the set is empty (count 0)
    std::uint8_t set = 0;    ///< the sender's number of the set
    std::uint8_t index = 0;  ///< 0 ... count - 1; 0 if the count is 0
    std::uint8_t count = 0;  ///< constraints of the set, 0 ... 255
    std::uint8_t from_system = 0;
    std::uint8_t from_component = 0;
};

/// Result of receiving a part. The values are those on the wire.
enum class ConstraintResult : std::uint8_t {
    kept = 0,          ///< the set lacks other parts
    in_force = 1,      ///< the whole set is valid from now on
    malformed = 2,     ///< length, version, kind or index
    out_of_range = 3,  ///< non-finite, beyond the limits of world::is_valid, or not in the frame of the other parts
    too_many = 4,      ///< count above kMaxReportedConstraints
};

}  // namespace jink::link
