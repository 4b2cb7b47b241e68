// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/shown_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/geometry/shape.hpp"
#include "firmware/linux/flight_log/shown_curves.hpp"

namespace jink::flightlog {
namespace {

constexpr std::array<std::string_view, 5> kNames{"sphere", "box", "capsule", "cylinder", "hull"};
static_assert(static_cast<std::size_t>(geometry::ShapeKind::hull) + 1 == kNames.size());

constexpr std::size_t kPassedOver = std::numeric_limits<std::size_t>::max();

template <std::size_t N>
bool are_shown(const std::array<float, N>& values)
{
    return std::all_of(values.begin(), values.end(),
                       [](float v) { return std::abs(static_cast<double>(v)) <= kMaxShown; });
}

bool is_size(float value) { return value >= 0.0F && static_cast<double>(value) <= kMaxShown; }

}  // namespace

std::string_view name_of_shape(std::uint8_t kind) noexcept { return kind < kNames.size() ? kNames[kind] : "?"; }

bool is_shape(const ObstacleTopic& t) noexcept
{
    float square = 0.0F;
    for (const float q : t.turn) {
        square += q * q;
    }
    return t.kind < kNames.size() && are_shown(t.centre) && std::all_of(t.half.begin(), t.half.end(), is_size) &&
           is_size(t.radius) && is_size(t.uncertainty) && std::abs(square - 1.0F) < 1e-2F;
}

bool is_shape(const AreaTopic& t) noexcept
{
    return are_shown(t.centre) && are_shown(t.velocity) && are_shown(std::array{t.bottom, t.top}) &&
           t.top >= t.bottom && is_size(t.radius) && is_size(t.margin);
}

bool is_same(const ObstacleTopic& a, const ObstacleTopic& b) noexcept
{
    return a.id == b.id && a.kind == b.kind && a.of_map == b.of_map && a.is_bound == b.is_bound &&
           a.centre == b.centre && a.half == b.half && a.turn == b.turn && a.radius == b.radius &&
           a.uncertainty == b.uncertainty;
}

bool is_same(const AreaTopic& a, const AreaTopic& b) noexcept
{
    return a.centre == b.centre && a.velocity == b.velocity && a.radius == b.radius && a.bottom == b.bottom &&
           a.top == b.top && a.margin == b.margin;
}

/// Whether the message is the next one of the round that grows, or the first one of another.
template <class T>
bool ShapeCollector::takes(const T& topic)
{
    if (growing_.known != topic.known || next_ == 0) {
        growing_ = {topic.known, {}, {}};
        obstacles_ = topic.obstacles;
        areas_ = topic.areas;
        next_ = 0;
    }
    constexpr bool kIsArea = std::is_same_v<T, AreaTopic>;
    const std::size_t number = topic.number + (kIsArea ? obstacles_ : 0U);
    const bool is_late = topic.timestamp < topic.known || topic.timestamp - topic.known > kShapeLife;
    if (number != next_ || topic.obstacles != obstacles_ || topic.areas != areas_ || is_late ||
        topic.number >= (kIsArea ? areas_ : obstacles_)) {
        next_ = kPassedOver;
        return false;
    }
    ++next_;
    return true;
}

bool ShapeCollector::finish()
{
    if (next_ != obstacles_ + areas_) {
        return false;
    }
    complete_ = std::exchange(growing_, {});
    next_ = obstacles_ = areas_ = 0;
    return true;
}

bool ShapeCollector::take(const ObstacleTopic& topic)
{
    if (!takes(topic)) {
        return false;
    }
    if (growing_.obstacles.size() < Shapes::kMaxObstacles && is_shape(topic)) {
        growing_.obstacles.push_back(topic);
    }
    return finish();
}

bool ShapeCollector::take(const AreaTopic& topic)
{
    if (!takes(topic)) {
        return false;
    }
    if (growing_.areas.size() < Shapes::kMaxAreas && is_shape(topic)) {
        growing_.areas.push_back(topic);
    }
    return finish();
}

}  // namespace jink::flightlog
