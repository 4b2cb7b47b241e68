// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/scan_picture.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"

namespace jink::reach {
namespace {

/// Sample points of a cell lie at these shares of each of its ranges.
constexpr std::array<float, 2> kInside{0.25F, 0.75F};

/// Of a number of columns.
constexpr float kRounding = 1e-3F;
/// All around; with fewer there is no picture.
constexpr std::size_t kMinColumns = 7;

/// Any hit is an obstacle, whatever its size.
constexpr float kAnyHit = 1e-3F;

/// The sample points of all cells of a grid, computed with few sines.
class InnerPoints {
public:
    explicit InnerPoints(const Grid<float>& grid) noexcept : grid_(grid)
    {
        for (std::size_t i = 0; i < kPerAxis; ++i) {
            for (std::size_t column = 0; column < grid.columns(); ++column) {
                const float angle = between(grid.column_start(column), grid.column_start(column + 1), kInside[i]);
                across_[kPerAxis * column + i] = {std::cos(angle), std::sin(angle)};
            }
            for (std::size_t row = 0; row < grid.rows(); ++row) {
                const float angle = between(grid.row_start(row), grid.row_start(row + 1), kInside[i]);
                up_[kPerAxis * row + i] = {std::cos(angle), std::sin(angle)};
            }
        }
    }

    static constexpr std::size_t kPerAxis = kInside.size();

    [[nodiscard]] Vec3 direction(std::size_t column, std::size_t i, std::size_t row, std::size_t j) const noexcept
    {
        const Eigen::Vector2f& across = across_[kPerAxis * column + i];
        const Eigen::Vector2f& up = up_[kPerAxis * row + j];
        return {up.x() * across.x(), up.x() * across.y(), up.y()};
    }
    [[nodiscard]] float distance(std::size_t layer, std::size_t k) const noexcept
    {
        return between(grid_.layer_start(layer), grid_.layer_end(layer), kInside[k]);
    }

private:
    [[nodiscard]] static float between(float from, float to, float share) noexcept
    {
        return from + share * (to - from);
    }

    const Grid<float>& grid_;
    std::array<Eigen::Vector2f, kPerAxis * CellFinder::kMaxFinderColumns> across_;
    std::array<Eigen::Vector2f, kPerAxis * kMaxRows> up_;
};

void block_if(bool blocked, Level& level) noexcept
{
    level = blocked ? static_cast<Level>(AvoidanceRun::obstacles) : level;
}

/// Transforms points of one frame to another one, both upright or upside down.
class Map {
public:
    Map(const Placed& of, const Placed& in) noexcept
        : offset_(in.to_set(of.origin)), x_(in.to_set(of.to_world(Vec3::UnitX())) - offset_),
          y_(in.to_set(of.to_world(Vec3::UnitY())) - offset_),
          z_(in.to_set(of.to_world(Vec3::UnitZ())).z() - offset_.z())
    {
    }
    /// Transforms a direction from the origin.
    [[nodiscard]] Vec3 along(const Vec3& direction) const noexcept
    {
        return direction.x() * x_ + direction.y() * y_ + Vec3(0.0F, 0.0F, z_ * direction.z());
    }
    [[nodiscard]] const Vec3& offset() const noexcept { return offset_; }

private:
    Vec3 offset_;
    Vec3 x_;
    Vec3 y_;
    float z_;
};

/// Points whose cells are found in one call.
class Places {
public:
    explicit Places(const CellFinder& finder) noexcept : finder_(finder) {}

    void begin() noexcept { count_ = 0; }
    void add(const Vec3& point) noexcept
    {
        x_[count_] = point.x();
        y_[count_] = point.y();
        z_[count_++] = point.z();
    }
    [[nodiscard]] std::span<const CellIndex> find() noexcept
    {
        const std::span<CellIndex> cells(cells_.data(), count_);
        finder_.locate_all(x_, y_, z_, cells);
        return cells;
    }

private:
    const CellFinder& finder_;
    CellFinder::Coordinates x_{};
    CellFinder::Coordinates y_{};
    CellFinder::Coordinates z_{};
    std::array<CellIndex, CellFinder::kAtOnce> cells_{};
    std::size_t count_ = 0;
};

}  // namespace

bool ScanPicture::configure(const Grid<float>& sets) noexcept
{
    known_ = counts_ = has_grid_ = false;
    if (sets.cells() == 0) {
        return false;
    }
    const std::size_t fit = std::min({CellFinder::kMaxFinderColumns, LidarScan::kDirections / sets.rows(),
                                      LidarScan::kCells / (sets.rows() * sets.layers())});
    if (fit < kMinColumns) {
        return false;
    }
    const float wanted = std::ceil(kPi / sets.horizontal() * static_cast<float>(sets.columns()) - kRounding);
    // An odd number: one of them lies about the nose.
    const auto odd = [](std::size_t n) { return n - 1 + n % 2; };
    const std::size_t columns = wanted < static_cast<float>(fit) ? odd(static_cast<std::size_t>(wanted) + 1) : odd(fit);
    const Grid<float> around(sets.layers(), std::max(columns, kMinColumns), sets.rows(), sets.distance(), kPi,
                             sets.vertical());
    has_grid_ = CellFinder::serves(around);
    if (has_grid_) {
        grid_ = around;
        finder_ = CellFinder(grid_);
    }
    return has_grid_;
}

bool ScanPicture::begin(const ScanStart& start) noexcept
{
    const std::size_t filled = 1 - seen_;
    counts_ = has_grid_ && is_finite(start.position) && std::isfinite(start.nose) && is_positive(start.unit) &&
              scans_[filled].configure(grid_, start.horizontal_pitch, start.vertical_pitch);
    start_[filled] = start;
    fired_.fill(0);
    return counts_;
}

/// False for a ray outside the grid's directions.
bool ScanPicture::note_ray(const Vec3& ray, CellPlace& place) noexcept
{
    if (!finder_.find_direction(ray, place)) {
        return false;
    }
    std::uint16_t& fired = fired_[place.column * grid_.rows() + place.row];
    fired = static_cast<std::uint16_t>(std::min(fired + 1, 0xFFFF));
    return true;
}

void ScanPicture::add(const Vec3& point) noexcept
{
    CellPlace place;
    const Vec3 turned = point / start_[1 - seen_].unit;
    if (!counts_ || !is_finite(turned) || !note_ray(turned, place)) {
        return;
    }
    const float distance = turned.norm();
    if (distance <= finder_.distance()) {
        place.layer = finder_.layer_of(distance);
        scans_[1 - seen_].add(place, distance);
    }
}

void ScanPicture::add_nothing(const Vec3& direction) noexcept
{
    CellPlace place;
    if (counts_ && is_finite(direction)) {
        static_cast<void>(note_ray(direction, place));
    }
}

void ScanPicture::end() noexcept
{
    if (counts_) {
        seen_ = 1 - seen_;
        ++ended_;
        known_ = true;
        judge();
    }
    counts_ = false;
}

void ScanPicture::judge() noexcept
{
    const LidarScan& scan = scans_[seen_];
    std::array<float, kMaxLayers> visible{};
    for (std::size_t column = 0; column < grid_.columns(); ++column) {
        for (std::size_t row = 0; row < grid_.rows(); ++row) {
            scan.visibility(column, row, visible);
            const std::size_t direction = column * grid_.rows() + row;
            const bool looks =
                static_cast<float>(fired_[direction]) >= kSeenShare * static_cast<float>(scan.rays(column, row));
            for (std::size_t layer = 0; layer < grid_.layers(); ++layer) {
                const CellPlace place{static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                      static_cast<std::uint8_t>(row)};
                const bool hit = scan.obstacle(place, kAnyHit) >= kThreshold;
                const bool seen = looks && visible[layer] >= 1.0F - kThreshold;
                cells_[grid_.index(place)] = hit ? Cell::hit : seen ? Cell::free : Cell::unseen;
            }
        }
    }
}

bool ScanPicture::is_fresh(TimePoint now, Seconds age) const noexcept
{
    return known_ && now - start_[seen_].stamp <= age;
}

Placed ScanPicture::frame() const noexcept
{
    Placed placed;
    placed.origin = start_[seen_].position;
    placed.cosine = std::cos(start_[seen_].nose);
    placed.sine = std::sin(start_[seen_].nose);
    placed.unit = start_[seen_].unit;
    return placed;
}

RateStatus ScanPicture::rate(const world::Situation& situation, const Placed& placed, const CellSpheres& /*spheres*/,
                             Seconds /*lead*/, std::span<Level> blocks, WorkBudget& budget) noexcept
{
    const Grid<float>& sets = placed.set->grid;
    if (!is_fresh(situation.now, kFresh) || !CellFinder::serves(sets)) {
        return is_known() && blocks_unseen_ ? RateStatus::blind : RateStatus::nothing_known;
    }
    CellBits near{};
    std::uint32_t seen = 0;
    do {
        // Where the budget lasts until the next slice, a scan may end meanwhile.
        seen = ended_;
        near = {};
        if (!budget.spend(static_cast<std::uint32_t>(units::kReachScanCell * (1 + grid_.cells() / kFindShare))) ||
            !budget.spend(
                static_cast<std::uint32_t>(units::kReachScanCell * (sets.cells() + find_near(placed, near))))) {
            return RateStatus::budget_spent;
        }
    } while (seen != ended_);
    look_from(placed, blocks);
    lay_over(placed, near, blocks);
    return RateStatus::rated;
}

/// Rates the cells of the set by the picture.
void ScanPicture::look_from(const Placed& placed, std::span<Level> blocks) const noexcept
{
    constexpr std::size_t kPerAxis = InnerPoints::kPerAxis;
    const Grid<float>& sets = placed.set->grid;
    const InnerPoints points(sets);
    const Map map(placed, frame());
    Places places(finder_);
    for (std::size_t column = 0; column < sets.columns(); ++column) {
        for (std::size_t row = 0; row < sets.rows(); ++row) {
            std::array<Cell, kMaxLayers> worst{};
            for (std::size_t direction = 0; direction < kPerAxis * kPerAxis; ++direction) {
                const Vec3 along = map.along(points.direction(column, direction / kPerAxis, row, direction % kPerAxis));
                places.begin();
                for (std::size_t k = 0; k < kPerAxis * sets.layers(); ++k) {
                    places.add(map.offset() + points.distance(k / kPerAxis, k % kPerAxis) * along);
                }
                const std::span<const CellIndex> found = places.find();
                for (std::size_t k = 0; k < found.size(); ++k) {
                    Cell& of_layer = worst[k / kPerAxis];
                    of_layer = std::max(of_layer, found[k] == kNoCell ? Cell::unseen : cells_[found[k]]);
                }
            }
            for (std::size_t layer = 0; layer < sets.layers(); ++layer) {
                block_if(worst[layer] == Cell::hit || (worst[layer] == Cell::unseen && blocks_unseen_),
                         blocks[sets.index({static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                            static_cast<std::uint8_t>(row)})]);
            }
        }
    }
}

/// The cells that were hit and may lie in a cell of the set, and their number.
std::size_t ScanPicture::find_near(const Placed& placed, CellBits& near) const noexcept
{
    const Grid<float>& sets = placed.set->grid;
    const Map map(frame(), placed);
    const float scale = start_[seen_].unit / placed.unit;
    const float across =
        0.5F * std::hypot(grid_.column_start(1) - grid_.column_start(0), grid_.row_start(1) - grid_.row_start(0));
    const float thickness = grid_.layer_end(0);
    // Outward normals of the set's sides; a set of more than half a turn has none that part the space.
    const bool is_narrow = sets.horizontal() <= 0.5F * kPi;
    const float sine = std::sin(sets.horizontal());
    const float cosine = std::cos(sets.horizontal());
    std::size_t count = 0;
    for (std::size_t column = 0; column < grid_.columns(); ++column) {
        for (std::size_t row = 0; row < grid_.rows(); ++row) {
            const Vec3 along = map.along(
                from_polar(Polar<float>{1.0F, 0.5F * (grid_.column_start(column) + grid_.column_start(column + 1)),
                                        0.5F * (grid_.row_start(row) + grid_.row_start(row + 1))}));
            for (std::size_t layer = 0; layer < grid_.layers(); ++layer) {
                const CellIndex cell = grid_.index({static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                                    static_cast<std::uint8_t>(row)});
                if (cells_[cell] != Cell::hit) {
                    continue;
                }
                const float end = grid_.layer_end(layer);
                const float radius = scale * (end * across + 0.5F * thickness);
                const Vec3 at = map.offset() + (end - 0.5F * thickness) * along;
                const float past_side = std::abs(at.y()) * cosine - at.x() * sine;
                if (at.norm() - radius <= sets.distance() && !(is_narrow && past_side > radius)) {
                    near[cell / 32U] |= std::uint32_t{1} << (cell % 32U);
                    ++count;
                }
            }
        }
    }
    return count;
}

/// Blocks the cells of the set in which the hit cells lie.
void ScanPicture::lay_over(const Placed& placed, const CellBits& near, std::span<Level> blocks) const noexcept
{
    constexpr std::size_t kPerAxis = InnerPoints::kPerAxis;
    const InnerPoints points(grid_);
    const CellFinder finder(placed.set->grid);
    const Map map(frame(), placed);
    Places places(finder);
    for (std::size_t i = 0; i < grid_.cells(); ++i) {
        if ((near[i / 32] >> (i % 32) & 1U) == 0) {
            continue;
        }
        const CellPlace place = grid_.place(static_cast<CellIndex>(i));
        places.begin();
        places.add(map.offset() + map.along(grid_.centre(place)));
        for (std::size_t direction = 0; direction < kPerAxis * kPerAxis; ++direction) {
            const Vec3 along =
                map.along(points.direction(place.column, direction / kPerAxis, place.row, direction % kPerAxis));
            for (std::size_t k = 0; k < kPerAxis; ++k) {
                places.add(map.offset() + points.distance(place.layer, k) * along);
            }
        }
        for (const CellIndex cell : places.find()) {
            if (cell != kNoCell) {
                block_if(true, blocks[cell]);
            }
        }
    }
}

}  // namespace jink::reach
