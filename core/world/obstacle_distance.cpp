// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_distance.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::world {
namespace {

/// Halvings that find how much of the box must be taken off.
constexpr int kShrinkSteps = 6;
static_assert(kOverlapResolution * static_cast<float>(1 << kShrinkSteps) == 1.0F);

float overlap(const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& shape,
              WorkBudget& budget) noexcept
{
    float clear = 0.0F;
    float touching = 1.0F;
    for (int i = 0; i < kShrinkSteps; ++i) {
        const float scale = 0.5F * (clear + touching);
        const Vec3 smaller = half * scale;
        const bool is_clear =
            geometry::swept_box_contact(smaller, from, to, shape, 0.0F, budget) == geometry::Contact::clear;
        (is_clear ? clear : touching) = scale;
    }
    return (1.0F - clear) * half.maxCoeff();
}

}  // namespace

bool as_sphere(const geometry::Shape& shape, const Vec3& half, Vec3& effective_half, float& radius) noexcept
{
    effective_half = half;
    radius = shape.radius;
    if (shape.kind == geometry::ShapeKind::sphere) {
        return true;
    }
    if (shape.kind == geometry::ShapeKind::capsule && shape.axes(0, 2) == 0.0F && shape.axes(1, 2) == 0.0F) {
        effective_half.z() += shape.half.z();
        return true;
    }
    return false;
}

float obstacle_margin(const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& shape,
                      WorkBudget& budget, float extra) noexcept
{
    Vec3 effective_half;
    float radius = 0.0F;
    if (as_sphere(shape, half, effective_half, radius)) {
        if (!budget.spend(units::kSphereQuery)) {
            return -std::max(half.maxCoeff(), radius);
        }
        const geometry::Approach near =
            geometry::least_distance(effective_half, {from, to - from}, {shape.centre, Vec3::Zero()}, 1.0F);
        return near.distance - radius - extra;
    }
    const float distance =
        geometry::swept_box_distance(half, from, to, shape, kObstacleReach, kObstacleResolution, budget);
    if (distance > extra) {
        return distance - extra;
    }
    // Nearer than the resolution is not yet contact: that a plane fits between is proven apart from how far.
    const auto clears = [&](float by) {
        return geometry::swept_box_contact(half, from, to, shape, by, budget) == geometry::Contact::clear &&
               !budget.exhausted();
    };
    if (clears(extra)) {
        return 0.0F;
    }
    if (distance > 0.0F || (extra > 0.0F && clears(0.0F))) {
        return distance - extra;
    }
    return -overlap(half, from, to, shape, budget) - extra;
}

}  // namespace jink::world
