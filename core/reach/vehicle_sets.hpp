// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/service.hpp"
#include "core/base/work_units.hpp"
#include "core/reach/reach_set.hpp"

// The reach sets of one vehicle: one pair for each segment of its states. How sharply the vehicle turns per movement
// depends on its speed, and the space before it on whether it climbs (Gomola 6.2.6). Made by `jink reach build`.

namespace jink::reach {

/// The sets for one state segment: both share one grid and one step.
struct SegmentSets {
    const ReachSet* navigation = nullptr;  ///< smooth trajectories, few nodes
    const ReachSet* emergency = nullptr;   ///< many trajectories, including trajectories that leave the grid sideways
    /// The tables are of the root with the opposite pitch: z, pitch and the grid's rows change their sign when they are
    /// read, and movements up and down change places (`upside_down` below).
    bool upside_down = false;
};

/// Segments by pitch, in the order of VehicleSets::segments.
enum class PitchSegment : std::uint8_t { descending, level, climbing };
inline constexpr std::size_t kPitchSegments = 3;
/// Segments by speed of one vehicle: each costs two to four sets, about 60 KiB.
inline constexpr std::size_t kMaxSpeedSegments = 8;

/// A view of constant tables.
struct VehicleSets {
    std::string_view vehicle;
    float period = 0.0F;  ///< duration of one movement [s]; its length is speed * period

    // Limits that the sets were built for: no movement in a set exceeds them, up to `most_speed`.
    float max_acceleration = 0.0F;           ///< level [m/s2]
    float max_vertical_acceleration = 0.0F;  ///< [m/s2]
    float max_climb = 0.0F;                  ///< [m/s]
    float max_descent = 0.0F;                ///< [m/s]
    float cruise_speed = 0.0F;               ///< [m/s]

    /// Lower ends of the speed segments, shares of the cruise speed, ascending. Speeds below the first end belong to
    /// the first segment. A speed on an end belongs to the segment above it; the last segment includes its upper end as
    /// well.
    std::span<const float> speeds;
    float most_speed = 0.0F;  ///< upper end of the last speed segment, share of the cruise speed

    /// Of each speed segment: flight-path angles [rad, nose down] that divide climbing | level | descending, ascending.
    /// Half a pitch step to either side; roots lie at -1, 0 and 1 steps.
    std::span<const std::array<float, 2>> pitch_separators;
    /// Of each speed segment: steepest flight-path angle to either side [rad], one and a half pitch steps.
    std::span<const float> most_pitch;

    std::span<const SegmentSets> segments;  ///< speed-major, kPitchSegments per speed in the order of PitchSegment
    std::uint32_t checksum = 0;             ///< of all of the above and of the checksums of the sets (`checksum_of`)
};

/// The sets to fly from a state. Null outside the envelope: faster than `most_speed`, steeper than `most_pitch`, or
/// non-finite.
///
/// @param speed_share speed over the vehicle's cruise speed
/// @param pitch       flight-path angle [rad], > 0 nose down
/// O(speed segments).
[[nodiscard]] const SegmentSets* segment_of(const VehicleSets& sets, float speed_share, float pitch) noexcept;

/// CRC-32 of the numbers and of the checksums of the sets. O(segments).
[[nodiscard]] std::uint32_t checksum_of(const VehicleSets& sets) noexcept;

/// Checks everything that `segment_of` and the flight rely on, of the vehicle and of each of its sets; an image calls
/// this once, when it starts. O(bytes of the tables).
[[nodiscard]] SetStatus check(const VehicleSets& sets) noexcept;

/// The checksums of a vehicle's tables, computed anew again and again while it flies: a memory cell that fails is found
/// before long. A background service: `failed` where a table is not what it was made to be.
class TableCheck {
public:
    /// Good (`check`); they outlive this.
    explicit TableCheck(const VehicleSets& sets) noexcept;
    [[nodiscard]] Progress advance(WorkBudget& budget) noexcept;
    /// What the next piece takes [work units]: with less, a call does nothing.
    [[nodiscard]] std::uint32_t units_of_next() const noexcept
    {
        return at_ < 2 * sets_->segments.size() ? units::kTableElements : units::kTableNumbers;
    }
    [[nodiscard]] const VehicleSets& sets() const noexcept { return *sets_; }

private:
    /// Numbers or entries of a table, checked at once.
    static constexpr std::size_t kElements = 32;

    [[gnu::cold]] void go_to(std::size_t table) noexcept;

    const VehicleSets* sets_;
    std::size_t at_ = 0;  ///< table of all, two of each segment; behind them: the vehicle's own numbers
    SetChecksum sum_;
    bool failed_ = false;
};

/// A movement and a cell as they are read from tables of the mirrored root. Its own inverse.
[[nodiscard]] constexpr Movement upside_down(Movement movement) noexcept
{
    switch (movement) {
    case Movement::up: return Movement::down;
    case Movement::down: return Movement::up;
    case Movement::up_left: return Movement::down_left;
    case Movement::down_left: return Movement::up_left;
    case Movement::up_right: return Movement::down_right;
    case Movement::down_right: return Movement::up_right;
    case Movement::straight:
    case Movement::left:
    case Movement::right: break;
    }
    return movement;
}
[[nodiscard]] constexpr CellPlace upside_down(const CellPlace& place, std::size_t rows) noexcept
{
    return {place.layer, place.column, static_cast<std::uint8_t>(rows - 1U - place.row)};
}

}  // namespace jink::reach
