// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/cylinder_closure.hpp"

#include <algorithm>
#include <cmath>

namespace jink::reach {
namespace {

float segment_distance(const Vec2& point, const Vec2& from, const Vec2& to) noexcept
{
    const Vec2 along = to - from;
    const float length = along.squaredNorm();
    const float share = length > 0.0F ? std::clamp((point - from).dot(along) / length, 0.0F, 1.0F) : 0.0F;
    return (point - from - share * along).norm();
}

/// Inner and outer radius of a cell seen from above.
struct Ring {
    float inner = 0.0F;
    float outer = 0.0F;
};
Ring ring_of(const Grid<float>& grid, const CellPlace& place) noexcept
{
    const float low = grid.row_start(place.row);
    const float high = grid.row_start(place.row + 1U);
    const float least = std::min(std::cos(low), std::cos(high));
    const float most = low <= 0.0F && high >= 0.0F ? 1.0F : std::max(std::cos(low), std::cos(high));
    return {grid.layer_start(place.layer) * least, grid.layer_end(place.layer) * most};
}

/// In the grid's axes and unit.
Vec2 in_grid(const GridPose& pose, const Vec2& world) noexcept
{
    const Vec2 apart = (world - pose.position.head<2>()) / pose.unit;
    const float c = std::cos(pose.yaw);
    const float s = std::sin(pose.yaw);
    return {c * apart.x() + s * apart.y(), -s * apart.x() + c * apart.y()};
}

/// About the middle of a cell, seen from above.
Circle shadow_of(const Grid<float>& grid, const CellPlace& place) noexcept
{
    const Ring ring = ring_of(grid, place);
    const float from = grid.column_start(place.column);
    const float to = grid.column_start(place.column + 1U);
    const float half = 0.5F * (to - from);
    const float middle = 0.5F * (from + to);
    const auto at = [](float radius, float angle) { return Vec2(radius * std::cos(angle), radius * std::sin(angle)); };
    Circle circle{at(0.5F * (ring.inner + ring.outer), middle), 0.0F};
    // The farthest point is on an arc: at its ends, or, of one that is wider than half a circle, anywhere.
    for (const float radius : {ring.inner, ring.outer}) {
        for (const float angle : {from, middle, to}) {
            circle.radius = std::max(circle.radius, (at(radius, angle) - circle.centre).norm());
        }
    }
    if (half > 0.5F * kPi) {
        circle = {Vec2::Zero(), ring.outer};
    }
    return circle;
}

}  // namespace

Heights heights_of(const Grid<float>& grid, const CellPlace& place) noexcept
{
    Heights heights{INFINITY, -INFINITY};
    for (const float distance : {grid.layer_start(place.layer), grid.layer_end(place.layer)}) {
        for (const float vertical : {grid.row_start(place.row), grid.row_start(place.row + 1U)}) {
            const float height = distance * std::sin(vertical);
            heights = {std::min(heights.bottom, height), std::max(heights.top, height)};
        }
    }
    return heights;
}

float level_distance(const Grid<float>& grid, const CellPlace& place, const Vec2& point) noexcept
{
    const Ring ring = ring_of(grid, place);
    const float from = grid.column_start(place.column);
    const float to = grid.column_start(place.column + 1U);
    const float radius = point.norm();
    const float angle = std::atan2(point.y(), point.x());
    if (angle >= from && angle <= to) {
        return std::max({0.0F, ring.inner - radius, radius - ring.outer});
    }
    float least = INFINITY;
    for (const float edge : {from, to}) {
        const Vec2 direction(std::cos(edge), std::sin(edge));
        least = std::min(least, segment_distance(point, ring.inner * direction, ring.outer * direction));
    }
    return least;
}

Closure closure_of(const Grid<float>& grid, const CellPlace& place, const GridPose& pose, const Cylinder& cylinder,
                   float from, float to) noexcept
{
    const Heights heights = heights_of(grid, place);
    if (pose.position.z() + pose.unit * heights.top < cylinder.bottom ||
        pose.position.z() + pose.unit * heights.bottom > cylinder.top) {
        return Closure::none;
    }
    float distance = 0.0F;
    const bool stands = cylinder.velocity == Vec2::Zero();
    if (stands || from == to) {
        const Vec2 centre = stands ? cylinder.circle.centre : Vec2(cylinder.circle.centre + from * cylinder.velocity);
        distance = pose.unit * level_distance(grid, place, in_grid(pose, centre));
    } else {
        const Circle shadow = shadow_of(grid, place);
        const Vec2 first = in_grid(pose, cylinder.circle.centre + from * cylinder.velocity);
        const Vec2 last = in_grid(pose, cylinder.circle.centre + to * cylinder.velocity);
        distance = pose.unit * (segment_distance(shadow.centre, first, last) - shadow.radius);
    }
    if (distance <= cylinder.circle.radius) {
        return Closure::hard;
    }
    return distance <= cylinder.circle.radius + cylinder.margin ? Closure::soft : Closure::none;
}

}  // namespace jink::reach
