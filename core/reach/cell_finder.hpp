// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "core/reach/grid.hpp"

namespace jink::reach {

/// Finds the cell of a point as Grid::locate does, without its angles: for many points of one grid, of less than 90
/// degrees to either side, and up and down.
///
/// The same cell but for points nearer to a face than 1e-5 of the grid's size, which may count to the other side of it.
/// O(columns + rows), two roots.
class CellFinder {
public:
    CellFinder() noexcept = default;
    explicit CellFinder(const Grid<float>& grid) noexcept
        : layers_(grid.layers()), columns_(grid.columns()), rows_(grid.rows()), distance_(grid.distance()),
          per_layer_(static_cast<float>(grid.layers()) / grid.distance())
    {
        for (std::size_t column = 0; column <= columns_; ++column) {
            column_[column] = std::tan(grid.column_start(column));
        }
        for (std::size_t row = 0; row <= rows_; ++row) {
            row_[row] = std::tan(grid.row_start(row));
        }
    }
    [[nodiscard]] static bool serves(const Grid<float>& grid) noexcept
    {
        constexpr float kRightAngle = 1.57F;
        return grid.horizontal() < kRightAngle && grid.vertical() < kRightAngle;
    }

    [[nodiscard]] Located locate(const Vec3& point) const noexcept
    {
        const float distance = point.norm();
        if (std::isnan(distance)) {
            return {LocateStatus::not_a_number, {}};
        }
        CellPlace place;
        if (!(distance <= distance_) || !find_direction(point, place)) {
            return {LocateStatus::outside, {}};
        }
        place.layer = layer_of(distance);
        return {LocateStatus::inside, place};
    }

    /// Column and row of the direction of `point`, finite, of any length; false outside the grid's angles.
    [[nodiscard]] bool find_direction(const Vec3& point, CellPlace& place) const noexcept
    {
        const float level = std::sqrt(point.x() * point.x() + point.y() * point.y());
        if (point.x() < 0.0F || point.y() < point.x() * column_[0] || point.y() > point.x() * column_[columns_] ||
            point.z() < level * row_[0] || point.z() > level * row_[rows_]) {
            return false;
        }
        place = {};
        for (std::size_t column = 1; column < columns_; ++column) {
            place.column = static_cast<std::uint8_t>(place.column + (point.y() > point.x() * column_[column] ? 1 : 0));
        }
        for (std::size_t row = 1; row < rows_; ++row) {
            place.row = static_cast<std::uint8_t>(place.row + (point.z() > level * row_[row] ? 1 : 0));
        }
        return true;
    }
    /// Layer of what is not beyond the grid. O(1).
    [[nodiscard]] std::uint8_t layer_of(float distance) const noexcept
    {
        const float layer = std::ceil(distance * per_layer_) - 1.0F;
        return static_cast<std::uint8_t>(std::fmax(0.0F, std::fmin(layer, static_cast<float>(layers_ - 1))));
    }
    [[nodiscard]] float distance() const noexcept { return distance_; }

private:
    std::size_t layers_ = 0;
    std::size_t columns_ = 0;
    std::size_t rows_ = 0;
    float distance_ = -1.0F;
    float per_layer_ = 0.0F;
    std::array<float, kMaxColumns + 1> column_{};  ///< tangents of the faces
    std::array<float, kMaxRows + 1> row_{};
};

}  // namespace jink::reach
