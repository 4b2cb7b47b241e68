// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/geometric/clearance.hpp"
#include "core/vehicle/motion.hpp"

// Candidates as the vehicle would fly them. Private to this room.

namespace jink::geometric::detail {

/// Flies a few candidates side by side, with braking to a stand at their ends, and says what each flight touches.
///
/// Side by side because that takes little longer than one alone (path/flight.hpp). A flight that touches what is
/// checked first is not flown on. Verdicts and units spent are those of one flight after the other, each flown to its
/// end and then checked.
///
/// Memory: kLanes * (a path and a curve), 2.9 KiB each with 64 points.
class Flown {
public:
    static constexpr std::size_t kLanes = kFlightLanes;

    /// All outlive this.
    Flown(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
          Clearance& clearance) noexcept;

    void clear() noexcept { lanes_in_use_ = 0; }
    [[nodiscard]] bool full() const noexcept { return lanes_in_use_ == kLanes; }
    [[nodiscard]] std::size_t size() const noexcept { return lanes_in_use_; }
    /// A lane more, its path about the start to be filled by the caller. Not when full.
    [[nodiscard]] path::TimedPath& add() noexcept;
    [[nodiscard]] const path::TimedPath& path(std::size_t lane) const noexcept { return lanes_[lane].path; }

    /// Flies all lanes. O(lanes * points).
    void fly() noexcept;
    /// What the flight of a lane touches; volumes that threats sweep end at `longest` or with the flight. After `fly`.
    /// O(points * (threats + obstacles)).
    [[nodiscard]] Verdict judge(std::size_t lane, Seconds longest, WorkBudget& budget) noexcept;

private:
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): paths and curves are filled before they are read
    struct Lane {
        path::TimedPath path;
        Curve flight;
        std::size_t points = 0;  ///< of the whole flight
        bool stopped = false;    ///< it has touched the first item
    };

    void start(Lane& lane, std::size_t steps) const noexcept;
    void fly_paths() noexcept;
    void fly_tails() noexcept;
    [[nodiscard]] bool stops(const Lane& lane, Room& room) noexcept;

    const vehicle::VehicleLimits& limits_;
    const Settings& settings_;
    Clearance& clearance_;
    const Vec3 start_velocity_;
    float fastest_;           ///< of any flight [m/s]
    float fastest_vertical_;  ///< [m/s]
    Seconds longest_tail_;
    vehicle::detail::Fading fading_;
    Seconds reach_time_ = -1.0F;  ///< longest path that find_first was asked for
    bool has_first_ = false;
    std::size_t lanes_in_use_ = 0;
    std::array<Lane, kLanes> lanes_;
};

}  // namespace jink::geometric::detail
