// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/world/world.hpp"
#include "firmware/linux/flight_log/topics.hpp"

namespace jink::flightlog {

/// Obstacles and closed areas on their way into the log: a round is copied after one step, and goes out in portions of
/// kPerStep with that step and those after it. So a round is what was known at one instant, whatever becomes of the
/// tables while it goes out. The next one begins kPeriod later at the earliest.
///
/// Memory: kMaxObstacles times 112 bytes and kMaxCylinders times 28. No allocation.
class ShapeRound {
public:
    static constexpr std::int64_t kPeriod = 1'000'000;  ///< from begin to begin [us]
    static constexpr std::size_t kPerStep = 4;          ///< messages

    /// The round before has gone out, and it is time.
    [[nodiscard]] bool is_due(TimePoint now) const noexcept { return left_ == 0 && now.us >= due_; }
    /// Copies what is known at `now`, in place of the round before.
    /// @param sensed  number of the first obstacles, which are not of a map. Vertices of hulls outlive this.
    /// O(obstacles + areas), a copy each.
    void begin(std::span<const world::Obstacle> obstacles, std::size_t sensed, std::span<const world::Cylinder> areas,
               TimePoint now) noexcept;

    /// Something of the round has not gone out.
    [[nodiscard]] bool goes_on() const noexcept { return left_ != 0; }
    /// Obstacles come first.
    [[nodiscard]] bool is_next_area() const noexcept { return left_ <= areas_.size(); }
    /// Takes the next one out: `goes_on`, and not `is_next_area`. O(1), O(vertices) of a hull.
    [[nodiscard]] ObstacleTopic next_obstacle(TimePoint now) noexcept;
    /// The same: `goes_on` and `is_next_area`. O(1).
    [[nodiscard]] AreaTopic next_area(TimePoint now) noexcept;

private:
    StaticVector<world::Obstacle, kMaxObstacles> obstacles_;
    StaticVector<world::Cylinder, kMaxCylinders> areas_;
    std::size_t sensed_ = 0;
    std::size_t left_ = 0;  ///< of both, not yet out
    TimePoint known_;
    std::int64_t due_ = 0;
};

/// The topic's fields that say what the solid is: kind, centre, half, turn, radius, is_bound.
void put_shape(const geometry::Shape& shape, ObstacleTopic& topic) noexcept;

}  // namespace jink::flightlog
