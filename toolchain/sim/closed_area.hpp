// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/app/constraints.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// A closed volume or a storm cell: an upright cylinder that goes straight on. The co-processor is told of it at the
/// start of the flight, as it is.
struct ClosedArea {
    std::string name;
    double radius = 1.0;         ///< [m]
    double bottom = 0.0;         ///< [m]
    double top = 0.0;            ///< [m]
    double margin = 0.0;         ///< soft, about the circle [m]
    Vec centre = Vec::Zero();    ///< at time 0, z counts for nothing [m]
    Vec velocity = Vec::Zero();  ///< level [m/s]

    [[nodiscard]] Vec centre_at(double t) const { return centre + velocity * t; }
};

/// Distance of a point from the body at time `t` [m]; inside it below 0, by the least way out.
[[nodiscard]] double surface_distance(const ClosedArea& area, double t, const Vec& point);

/// As a co-processor is told that has its clock at `start` when the flight begins.
[[nodiscard]] std::vector<app::Constraint> constraints_of(const std::vector<ClosedArea>& areas, TimePoint start);

/// As jinkd reads it (firmware/linux/airspace_file.hpp), the flight having begun at `began` seconds since 1970.
[[nodiscard]] std::string airspace_text(const std::vector<ClosedArea>& areas, double began);
/// The same written now into a file, at once for whoever reads it. @throws std::runtime_error when that fails
void write_airspace(const std::filesystem::path& file, const std::vector<ClosedArea>& areas);

}  // namespace jink::sim
