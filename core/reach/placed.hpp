// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "core/base/time.hpp"
#include "core/reach/reach_set.hpp"

namespace jink::reach {

/// A reach set placed in the world: a level grid at the vehicle's position, its x axis along the vehicle's course.
struct Placed {
    const ReachSet* set = nullptr;
    Vec3 origin = Vec3::Zero();  ///< [m]
    float cosine = 1.0F;         ///< of the course, counter-clockwise from east
    float sine = 0.0F;
    float unit = 1.0F;         ///< length of a movement [m]
    Seconds period = 1.0F;     ///< and its duration
    bool upside_down = false;  ///< the set is of the mirrored root: its z points down

    [[nodiscard]] Vec3 to_world(const Vec3& point) const noexcept
    {
        const float z = upside_down ? -point.z() : point.z();
        return origin + unit * Vec3(cosine * point.x() - sine * point.y(), sine * point.x() + cosine * point.y(), z);
    }
    [[nodiscard]] Vec3 to_set(const Vec3& world) const noexcept
    {
        const Vec3 d = (world - origin) / unit;
        return {cosine * d.x() + sine * d.y(), -sine * d.x() + cosine * d.y(), upside_down ? -d.z() : d.z()};
    }
    [[nodiscard]] Vec3 node(std::size_t node) const noexcept { return to_world(set->position_of(node)); }
    /// Time at which the vehicle is at a node.
    [[nodiscard]] Seconds time(std::size_t node) const noexcept
    {
        return period * static_cast<float>(set->depth[node]);
    }
    /// Largest distance of a movement from its chord [m].
    [[nodiscard]] float bulge() const noexcept
    {
        // An arc of length 1 that turns by `a` bulges by (1 - cos(a / 2)) / a < a / 8; both turns add up.
        return unit * 0.125F * std::hypot(set->step.pitch, set->step.yaw) * 1.01F + unit * kPositionUnit;
    }
};

}  // namespace jink::reach
