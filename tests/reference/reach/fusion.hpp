// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/reach/evaluation.hpp"

// Fusion of a cell's ratings by sensors, maps, intruders and constraints (Gomola 6.7.1).

namespace jink::reach {

/// One cell's ratings, each 0 to 1, added in sequence. Stores complements, because near 1 single precision cannot
/// resolve the threshold.
class CellRating {
public:
    /// A sensor in whose field the cell lies (Gomola eq. 6.156).
    /// @param hidden    1 - visibility
    /// @param obstacle  of this sensor
    void add_sensor(float hidden, float obstacle) noexcept
    {
        hidden_ = seen_ ? std::max(hidden_, hidden) : hidden;
        seen_ = true;
        obstacle_ = std::max(obstacle_, obstacle);
    }
    void add_map(float rating) noexcept { map_ = std::max(map_, rating); }
    /// Margin of a charted body: a soft constraint where sensors do not cover, as the body itself (Gomola eq. 6.103).
    void add_map_margin(float rating) noexcept { map_margin_ = std::max(map_margin_, rating); }
    /// Of one intruder (Gomola eq. 6.159).
    void add_intruder(float rating) noexcept { spared_by_intruders_ *= 1.0F - rating; }
    void add_hard(float rating) noexcept { hard_ = std::max(hard_, rating); }
    void add_soft(float rating) noexcept { soft_ = std::max(soft_, rating); }

    /// 1 - visibility; 1 where no sensor covers the cell.
    [[nodiscard]] float hidden() const noexcept { return seen_ ? hidden_ : 1.0F; }
    [[nodiscard]] float visibility() const noexcept { return 1.0F - hidden(); }
    /// Scaled by the visibility (Gomola eq. 6.157).
    [[nodiscard]] float obstacle() const noexcept { return obstacle_ * visibility(); }
    /// Rating of the map where sensors do not cover (Gomola eq. 6.158).
    [[nodiscard]] float map() const noexcept { return map_ * hidden(); }
    [[nodiscard]] float intruder() const noexcept { return 1.0F - spared_by_intruders_; }
    [[nodiscard]] float soft() const noexcept { return std::max(soft_, map_margin_ * hidden()); }
    [[nodiscard]] float constraint() const noexcept { return std::max(hard_, soft()); }
    /// Gomola eq. 6.161.
    [[nodiscard]] float threat() const noexcept
    {
        return std::max(std::max(obstacle(), map()), std::max(intruder(), constraint()));
    }

    [[nodiscard]] bool is_visible() const noexcept { return hidden() <= kThreshold; }
    [[nodiscard]] bool is_occupied() const noexcept { return obstacle() >= kThreshold; }
    [[nodiscard]] bool is_mapped() const noexcept { return map() >= kThreshold; }
    [[nodiscard]] bool is_intruded() const noexcept { return intruder() >= kThreshold; }
    [[nodiscard]] bool is_hard() const noexcept { return hard_ >= kThreshold; }
    [[nodiscard]] bool is_soft() const noexcept { return soft() >= kThreshold; }

    /// The first run in which the cell is not free. `allow_hidden`: hidden cells are free, except for obstacles and
    /// charted obstacles, which count at any visibility.
    [[nodiscard]] Level level(bool allow_hidden = false) const noexcept
    {
        const bool blocked = allow_hidden ? obstacle_ >= kThreshold || map_ >= kThreshold
                                          : !is_visible() || is_occupied() || is_mapped();
        if (blocked) {
            return static_cast<Level>(AvoidanceRun::obstacles);
        }
        if (is_intruded()) {
            return static_cast<Level>(AvoidanceRun::intruders);
        }
        if (is_hard()) {
            return static_cast<Level>(AvoidanceRun::hard_constraints);
        }
        return is_soft() ? static_cast<Level>(AvoidanceRun::soft_constraints) : kFree;
    }

private:
    float hidden_ = 1.0F;
    float obstacle_ = 0.0F;
    float map_ = 0.0F;
    float map_margin_ = 0.0F;
    float spared_by_intruders_ = 1.0F;
    float hard_ = 0.0F;
    float soft_ = 0.0F;
    bool seen_ = false;
};

/// The space sets that a cell belongs to (Gomola eq. 6.164 to 6.167). The first three may overlap: a hidden cell keeps
/// its known contents. Free cells are in none of them, and not charted.
struct SpaceSets {
    bool uncertain = false;
    bool occupied = false;
    bool constrained = false;
    bool free = false;
};
/// O(1).
[[nodiscard]] inline SpaceSets space_of(const CellRating& cell) noexcept
{
    SpaceSets sets;
    sets.uncertain = !cell.is_visible();
    sets.occupied = cell.is_occupied();
    sets.constrained = cell.is_visible() && (cell.is_hard() || cell.is_soft() || cell.is_intruded());
    sets.free = !(sets.uncertain || sets.occupied || sets.constrained || cell.is_mapped());
    return sets;
}

/// A trajectory by the threats of the cells it passes (Gomola eq. 6.162), for telemetry: levels decide the flown
/// trajectory.
class TrajectoryRating {
public:
    /// Adds a cell; a cell passed before does not count again. An invalid cell makes the trajectory unreachable.
    void add(CellIndex cell, float threat) noexcept
    {
        if (cell >= kMaxCells) {
            blocked_ = true;
            return;
        }
        const std::uint32_t bit = 1U << (cell % 32U);
        if ((passed_[cell / 32U] & bit) != 0) {
            return;
        }
        passed_[cell / 32U] |= bit;
        loss_ -= std::log1p(-std::min(threat, 1.0F));
        blocked_ = blocked_ || !(threat < kThreshold);
    }
    /// Product of 1 - threat.
    [[nodiscard]] float reachability() const noexcept { return std::exp(-loss_); }
    /// At least 1 - threshold, computed with complements, and no threat on the path. At the threshold itself table 6.5
    /// is ambiguous; the threat wins.
    [[nodiscard]] bool is_reachable() const noexcept { return !blocked_ && loss_ <= -std::log1p(-kThreshold); }

private:
    std::array<std::uint32_t, kMaxCells / 32> passed_{};  // one bit of each cell
    float loss_ = 0.0F;
    bool blocked_ = false;
};

}  // namespace jink::reach
