// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/reach/grid.hpp"
#include "core/reach/movement.hpp"

// A reach set under construction, in double precision, on the host.

namespace jink::reach::build {

/// Samples per movement, at equal shares; the last sample is the movement's end.
inline constexpr int kSamples = 8;

/// A cell that a path enters for the first time in a movement, and the interval in samples of the movement: from the
/// first sample in the cell (counted from 1) to the last.
struct Entered {
    CellIndex cell = kNoCell;
    std::uint8_t first = 0;
    std::uint8_t last = 0;
};

/// The end of one trajectory: a path of movements from the root.
struct Node {
    std::uint32_t parent = 0;  ///< the root is its own parent
    Movement movement = Movement::straight;
    std::uint8_t depth = 0;   ///< movements from the root
    std::uint8_t smooth = 0;  ///< number of smooth movements
    std::int8_t pitch_steps = 0;
    std::int8_t yaw_steps = 0;
    std::uint8_t separations = 0xF;  ///< planes that all movements stay in (acas.hpp)
    Pose<double> pose;
    CellPlace end;                     ///< cell of its end
    std::vector<CellIndex> footprint;  ///< cells of the path in order of entry, each once
    std::vector<Entered> entered;      ///< cells entered by the last movement
    double wall = 0.0;    ///< least distance of the last movement's samples in the end cell from its side walls
    double centre = 0.0;  ///< least distance of these samples from the cell's centre

    [[nodiscard]] double smoothness() const noexcept
    {
        return depth == 0 ? 1.0 : static_cast<double>(smooth) / static_cast<double>(depth);
    }
};

struct Settings {
    Grid<double> grid;
    MovementStep<double> step;
    DisplacementModel model = DisplacementModel::arc;
    bool attitude_in_key = true;  ///< trajectories with one footprint but different attitudes are distinct
    bool keep_lateral = false;    ///< trajectories that leave the grid sideways, from an outer cell, count as well
    /// Largest number of lateral trajectories per end cell: the smoothest, then the shortest.
    std::size_t most_lateral = static_cast<std::size_t>(-1);
    int most_extra = 3;           ///< largest number of consecutive movements that end in the layer where they begin
    std::int8_t root_pitch = 0;   ///< of the vehicle at the origin, in steps; the grid stays level
    std::int8_t most_down = 127;  ///< steepest pitch of any trajectory, in steps
    std::int8_t most_up = 127;
    std::uint32_t most_nodes = 1U << 20U;
};

}  // namespace jink::reach::build
