// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/obstacle_view.hpp"

#include <algorithm>

namespace jink::orca::detail {

namespace {

/// Of a distance: what is no shortfall of a search but rounding.
constexpr float kRoundingShare = 1e-5F;

/// What a search says of an obstacle that is larger by `grown`.
Sighting sighting_of(const geometry::Separation& from, float grown, const geometry::DistanceQuery& query) noexcept
{
    const bool bounded = from.distance < query.reach &&
                         from.upper - from.distance > 2.0F * query.resolution + kRoundingShare * from.upper;
    return {from.distance - grown, from.upper - grown, from.direction, bounded};
}

/// A search that proved nothing has the point in the obstacle, or so near that the way out is the way to go.
Sighting way_out(const geometry::Exit& out, float grown) noexcept
{
    const float distance = -out.depth - grown;
    return {std::min(distance, 0.0F), std::max(distance, 0.0F), -out.direction, false};
}

}  // namespace

Sighting ObstacleView::obstacle(std::size_t index, const Vec3& point, float reach, WorkBudget& budget) const noexcept
{
    const geometry::Shape& shape = *obstacles[index].solid;
    const float grown = stretched_uncertainty(index);
    const geometry::DistanceQuery query{envelope.stretch, reach + grown, resolution, Vec3::Zero()};
    const geometry::Separation from = geometry::point_shape_distance(point, shape, query, budget);
    if (from.distance > 0.0F || budget.exhausted()) {
        return sighting_of(from, grown, query);
    }
    return way_out(geometry::exit_of_shape(point, shape, envelope.stretch), grown);
}

float ObstacleView::stretched_uncertainty(std::size_t index) const noexcept
{
    return std::max(1.0F, envelope.stretch) * obstacles[index].slack;
}

float ObstacleView::obstacle_bound(std::size_t index, const Vec3& point) const noexcept
{
    constexpr float kRoundedOff = 1e-6F;
    const geometry::Shape& shape = *obstacles[index].solid;
    Vec3 offset = shape.centre - point;
    offset.z() *= envelope.stretch;
    const float radius = std::max(1.0F, envelope.stretch) * geometry::bounding_radius(shape);
    return std::max(0.0F, offset.norm() * (1.0F - kRoundedOff) - radius * (1.0F + kRoundedOff) -
                              stretched_uncertainty(index));
}

}  // namespace jink::orca::detail
