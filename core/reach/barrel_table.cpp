// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/barrel_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jink::reach {
namespace {

constexpr float kHoldSlack = 1e-5F;

Circle shifted(const Barrel& barrel, float t) noexcept
{
    return {barrel.circle.centre + t * barrel.velocity, barrel.circle.radius};
}

/// Circle around a barrel's body over the whole interval.
Circle swept(const Barrel& barrel, float from, float to) noexcept
{
    return around(shifted(barrel, from), shifted(barrel, to));
}

}  // namespace

bool may_matter(const Barrel& barrel, const Vec3& vehicle, float range, float since, float horizon) noexcept
{
    const Circle way = swept(barrel, since, since + horizon);
    const float apart = (way.centre - vehicle.head<2>()).norm() - way.radius - barrel.margin;
    return !(apart > range || vehicle.z() + range < barrel.bottom || vehicle.z() - range > barrel.top);
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

Barrel merged(const Barrel& a, const Barrel& b, float from, float to) noexcept
{
    Barrel both;
    both.circle = around(swept(a, from, to), swept(b, from, to));
    both.bottom = std::min(a.bottom, b.bottom);
    both.top = std::max(a.top, b.top);
    both.margin = std::max(a.margin, b.margin);
    return both;
}

void BarrelTable::begin(const Vec3& vehicle, float from, float to) noexcept
{
    vehicle_ = vehicle;
    from_ = from;
    to_ = to;
    barrels_.clear();
    merged_ = 0;
}

float BarrelTable::distance_to(const Barrel& barrel) const noexcept
{
    const Circle way = swept(barrel, from_, to_);
    return (way.centre - vehicle_.head<2>()).norm() - way.radius - barrel.margin;
}

AddStatus BarrelTable::add(const Barrel& barrel) noexcept
{
    if (barrels_.try_push_back(barrel)) {
        return AddStatus::added;
    }
    // The two farthest of the stored barrels and the new one are merged.
    Barrel spare = barrel;
    std::size_t farthest = 0;
    for (std::size_t i = 1; i < barrels_.size(); ++i) {
        farthest = distance_to(barrels_[i]) > distance_to(barrels_[farthest]) ? i : farthest;
    }
    if (distance_to(barrels_[farthest]) > distance_to(spare)) {
        std::swap(barrels_[farthest], spare);
        // Now `spare` is the farthest barrel; the next farthest takes it in.
        farthest = 0;
        for (std::size_t i = 1; i < barrels_.size(); ++i) {
            farthest = distance_to(barrels_[i]) > distance_to(barrels_[farthest]) ? i : farthest;
        }
    }
    barrels_[farthest] = reach::merged(barrels_[farthest], spare, from_, to_);
    ++merged_;
    return AddStatus::constraint_merged;
}

}  // namespace jink::reach
