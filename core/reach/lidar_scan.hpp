// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/reach/grid.hpp"

// Ratings of the grid's cells by a scanning range sensor (Gomola 6.5.1). Points are counted as they arrive and are not
// stored.

namespace jink::reach {

/// Result of adding a point.
enum class PointStatus : std::uint8_t { counted, beyond, outside, not_a_number };

/// A scan counted by cells. Arrays beyond the grid's cells are unused.
///
/// Memory: 6 bytes for each of kCells cells, 6 for each of kDirections.
class LidarScan {
public:
    static constexpr std::size_t kCells = 2560;      ///< capacity for the cells of a grid
    static constexpr std::size_t kDirections = 256;  ///< capacity for columns times rows

    /// @param grid  its unit of length is that of the points; outlives this
    /// @param horizontal_pitch, vertical_pitch  between neighbouring rays [rad], > 0
    /// @return false, with nothing counted, if the grid exceeds the capacity or a direction has no ray.
    [[nodiscard]] bool configure(const Grid<float>& grid, float horizontal_pitch, float vertical_pitch) noexcept;

    /// Clears the points of the previous scan. O(cells).
    void begin() noexcept;

    /// Adds a first return, in the grid's frame. O(1).
    PointStatus add(const Point<float>& point) noexcept { return add(to_polar(point)); }
    PointStatus add(const Polar<float>& point) noexcept;
    /// Adds a first return that is known to lie in a cell of the grid.
    /// @param distance  from the sensor [grid's unit]
    void add(const CellPlace& place, float distance) noexcept;

    /// Share of the rays through the cell that end in the cell (as in eq. 6.98 and the figures; eq. 6.92 prints the
    /// opposite).
    [[nodiscard]] float hindrance(const CellPlace& place) const noexcept;
    /// Obstacle rating: the surface that was hit over the least surface that is a threat, 1 at most. A plate has the
    /// same rating at any distance.
    [[nodiscard]] float obstacle(const CellPlace& place, float threshold_area) const noexcept;
    /// Share of the rays that reach the cell: those that do not end in the layers before. For all cells of a direction
    /// in turn.
    /// @param out  for each layer
    void visibility(std::size_t column, std::size_t row, std::span<float> out) const noexcept;

    [[nodiscard]] std::uint32_t points() const noexcept { return points_; }
    [[nodiscard]] std::uint16_t rays(std::size_t column, std::size_t row) const noexcept
    {
        return rays_[direction(column, row)];
    }

private:
    [[nodiscard]] std::size_t direction(std::size_t column, std::size_t row) const noexcept
    {
        return column * grid_->rows() + row;
    }

    const Grid<float>* grid_ = nullptr;
    std::array<std::uint16_t, kDirections> rays_{};
    std::array<std::uint16_t, kCells> hits_{};
    std::array<float, kCells> distances_{};  ///< sum over the hits
    std::uint32_t points_ = 0;
};

/// Surface of the sphere of `radius` within a cell's angles (Gomola eq. 6.93). O(1).
[[nodiscard]] float area_of(const Grid<float>& grid, std::size_t column, std::size_t row, float radius) noexcept;

}  // namespace jink::reach
