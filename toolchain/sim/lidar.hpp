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

/// Range at which a ray enters a body [m]; 0 from inside it, negative when it passes by.
///
/// @param centre     of the threat [m]
/// @param direction  unit vector
/// In closed form. O(1).
[[nodiscard]] double ray_range(const Threat& threat, const Vec& centre, const Vec& from, const Vec& direction) noexcept;

/// How a multirotor lies that has to pull itself along as it accelerates: its thrust is opposite to gravity and what
/// moves it. Aerospace angles [rad]: right side down, nose up. No wind, no drag.
struct Tilt {
    double roll = 0.0;
    double pitch = 0.0;
};
[[nodiscard]] Tilt tilt_of(const Truth& truth) noexcept;

/// Turns what is seen from the platform (x along the nose, y left, z up) into the world's axes.
[[nodiscard]] Eigen::Matrix3d platform_to_world(const Tilt& tilt, double yaw);

/// Of the platform.
struct LidarRay {
    double azimuth = 0.0;    ///< from the nose to the left [rad]
    double elevation = 0.0;  ///< [rad]
    Vec direction = Vec::Zero();
};

/// Rays of a scan, row by row from below. The columns of a field that does not close lie evenly about the nose.
[[nodiscard]] std::vector<LidarRay> rays_of(const LidarSensor& sensor);

/// True ranges of rays now [m], to the nearest of what is there to be seen by a LiDAR and of the ground; negative:
/// nothing within the sensor's range. O(rays * threats).
[[nodiscard]] std::vector<double> true_ranges(const World& world, const LidarSensor& sensor,
                                              const std::vector<LidarRay>& rays);

/// The simulated LiDAR and its line: measures when it is time, and lets whoever is at the other end read the product's
/// compact frames (firmware/link/cloud/frame.hpp) once they have arrived.
///
/// The line loses nothing and takes a scan as a whole, `latency` after it was measured. Stamps are of the flight's
/// clock, 7 s ahead of it, for nobody may take them for their own.
class Lidar final : public hal::SerialPort {
public:
    /// @param scenario  has a lidar; outlives this
    explicit Lidar(const Scenario& scenario);

    /// Call it every step of the world. O(rays * threats) when it is time for a scan.
    void step(const World& world);

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    /// Nobody listens to what is said to a LiDAR.
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    [[nodiscard]] hal::PortHealth health() const noexcept override;

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
    Random random_;
    Micros now_ = 0;
    Micros next_ = 0;
    std::uint16_t scan_ = 0;
    std::uint16_t sequence_ = 0;
    std::deque<Scan> under_way_;
    std::size_t read_ = 0;  ///< bytes of the first scan under way
};

}  // namespace jink::sim
