// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// The sensor that reports a threat to the co-processor.
enum class SensedBy : std::uint8_t {
    traffic,  ///< ADSB_VEHICLE of an aircraft
    point,    ///< ADSB_VEHICLE of a point obstacle, velocity 0
    scan,     ///< OBSTACLE_DISTANCE
    lidar,    ///< point clouds in compact frames, in process only (lidar.hpp)
};

/// Bodies. All but the sphere are static.
enum class Form : std::uint8_t {
    sphere,    ///< `radius`; with `half_height` an upright capsule with an axis of this half length
    cylinder,  ///< upright: `radius`, `half_height`
    box,       ///< `half_extents`, along the axes of the world
};

[[nodiscard]] std::string_view to_string(SensedBy by) noexcept;
[[nodiscard]] std::string_view to_string(Form form) noexcept;

/// A change of velocity at an instant.
struct Turn {
    double at = 0.0;  ///< [s]
    Vec velocity = Vec::Zero();
};

/// A body that flies straight between turns, or is static.
struct Threat {
    std::string name;
    Form form = Form::sphere;
    double radius = 1.0;             ///< of the body [m]
    double half_height = 0.0;        ///< of the upright axis of a capsule or a cylinder [m]
    Vec half_extents = Vec::Zero();  ///< of a box [m]
    Vec position = Vec::Zero();      ///< at time 0 [m]
    Vec velocity = Vec::Zero();      ///< from time 0 [m/s]
    std::vector<Turn> turns;         ///< in order of time
    SensedBy sensed_by = SensedBy::traffic;
    double appears_at = 0.0;                        ///< not detectable before [s]
    std::optional<double> appears_when_own_within;  ///< distance of the own vehicle to `collision_point` at which the
                                                    ///< threat becomes detectable [m]
    Vec collision_point = Vec::Zero();

    [[nodiscard]] Vec position_at(double t) const noexcept;
    [[nodiscard]] Vec velocity_at(double t) const noexcept;
    [[nodiscard]] bool at_rest() const noexcept;
};

/// Distance from a point to the surface of a threat whose centre is at `centre` [m]; negative inside. O(1).
[[nodiscard]] double surface_distance(const Threat& threat, const Vec& centre, const Vec& point) noexcept;
/// The same for a world-aligned box with the given half extents around `point`; 0 on contact or overlap. O(1).
[[nodiscard]] double box_distance(const Threat& threat, const Vec& centre, const Vec& point, const Vec& half) noexcept;

/// Least distance to the surface while the point goes from `from` to `to` and the centre from `centre_from` to
/// `centre_to`, both at constant velocity, and the share of the step at which it occurs. Exact for spheres; for other,
/// static bodies the nearer end of the step.
struct Nearest {
    double distance = 0.0;
    double share = 0.0;
};
[[nodiscard]] Nearest nearest_in_step(const Threat& threat, const Vec& centre_from, const Vec& centre_to,
                                      const Vec& from, const Vec& to) noexcept;

}  // namespace jink::sim
