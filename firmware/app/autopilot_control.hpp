// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "firmware/app/autopilot_state.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/follow_check.hpp"
#include "firmware/app/outbox.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/app/stick_watch.hpp"
#include "firmware/app/takeover.hpp"

namespace jink::app {

/// Whether this vehicle flies the velocities that we would send. A plane is steered as the plane that VEH_FIXED_WING
/// describes, never as a vehicle that stops.
[[nodiscard]] bool can_steer(const link::AutopilotReport& autopilot, const Configuration& c) noexcept;

/// What the control of one step depends on beside the report.
struct ControlInput {
    TimePoint now;
    const vehicle::VehicleState& own;      ///< carried forward to now
    const Vec3& velocity;                  ///< own, as measured last [m/s]
    std::span<const world::Track> tracks;  ///< the conflict's track is one of them
    const AutopilotState& autopilot;
};

/// The autopilot as it is steered: taking over and giving back, requests of a mode, the stream of set-points, and the
/// two reasons to let go that show in flight, sticks that moved and commands that are not followed.
class AutopilotControl {
public:
    static constexpr Seconds kTick = 0.02F;

    AutopilotControl(link::Link& link, Diagnostics& counts) noexcept : link_(link), counts_(counts) {}

    /// The autopilot has restarted: control is dropped and said to be.
    void note_restart(Outbox& outbox) noexcept;
    /// @param report  nullptr: none came in this step
    void watch_sticks(const link::SticksReport* report, float threshold) noexcept
    {
        sticks_moved_ = stick_watch_.update(report, takeover_.streaming(), threshold);
    }
    /// Takes over, steers or gives back as the report's guidance and faults say; sends what that takes. A non-finite
    /// velocity becomes a fault of the report and is never sent.
    /// @return what happened
    TakeoverEvent update(const ControlInput& input, const Configuration& c, StepReport& report,
                         Outbox& outbox) noexcept;
    /// Before a stop on purpose: no stream, no request that waits; the hold mode is asked for where we have control.
    void shut_down(TimePoint now) noexcept;

    [[nodiscard]] const Takeover& takeover() const noexcept { return takeover_; }

private:
    [[nodiscard]] TakeoverInput takeover_input(const ControlInput& input, const Configuration& c,
                                               const StepReport& report) noexcept;
    void note_block(const AutopilotState& autopilot, const avoid::Guidance& guidance, Outbox& outbox) noexcept;
    void request(const TakeoverOutput& output, TimePoint now) noexcept;
    [[nodiscard]] Seconds setpoint_period(const Configuration& c) const noexcept;
    void send_setpoint(const ControlInput& input, Seconds period, bool followed, StepReport& report) noexcept;
    void drop_stale(Seconds period, TimePoint now) noexcept;

    link::Link& link_;
    Diagnostics& counts_;
    Takeover takeover_;
    FollowCheck follow_check_;
    StickWatch stick_watch_;
    bool sticks_moved_ = false;
    bool way_blocked_ = false;  ///< given up in front of a static obstacle: a hold is asked for, or held
    TimePoint last_setpoint_;
    Vec3 last_velocity_ = Vec3::Zero();  ///< of the last set-point [m/s]
    TimePoint last_mode_request_;
};

}  // namespace jink::app
