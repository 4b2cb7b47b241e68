// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/cylinder.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"

namespace jink::world {
namespace {

constexpr float kMaxCylinderExtent = 1e5F;   // [m]
constexpr float kMaxCylinderSpeed = 500.0F;  // [m/s]
/// Of all coordinates: what rounding may add to a distance.
constexpr float kCylinderRounding = 4e-7F;
/// Nearer than this to the least distance is found [m].
constexpr float kCylinderAccuracy = 1e-4F;
/// Halvings of the time until a contact.
constexpr int kContactTurns = 16;

float level_size(const Vec2& v) noexcept { return std::abs(v.x()) + std::abs(v.y()); }

}  // namespace

bool is_valid(const Cylinder& cylinder) noexcept
{
    const auto& [circle, velocity, bottom, top, margin] = cylinder;
    const auto within = [](float value, float most) { return std::abs(value) <= most; };  // no for what is no number
    return within(circle.centre.x(), kMaxCylinderExtent) && within(circle.centre.y(), kMaxCylinderExtent) &&
           circle.radius > 0.0F && within(circle.radius, kMaxCylinderExtent) &&
           within(velocity.x(), kMaxCylinderSpeed) && within(velocity.y(), kMaxCylinderSpeed) &&
           within(bottom, kMaxCylinderExtent) && within(top, kMaxCylinderExtent) && top >= bottom && margin >= 0.0F &&
           within(margin, kMaxCylinderExtent);
}

float cylinder_distance(const Vec3& half, const Vec3& position, const Cylinder& cylinder, Seconds t) noexcept
{
    return detail::CylinderApproach(half, {position, Vec3::Zero()}, cylinder, t, 0.0F, 0.0F).look(0.0F).value;
}

namespace detail {

CylinderApproach::CylinderApproach(const Vec3& half, const geometry::Motion& own, const Cylinder& cylinder,
                                   Seconds start, float outset, float growth) noexcept
    : half_(half), gap_(cylinder.circle.centre + cylinder.velocity * start - own.position.head<2>()),
      closing_(cylinder.velocity - own.velocity.head<2>()), radius_(cylinder.circle.radius), height_(own.position.z()),
      climb_(own.velocity.z()), bottom_(cylinder.bottom - half.z()), top_(cylinder.top + half.z()), outset_(outset),
      growth_(growth)
{
    const Vec2 way = cylinder.velocity * start;
    outset_ += kCylinderRounding *
               (level_size(cylinder.circle.centre) + level_size(way) + own.position.cwiseAbs().sum() + half.sum() +
                radius_ + std::abs(cylinder.bottom) + std::abs(cylinder.top) + std::abs(outset));
}

CylinderApproach::Look CylinderApproach::look(Seconds t) const noexcept
{
    const Vec2 centre = gap_ + closing_ * t;
    const Vec2 half = half_.head<2>();
    const Vec2 off = centre - centre.cwiseMax(-half).cwiseMin(half);
    const float apart = off.norm();
    const float level = apart - radius_;
    const float level_slope = apart > 0.0F ? off.dot(closing_) / apart : 0.0F;
    const float z = height_ + climb_ * t;
    const bool is_below = bottom_ - z > z - top_;
    const float height = is_below ? bottom_ - z : z - top_;
    const float height_slope = is_below ? -climb_ : climb_;
    const float rounding = kCylinderRounding * t * (level_size(closing_) + std::abs(climb_));
    const float off_by = outset_ + growth_ * t + rounding;
    if (level > 0.0F && height > 0.0F) {
        const float distance = std::sqrt(level * level + height * height);
        return {distance - off_by, (level * level_slope + height * height_slope) / distance - growth_};
    }
    return level >= height ? Look{level - off_by, level_slope - growth_}
                           : Look{height - off_by, height_slope - growth_};
}

geometry::Approach CylinderApproach::least(Seconds span, float enough, WorkBudget& budget) const noexcept
{
    if (!budget.spend(units::kCylinderPart)) {
        return {-kNoBudget, 0.0F};
    }
    Seconds from = 0.0F;
    Look first = look(from);
    if (!(first.slope < 0.0F) || !(span > 0.0F)) {
        return {first.value, from};
    }
    Seconds to = span;
    Look last = look(to);
    if (!(last.slope > 0.0F)) {
        return {last.value, to};
    }
    geometry::Approach best =
        first.value <= last.value ? geometry::Approach{first.value, from} : geometry::Approach{last.value, to};
    float bound = best.distance;
    for (int turn = 0; turn < kTurns; ++turn) {
        // Both tangents lie below the function between their instants, and so does the point where they cross.
        const Seconds width = to - from;
        const float meet = (first.value - last.value + last.slope * width) / (last.slope - first.slope);
        const Seconds at = std::clamp(meet, 0.0F, width);
        bound = std::min(first.value + first.slope * at, best.distance);
        if (bound >= enough || best.distance - bound <= kCylinderAccuracy) {
            break;
        }
        if (!budget.spend(units::kCylinderTurn)) {
            return {-kNoBudget, 0.0F};
        }
        // Crossings alone can creep along a long arm: every other time the middle is taken.
        const Seconds probe = from + (turn % 2 == 0 ? at : 0.5F * width);
        const Look seen = look(probe);
        if (seen.value < best.distance) {
            best = {seen.value, probe};
        }
        (seen.slope < 0.0F ? from : to) = probe;
        (seen.slope < 0.0F ? first : last) = seen;
        if (!(seen.slope < 0.0F) && !(seen.slope > 0.0F)) {
            return best;  // a level piece: nothing is below it
        }
    }
    return {bound, best.when};
}

Seconds CylinderApproach::first_contact(Seconds until, WorkBudget& budget) const noexcept
{
    if (!budget.spend(units::kCylinderTurn * static_cast<std::uint32_t>(kContactTurns + 1)) ||
        look(0.0F).value <= 0.0F) {
        return 0.0F;
    }
    Seconds clear = 0.0F;
    Seconds touching = until;
    for (int i = 0; i < kContactTurns; ++i) {
        const Seconds middle = 0.5F * (clear + touching);
        (look(middle).value <= 0.0F ? touching : clear) = middle;
    }
    return clear;
}

}  // namespace detail
}  // namespace jink::world
