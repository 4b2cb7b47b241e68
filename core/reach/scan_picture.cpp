// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/scan_picture.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"

namespace jink::reach {
namespace {

/// Points of a cell at these shares of each of its ranges.
constexpr std::array<float, 2> kInside{0.25F, 0.75F};

/// Anything that is hit is an obstacle: how large it is, is no question of life.
constexpr float kAnyHit = 1e-3F;

Vec3 inside_of(const Grid<float>& grid, const CellPlace& place, float distance, float across, float up) noexcept
{
    const auto between = [](float from, float to, float share) { return from + share * (to - from); };
    return from_polar(
        Polar<float>{between(grid.layer_start(place.layer), grid.layer_end(place.layer), distance),
                     between(grid.column_start(place.column), grid.column_start(place.column + 1U), across),
                     between(grid.row_start(place.row), grid.row_start(place.row + 1U), up)});
}

template <class Look>
void for_each_inside(const Grid<float>& grid, const CellPlace& place, const Look& look) noexcept
{
    for (const float distance : kInside) {
        for (const float across : kInside) {
            for (const float up : kInside) {
                look(inside_of(grid, place, distance, across, up));
            }
        }
    }
}

}  // namespace

bool ScanPicture::configure(const Grid<float>& sets) noexcept
{
    const std::size_t columns = sets.columns() + 2 * kSpareColumns;
    const float horizontal = sets.horizontal() * static_cast<float>(columns) / static_cast<float>(sets.columns());
    known_ = counts_ = false;
    has_grid_ = sets.cells() > 0 && horizontal <= kPi && columns * sets.rows() <= LidarScan::kDirections &&
                sets.layers() * columns * sets.rows() <= LidarScan::kCells;
    if (has_grid_) {
        grid_ = Grid<float>(sets.layers(), columns, sets.rows(), sets.distance(), horizontal, sets.vertical());
    }
    return has_grid_;
}

bool ScanPicture::begin(const ScanStart& start) noexcept
{
    const std::size_t filled = 1 - seen_;
    counts_ = has_grid_ && is_finite(start.position) && std::isfinite(start.nose) && std::isfinite(start.course) &&
              is_positive(start.unit) && scans_[filled].configure(grid_, start.horizontal_pitch, start.vertical_pitch);
    start_[filled] = start;
    return counts_;
}

void ScanPicture::add(const Vec3& point) noexcept
{
    if (!counts_) {
        return;
    }
    const ScanStart& start = start_[1 - seen_];
    const float turn = start.nose - start.course;
    const float c = std::cos(turn);
    const float s = std::sin(turn);
    static_cast<void>(scans_[1 - seen_].add(
        Vec3(Vec3(c * point.x() - s * point.y(), s * point.x() + c * point.y(), point.z()) / start.unit)));
}

void ScanPicture::add_invalid(const Vec3& direction) noexcept
{
    if (!counts_) {
        return;
    }
    const ScanStart& start = start_[1 - seen_];
    Polar<float> polar = to_polar(direction);
    polar.horizontal = std::remainder(polar.horizontal + start.nose - start.course, 2.0F * kPi);
    polar.distance = 0.5F * grid_.distance();
    if (const Located at = grid_.locate(polar); at.status == LocateStatus::inside) {
        scans_[1 - seen_].add_invalid(at.place.column, at.place.row);
    }
}

void ScanPicture::end(std::uint32_t lost) noexcept
{
    if (counts_) {
        seen_ = 1 - seen_;
        lost_[seen_] = lost;
        known_ = true;
    }
    counts_ = false;
}

bool ScanPicture::is_fresh(TimePoint now, Seconds age) const noexcept
{
    return known_ && now - start_[seen_].stamp <= age;
}

Placed ScanPicture::frame() const noexcept
{
    Placed placed;
    placed.origin = start_[seen_].position;
    placed.cosine = std::cos(start_[seen_].course);
    placed.sine = std::sin(start_[seen_].course);
    placed.unit = start_[seen_].unit;
    return placed;
}

bool ScanPicture::rate(const Placed& placed, bool blocks_unseen, std::span<Level> blocks,
                       WorkBudget& budget) const noexcept
{
    constexpr Level kBlocked = static_cast<Level>(AvoidanceRun::obstacles);
    const Grid<float>& sets = placed.set->grid;
    if (!budget.spend(static_cast<std::uint32_t>(units::kReachScanCell * (sets.cells() + grid_.cells())))) {
        return false;
    }
    const Placed from = frame();
    const LidarScan& scan = scans_[seen_];
    std::array<bool, LidarScan::kCells> is_seen{};
    std::array<float, kMaxLayers> visible{};
    for (std::size_t column = 0; column < grid_.columns(); ++column) {
        for (std::size_t row = 0; row < grid_.rows(); ++row) {
            scan.visibility(column, row, visible);
            for (std::size_t layer = 0; layer < grid_.layers(); ++layer) {
                const CellPlace place{static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                      static_cast<std::uint8_t>(row)};
                is_seen[grid_.index(place)] = lost_[seen_] == 0 && visible[layer] >= 1.0F - kThreshold;
            }
        }
    }
    for (std::size_t i = 0; i < sets.cells(); ++i) {
        blocks[i] = kFree;
        for_each_inside(sets, sets.place(static_cast<CellIndex>(i)), [&](const Vec3& point) {
            const Located at = grid_.locate(from.to_set(placed.to_world(point)));
            const bool known = at.status == LocateStatus::inside;
            const bool hit = known && scan.obstacle(at.place, kAnyHit) >= kThreshold;
            const bool unseen = !known || !is_seen[grid_.index(at.place)];
            blocks[i] = hit || (unseen && blocks_unseen) ? kBlocked : blocks[i];
        });
    }
    for (std::size_t i = 0; i < grid_.cells(); ++i) {
        const CellPlace place = grid_.place(static_cast<CellIndex>(i));
        if (scan.obstacle(place, kAnyHit) < kThreshold) {
            continue;
        }
        const auto block = [&](const Vec3& point) {
            const Located at = sets.locate(placed.to_set(from.to_world(point)));
            if (at.status == LocateStatus::inside) {
                blocks[sets.index(at.place)] = kBlocked;
            }
        };
        block(grid_.centre(place));
        for_each_inside(grid_, place, block);
    }
    return true;
}

}  // namespace jink::reach
