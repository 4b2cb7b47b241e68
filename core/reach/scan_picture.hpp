// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reach/cell_finder.hpp"
#include "core/reach/cell_source.hpp"
#include "core/reach/lidar_scan.hpp"

// The newest scan of a range sensor, counted by cells of a grid all around, and its ratings for a set that is placed
// elsewhere a short time later.

namespace jink::reach {

/// Where and how a scan is made.
struct ScanStart {
    TimePoint stamp;
    Vec3 position = Vec3::Zero();  ///< [m]
    float nose = 0.0F;  ///< direction of the points' and the grid's x axis, counter-clockwise from east [rad]
    float unit = 1.0F;  ///< thickness of its layers [m], > 0
    float horizontal_pitch = 0.0F;  ///< between neighbouring rays [rad], > 0
    float vertical_pitch = 0.0F;
};

/// All around, because a vehicle that hovers may leave in any direction.
///
/// Memory: that of two LidarScans, about 36 KiB: one is filled while the other is read.
class ScanPicture final : public CellSource {  // NOLINT(cppcoreguidelines-virtual-class-destructor): final
public:
    /// Least share of a direction's rays that must be fired: the number of rays varies a little between directions.
    static constexpr float kSeenShare = 0.75F;

    /// Layers and rows as the sets', and columns all around that are no wider, or as many as a LidarScan and a
    /// CellFinder have space for: coarser cells block more. False if that is not even seven; the picture then stays
    /// without a scan.
    [[nodiscard]] bool configure(const Grid<float>& sets) noexcept;

    /// Begins a new scan; a previous scan without its end is discarded. False if the scan cannot be used: no grid,
    /// non-finite values, a direction without rays. In that case nothing is counted until the next scan.
    bool begin(const ScanStart& start) noexcept;
    /// A first return, relative to the sensor: x along the nose, y left, z up [m]. O(columns + rows).
    void add(const Vec3& point) noexcept;
    /// A ray that was fired and had no return. Rays that were not fired, or are known to be wrong, are not reported
    /// here.
    void add_nothing(const Vec3& direction) noexcept;
    /// Ends the scan, which becomes the picture. A direction in which fewer than kSeenShare of the rays were fired, by
    /// the pitches, counts as unseen: outside the sensor's field of view, lost in transfer, or invalid.
    void end() noexcept;

    /// A complete scan exists that is no older than `age`.
    [[nodiscard]] bool is_fresh(TimePoint now, Seconds age) const noexcept;
    /// A complete scan has ever existed.
    [[nodiscard]] bool is_known() const noexcept { return known_; }
    [[nodiscard]] const ScanStart& start() const noexcept { return start_[seen_]; }

    /// From now on cells that the picture does not see are blocked too. On at first.
    void block_unseen(bool on) noexcept { blocks_unseen_ = on; }

    /// Rates cells by the picture alone: obstacles where there was a hit and, while unseen cells are blocked, where the
    /// picture does not see all of the cell. Each cell is sampled at eight places, and each place that was hit at nine;
    /// smaller overlaps of cells are left to the exact checks. A picture older than kFresh counts as no picture; while
    /// unseen cells are blocked, as blindness. O(cells of the set + cells hit near to them).
    [[nodiscard]] RateStatus rate(const world::Situation& situation, const Placed& placed, const CellSpheres& spheres,
                                  Seconds lead, std::span<Level> blocks, WorkBudget& budget) noexcept override;

    /// Cells whose work rate() pays at most, but where more than 512 hit cells lie near a set: twice what the picture
    /// has within a set's angles.
    static constexpr std::size_t kRatedCells = kMaxReachCells + 512 + LidarScan::kCells / 32;
    /// Largest age of a usable picture [s].
    static constexpr Seconds kFresh = 0.5F;

private:
    /// To find which of so many cells are near to a set takes the work of laying one over it.
    static constexpr std::size_t kFindShare = 32;

    [[nodiscard]] Placed frame() const noexcept;
    [[nodiscard]] bool note_ray(const Vec3& ray, CellPlace& place) noexcept;
    void judge() noexcept;
    using CellBits = std::array<std::uint32_t, (LidarScan::kCells + 31) / 32>;
    [[nodiscard]] std::size_t find_near(const Placed& placed, CellBits& near) const noexcept;
    void look_from(const Placed& placed, std::span<Level> blocks) const noexcept;
    void lay_over(const Placed& placed, const CellBits& near, std::span<Level> blocks) const noexcept;

    Grid<float> grid_;
    CellFinder finder_;
    bool has_grid_ = false;
    bool blocks_unseen_ = true;
    bool counts_ = false;  ///< a usable scan has begun
    bool known_ = false;
    std::size_t seen_ = 0;     ///< which of both scans is the picture
    std::uint32_t ended_ = 0;  ///< scans that ended as the picture
    std::array<LidarScan, 2> scans_;
    std::array<ScanStart, 2> start_;
    std::array<std::uint16_t, LidarScan::kDirections> fired_{};  ///< of the scan under way
    enum class Cell : std::uint8_t { free, unseen, hit };
    std::array<Cell, LidarScan::kCells> cells_{};  ///< of the picture
};

}  // namespace jink::reach
