// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware/linux/flight_log/topics.hpp"

// Obstacles and closed areas that pages draw of what a flight log says.

namespace jink::flightlog {

/// How long a round is shown without a newer one. The next one is complete 1.7 s after the round was known, where steps
/// are 20 ms and the tables are full.
inline constexpr std::uint64_t kShapeLife = 2'000'000;  // [us]

/// Name of a geometry::ShapeKind in a topic.
[[nodiscard]] std::string_view name_of_shape(std::uint8_t kind) noexcept;

/// Numbers that a solid has: finite, up to kMaxShown, sizes not negative, a unit quaternion, a known kind.
[[nodiscard]] bool is_shape(const ObstacleTopic& topic) noexcept;
[[nodiscard]] bool is_shape(const AreaTopic& topic) noexcept;
/// The same obstacle, or area, in the same place. When it was known does not count.
[[nodiscard]] bool is_same(const ObstacleTopic& a, const ObstacleTopic& b) noexcept;
[[nodiscard]] bool is_same(const AreaTopic& a, const AreaTopic& b) noexcept;

/// What one round says.
struct Shapes {
    /// Beyond: not shown.
    static constexpr std::size_t kMaxObstacles = 96;
    static constexpr std::size_t kMaxAreas = 32;
    std::uint64_t known = 0;  ///< [us]
    std::vector<ObstacleTopic> obstacles;
    std::vector<AreaTopic> areas;
};

/// Puts rounds together. Their messages come in order: a round that lacks one, or has one that is no part of it, is
/// passed over. Solids whose numbers cannot be are left out. Memory: two rounds.
class ShapeCollector {
public:
    /// @return the message completes a round
    bool take(const ObstacleTopic& topic);
    bool take(const AreaTopic& topic);
    /// The newest complete one.
    [[nodiscard]] const Shapes& complete() const noexcept { return complete_; }

private:
    template <class T>
    bool takes(const T& topic);
    bool finish();

    Shapes growing_;
    std::size_t obstacles_ = 0;  ///< of the growing round, in all
    std::size_t areas_ = 0;
    std::size_t next_ = 0;  ///< number of the next message, obstacles first; beyond all: the round is passed over
    Shapes complete_;
};

}  // namespace jink::flightlog
