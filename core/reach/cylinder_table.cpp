// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/cylinder_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jink::reach {
namespace {

constexpr float kHoldSlack = 1e-5F;

Circle shifted(const Cylinder& cylinder, float t) noexcept
{
    return {cylinder.circle.centre + t * cylinder.velocity, cylinder.circle.radius};
}

/// Circle around a cylinder's body over the whole interval.
Circle swept(const Cylinder& cylinder, float from, float to) noexcept
{
    return around(shifted(cylinder, from), shifted(cylinder, to));
}

}  // namespace

bool may_matter(const Cylinder& cylinder, const Vec3& vehicle, float range, float since, float horizon) noexcept
{
    const Circle way = swept(cylinder, since, since + horizon);
    const float apart = (way.centre - vehicle.head<2>()).norm() - way.radius - cylinder.margin;
    return !(apart > range || vehicle.z() + range < cylinder.bottom || vehicle.z() - range > cylinder.top);
}

Circle around(const Circle& a, const Circle& b) noexcept
{
    const Vec2 apart = b.centre - a.centre;
    const float distance = apart.norm();
    const float slack = kHoldSlack * (a.centre.norm() + b.centre.norm() + a.radius + b.radius);
    if (distance + b.radius <= a.radius) {
        return {a.centre, a.radius + slack};
    }
    if (distance + a.radius <= b.radius) {
        return {b.centre, b.radius + slack};
    }
    const float radius = 0.5F * (distance + a.radius + b.radius);
    return {a.centre + (radius - a.radius) / distance * apart, radius + slack};
}

Cylinder merged(const Cylinder& a, const Cylinder& b, float from, float to) noexcept
{
    Cylinder both;
    both.circle = around(swept(a, from, to), swept(b, from, to));
    both.bottom = std::min(a.bottom, b.bottom);
    both.top = std::max(a.top, b.top);
    both.margin = std::max(a.margin, b.margin);
    return both;
}

void CylinderTable::begin(const Vec3& vehicle, float from, float to) noexcept
{
    vehicle_ = vehicle;
    from_ = from;
    to_ = to;
    cylinders_.clear();
    merged_ = 0;
}

float CylinderTable::distance_to(const Cylinder& cylinder) const noexcept
{
    const Circle way = swept(cylinder, from_, to_);
    return (way.centre - vehicle_.head<2>()).norm() - way.radius - cylinder.margin;
}

AddStatus CylinderTable::add(const Cylinder& cylinder) noexcept
{
    if (cylinders_.try_push_back(cylinder)) {
        return AddStatus::added;
    }
    // The two farthest of the stored cylinders and the new one are merged.
    Cylinder spare = cylinder;
    std::size_t farthest = 0;
    for (std::size_t i = 1; i < cylinders_.size(); ++i) {
        farthest = distance_to(cylinders_[i]) > distance_to(cylinders_[farthest]) ? i : farthest;
    }
    if (distance_to(cylinders_[farthest]) > distance_to(spare)) {
        std::swap(cylinders_[farthest], spare);
        // Now `spare` is the farthest cylinder; the next farthest takes it in.
        farthest = 0;
        for (std::size_t i = 1; i < cylinders_.size(); ++i) {
            farthest = distance_to(cylinders_[i]) > distance_to(cylinders_[farthest]) ? i : farthest;
        }
    }
    cylinders_[farthest] = reach::merged(cylinders_[farthest], spare, from_, to_);
    ++merged_;
    return AddStatus::constraint_merged;
}

}  // namespace jink::reach
