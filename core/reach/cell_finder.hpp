// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/reach/grid.hpp"

namespace jink::reach {

/// A measure of azimuth that grows with it, without trigonometry: y over the sum of |x| and |y|, between -2 (half a
/// turn to the right) and 2. 0 for the origin.
[[nodiscard]] inline float azimuth_measure(float x, float y) noexcept
{
    const float sum = std::max(std::abs(x) + std::abs(y), 1e-30F);
    const float front = y / sum;
    return x >= 0.0F ? front : y >= 0.0F ? 2.0F - front : -2.0F - front;
}

/// Finds the cell of a point as Grid::locate does, without its angles: for many points of one grid, which may reach all
/// around, and less than 90 degrees up and down.
///
/// The same cell as Grid::locate, except for points nearer to a face than 1e-5 of the grid's size, which may count to
/// the other side of the face.
/// O(columns + rows), two roots.
class CellFinder {
public:
    /// Capacity: that of a grid of sets, or of one as fine that reaches all around.
    static constexpr std::size_t kMaxFinderColumns = 2 * kMaxColumns;

    CellFinder() noexcept = default;
    explicit CellFinder(const Grid<float>& grid) noexcept
        : layers_(grid.layers()), columns_(grid.columns()), rows_(grid.rows()), distance_(grid.distance()),
          per_layer_(static_cast<float>(grid.layers()) / grid.distance())
    {
        for (std::size_t column = 0; column <= columns_; ++column) {
            const float azimuth = grid.column_start(column);
            const float back = kPi - std::abs(azimuth);
            // By its complement where it points backwards: half a turn is 2, whatever the rounding.
            const float measure = back >= 0.5F * kPi ? azimuth_measure(std::cos(azimuth), std::sin(std::abs(azimuth)))
                                                     : 2.0F - azimuth_measure(std::cos(back), std::sin(back));
            column_[column] = azimuth < 0.0F ? -measure : measure;
        }
        for (std::size_t row = 0; row <= rows_; ++row) {
            row_[row] = std::tan(grid.row_start(row));
        }
    }
    [[nodiscard]] static bool serves(const Grid<float>& grid) noexcept
    {
        constexpr float kRightAngle = 1.57F;
        return grid.columns() <= kMaxFinderColumns && grid.rows() <= kMaxRows && grid.horizontal() <= kPi &&
               grid.vertical() < kRightAngle;
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

    /// Capacity of one `locate_all`.
    static constexpr std::size_t kAtOnce = 2 * kMaxLayers;
    using Coordinates = std::array<float, kAtOnce>;

    /// Finds the cells of the first out.size() <= kAtOnce points (x, y, z) as `locate` does, kNoCell outside. The loops
    /// run over points, so that the compiler can use vector registers. O(points * (columns + rows)).
    void locate_all(const Coordinates& x, const Coordinates& y, const Coordinates& z,
                    std::span<CellIndex> out) const noexcept
    {
        const std::size_t n = out.size();
        Coordinates level;
        Coordinates distance;
        Coordinates azimuth;
        Coordinates column;
        Coordinates row;
        for (std::size_t i = 0; i < n; ++i) {
            const float level_squared = x[i] * x[i] + y[i] * y[i];
            level[i] = std::sqrt(level_squared);
            distance[i] = std::sqrt(level_squared + z[i] * z[i]);
            azimuth[i] = azimuth_measure(x[i], y[i]);
            column[i] = row[i] = 0.0F;
        }
        for (std::size_t face = 1; face < columns_; ++face) {
            for (std::size_t i = 0; i < n; ++i) {
                column[i] += azimuth[i] > column_[face] ? 1.0F : 0.0F;
            }
        }
        for (std::size_t face = 1; face < rows_; ++face) {
            for (std::size_t i = 0; i < n; ++i) {
                row[i] += z[i] > level[i] * row_[face] ? 1.0F : 0.0F;
            }
        }
        const auto most = static_cast<float>(layers_);
        const auto columns = static_cast<float>(columns_);
        const auto rows = static_cast<float>(rows_);
        for (std::size_t i = 0; i < n; ++i) {
            // Rounded up, minus one, without a library call.
            const float layers = std::min(most, distance[i] * per_layer_);
            const auto whole = static_cast<float>(static_cast<std::int32_t>(layers));
            const float layer = std::max(whole - (whole == layers ? 1.0F : 0.0F), 0.0F);
            const auto cell = static_cast<std::int32_t>((layer * columns + column[i]) * rows + row[i]);
            const bool inside = distance[i] <= distance_ && azimuth[i] >= column_[0] &&
                                azimuth[i] <= column_[columns_] && z[i] >= level[i] * row_[0] &&
                                z[i] <= level[i] * row_[rows_];
            out[i] = static_cast<CellIndex>(inside ? cell : std::int32_t{kNoCell});
        }
    }

    /// Column and row of the direction of `point`, finite, of any length; false outside the grid's angles.
    [[nodiscard]] bool find_direction(const Vec3& point, CellPlace& place) const noexcept
    {
        const float level = std::sqrt(point.x() * point.x() + point.y() * point.y());
        const float azimuth = azimuth_measure(point.x(), point.y());
        if (azimuth < column_[0] || azimuth > column_[columns_] || point.z() < level * row_[0] ||
            point.z() > level * row_[rows_]) {
            return false;
        }
        std::uint32_t columns_below = 0;
        for (std::size_t face = 1; face < columns_; ++face) {
            columns_below += azimuth > column_[face] ? 1U : 0U;
        }
        std::uint32_t rows_below = 0;
        for (std::size_t face = 1; face < rows_; ++face) {
            rows_below += point.z() > level * row_[face] ? 1U : 0U;
        }
        place = {0, static_cast<std::uint8_t>(columns_below), static_cast<std::uint8_t>(rows_below)};
        return true;
    }
    /// Layer of a point at `distance`; points beyond the grid count to the last layer. O(1).
    [[nodiscard]] std::uint8_t layer_of(float distance) const noexcept
    {
        const float layer = std::ceil(distance * per_layer_) - 1.0F;
        return static_cast<std::uint8_t>(std::clamp(layer, 0.0F, static_cast<float>(layers_ - 1)));
    }
    [[nodiscard]] float distance() const noexcept { return distance_; }

private:
    std::size_t layers_ = 0;
    std::size_t columns_ = 0;
    std::size_t rows_ = 0;
    float distance_ = -1.0F;
    float per_layer_ = 0.0F;
    std::array<float, kMaxFinderColumns + 1> column_{};  ///< azimuth_measure() of the faces
    std::array<float, kMaxRows + 1> row_{};              ///< tangents of the faces
};

}  // namespace jink::reach
