// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_distance.hpp"

#include <cmath>

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
    constexpr float kVertical = 0.9999995F;  // within 1 mrad
    effective_half = half;
    radius = shape.radius;
    if (shape.kind == geometry::ShapeKind::sphere) {
        return true;
    }
    if (shape.kind == geometry::ShapeKind::capsule && std::abs(shape.axes(2, 2)) >= kVertical) {
        effective_half.z() += shape.half.z();
        radius += shape.half.z() * std::hypot(shape.axes(0, 2), shape.axes(1, 2));  // how far its ends lean
        return true;
    }
    return false;
}

float obstacle_margin(const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& shape,
                      WorkBudget& budget) noexcept
{
    Vec3 effective_half;
    float radius = 0.0F;
    if (as_sphere(shape, half, effective_half, radius)) {
        const geometry::Approach near =
            geometry::least_distance(effective_half, {from, to - from}, {shape.centre, Vec3::Zero()}, 1.0F);
        return near.distance - radius;
    }
    const float distance =
        geometry::swept_box_distance(half, from, to, shape, kObstacleReach, kObstacleResolution, budget);
    if (distance > 0.0F) {
        return distance;
    }
    // Nearer than the resolution is not yet contact: that a plane fits between is proven apart from how far.
    const bool clear = geometry::swept_box_contact(half, from, to, shape, 0.0F, budget) == geometry::Contact::clear;
    return clear && !budget.exhausted() ? 0.0F : -overlap(half, from, to, shape, budget);
}

}  // namespace jink::world
