// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/vec3.hpp"
#include "core/reach/movement.hpp"

// The avoidance grid: the space in front of the vehicle in polar cells, in layers of equal thickness (Gomola 6.3).

namespace jink::reach {

/// Capacities: layers, columns and rows of a grid.
inline constexpr std::size_t kMaxLayers = 16;
inline constexpr std::size_t kMaxColumns = 16;
inline constexpr std::size_t kMaxRows = 16;

using CellIndex = std::uint16_t;
inline constexpr CellIndex kNoCell = 0xFFFF;

/// Layer, column and row, counted from 0; Gomola counts from 1.
struct CellPlace {
    std::uint8_t layer = 0;
    std::uint8_t column = 0;  ///< from the right to the left
    std::uint8_t row = 0;     ///< from below upwards
    friend constexpr bool operator==(const CellPlace&, const CellPlace&) noexcept = default;
};

enum class LocateStatus : std::uint8_t { inside, outside, not_a_number };
struct Located {
    LocateStatus status = LocateStatus::outside;
    CellPlace place;
};

/// Distance, azimuth (left positive) and elevation (up positive) of a point.
template <class T>
struct Polar {
    T distance = T(0);
    T horizontal = T(0);  ///< [rad]
    T vertical = T(0);    ///< [rad]
};
template <class T>
[[nodiscard]] Polar<T> to_polar(const Point<T>& p) noexcept
{
    return {p.norm(), std::atan2(p.y(), p.x()), std::atan2(p.z(), std::hypot(p.x(), p.y()))};
}
template <class T>
[[nodiscard]] Point<T> from_polar(const Polar<T>& p) noexcept
{
    const T level = p.distance * std::cos(p.vertical);
    return {level * std::cos(p.horizontal), level * std::sin(p.horizontal), p.distance * std::sin(p.vertical)};
}

/// Ranges and numbers of cells. Cells are half-open, (start, end], but the first cell of each range includes its start:
/// with Gomola's rule the origin and the faces at the lower ends would lie in no cell. Points within 1e-6 (float;
/// double: 1e-9) of a cell's size past a face count to the cell before it. So a point that lies on a face by
/// construction lies in the same cell on every machine.
template <class T>
class Grid {
public:
    /// Gomola's grid: 10 layers of one movement each, 90 by 60 degrees in 7 by 5.
    constexpr Grid() noexcept = default;
    constexpr Grid(std::size_t layers, std::size_t columns, std::size_t rows, T distance, T horizontal,
                   T vertical) noexcept
        : layers_(layers), columns_(columns), rows_(rows), distance_(distance), horizontal_(horizontal),
          vertical_(vertical)
    {
    }

    [[nodiscard]] constexpr std::size_t layers() const noexcept { return layers_; }
    [[nodiscard]] constexpr std::size_t columns() const noexcept { return columns_; }
    [[nodiscard]] constexpr std::size_t rows() const noexcept { return rows_; }
    [[nodiscard]] constexpr std::size_t cells() const noexcept { return layers_ * columns_ * rows_; }
    /// End of the outermost layer.
    [[nodiscard]] constexpr T distance() const noexcept { return distance_; }
    /// Half angle to either side [rad].
    [[nodiscard]] constexpr T horizontal() const noexcept { return horizontal_; }
    /// Half angle up and down [rad].
    [[nodiscard]] constexpr T vertical() const noexcept { return vertical_; }

    [[nodiscard]] T layer_end(std::size_t layer) const noexcept
    {
        return distance_ * static_cast<T>(layer + 1) / static_cast<T>(layers_);
    }
    [[nodiscard]] T layer_start(std::size_t layer) const noexcept
    {
        return distance_ * static_cast<T>(layer) / static_cast<T>(layers_);
    }
    /// Lower face of a column; for the column past the last: the grid's end.
    [[nodiscard]] T column_start(std::size_t column) const noexcept
    {
        return horizontal_ * (T(2) * static_cast<T>(column) / static_cast<T>(columns_) - T(1));
    }
    [[nodiscard]] T row_start(std::size_t row) const noexcept
    {
        return vertical_ * (T(2) * static_cast<T>(row) / static_cast<T>(rows_) - T(1));
    }

    [[nodiscard]] CellIndex index(const CellPlace& place) const noexcept
    {
        return static_cast<CellIndex>((place.layer * columns_ + place.column) * rows_ + place.row);
    }
    [[nodiscard]] CellPlace place(CellIndex cell) const noexcept
    {
        const std::size_t in_layer = columns_ * rows_;
        // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a grid that has the cell has a row
        return {static_cast<std::uint8_t>(cell / in_layer), static_cast<std::uint8_t>(cell % in_layer / rows_),
                static_cast<std::uint8_t>(cell % rows_)};
    }
    /// Middle of each range.
    [[nodiscard]] Point<T> centre(const CellPlace& place) const noexcept
    {
        return from_polar(Polar<T>{(layer_start(place.layer) + layer_end(place.layer)) / T(2),
                                   (column_start(place.column) + column_start(place.column + 1U)) / T(2),
                                   (row_start(place.row) + row_start(place.row + 1U)) / T(2)});
    }
    [[nodiscard]] T volume(const CellPlace& place) const noexcept
    {
        const T outer = layer_end(place.layer);
        const T inner = layer_start(place.layer);
        return (outer * outer * outer - inner * inner * inner) / T(3) *
               (std::sin(row_start(place.row + 1U)) - std::sin(row_start(place.row))) *
               (column_start(place.column + 1U) - column_start(place.column));
    }
    /// Whether the cell has a wall on the grid's border, except the border at the vehicle.
    [[nodiscard]] bool is_outer(const CellPlace& place) const noexcept
    {
        return place.layer + 1U == layers_ || place.column == 0 || place.column + 1U == columns_ || place.row == 0 ||
               place.row + 1U == rows_;
    }

    /// The cell of a point. O(1): two arc tangents, two roots.
    [[nodiscard]] Located locate(const Point<T>& p) const noexcept { return locate(to_polar(p)); }
    [[nodiscard]] Located locate(const Polar<T>& p) const noexcept
    {
        const T layer = p.distance / distance_ * static_cast<T>(layers_);
        const T column = (p.horizontal / horizontal_ + T(1)) / T(2) * static_cast<T>(columns_);
        const T row = (p.vertical / vertical_ + T(1)) / T(2) * static_cast<T>(rows_);
        if (!(std::isfinite(layer) && std::isfinite(column) && std::isfinite(row))) {
            return {LocateStatus::not_a_number, {}};
        }
        const auto past = [](T at, std::size_t count) {
            return at < -tolerance() || at > static_cast<T>(count) + tolerance();
        };
        if (past(layer, layers_) || past(column, columns_) || past(row, rows_)) {
            return {};
        }
        return {LocateStatus::inside, {part(layer, layers_), part(column, columns_), part(row, rows_)}};
    }

private:
    [[nodiscard]] static constexpr T tolerance() noexcept { return sizeof(T) == sizeof(float) ? T(1e-6) : T(1e-9); }

    [[nodiscard]] static std::uint8_t part(T at, std::size_t count) noexcept
    {
        const T end = std::ceil(at - tolerance());
        return static_cast<std::uint8_t>(std::clamp(end - T(1), T(0), static_cast<T>(count) - T(1)));
    }

    std::size_t layers_ = 10;
    std::size_t columns_ = 7;
    std::size_t rows_ = 5;
    T distance_ = T(10);
    T horizontal_ = T(0.78539816339744831);
    T vertical_ = T(0.52359877559829888);
};

}  // namespace jink::reach
