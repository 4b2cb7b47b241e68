// SPDX-License-Identifier: BSD-3-Clause
// Closed airspace and weather near a placed reach set (Gomola 6.6.5, time-aware over whole movements).
#include <algorithm>
#include <cmath>

#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"
#include "core/reach/near.hpp"

namespace jink::reach::detail {
namespace {

/// Whether the own box's level rectangle comes within `radius` of a cylinder's axis while its middle is within `height`
/// of the cylinder's. The axis moves straight from `first` to `last` relative to the own box. Exact but for rounding,
/// which works to the safe side; touching counts as contact.
bool touches_between(const NearThreat& cylinder, const Vec3& first, const Vec3& last, float radius,
                     float height) noexcept
{
    constexpr float kSlack = 1e-5F;  // of the heights
    const float reach = height + kSlack * (height + std::abs(first.z()) + std::abs(last.z()));
    const float rise = last.z() - first.z();
    float enters = 0.0F;
    float leaves = 1.0F;
    if (std::abs(rise) > kSlack * reach) {
        const float a = (-reach - first.z()) / rise;
        const float b = (reach - first.z()) / rise;
        enters = std::max(std::min(a, b) - kSlack, 0.0F);
        leaves = std::min(std::max(a, b) + kSlack, 1.0F);
        if (enters > leaves) {
            return false;
        }
    } else if (std::min(std::abs(first.z()), std::abs(last.z())) > reach) {
        return false;
    }
    const Vec3 way(last.x() - first.x(), last.y() - first.y(), 0.0F);
    const Vec3 begin = Vec3(first.x(), first.y(), 0.0F) + enters * way;
    const Vec3 half(cylinder.half.x(), cylinder.half.y(), 1.0F);
    const geometry::QuickReject quick =
        geometry::quick_reject(half, begin, Vec3(begin + (leaves - enters) * way), radius);
    return quick == geometry::QuickReject::touches ||
           (quick == geometry::QuickReject::unclear &&
            geometry::contact_interval(half, {}, {begin, (leaves - enters) * way}, radius, 1.0F).has_value());
}

}  // namespace

void NearThreats::add_cylinder(const world::Threat& threat, const Vec3& own, const Placed& placed, Seconds lead,
                               float range) noexcept
{
    NearThreat near;
    const world::Cylinder& cylinder = *threat.cylinder;
    const float extra = threat.growth.radius;
    const Vec3 centre = threat.position_at(lead);
    near.half = {own.x(), own.y(), 0.5F * (cylinder.top - cylinder.bottom) + own.z() + extra};
    near.position = {centre.x(), centre.y(), 0.5F * (cylinder.top + cylinder.bottom)};
    near.velocity = threat.velocity;
    near.growth.radius = cylinder.circle.radius + extra;
    near.body = std::hypot(own.x(), own.y());
    near.room = std::max(rules_.clearance, cylinder.margin);
    near.is_tall = near.is_cylinder = true;
    const Seconds last = placed.period * static_cast<float>(kMaxDepth);
    const auto level = [](const Vec3& v) { return Vec3(v.x(), v.y(), 0.0F); };
    const float apart =
        geometry::point_segment_distance(level(placed.origin), level(near.position), level(near.at(last)));
    const float height = std::abs(placed.origin.z() - near.position.z()) - near.half.z();
    if (apart > range + near.growth.radius + near.body + cylinder.margin || height > range) {
        return;
    }
    near.shrunk = shrunk_by(world::cylinder_distance(own, placed.origin, cylinder, lead) - extra);
    set_far(near, last, placed);
    near_.unchecked_push_back(near);
}

/// A flat-ended solid: the level distance counts while the heights overlap, with its size at the piece's end.
Level NearThreats::against_cylinder(const NearThreat& cylinder, const Piece& piece) const noexcept
{
    const float shrunk = shrunk_at(cylinder.shrunk, piece.end);
    const float radius = cylinder.growth.radius - shrunk + piece.bulge;
    const float height = cylinder.half.z() - shrunk + piece.bulge;
    const Vec3 first = cylinder.at(piece.start) - piece.from;
    const Vec3 last = cylinder.at(piece.end) - piece.to;
    if (radius >= 0.0F && height >= 0.0F && touches_between(cylinder, first, last, radius, height)) {
        return static_cast<Level>(AvoidanceRun::hard_constraints);
    }
    const bool is_close = radius + cylinder.room >= 0.0F && height + rules_.clearance >= 0.0F &&
                          touches_between(cylinder, first, last, radius + cylinder.room, height + rules_.clearance);
    return is_close ? static_cast<Level>(AvoidanceRun::soft_constraints) : kFree;
}

}  // namespace jink::reach::detail
