// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/lidar_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jink::reach {
namespace {

/// Rays of a scanner with `pitch` between neighbours whose direction lies in (from, to]; one ray points at 0.
std::uint32_t rays_between(float from, float to, float pitch) noexcept
{
    constexpr float kTolerance = 1e-4F;  // of a pitch: faces on which rays lie belong to the cell before
    const float first = std::floor(from / pitch + kTolerance);
    const float last = std::floor(to / pitch + kTolerance);
    return static_cast<std::uint32_t>(std::max(last - first, 0.0F));
}

std::uint16_t one_more(std::uint16_t count) noexcept
{
    return count < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(count + 1U) : count;
}

}  // namespace

bool LidarScan::configure(const Grid<float>& grid, float horizontal_pitch, float vertical_pitch) noexcept
{
    grid_ = nullptr;
    if (grid.cells() > kCells || grid.columns() * grid.rows() > kDirections || !(horizontal_pitch > 0.0F) ||
        !(vertical_pitch > 0.0F)) {
        return false;
    }
    for (std::size_t column = 0; column < grid.columns(); ++column) {
        for (std::size_t row = 0; row < grid.rows(); ++row) {
            const std::uint32_t across =
                rays_between(grid.column_start(column), grid.column_start(column + 1), horizontal_pitch);
            const std::uint32_t up = rays_between(grid.row_start(row), grid.row_start(row + 1), vertical_pitch);
            const std::uint32_t rays = across * up;
            if (rays == 0 || rays > std::numeric_limits<std::uint16_t>::max()) {
                return false;
            }
            rays_[column * grid.rows() + row] = static_cast<std::uint16_t>(rays);
        }
    }
    grid_ = &grid;
    begin();
    return true;
}

void LidarScan::begin() noexcept
{
    hits_.fill(0);
    distances_.fill(0.0F);
    points_ = 0;
}

PointStatus LidarScan::add(const Polar<float>& point) noexcept
{
    if (grid_ == nullptr) {
        return PointStatus::outside;
    }
    const Located at = grid_->locate(point);
    if (at.status == LocateStatus::not_a_number) {
        return PointStatus::not_a_number;
    }
    if (at.status == LocateStatus::outside) {
        const bool farther = point.distance > grid_->distance() && std::abs(point.horizontal) <= grid_->horizontal() &&
                             std::abs(point.vertical) <= grid_->vertical();
        return farther ? PointStatus::beyond : PointStatus::outside;
    }
    add(at.place, point.distance);
    return PointStatus::counted;
}

void LidarScan::add(const CellPlace& place, float distance) noexcept
{
    const CellIndex cell = grid_->index(place);
    hits_[cell] = one_more(hits_[cell]);
    distances_[cell] += distance;
    ++points_;
}

float LidarScan::hindrance(const CellPlace& place) const noexcept
{
    const float share =
        static_cast<float>(hits_[grid_->index(place)]) / static_cast<float>(rays(place.column, place.row));
    return std::min(share, 1.0F);  // more points than rays: several returns, or a finer sensor than configured
}

float LidarScan::obstacle(const CellPlace& place, float threshold_area) const noexcept
{
    const std::uint16_t hits = hits_[grid_->index(place)];
    if (hits == 0) {
        return 0.0F;
    }
    const float radius = distances_[grid_->index(place)] / static_cast<float>(hits);
    const float area = hindrance(place) * area_of(*grid_, place.column, place.row, radius);
    return area < threshold_area ? area / threshold_area : 1.0F;
}

void LidarScan::visibility(std::size_t column, std::size_t row, std::span<float> out) const noexcept
{
    float left = 1.0F;
    for (std::size_t layer = 0; layer < grid_->layers(); ++layer) {
        out[layer] = left;
        left = std::max(left - hindrance({static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                          static_cast<std::uint8_t>(row)}),
                        0.0F);
    }
}

float area_of(const Grid<float>& grid, std::size_t column, std::size_t row, float radius) noexcept
{
    return radius * radius * (std::sin(grid.row_start(row + 1)) - std::sin(grid.row_start(row))) *
           (grid.column_start(column + 1) - grid.column_start(column));
}

}  // namespace jink::reach
