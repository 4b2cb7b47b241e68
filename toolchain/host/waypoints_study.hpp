// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/linux/vehicle_file.hpp"

// Number of waypoints that a candidate needs: errors of its costs and shape against a candidate of 1000 waypoints in
// double precision, and cost and outcome of plans.

namespace jink::host {

inline constexpr std::size_t kReferenceWaypoints = 1000;

/// Distance of the main threat [m]: two seconds of flight, but at least 2 v^2 / a so that turning is possible.
[[nodiscard]] float study_distance(const vehicle::VehicleLimits& limits);

/// Errors over all curves of the study: three families, |r| from 0.16 to 1.28, legs of -30, 0 and 30 degrees, planes
/// every 45 degrees, and a crossing threat.
struct WaypointErrors {
    std::size_t waypoints = 0;
    double time = 0.0;        ///< largest, relative
    double smoothness = 0.0;  ///< largest, relative
    double energy = 0.0;      ///< largest, relative
    double closeness = 0.0;   ///< largest, relative
    double cost = 0.0;        ///< largest error of the total cost (default weights)
    /// Largest difference between the cost errors of two curves about the same threat: bounds changes of their order.
    double order = 0.0;
    double inside = 0.0;   ///< largest distance between chords and curve over D, at the widest offset
    double typical = 0.0;  ///< the same at an offset of 0.4 D
};
/// Plans of the planner itself, over random problems with two moving threats.
struct WaypointPlans {
    std::size_t problems = 0;
    std::size_t found = 0;
    std::size_t same_choice = 0;  ///< family, plane and offset number equal those with kMaxPathPoints waypoints (or
                                  ///< neither finds a plan)
    double units = 0.0;           ///< mean work of a plan
    double microseconds = 0.0;    ///< CPU time on this host: least of nine means over the problems
};

[[nodiscard]] WaypointErrors waypoint_errors(const files::Vehicle& vehicle, std::size_t waypoints);
[[nodiscard]] std::vector<WaypointPlans>
waypoint_plans(const files::Vehicle& vehicle, const std::vector<std::uint16_t>& waypoints, std::size_t problems);
/// Largest distance between a curve of D = 1 and its chords.
[[nodiscard]] double chord_distance(std::size_t family, std::size_t waypoints, double ratio);

}  // namespace jink::host
