// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "core/base/static_vector.hpp"
#include "core/world/world.hpp"

namespace jink::app {

/// Turn rate and steady speed of the last second, from measured velocities.
///
/// Turn rate: least squares over the angles between successive samples of the level velocity (direction_angle of their
/// cross and dot product). Accuracy against double precision: 1e-5 rad/s, while the ground speed stays above kMoving;
/// 0 otherwise. No function of the C library but the square root, so every target has the same rate to the bit.
///
/// 300 bytes. O(samples) per added velocity.
class MotionEstimate {
public:
    static constexpr float kMoving = 1.0F;    ///< slower motion turns nowhere and is not steady [m/s]
    static constexpr float kMinTurn = 0.06F;  ///< a slower turn is noise: 3 m off after 5 s at 5 m/s [rad/s]
    static constexpr Seconds kWindow = 1.0F;  ///< [s]

    /// Own state as measured. Samples are spaced in time: states in between are left out.
    void add(const vehicle::VehicleState& measured) noexcept;
    void clear() noexcept;

    [[nodiscard]] float turn_rate() const noexcept { return turn_rate_; }        ///< counter-clockwise; 0: none [rad/s]
    [[nodiscard]] float steady_speed() const noexcept { return steady_speed_; }  ///< 0: the speed changes [m/s]

private:
    struct Sample {
        TimePoint at;
        float turned = 0.0F;           ///< since the sample before, counter-clockwise [rad]
        Vec3 velocity = Vec3::Zero();  ///< [m/s]
    };
    static constexpr std::size_t kSamples = 12;

    void estimate() noexcept;

    StaticVector<Sample, kSamples> samples_;
    float turn_rate_ = 0.0F;
    float steady_speed_ = 0.0F;
};

}  // namespace jink::app
