// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/reach/grid.hpp"

namespace jink::reach {

/// The spheres about all cells of a grid, computed with few sines: directions of the centres, and radii, which are the
/// same for all columns. Construction: O(columns + rows * layers).
///
/// Memory: 12 bytes a direction, 4 for each layer of each row: about 0.7 KiB for 10 layers of 7 by 5.
class CellSpheres {
public:
    static constexpr std::size_t kMaxDirections = 64;

    CellSpheres() noexcept = default;
    explicit CellSpheres(const Grid<float>& grid) noexcept;

    [[nodiscard]] bool are_of(const Grid<float>& grid) const noexcept
    {
        return grid_.layers() == grid.layers() && grid_.columns() == grid.columns() && grid_.rows() == grid.rows() &&
               grid_.distance() == grid.distance() && grid_.horizontal() == grid.horizontal() &&
               grid_.vertical() == grid.vertical();
    }
    /// Direction of the cells' middles; times the middle of a layer: the cells' centres.
    [[nodiscard]] const Vec3& direction(std::size_t column, std::size_t row) const noexcept
    {
        return directions_[column * grid_.rows() + row];
    }
    [[nodiscard]] float distance(std::size_t layer) const noexcept { return distances_[layer]; }
    [[nodiscard]] Vec3 centre(const CellPlace& place) const noexcept
    {
        return distances_[place.layer] * direction(place.column, place.row);
    }
    [[nodiscard]] float radius(std::size_t layer, std::size_t row) const noexcept
    {
        return radii_[layer * kMaxRows + row];
    }
    /// False for grids with more directions than kMaxDirections.
    [[nodiscard]] static bool serves(const Grid<float>& grid) noexcept
    {
        return grid.columns() * grid.rows() <= kMaxDirections;
    }

private:
    Grid<float> grid_{0, 0, 0, 0.0F, 0.0F, 0.0F};
    std::array<Vec3, kMaxDirections> directions_{};
    std::array<float, kMaxLayers> distances_{};
    std::array<float, kMaxLayers * kMaxRows> radii_{};
};

}  // namespace jink::reach
