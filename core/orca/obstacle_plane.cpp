// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/obstacle_plane.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/finite.hpp"
#include "core/orca/limits.hpp"
#include "core/orca/obstacle_view.hpp"

namespace jink::orca {

namespace {

/// Velocities that differ by less are the same to the programs that choose among them [m/s].
constexpr float kSameVelocity = 1e-5F;

/// How much of a stretched length may be the physical one times this.
float most_stretch(const Envelope& envelope) noexcept { return std::max(1.0F, envelope.stretch); }

/// Speed towards an obstacle `margin` away that is bounded by `braking` [m/s2], both in the stretched space.
float braking_bound(float margin, float closing, float braking, const ObstacleSettings& settings) noexcept
{
    return std::sqrt(2.0F * braking * std::max(0.0F, margin - closing * settings.delay));
}

/// Whether every velocity within `speed` that keeps to `kept` keeps to `other` too.
bool implies(const HalfSpace& kept, const HalfSpace& other, float speed) noexcept
{
    // The fastest towards the other obstacle: along its own normal if `kept` admits that, else on the rim of `kept`.
    const float cosine = kept.normal.dot(other.normal);
    const float bound = -kept.offset;
    const float other_bound = -other.offset + kSameVelocity;
    if (speed * cosine <= bound) {
        return speed <= other_bound;
    }
    // bound * cosine + rim * sine <= other_bound; a plane that admits nothing says nothing of the other one.
    const float left = other_bound - bound * cosine;
    const float rim_squared = (speed - bound) * (speed + bound);
    // The sine's square in a way that is exact enough to say no, which is nearly always the answer.
    constexpr float kRounding = 1e-5F;
    if (!(left >= 0.0F && rim_squared >= 0.0F && rim_squared * (1.0F - cosine * cosine - kRounding) <= left * left)) {
        return false;
    }
    return rim_squared * kept.normal.cross(other.normal).squaredNorm() <= left * left;
}

/// The nearest planes so far, nearest first.
class NearestPlanes {
public:
    NearestPlanes(const Envelope& envelope, const OwnMotion& own, const ObstacleSettings& settings,
                  ObstaclePlanes& out) noexcept
        : envelope_(envelope), own_(own), settings_(settings), out_(out)
    {
    }

    /// An unchecked obstacle or part that may be `distance` away.
    void drop(float distance) noexcept { dropped_ = std::min(dropped_, distance - envelope_.radius); }
    [[nodiscard]] float dropped() const noexcept { return dropped_; }

    void add(std::uint16_t source, const detail::Sighting& seen) noexcept
    {
        const float margin = seen.distance - envelope_.radius;
        out_.penetrating = out_.penetrating || seen.upper < envelope_.radius;
        out_.bounded = out_.bounded || seen.bounded;
        if (margin < out_.margin) {
            out_.margin = margin;
            out_.nearest = source;
        }
        HalfSpace plane = obstacle_half_space(seen.distance, seen.direction, envelope_, own_, settings_);
        plane.source = source;
        for (const HalfSpace& kept : out_.planes) {
            if (implies(kept, plane, own_.reach_speed)) {
                return;
            }
        }
        insert(plane, margin);
    }

private:
    void insert(const HalfSpace& plane, float margin) noexcept
    {
        if (out_.planes.full()) {
            const float last = margins_[out_.planes.size() - 1];
            dropped_ = std::min(dropped_, std::max(last, margin));
            if (margin >= last) {
                return;
            }
            out_.planes.pop_back();
        }
        std::size_t at = out_.planes.size();
        out_.planes.unchecked_push_back(plane);
        for (; at > 0 && margin < margins_[at - 1]; --at) {
            out_.planes[at] = out_.planes[at - 1];
            margins_[at] = margins_[at - 1];
        }
        out_.planes[at] = plane;
        margins_[at] = margin;
    }

    const Envelope& envelope_;
    const OwnMotion& own_;
    const ObstacleSettings& settings_;
    ObstaclePlanes& out_;
    std::array<float, kMaxObstaclePlanes> margins_{};
    float dropped_ = std::numeric_limits<float>::infinity();
};

void add_obstacles(const detail::ObstacleView& view, const OwnMotion& own, float reach, NearestPlanes& selection,
                   WorkBudget& budget) noexcept
{
    for (std::size_t i = 0; i < view.obstacles.size(); ++i) {
        const float bound = view.obstacle_bound(i, own.position);
        if (bound >= reach) {
            continue;
        }
        const detail::Sighting seen = view.obstacle(i, own.position, reach, budget);
        if (budget.exhausted()) {
            selection.drop(std::max(bound, seen.distance));
        } else if (seen.distance < reach) {
            selection.add(static_cast<std::uint16_t>(i), seen);
        }
    }
}

}  // namespace

bool is_valid(const ObstacleSettings& s) noexcept
{
    const float stretch = s.horizontal / s.vertical;
    return is_positive(s.horizontal) && is_positive(s.vertical) && stretch >= kMinStretch && stretch <= kMaxStretch &&
           is_positive(s.horizon) && is_not_negative(s.recovery_speed) && is_positive(s.recovery_time) &&
           is_not_negative(s.braking) && is_not_negative(s.delay) && is_positive(s.resolution);
}

Envelope envelope_of(const ObstacleSettings& settings) noexcept
{
    constexpr float kSquareRootOf2 = 1.4142136F;
    const float cover = settings.covers_cylinder ? kSquareRootOf2 : 1.0F;
    return {settings.horizontal / settings.vertical, cover * settings.horizontal};
}

HalfSpace obstacle_half_space(float distance, const Vec3& direction, const Envelope& envelope, const OwnMotion& own,
                              const ObstacleSettings& settings) noexcept
{
    const Vec3 along(direction.x(), direction.y(), envelope.stretch * direction.z());
    const float length = along.norm();
    const float margin = distance - envelope.radius;
    float bound = margin / settings.horizon;
    if (margin < 0.0F) {
        bound = -std::min(settings.recovery_speed, -margin / settings.recovery_time);
    } else if (settings.braking > 0.0F) {
        const float closing = std::max(0.0F, along.dot(own.velocity));
        bound = std::min(bound, braking_bound(margin, closing, settings.braking * length, settings));
    }
    HalfSpace plane;
    plane.normal = -along / length;
    plane.offset = -bound / length;
    plane.level = Level::obstacles;
    return plane;
}

float obstacle_reach(const Envelope& envelope, const OwnMotion& own, const ObstacleSettings& settings) noexcept
{
    const float speed = most_stretch(envelope) * own.reach_speed;
    float margin = settings.horizon * speed;
    if (settings.braking > 0.0F) {
        const float braking = std::min(1.0F, envelope.stretch) * settings.braking;
        const float closing = most_stretch(envelope) * std::max(own.velocity.norm(), own.reach_speed);
        margin = std::max(margin, 0.5F * speed * speed / braking + closing * settings.delay);
    }
    return envelope.radius + margin;
}

ObstaclePlanes obstacle_planes(Obstacles obstacles, const OwnMotion& own, const ObstacleSettings& settings,
                               WorkBudget& budget) noexcept
{
    assert(is_valid(settings) && is_finite(own.position) && is_finite(own.velocity) && own.reach_speed >= 0.0F);
    ObstaclePlanes out;
    const detail::ObstacleView view{obstacles, envelope_of(settings), settings.resolution};
    const float reach = obstacle_reach(view.envelope, own, settings);
    NearestPlanes selection(view.envelope, own, settings, out);
    add_obstacles(view, own, reach, selection, budget);
    if (selection.dropped() < std::numeric_limits<float>::infinity()) {
        // Whatever direction a dropped obstacle lies in: no velocity within this bound closes in faster than it may.
        const float margin = std::max(0.0F, selection.dropped());
        const float stretch = most_stretch(view.envelope);
        float bound = margin / settings.horizon;
        if (settings.braking > 0.0F) {
            const float braking = std::min(1.0F, view.envelope.stretch) * settings.braking;
            bound = std::min(bound, braking_bound(margin, stretch * own.velocity.norm(), braking, settings));
        }
        out.speed_cap = bound / stretch;
        out.truncated = true;
    }
    return out;
}

}  // namespace jink::orca
