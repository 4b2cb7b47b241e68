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
/// Of two boxes that touch, and rounding says that they do not [m].
constexpr float kMinOverlap = 1e-4F;
/// Of the sum of the magnitudes, as stated.
constexpr float kBoxRounding = 3e-5F;
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

/// What the own box, anywhere between `from` and `to`, overlaps of a box at most along each of the six axes of both;
/// the least of them, below 0 where one of these axes keeps both apart all the way. Of two upright boxes at rest it is
/// how far one has to be moved until they are apart.
[[gnu::noinline]] float depth_in_box(const Vec3& half, const Vec3& from, const Vec3& to,
                                     const geometry::Shape& box) noexcept
{
    const auto least = [](const Vec3& sizes, const Vec3& a, const Vec3& b) {
        const Vec3 near = a.cwiseMin(b).cwiseMax(-a.cwiseMax(b)).cwiseMax(0.0F);
        return (sizes - near).minCoeff();
    };
    const Vec3 a = from - box.centre;
    const Vec3 b = to - box.centre;
    const Mat3 into = box.axes.transpose();
    return std::min(least(box.half + into.cwiseAbs() * half, into * a, into * b),
                    least(half + box.axes.cwiseAbs() * box.half, a, b));
}

/// Whether an upright box is met at one end of the way, which saves the queries.
bool surely_meets_box(const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& box) noexcept
{
    const bool is_upright = box.axes(0, 2) == 0.0F && box.axes(1, 2) == 0.0F;
    const float rounding =
        kBoxRounding * ((from - box.centre).norm() + (to - from).norm() + half.norm() + geometry::bounding_radius(box));
    return is_upright && std::max(depth_in_box(half, from, from, box), depth_in_box(half, to, to, box)) > rounding;
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
    const bool is_box = shape.kind == geometry::ShapeKind::box;
    if (is_box && budget.spend(units::kBoxDepth) && surely_meets_box(half, from, to, shape)) {
        return -depth_in_box(half, from, to, shape) - extra;
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
    if (is_box && !budget.exhausted()) {
        return -std::max(kMinOverlap, depth_in_box(half, from, to, shape)) - extra;
    }
    return -overlap(half, from, to, shape, budget) - extra;
}

}  // namespace jink::world
