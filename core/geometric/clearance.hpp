// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometric/curve.hpp"
#include "core/geometric/planner.hpp"

// What a curve touches. Private to this room.

namespace jink::geometric::detail {

/// Axis-aligned box about the start of the manoeuvre [m].
struct Extent {
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
};
[[nodiscard]] Extent extent_of(const Curve& curve) noexcept;

struct Verdict {
    CandidateStatus status = CandidateStatus::available;
    world::ThreatRef hit;
};

/// Threats, obstacles and bounds of a problem as the curves of one call of `collect` meet them.
///
/// Memory: 8 bytes per track and obstacle.
class Clearance {
public:
    /// All three outlive this.
    Clearance(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept;

    /// Takes in what a curve within `reach` that lasts no longer than `longest` can meet; the rest is out of reach.
    /// Call before `check`, for several curves at once or for each. Support calls for obstacles about the start.
    /// O(threats + obstacles).
    void collect(const Extent& reach, Seconds longest, WorkBudget& budget) noexcept;

    /// Volumes that moving threats sweep end at this time: the longest candidate's duration (swept mode).
    void sweep_until(Seconds t_max) noexcept { t_max_ = t_max; }
    /// When the volume of threat `index` ends: then, or at the collision point for the main threat where the settings
    /// say so.
    [[nodiscard]] Seconds sweep_end(std::size_t index) const noexcept;

    /// First cause in the order airspace, static threats, obstacles, moving threats, each by index. When the budget
    /// runs out the verdict is not_evaluated. O(points * (threats + obstacles)).
    [[nodiscard]] Verdict check(const Curve& curve, WorkBudget& budget) const noexcept;

private:
    /// A static or moving sphere, or an obstacle with the sphere's closed form.
    struct Ball {
        Vec3 position;  ///< relative to the start
        Vec3 velocity;
        Vec3 half;  ///< own box as this one meets it
        float radius = 0.0F;
        float rate = 0.0F;
        float acceleration = 0.0F;

        [[nodiscard]] float radius_at(Seconds t) const noexcept
        {
            return radius + t * (rate + 0.5F * acceleration * t);
        }
    };
    enum class Kind : std::uint8_t { static_ball, obstacle_ball, solid, moving_ball };
    /// What is within reach, in the order of checking.
    struct Item {
        Kind kind = Kind::solid;
        std::uint16_t index = 0;  ///< of the threat or obstacle
        float shrunk = 0.0F;      ///< by the escape rule, at t = 0
    };

    [[nodiscard]] Ball ball_of(std::size_t threat) const noexcept;
    [[nodiscard]] Ball ball_of(const geometry::Shape& shape) const noexcept;
    void add_ball(Kind kind, std::size_t index, const Ball& ball, const Extent& reach, Seconds longest) noexcept;
    void add_threats(const Extent& reach, Seconds longest, bool moving) noexcept;
    void add_obstacle(std::size_t index, const Extent& reach, WorkBudget& budget) noexcept;
    [[nodiscard]] float shrink_to_clear(float start_margin) const noexcept;
    [[nodiscard]] float shrink_at(float shrunk, Seconds t) const noexcept;
    [[nodiscard]] int escape_parts(Seconds duration) const noexcept;
    [[nodiscard]] bool leaves(const Curve& curve, std::size_t i, const geometry::Shape& shape, float shrunk,
                              WorkBudget& budget) const noexcept;
    [[nodiscard]] world::ThreatKind left_airspace(const Curve& curve) const noexcept;
    [[nodiscard]] bool touches(const Curve& curve, const Ball& ball, float shrunk) const noexcept;
    [[nodiscard]] bool touches_swept(const Curve& curve, const Extent& extent, const Ball& ball,
                                     Seconds end) const noexcept;
    [[nodiscard]] bool touches(const Curve& curve, const Extent& extent, const geometry::Shape& shape, float shrunk,
                               WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches(const Curve& curve, const Extent& extent, const Item& item,
                               WorkBudget& budget) const noexcept;

    const Problem& problem_;
    const Settings& settings_;
    const Vec3 half_;
    Seconds t_max_ = 0.0F;
    StaticVector<Item, kMaxTracks + kMaxObstacles> items_;
};

}  // namespace jink::geometric::detail
