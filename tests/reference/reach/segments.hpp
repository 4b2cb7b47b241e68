// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/reach/movement.hpp"

// Regions of equal manoeuvrability in a vehicle's envelope: a partition of the relevant states, with the movements'
// turns in each part (Gomola 6.2.6).

namespace jink::reach {

/// States that a vehicle's limits may depend on.
enum class Impact : std::uint8_t { speed, pitch, altitude, payload };
inline constexpr std::size_t kImpacts = 4;

/// The state that a segment is looked up by.
struct Condition {
    float speed = 1.0F;     ///< [m/s]
    float pitch = 0.0F;     ///< [rad], nose down
    float altitude = 0.0F;  ///< [m]
    float payload = 0.0F;   ///< [kg]
};

/// A vehicle's limits within one movement, in one segment.
struct SegmentLimits {
    float pitch = 0.26179939F;      ///< of one step up or down [rad]: 15 degrees
    float yaw = 0.26179939F;        ///< of one step to a side [rad]
    float speed_change = INFINITY;  ///< of the speed from one movement to the next [m/s]
};

/// Intervals of one state, few because the number of segments is the product over the states: 8 are steps of 5 m/s up
/// to 40 m/s.
inline constexpr std::size_t kMaxIntervals = 8;
/// Segments, and so reach sets, of one vehicle: each costs a table of about 50 KiB.
inline constexpr std::size_t kMaxSegments = 64;

enum class SegmentStatus : std::uint8_t {
    good,
    bad_bounds,          ///< not finite, or the upper not above the lower one
    bad_separators,      ///< not in order, or not between the bounds
    too_many_intervals,  ///< of one state
    too_many_segments,   ///< in all
    named_twice,
    no_such_segment,
    bad_limits,  ///< not finite, or below zero
};

/// A segment, and whether the state is outside all segments: then the nearest segment, which need not be valid.
struct SegmentAt {
    std::uint8_t segment = 0;
    bool outside = false;
};

/// The partition. Built when a vehicle is configured; refused calls change nothing. Without any state there is one
/// segment, Gomola's: all states with turns of 15 degrees.
///
/// Intervals are [lower, s1), [s1, s2), ..., [sn, upper] (Gomola eq. 6.42). Memory: 4 states of 9 numbers and 64
/// segments of 3.
class Segments {
public:
    /// Splits every segment by one more state; resets all limits to Gomola's. O(kMaxIntervals).
    [[nodiscard]] SegmentStatus split(Impact impact, float lower, float upper,
                                      std::span<const float> separators) noexcept;
    [[nodiscard]] SegmentStatus set(std::size_t segment, const SegmentLimits& limits) noexcept;

    /// Product of the numbers of intervals (Gomola eq. 6.43).
    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    /// Total: every state has exactly one segment (Gomola's eq. 6.47 is not an injection, as stated there). A state
    /// beyond a bound, or NaN, is `outside`. O(sum of the numbers of intervals).
    [[nodiscard]] SegmentAt at(const Condition& condition) const noexcept;
    [[nodiscard]] const SegmentLimits& limits(std::size_t segment) const noexcept { return limits_[segment]; }

private:
    struct Split {
        Impact impact = Impact::speed;
        float lower = 0.0F;
        float upper = 0.0F;
        StaticVector<float, kMaxIntervals - 1> separators;
    };

    StaticVector<Split, kImpacts> splits_;
    std::array<SegmentLimits, kMaxSegments> limits_{};
    std::size_t count_ = 1;
};

}  // namespace jink::reach
