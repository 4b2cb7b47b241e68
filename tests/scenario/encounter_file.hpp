// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

// Recorded encounters of several aircraft (*.daa): a line of column names, a line of units, a row per aircraft and
// time; the first aircraft is the own ship. Lines that begin with # are remarks.

namespace jink::test {

/// An aircraft at one time, in a local plane (x east, y north, z up) about where the own ship was first; metres, m/s.
struct Fix {
    double time = 0.0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

struct Aircraft {
    std::string name;
    std::vector<Fix> fixes;  ///< in order of time

    /// Straight between fixes. Within the time of the fixes.
    [[nodiscard]] Eigen::Vector3d position_at(double t) const;
};

struct Encounter {
    std::vector<Aircraft> aircraft;  ///< own ship first
};

/// @throws std::runtime_error, with file and line, on columns, units or numbers that are not understood
[[nodiscard]] Encounter read_encounter(const std::filesystem::path& file);

}  // namespace jink::test
