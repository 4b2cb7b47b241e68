// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/obstacle_view.hpp"

#include <algorithm>

namespace jink::orca::detail {

namespace {

/// Of a distance: what is no shortfall of a search but rounding.
constexpr float kRoundingShare = 1e-5F;

Sighting sighting_of(const geometry::Separation& from, const geometry::DistanceQuery& query) noexcept
{
    const bool bounded = from.distance < query.reach &&
                         from.upper - from.distance > 2.0F * query.resolution + kRoundingShare * from.upper;
    return {from.distance, from.upper, from.direction, bounded};
}

/// A search that proved nothing has the point in the obstacle, or so near that the way out is the way to go.
Sighting way_out(const geometry::Exit& out) noexcept
{
    return {std::min(-out.depth, 0.0F), std::max(-out.depth, 0.0F), -out.direction, false};
}

}  // namespace

Sighting ObstacleView::piece(std::size_t index, const Vec3& point, float reach, WorkBudget& budget) const noexcept
{
    const geometry::DistanceQuery query{envelope.stretch, reach, resolution, Vec3::Zero()};
    const geometry::Separation from = geometry::piece_distance(*scene.map, index, point, query, budget);
    if (from.distance > 0.0F || budget.exhausted()) {
        return sighting_of(from, query);
    }
    return way_out(geometry::piece_exit(*scene.map, index, point, envelope.stretch));
}

Sighting ObstacleView::obstacle(std::size_t index, const Vec3& point, float reach, WorkBudget& budget) const noexcept
{
    const geometry::Shape& shape = *scene.obstacles[index].solid;
    const geometry::DistanceQuery query{envelope.stretch, reach, resolution, Vec3::Zero()};
    const geometry::Separation from = geometry::point_shape_distance(point, shape, query, budget);
    if (from.distance > 0.0F || budget.exhausted()) {
        return sighting_of(from, query);
    }
    return way_out(geometry::exit_of_shape(point, shape, envelope.stretch));
}

float ObstacleView::obstacle_bound(std::size_t index, const Vec3& point) const noexcept
{
    constexpr float kRoundedOff = 1e-6F;
    const geometry::Shape& shape = *scene.obstacles[index].solid;
    Vec3 offset = shape.centre - point;
    offset.z() *= envelope.stretch;
    const float radius = std::max(1.0F, envelope.stretch) * geometry::bounding_radius(shape);
    return std::max(0.0F, offset.norm() * (1.0F - kRoundedOff) - radius * (1.0F + kRoundedOff));
}

}  // namespace jink::orca::detail
