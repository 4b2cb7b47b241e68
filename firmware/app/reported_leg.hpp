// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/world/world.hpp"

namespace jink::app {

/// The leg that the link reports: whether it is believed, and how fast it is going to be flown.
///
/// The leg is believed until the motion contradicts it for kContradicted: faster than MotionEstimate::kMoving, and away
/// from the leg, or neither along it nor back to it. It is believed again once the motion has agreed with it for
/// kAgreed, or when another leg is reported. A vehicle that stands, or turns within kCornerTime of the leg's end,
/// contradicts nothing.
///
/// Speed along the leg: the mission's where the link reports it; else the last steady speed that was measured along a
/// leg; else the cruise parameter. When the vehicle now flies steadily along the leg at another speed, that is taken; a
/// greater speed always is.
///
/// O(1) per call.
class ReportedLeg {
public:
    static constexpr Seconds kContradicted = 1.5F;  ///< [s]
    static constexpr Seconds kAgreed = 1.0F;        ///< [s]
    static constexpr Seconds kCornerTime = 2.0F;    ///< of flight before the end of the leg [s]

    /// @param leg  as reported, speed 0: not said; null: none is known
    void take(const world::Leg* leg) noexcept;
    /// Compares the leg with the motion of a vehicle that the autopilot steers.
    /// @param steady_speed  of the last second [m/s]; 0: the speed changes
    void judge(const vehicle::VehicleState& own, float steady_speed) noexcept;
    /// The motion says nothing of the leg at `now`.
    void pass_over(TimePoint now) noexcept;
    /// Believes the leg until the motion contradicts it anew.
    void believe() noexcept;

    /// The leg at the speed it is going to be flown at. A leg is known.
    /// @param own           carried forward to now
    /// @param steady_speed  see judge
    /// @param in_control    the vehicle follows our commands: its speed says nothing
    [[nodiscard]] world::Reference reference(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                             float steady_speed, bool in_control) const noexcept;

    [[nodiscard]] bool is_known() const noexcept { return known_; }
    [[nodiscard]] bool is_believed() const noexcept { return known_ && believed_; }
    /// How often the motion has contradicted a leg for long enough.
    [[nodiscard]] std::uint32_t doubted() const noexcept { return doubted_; }

private:
    world::Leg leg_;
    bool known_ = false;
    bool believed_ = true;
    Seconds disagreeing_ = 0.0F;
    Seconds agreeing_ = 0.0F;
    TimePoint judged_;
    float steady_ = 0.0F;  ///< the last steady speed along a leg; 0: not measured yet [m/s]
    std::uint32_t doubted_ = 0;
};

}  // namespace jink::app
