// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/shape_round.hpp"

#include <Eigen/Geometry>

namespace jink::flightlog {
namespace {

/// The box about the vertices of a hull, in its own axes.
void put_bound(const geometry::Shape& hull, ObstacleTopic& topic) noexcept
{
    if (hull.vertices.empty()) {
        return;
    }
    Vec3 low = hull.vertices.front().vec();
    Vec3 high = low;
    for (const Point3& p : hull.vertices) {
        const Vec3 at = p.vec();
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
    }
    topic.centre = xyz_of(hull.centre + hull.axes * (0.5F * (low + high)));
    topic.half = xyz_of(0.5F * (high - low));
}

}  // namespace

void put_shape(const geometry::Shape& shape, ObstacleTopic& topic) noexcept
{
    topic.kind = static_cast<std::uint8_t>(shape.kind);
    topic.centre = xyz_of(shape.centre);
    topic.half = xyz_of(shape.half);
    topic.radius = shape.radius;
    topic.is_bound = shape.kind == geometry::ShapeKind::hull;
    if (topic.is_bound) {
        put_bound(shape, topic);
    }
    // All of these solids are their own mirror images in their own axes: an axis may be turned round.
    Mat3 axes = shape.axes;
    if (axes.determinant() < 0.0F) {
        axes.col(0) = -axes.col(0);
    }
    const Eigen::Quaternionf turn(axes);
    topic.turn = {turn.w(), turn.x(), turn.y(), turn.z()};
}

void ShapeRound::begin(std::span<const world::Obstacle> obstacles, std::size_t sensed,
                       std::span<const world::Cylinder> areas, TimePoint now) noexcept
{
    obstacles_.clear();
    areas_.clear();
    for (const world::Obstacle& obstacle : obstacles) {
        static_cast<void>(obstacles_.try_push_back(obstacle));
    }
    for (const world::Cylinder& area : areas) {
        static_cast<void>(areas_.try_push_back(area));
    }
    sensed_ = sensed;
    left_ = obstacles_.size() + areas_.size();
    known_ = now;
    due_ = now.us + kPeriod;
}

ObstacleTopic ShapeRound::next_obstacle(TimePoint now) noexcept
{
    const std::size_t number = obstacles_.size() + areas_.size() - left_--;
    const world::Obstacle& obstacle = obstacles_[number];
    ObstacleTopic topic;
    topic.timestamp = static_cast<std::uint64_t>(now.us);
    topic.known = static_cast<std::uint64_t>(known_.us);
    topic.id = obstacle.id;
    put_shape(obstacle.shape, topic);
    topic.uncertainty = obstacle.uncertainty;
    topic.number = static_cast<std::uint16_t>(number);
    topic.obstacles = static_cast<std::uint16_t>(obstacles_.size());
    topic.areas = static_cast<std::uint16_t>(areas_.size());
    topic.of_map = number >= sensed_;
    return topic;
}

AreaTopic ShapeRound::next_area(TimePoint now) noexcept
{
    const std::size_t number = areas_.size() - left_--;
    const world::Cylinder& area = areas_[number];
    AreaTopic topic;
    topic.timestamp = static_cast<std::uint64_t>(now.us);
    topic.known = static_cast<std::uint64_t>(known_.us);
    topic.centre = {area.circle.centre.x(), area.circle.centre.y()};
    topic.velocity = {area.velocity.x(), area.velocity.y()};
    topic.radius = area.circle.radius;
    topic.bottom = area.bottom;
    topic.top = area.top;
    topic.margin = area.margin;
    topic.number = static_cast<std::uint16_t>(number);
    topic.obstacles = static_cast<std::uint16_t>(obstacles_.size());
    topic.areas = static_cast<std::uint16_t>(areas_.size());
    return topic;
}

}  // namespace jink::flightlog
