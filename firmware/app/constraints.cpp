// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/constraints.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach/cylinder_table.hpp"
#include "firmware/link/mavlink/geodesy.hpp"

namespace jink::app {
namespace {

/// A stamp may lie so far ahead of our clock [s].
constexpr Seconds kConstraintSlack = 0.5F;

/// A constraint `age` seconds after its stamp, about another point of the globe.
world::Cylinder moved(const Constraint& constraint, Seconds age, const std::optional<link::GlobalPosition>& to)
{
    world::Cylinder cylinder = constraint.cylinder;
    cylinder.circle.centre += age * cylinder.velocity;
    if (constraint.about && to) {
        const Vec3 shift = link::mavlink::to_local(*constraint.about, *to);
        cylinder.circle.centre += shift.head<2>();
        cylinder.bottom += shift.z();
        cylinder.top += shift.z();
        cylinder.circle.radius += ConstraintTable::kMapError * shift.head<2>().norm();
    }
    return cylinder;
}

}  // namespace

bool ConstraintTable::accepts(const Constraint& constraint, TimePoint now) noexcept
{
    return world::is_valid(constraint.cylinder) && constraint.stamp <= now + kConstraintSlack;
}

void ConstraintTable::tell(std::span<const Constraint> constraints, const std::optional<link::GlobalPosition>& origin,
                           const Vec3& own, TimePoint now) noexcept
{
    entries_.clear();
    std::size_t good = 0;
    for (const Constraint& constraint : constraints) {
        ++diagnostics_.reported;
        if (!accepts(constraint, now)) {
            ++diagnostics_.refused;
            continue;
        }
        ++good;
        static_cast<void>(entries_.try_push_back({constraint, constraint.cylinder.velocity.norm()}));
    }
    if (good > entries_.size()) {
        merge(constraints, origin, own, now);
    }
    place(origin, now);
}

/// About the first one's point, or in the local frame where that has none.
void ConstraintTable::merge(std::span<const Constraint> constraints, const std::optional<link::GlobalPosition>& origin,
                            const Vec3& own, TimePoint now) noexcept
{
    const auto first =
        std::find_if(constraints.begin(), constraints.end(), [&](const Constraint& c) { return accepts(c, now); });
    const std::optional<link::GlobalPosition> about = first->about;
    const Vec3 vehicle = about && origin ? Vec3(own - link::mavlink::to_local(*about, *origin)) : own;
    reach::CylinderTable table;
    table.begin(vehicle, 0.0F, kFresh);
    float fastest = 0.0F;
    TimePoint ends{};
    for (const Constraint& constraint : constraints) {
        if (!accepts(constraint, now)) {
            continue;
        }
        const Seconds age = std::max(now - constraint.stamp, 0.0F);
        world::Cylinder cylinder = moved(constraint, age, about);
        const float speed = cylinder.velocity.norm();
        cylinder.circle.radius += speed * age;  // it begins to grow so much earlier than its new entry
        fastest = std::max(fastest, speed);
        ends = std::max(ends, constraint.ends);
        diagnostics_.merged += table.add(cylinder) == reach::AddStatus::constraint_merged ? 1U : 0U;
    }
    entries_.clear();
    for (const world::Cylinder& cylinder : table.cylinders()) {
        // It stands, and has to hold what goes on and grows.
        entries_.unchecked_push_back({{cylinder, now, ends, about}, 2.0F * fastest});
    }
}

void ConstraintTable::place(const std::optional<link::GlobalPosition>& origin, TimePoint now) noexcept
{
    placed_.clear();
    lacks_origin_ = false;
    for (const Entry& entry : entries_) {
        const Constraint& constraint = entry.constraint;
        if (now > constraint.ends) {
            continue;
        }
        if (constraint.about && !origin) {
            lacks_origin_ = true;
            continue;
        }
        const Seconds age = std::max(now - constraint.stamp, 0.0F);
        world::Cylinder cylinder = moved(constraint, age, origin);
        const Seconds old = age + kAhead - kFresh;
        if (entry.speed > 0.0F && old > 0.0F) {
            cylinder.circle.radius += entry.speed * old;
            ++diagnostics_.grown;
        }
        placed_.unchecked_push_back(cylinder);
    }
}

}  // namespace jink::app
