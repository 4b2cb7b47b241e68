// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "core/geometric/extent.hpp"
#include "core/geometric/planner.hpp"

// Contacts of a curve. Private to this module.

namespace jink::geometric::detail {

[[nodiscard]] bool is_moving(const world::Threat& threat) noexcept;

/// Where a threat is, and by how much it has grown, when the manoeuvre begins.
struct AtStart {
    geometry::Motion motion;
    world::Growth growth;
};
[[nodiscard]] AtStart at_start(const Problem& problem, const world::Threat& threat) noexcept;

/// How far a curve and a sphere are from meeting, by bounds on their speeds: segments are passed over while nothing can
/// happen. Never hides what the exact test would find: the bounds leave more clearance than that test's rounding takes.
class MotionBound {
public:
    /// Of a curve whose coordinates change no faster than `fastest` [m/s] and that lasts `duration`, and a sphere whose
    /// coordinates change no faster than `sphere_fastest` and that is never larger than `largest`.
    MotionBound(float fastest, float sphere_fastest, float largest, Seconds duration) noexcept
        : closing_(fastest + sphere_fastest), largest_(largest), scale_(1.0F + closing_ * duration + largest)
    {
    }

    /// Samples where the sphere's centre is from the curve, at `t`.
    void look(const Vec3& apart, const Vec3& half, Seconds t) noexcept
    {
        const Vec3 size = apart.cwiseAbs();
        looked_at_ = t;
        room_ = (size - half).maxCoeff() - largest_ - kShare * (scale_ + size.maxCoeff() + half.maxCoeff());
    }
    /// No contact from the last look until `t`.
    [[nodiscard]] bool lasts_until(Seconds t) const noexcept { return (t - looked_at_) * closing_ < room_; }

private:
    /// Of the lengths involved, for rounding: a hundred times what the exact test allows itself.
    static constexpr float kShare = 1e-4F;

    float closing_;
    float largest_;
    float scale_;
    Seconds looked_at_ = 0.0F;
    float room_ = -1.0F;
};

/// Some of the threats of a problem, by index.
using Selection = std::array<bool, kMaxProblemThreats>;

class Planes;

struct Verdict {
    CandidateStatus status = CandidateStatus::available;
    world::ThreatRef hit;
};

/// Threats, obstacles and bounds of a problem as the curves of one call of `collect` meet them.
///
/// Memory: 9 bytes per threat.
class Clearance {
public:
    /// All three outlive this.
    Clearance(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept;

    /// Takes in what a curve within `reach` that lasts no longer than `longest` can meet; the rest is out of reach.
    /// Call before `check`, for several curves at once or for each. Support calls for obstacles about the start.
    /// O(threats + obstacles).
    void collect(const Extent& reach, Seconds longest, WorkBudget& budget) noexcept;

    /// Moving threats, by index, that are checked apart from the others: see `check`. None until this is called.
    void defer(const Selection& threats) noexcept { deferred_ = threats; }

    /// Volumes that moving threats sweep end at this time: the longest candidate's duration (swept mode).
    void sweep_until(Seconds t_max) noexcept { t_max_ = t_max; }
    /// When the volume of a track ends: then, or at the collision point for the main threat where the settings say so.
    [[nodiscard]] Seconds sweep_end(const world::Threat& track) const noexcept;

    /// Solids that no closed form knows, of what was collected.
    [[nodiscard]] std::uint32_t solids() const noexcept;
    /// near: all but deferred threats.
    enum class Part : std::uint8_t { all, near, deferred };
    /// First cause in the order bounds, static threats, obstacles, moving threats, moving solids, cylinders, deferred
    /// threats, each by index. When the budget runs out the verdict is not_evaluated. O(points * (threats +
    /// obstacles)).
    [[nodiscard]] Verdict check(const Curve& curve, WorkBudget& budget, Part part = Part::all) const noexcept;

private:
    /// A static or moving sphere, or an obstacle with the sphere's closed form.
    struct Sphere {
        Vec3 position;  ///< relative to the start
        Vec3 velocity;
        Vec3 half;  ///< own box as this one meets it
        world::Growth growth;

        /// From point `i` of a curve.
        [[nodiscard]] Vec3 apart(const Curve& curve, std::size_t i) const noexcept
        {
            return curve.position(i) - (position + velocity * curve.t[i]);
        }
    };
    /// What is within reach, in the order of checking.
    struct Item {
        std::uint16_t index = 0;  ///< of the threat
        float shrunk = 0.0F;      ///< by the escape rule, at t = 0
    };

    /// An obstacle or a moving solid, where that was at t = 0.
    struct Solid {
        const geometry::Shape& shape;
        float shrunk = 0.0F;  ///< by the escape rule, at t = 0
        world::Growth growth;

        [[nodiscard]] bool grows() const noexcept { return growth.rate > 0.0F || growth.acceleration > 0.0F; }
    };

    /// Of the airspace, about the start, for the box's centre.
    struct Bounds {
        Vec3 home = Vec3::Zero();
        float floor = -std::numeric_limits<float>::infinity();
        float ceiling = std::numeric_limits<float>::infinity();
        float radius = std::numeric_limits<float>::infinity();
    };

    [[nodiscard]] std::uint16_t index_of(const world::Threat& threat) const noexcept
    {
        return static_cast<std::uint16_t>(&threat - problem_.threats.data());
    }
    [[nodiscard]] Sphere sphere_of(const world::Threat& threat) const noexcept;
    void add_sphere(const world::Threat& threat, const Extent& reach, Seconds longest) noexcept;
    enum class Which : std::uint8_t { at_rest, moving, deferred };
    void add_tracks(const Extent& reach, Seconds longest, Which which) noexcept;
    void add_obstacles(const Extent& reach, Seconds longest, bool moving, WorkBudget& budget) noexcept;
    void add_cylinders(const Extent& reach, Seconds longest) noexcept;
    [[nodiscard]] world::Cylinder kept_clear_of(const world::Threat& threat) const noexcept;
    void add_solid(const world::Threat& threat, WorkBudget& budget) noexcept;
    [[nodiscard]] Solid solid_of(const world::Threat& threat, float shrunk) const noexcept;
    [[nodiscard]] Sphere sphere_about(const world::Threat& solid) const noexcept;
    [[nodiscard]] bool is_solid(const Item& item) const noexcept
    {
        return problem_.threats[item.index].form == world::ThreatForm::solid;
    }
    [[nodiscard]] float shrink_to_clear(float start_margin) const noexcept;
    [[nodiscard]] float shrink_at(float shrunk, Seconds t) const noexcept
    {
        return shrunk > 0.0F ? std::max(0.0F, shrunk - problem_.rules.escape.speed * t) : 0.0F;
    }
    [[nodiscard]] int escape_parts(Seconds duration) const noexcept;
    [[nodiscard]] bool leaves(const View& view, std::size_t i, const Solid& solid, WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches_at_its_top(const View& view, const Planes& planes, const Solid& solid) const noexcept;
    [[nodiscard]] bool meets(const View& view, std::size_t i, std::size_t end, const Solid& solid,
                             WorkBudget& budget) const noexcept;
    [[nodiscard]] world::ThreatKind left_airspace(const Curve& curve) const noexcept;
    [[nodiscard]] static bool out_of(const Extent& reach, const Sphere& sphere, Seconds longest) noexcept;
    [[nodiscard]] bool is_out_of(const Extent& reach, const geometry::Shape& solid, float clearance) const noexcept;
    [[nodiscard]] static Bounds bounds_of(const Problem& problem, const Vec3& half) noexcept;
    [[nodiscard]] Verdict verdict_of(const Item& item) const noexcept;
    [[nodiscard]] bool is_sphere_out_of(const Extent& extent, const Item& item, Seconds duration) const noexcept;
    [[nodiscard]] bool touches(const Curve& curve, std::size_t i, const Sphere& sphere, float shrunk,
                               const Vec3& before, const Vec3& after, WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches_in_parts(const Curve& curve, std::size_t i, const Sphere& sphere, float shrunk,
                                        const Vec3& before, const Vec3& after, int parts,
                                        WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches(const Curve& curve, const Sphere& sphere, float shrunk,
                               WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches_swept(const Curve& curve, const Extent& extent, const Sphere& sphere, Seconds end,
                                     WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches(const View& view, const Solid& solid, WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches_moving_solid(const View& view, const Item& item, WorkBudget& budget) const noexcept;
    [[nodiscard]] bool is_cylinder_out_of(const Extent& extent, const world::Threat& threat, Seconds from,
                                          Seconds until) const noexcept;
    [[nodiscard]] bool touches_cylinder(const Curve& curve, const world::Threat& threat, float shrunk,
                                        WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches_cylinder(const Curve& curve, std::size_t i, const world::Threat& threat, float shrunk,
                                        WorkBudget& budget) const noexcept;
    [[nodiscard]] bool touches(const View& view, const Item& item, WorkBudget& budget) const noexcept;

    const Problem& problem_;
    const Settings& settings_;
    const Vec3 half_;
    const Bounds bounds_;
    Seconds t_max_ = 0.0F;
    const std::span<const world::Threat> tracks_;
    const std::span<const world::Threat> obstacles_;
    const std::span<const world::Threat> cylinders_;
    Selection deferred_{};
    StaticVector<Item, kMaxTracks + kMaxObstacles + kMaxMovingSolids + kMaxCylinders> items_;
    std::size_t near_items_ = 0;  ///< the deferred ones come after these
    bool needs_extent_ = false;   ///< some item is tested against a curve's extent
};

}  // namespace jink::geometric::detail
