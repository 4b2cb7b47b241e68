// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/geometry/sweep.hpp"

// Airspace that is closed, and weather: an upright cylinder between two heights that may move (Gomola 6.5.3, 6.6.5).

namespace jink::world {

using Vec2 = Eigen::Vector2f;

struct Circle {
    Vec2 centre = Vec2::Zero();
    float radius = 0.0F;
};

/// A constraint as it is flown around. In a Situation `circle` is where it is at Situation::now, and it goes straight
/// on from there.
struct Cylinder {
    Circle circle;                 ///< at time 0 (world frame, east and north) [m]
    Vec2 velocity = Vec2::Zero();  ///< [m/s]
    float bottom = 0.0F;           ///< [m], world frame
    float top = 0.0F;              ///< [m], not below the bottom
    float margin = 0.0F;           ///< about the circle: soft, kept off where there is a way that does [m]
};

/// Finite, radius and speed within 100 km and 500 m/s, radius > 0, top >= bottom, margin >= 0. O(1).
[[nodiscard]] bool is_valid(const Cylinder& cylinder) noexcept;

/// Distance of a box of half extents `half` [m] about `position` from a cylinder's body, `t` seconds on [m]. Below 0
/// where they overlap: minus what separates them at least, up or down or sideways, the box counting as its centre line
/// does (the level depth is never above the radius). Never above the truth; below it by 1e-6 of the coordinates. O(1).
[[nodiscard]] float cylinder_distance(const Vec3& half, const Vec3& position, const Cylinder& cylinder,
                                      Seconds t) noexcept;

namespace detail {

/// A box and a cylinder in straight motion. Their distance (cylinder_distance) is a convex function of time, because
/// the level distance and the height above or below are, and a distance rises with both; and so it is with something
/// taken off that grows evenly. Its least value is closed in between the tangents at two instants, and their crossing
/// is never above it.
class CylinderApproach {
public:
    /// @param half    of the own box [m]
    /// @param own     position at the beginning
    /// @param cylinder  where it is `start` seconds before the beginning
    /// @param outset  by so much the body is larger at the beginning [m], below 0: smaller; and it grows by
    /// @param growth  so much [m/s]
    CylinderApproach(const Vec3& half, const geometry::Motion& own, const Cylinder& cylinder, Seconds start,
                     float outset, float growth) noexcept;

    /// Distance and its slope [m/s] `t` seconds after the beginning.
    struct Look {
        float value = 0.0F;
        float slope = 0.0F;
    };
    [[nodiscard]] Look look(Seconds t) const noexcept;

    /// Least distance within [0, span], never above the truth (see cylinder_distance), below it by 2e-4 m where fewer
    /// than kTurns instants do, which they do but for distances of kilometres. Distances not below `enough` are not
    /// distinguished. A budget that runs out: -kNoBudget. O(kTurns).
    [[nodiscard]] geometry::Approach least(Seconds span, float enough, WorkBudget& budget) const noexcept;
    static constexpr float kNoBudget = 1e9F;
    static constexpr int kTurns = 24;

    /// First contact within [0, until], given that there is contact at `until`; never later than the true one, and
    /// before it by until / 2^16 at most. A budget that runs out: 0. O(1).
    [[nodiscard]] Seconds first_contact(Seconds until, WorkBudget& budget) const noexcept;

private:
    Vec3 half_;
    Vec2 gap_;      ///< from the box to the cylinder's centre [m]
    Vec2 closing_;  ///< [m/s]
    float radius_;
    float height_;  ///< of the own centre [m]
    float climb_;   ///< [m/s]
    float bottom_;  ///< lowest height of the own centre with contact [m]
    float top_;     ///< and highest
    float outset_;
    float growth_;
};

}  // namespace detail
}  // namespace jink::world
