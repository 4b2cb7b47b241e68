// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/link/cloud/frame.hpp"
#include "hal/serial_port.hpp"
#include "toolchain/sim/world.hpp"

namespace jink::sim {

/// Range at which a ray enters a body [m]; 0 from inside the body, negative without an intersection.
///
/// @param centre     of the threat [m]
/// @param direction  unit vector
/// In closed form. O(1).
[[nodiscard]] double ray_range(const Threat& threat, const Vec& centre, const Vec& from, const Vec& direction) noexcept;

/// Attitude of an accelerating multirotor whose thrust balances gravity and provides the acceleration. Aerospace angles
/// [rad]: roll positive right side down, pitch positive nose up. No wind, no drag.
struct Tilt {
    double roll = 0.0;
    double pitch = 0.0;
};
[[nodiscard]] Tilt tilt_of(const Truth& truth) noexcept;

/// Rotation from the platform frame (x along the nose, y left, z up) to the world frame.
[[nodiscard]] Eigen::Matrix3d platform_to_world(const Tilt& tilt, double yaw);

/// Direction of a ray in the platform frame.
struct LidarRay {
    double azimuth = 0.0;    ///< from the nose to the left [rad]
    double elevation = 0.0;  ///< [rad]
    Vec direction = Vec::Zero();
};

/// Rays of a scan, row by row from below. If the field of view is below 360 degrees, its columns are centred on the
/// nose.
[[nodiscard]] std::vector<LidarRay> rays_of(const LidarSensor& sensor);

/// Present true ranges of rays [m] to the nearest threat sensed by LiDAR or to the ground; negative: nothing within the
/// sensor's range. O(rays * threats).
///
/// @param hit  where given: true is written for each threat that a ray ends at; one entry per threat
[[nodiscard]] std::vector<double> true_ranges(const World& world, const LidarSensor& sensor,
                                              const std::vector<LidarRay>& rays, std::vector<bool>* hit = nullptr);

/// The simulated LiDAR and its line. Measures when a scan is due. The other end reads the product's compact frames
/// (firmware/link/cloud/frame.hpp) once they have arrived.
///
/// The line is lossless and delivers a scan as a whole, `latency` after the measurement. Time stamps are 7 s ahead of
/// the flight's clock, so that a receiver that uses them as its own clock fails.
class Lidar final : public hal::SerialPort {
public:
    /// @param scenario  has a lidar; outlives this
    explicit Lidar(const Scenario& scenario);

    /// Call every step of the world. O(rays * threats) when a scan is due.
    void step(const World& world);

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    /// Discards the bytes: the LiDAR has no input.
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    [[nodiscard]] hal::PortHealth health() const noexcept override;
    /// Time at which the first scan with a return from each threat arrives [s]; negative: none.
    [[nodiscard]] const std::vector<double>& reported() const noexcept { return reported_; }

private:
    struct Scan {
        Micros arrives = 0;
        std::vector<std::byte> bytes;
    };
    void measure(const World& world);
    [[nodiscard]] std::vector<std::byte> frames_of(const World& world,
                                                   const std::vector<link::cloud::RawPoint>& points);

    const LidarSensor sensor_;
    std::vector<LidarRay> rays_;
    std::vector<double> reported_;
    Random random_;
    Micros now_ = 0;
    Micros next_ = 0;
    std::uint16_t scan_ = 0;
    std::uint16_t sequence_ = 0;
    std::deque<Scan> under_way_;
    std::size_t read_ = 0;  ///< bytes already read of the first scan in transit
};

}  // namespace jink::sim
