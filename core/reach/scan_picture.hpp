// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reach/cell_finder.hpp"
#include "core/reach/cell_source.hpp"
#include "core/reach/lidar_scan.hpp"

// The newest scan of a range sensor, counted by cells of a grid of its own, and what it says of a set that is placed
// elsewhere a moment later.

namespace jink::reach {

/// Where a scan is made from, and how.
struct ScanStart {
    TimePoint stamp;
    Vec3 position = Vec3::Zero();   ///< [m]
    float nose = 0.0F;              ///< where x of the points looks: counter-clockwise from east [rad]
    float course = 0.0F;            ///< along which the grid is laid [rad]
    float unit = 1.0F;              ///< thickness of its layers [m], > 0
    float horizontal_pitch = 0.0F;  ///< between neighbouring rays [rad], > 0
    float vertical_pitch = 0.0F;
};

/// Memory: that of a LidarScan twice, about 7 KiB: one is filled while the other one is read.
class ScanPicture final : public CellSource {  // NOLINT(cppcoreguidelines-virtual-class-destructor): final
public:
    /// Columns to either side of a set's, so that a course may change until it is planned.
    static constexpr std::size_t kSpareColumns = 1;
    /// Of the rays that a direction should have: rays lie a little otherwise in each direction.
    static constexpr float kSeenShare = 0.75F;

    /// Layers, columns and rows as the sets', and kSpareColumns. False where that does not fit in a LidarScan; the
    /// picture then stays without a scan.
    [[nodiscard]] bool configure(const Grid<float>& sets) noexcept;

    /// A new scan begins; what was counted of one that did not end is forgotten. False, and nothing is counted until
    /// the next one, when it cannot be used: no grid, numbers that are none, a direction without rays.
    bool begin(const ScanStart& start) noexcept;
    /// A first return, relative to the sensor: x along the nose, y left, z up [m]. O(columns + rows).
    void add(const Vec3& point) noexcept;
    /// A ray that went out and came back from nowhere. Rays that were not fired, or are known to be wrong, are not
    /// told.
    void add_nothing(const Vec3& direction) noexcept;
    /// The scan has ended: from now on it is the picture. A direction in which fewer than kSeenShare of the rays were
    /// fired, by the pitches, is not seen: beyond the sensor's field, lost on the way, or not valid.
    void end() noexcept;

    /// A whole scan is known that is no older than `age`.
    [[nodiscard]] bool is_fresh(TimePoint now, Seconds age) const noexcept;
    /// A scan was ever known.
    [[nodiscard]] bool is_known() const noexcept { return known_; }
    [[nodiscard]] const ScanStart& start() const noexcept { return start_[seen_]; }

    /// What it does not see is blocked too, from now on. On at first.
    void block_unseen(bool on) noexcept { blocks_unseen_ = on; }

    /// By the picture alone: obstacles where something was hit or, where that is to be, where it does not see all. Each
    /// cell is looked at in eight places, and each place that was hit in nine: cells that are cut by less are the
    /// business of what is known more exactly. A picture older than kFresh is no more than none; while what is unseen
    /// is blocked it is blindness. O(cells of the set + cells hit).
    [[nodiscard]] RateStatus rate(const world::Situation& situation, const Placed& placed, const CellBalls& balls,
                                  Seconds lead, std::span<Level> blocks, WorkBudget& budget) noexcept override;

    /// [s]
    static constexpr Seconds kFresh = 0.5F;

private:
    [[nodiscard]] Placed frame() const noexcept;
    [[nodiscard]] Vec3 in_grid(const Vec3& point) const noexcept;
    [[nodiscard]] bool note_ray(const Vec3& in_grid, CellPlace& place) noexcept;
    void judge() noexcept;
    void look_from(const Placed& placed, std::span<Level> blocks) const noexcept;
    void lay_over(const Placed& placed, std::span<Level> blocks) const noexcept;

    Grid<float> grid_;
    CellFinder finder_;
    bool has_grid_ = false;
    float cosine_ = 1.0F;  ///< from the nose to the course of the scan under way
    float sine_ = 0.0F;
    bool blocks_unseen_ = true;
    bool counts_ = false;  ///< a scan has begun that can be used
    bool known_ = false;
    std::size_t seen_ = 0;  ///< which of both is the picture
    std::array<LidarScan, 2> scans_;
    std::array<ScanStart, 2> start_;
    std::array<std::uint16_t, LidarScan::kDirections> fired_{};  ///< of the scan under way
    enum class Cell : std::uint8_t { free, unseen, hit };
    std::array<Cell, LidarScan::kCells> cells_{};  ///< of the picture
    std::size_t hits_ = 0;                         ///< so many of them
};

}  // namespace jink::reach
