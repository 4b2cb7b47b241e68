// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/reach/grid.hpp"

// What a scanning range sensor says of the grid's cells (Gomola 6.5.1). Points are counted as they come, none is kept.

namespace jink::reach {

/// What happened to a point.
enum class PointStatus : std::uint8_t { counted, beyond, outside, not_a_number };

/// A scan by cells. Cells beyond those of the grid are not used.
///
/// Memory: 6 bytes for each of kCells cells, 6 for each of kDirections.
class LidarScan {
public:
    static constexpr std::size_t kCells = 512;      ///< most that a grid may have here
    static constexpr std::size_t kDirections = 64;  ///< columns times rows, most

    /// @param grid  its unit of length is that of the points; outlives this
    /// @param horizontal_pitch, vertical_pitch  between neighbouring rays [rad], > 0
    /// False, and nothing is counted, when the grid is larger than there is room for or a direction has no ray.
    [[nodiscard]] bool configure(const Grid<float>& grid, float horizontal_pitch, float vertical_pitch) noexcept;

    /// Forgets the points of the scan before. O(cells).
    void begin() noexcept;

    /// A first return, in the grid's frame. O(1).
    PointStatus add(const Point<float>& point) noexcept { return add(to_polar(point)); }
    PointStatus add(const Polar<float>& point) noexcept;
    /// The same of a point that is known to lie in a cell of the grid.
    /// @param distance  from the sensor [grid's unit]
    void add(const CellPlace& place, float distance) noexcept;

    /// Share of the rays through the cell that end in it (as 6.98 and the figures have it; 6.92 prints the opposite).
    [[nodiscard]] float hindrance(const CellPlace& place) const noexcept;
    /// Obstacle rating: the surface that was hit over the least one that is a threat, 1 at most. A plate has the same
    /// rating far away as nearby.
    [[nodiscard]] float obstacle(const CellPlace& place, float threshold_area) const noexcept;
    /// Share of the rays that come to the cell at all: what is not stopped in the layers before. Of all cells of a
    /// direction in turn.
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
