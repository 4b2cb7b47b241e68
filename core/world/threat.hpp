// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/geometry/shape.hpp"
#include "core/world/cylinder.hpp"

namespace jink::world {

struct Track;

enum class ThreatKind : std::uint8_t { none, track, obstacle, floor, ceiling, keep_in, cylinder };

/// Where a threat comes from: the kind and, for tracks, obstacles and cylinders, the index in Surroundings.
struct ThreatRef {
    ThreatKind kind = ThreatKind::none;
    std::uint16_t index = 0;
    friend constexpr bool operator==(const ThreatRef&, const ThreatRef&) noexcept = default;
};

/// A radius as a polynomial of time.
struct Growth {
    float radius = 0.0F;        ///< at time 0 [m]
    float rate = 0.0F;          ///< [m/s]
    float acceleration = 0.0F;  ///< [m/s2]

    [[nodiscard]] float at(Seconds t) const noexcept { return radius + t * (rate + 0.5F * acceleration * t); }
    /// The same polynomial, counted from `lead` on.
    [[nodiscard]] Growth from(Seconds lead) const noexcept
    {
        return {at(lead), rate + acceleration * lead, acceleration};
    }
};

/// Shape of a threat, before it grows.
enum class ThreatForm : std::uint8_t {
    point,     ///< swept up and down by `half_height`: grown, a sphere or an upright capsule
    solid,     ///< `solid`, at rest
    cylinder,  ///< `cylinder`, upright and flat-ended, in level motion
    floor,     ///< all that is below `position`
    ceiling,   ///< all that is above `position`
    keep_in,   ///< all that is farther than `level_radius` from the upright line through `position`
};

/// Something that must be kept clear of, in the form in which everybody meets it: a shape in straight motion that grows
/// with what is not known of it. World frame, times from Situation::now on. Contact is contact of the own box with the
/// grown shape; the own box is no part of it. 64 bytes on a 32-bit target.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): one of the three pointers is set, which stands for all
struct Threat {
    ThreatRef ref;
    ThreatForm form = ThreatForm::point;
    bool grows = false;       ///< with time
    bool reciprocal = false;  ///< it does half of the avoidance
    bool doubted = false;     ///< its velocity may have changed since it was reported: `doubt`
    float half_height = 0.0F;
    Vec3 position = Vec3::Zero();  ///< at time 0 [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    Growth growth;                 ///< own uncertainty of position included
    Seconds growth_begins = 0.0F;  ///< a stamp ahead of now: the threat grows from there on
    union {
        float level_radius = 0.0F;  ///< of keep_in [m]
        float doubt;                ///< where `doubted`: its velocity may be off by so much [m/s], >= 0
    };
    union {
        float slack = 0.0F;  ///< of an obstacle: what `growth` holds beside its shape and the own uncertainty [m]
        Seconds doubt_ends;  ///< where `doubted`: from then on what it does depends on both, >= 0
    };
    union {  ///< by `form`; a point is an obstacle's or a track's, by `ref.kind`
        const geometry::Shape* solid = nullptr;
        const Cylinder* cylinder;  ///< where it is at time 0
        const Track* track;        ///< of a ThreatSet; null where a point is made without one
    };

    /// By how much the shape has grown at time `t` >= 0 [m].
    [[nodiscard]] float radius_at(Seconds t) const noexcept
    {
        if (!grows) {
            return growth.radius;
        }
        const float grown = growth.at(std::max(t - growth_begins, 0.0F));
        return doubted ? grown + doubt * std::min(t, doubt_ends) : grown;
    }
    /// Its growth from time `lead` >= 0 on, without its doubt; else never below `radius_at` where the threat grows only
    /// later. The final check counts the doubt.
    [[nodiscard]] Growth growth_from(Seconds lead) const noexcept
    {
        return grows ? growth.from(std::max(lead - growth_begins, 0.0F)) : growth;
    }
    [[nodiscard]] Vec3 position_at(Seconds t) const noexcept { return position + velocity * t; }
    /// The point of its upright axis that is nearest in height to `height` at time `t`.
    [[nodiscard]] Vec3 nearest_in_height(Seconds t, float height) const noexcept
    {
        const Vec3 centre = position_at(t);
        return {centre.x(), centre.y(), std::clamp(height, centre.z() - half_height, centre.z() + half_height)};
    }
    /// The own box as this threat meets it: a box against an upright capsule is the taller box against the capsule's
    /// sphere; exact.
    [[nodiscard]] Vec3 box_against(const Vec3& half_extents) const noexcept
    {
        return half_extents + half_height * Vec3::UnitZ();
    }
    [[nodiscard]] bool is_bound() const noexcept { return form >= ThreatForm::floor; }
};

}  // namespace jink::world
