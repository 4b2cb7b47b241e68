// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/app/constraints.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// A closed volume or a storm cell: an upright cylinder in straight level motion. A ground station reports it at the
/// start of the flight (AreaSender).
struct ClosedArea {
    std::string name;
    double radius = 1.0;         ///< [m]
    double bottom = 0.0;         ///< [m]
    double top = 0.0;            ///< [m]
    double margin = 0.0;         ///< soft, about the circle [m]
    Vec centre = Vec::Zero();    ///< at time 0, z is ignored [m]
    Vec velocity = Vec::Zero();  ///< level [m/s]

    [[nodiscard]] Vec centre_at(double t) const { return centre + velocity * t; }
};

/// Signed distance of a point from the body at time `t` [m]; inside negative, to the nearest surface.
[[nodiscard]] double surface_distance(const ClosedArea& area, double t, const Vec& point);

/// The areas as reported by a sender whose clock reads `start` when the flight begins.
[[nodiscard]] std::vector<app::Constraint> constraints_of(const std::vector<ClosedArea>& areas, TimePoint start);

}  // namespace jink::sim
