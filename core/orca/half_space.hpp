// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/vec3.hpp"

// What a velocity has to keep to, in the space of the own velocities [m/s], world frame.

namespace jink::orca {

/// Which constraints give way first: the last ones (Alejo 7.1 leaves it open).
enum class Level : std::uint8_t {
    limits,     ///< what the vehicle can fly; never gives way
    obstacles,  ///< static obstacles
    conflict,   ///< the conflict regions of other vehicles
    warning,    ///< their warning regions
};

/// The velocities x with normal . x >= offset.
struct HalfSpace {
    Vec3 normal = Vec3::UnitZ();  ///< unit length, into what is allowed
    float offset = 0.0F;          ///< [m/s]
    Level level = Level::limits;
    std::uint16_t source = 0;  ///< index of the neighbour or of the obstacle it comes from
    float yield = 1.0F;        ///< > 0: how fast it gives way when the level is relaxed, beside the others

    /// How far `velocity` is on the wrong side [m/s]; negative: on the right one.
    [[nodiscard]] float violation(const Vec3& velocity) const noexcept { return offset - normal.dot(velocity); }
};

/// The velocities no farther than `radius` from `centre` [m/s].
struct Sphere {
    Vec3 centre = Vec3::Zero();
    float radius = 0.0F;
};

}  // namespace jink::orca
