// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/world.hpp"
#include "firmware/app/motion_estimate.hpp"
#include "firmware/app/motion_path.hpp"
#include "firmware/app/reported_leg.hpp"

namespace jink::app {

/// Where the vehicle is expected to fly: the intended path, which is the leg that the link reports (ReportedLeg), and
/// the measured motion (MotionEstimate, MotionPath). A conflict on either counts (avoid::Supervisor).
///
/// The intended path says where the vehicle would be at the speed that it is going to have, from rest or out of a
/// corner too, and the measured motion where it would be at the one that it has. Every target has the same paths to the
/// bit.
///
/// From a take-over on the measured motion as it was then is kept while it is in conflict, and where no leg is
/// believed. Then the leg counts: the autopilot is going to fly there, and the motion goes on past the leg's end. Of
/// motion slower than MotionEstimate::kMoving and half the cruise speed the place alone is kept. 1 KiB. O(samples) per
/// update.
class NominalPaths {
public:
    NominalPaths() = default;
    NominalPaths(const NominalPaths&) = delete;
    NominalPaths& operator=(const NominalPaths&) = delete;

    /// @param measured    the newest own state, as measured
    /// @param own         the same carried forward to now
    /// @param leg         as reported, speed 0: not said; null: none is known
    /// @param in_control  the vehicle follows our commands: its motion says nothing of where the autopilot goes
    void update(const vehicle::VehicleState& measured, const vehicle::VehicleState& own, const world::Leg* leg,
                const vehicle::VehicleLimits& limits, bool in_control) noexcept;
    /// What the supervisor made of them: whether there is a conflict, and whether it is on the other path.
    void note(bool has_conflict, bool on_other) noexcept;
    /// The frame jumped, or own state comes from elsewhere.
    void reset() noexcept;

    /// The path that is flown in control. Valid until the next update.
    [[nodiscard]] const world::Reference& primary() const noexcept { return on_motion_ ? motion() : intended_; }
    /// The primary path is the leg that the link reports; otherwise it is the measured motion.
    [[nodiscard]] bool is_intended() const noexcept { return !on_motion_; }
    /// The other one; null where there is none.
    [[nodiscard]] const world::Reference* other() const noexcept;
    [[nodiscard]] bool believes_leg() const noexcept { return leg_.is_believed(); }
    /// Counter-clockwise; 0: flies straight [rad/s].
    [[nodiscard]] float turn_rate() const noexcept { return estimate_.turn_rate(); }
    [[nodiscard]] std::uint32_t legs_doubted() const noexcept { return leg_.doubted(); }

private:
    void keep(const vehicle::VehicleLimits& limits) noexcept;
    [[nodiscard]] const world::Reference& motion() const noexcept
    {
        return in_control_ ? kept_.reference() : live_.reference();
    }

    MotionEstimate estimate_;
    ReportedLeg leg_;
    world::Reference intended_;
    MotionPath live_;
    MotionPath kept_;
    bool in_control_ = false;
    TimePoint given_back_;   ///< when control ended last: what was steady before was our own speed
    bool on_motion_ = true;  ///< the primary one
    bool was_on_motion_ = false;
    bool outdated_ = false;  ///< what is kept: the frame has jumped
};

}  // namespace jink::app
