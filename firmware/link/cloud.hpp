// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::link {

/// Properties of a scan that are known before its first ray.
struct CloudScan {
    TimePoint stamp;                  ///< of the scan, on our clock
    std::uint8_t sensor = 0;          ///< the sender's number
    float ray_pitch_level = 0.0F;     ///< between neighbouring rays of a row [rad]; 0: not given
    float ray_pitch_vertical = 0.0F;  ///< between rows [rad]; 0: not given
    float max_range = 0.0F;           ///< range up to which `Ray::nothing` is empty [m], > 0
};

enum class Ray : std::uint8_t {
    hit,
    nothing,  ///< fired, with no return up to the scan's max_range
    invalid,  ///< not fired, or known to be wrong
};

/// Receives point clouds ray by ray; the caller stores nothing of a scan for the sink.
///
/// One scan of one sensor lies between begin_scan and end_scan: another scan begins when the previous scan has ended.
class CloudSink {
public:
    virtual void begin_scan(const CloudScan& scan) noexcept = 0;

    /// @param point  `Ray::hit`: position relative to the vehicle at the scan's stamp [m], finite. LEVEL frame: x along
    ///               the
    ///               vehicle's nose projected to the horizon, y left, z up. For other rays the direction, of length 1
    virtual void add(Ray ray, const Vec3& point) noexcept = 0;

    /// @param points_lost  rays that the sender counted in the scan and that did not arrive
    virtual void end_scan(std::uint32_t points_lost) noexcept = 0;

protected:
    ~CloudSink() = default;
};

/// Rotation from the body frame FRD (forward, right, down) to the level frame of CloudSink.
///
/// @param roll, pitch  aerospace angles [rad]: right side down, nose up
/// z-y-x Euler angles without the yaw, then y and z change their sign. O(1).
[[nodiscard]] inline Mat3 level_of_frd(float roll, float pitch) noexcept
{
    const float cr = std::cos(roll);
    const float sr = std::sin(roll);
    const float cp = std::cos(pitch);
    const float sp = std::sin(pitch);
    Mat3 turn;
    turn << cp, sp * sr, sp * cr, 0.0F, -cr, sr, sp, -cp * sr, -cp * cr;
    return turn;
}

}  // namespace jink::link
