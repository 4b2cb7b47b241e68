// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/nominal_paths.hpp"

#include <algorithm>

namespace jink::app {
namespace {

/// Of the cruise speed: slower motion may be the drift of a vehicle that waits.
constexpr float kDriftShare = 0.5F;

}  // namespace

void NominalPaths::reset() noexcept
{
    estimate_.clear();
    leg_.believe();
    outdated_ = true;
}

/// What drifts in gusts is going nowhere: its place is kept, not a path that it would be brought back to.
void NominalPaths::keep(const vehicle::VehicleLimits& limits) noexcept
{
    kept_.copy_from(live_);
    if (kept_.reference().speed < std::min(MotionEstimate::kMoving, kDriftShare * limits.cruise_speed)) {
        kept_.stay(kept_.reference().route().at(0.0F).position, limits);
    }
}

const world::Reference* NominalPaths::other() const noexcept
{
    if (!on_motion_) {
        return &live_.reference();  // in control what we fly: it is not handed over heading for something
    }
    return in_control_ && believes_leg() ? &intended_ : nullptr;
}

void NominalPaths::update(const vehicle::VehicleState& measured, const vehicle::VehicleState& own,
                          const world::Leg* leg, const vehicle::VehicleLimits& limits, bool in_control) noexcept
{
    if (in_control && !in_control_) {
        keep(limits);
        on_motion_ = was_on_motion_ || !believes_leg();
    }
    if (in_control_ && !in_control) {
        given_back_ = own.stamp;
    }
    in_control_ = in_control;
    estimate_.add(measured);
    leg_.take(leg);
    // What was steady under our commands is not the mission's speed.
    const bool is_autopilots = !in_control && own.stamp - given_back_ >= MotionEstimate::kWindow;
    const float steady_speed = is_autopilots ? estimate_.steady_speed() : 0.0F;
    if (in_control) {
        leg_.pass_over(own.stamp);
    } else {
        leg_.judge(own, steady_speed);
        was_on_motion_ = was_on_motion_ && believes_leg();
    }
    if (leg_.is_known()) {
        intended_ = leg_.reference(own, limits, steady_speed, in_control);
    }
    live_.extrapolate(own, estimate_.turn_rate(), limits);
    if (outdated_) {
        keep(limits);
        outdated_ = false;
    }
    if (in_control) {
        kept_.progress_to(own.position);
    }
    on_motion_ = in_control ? on_motion_ || !leg_.is_known() : !believes_leg();
}

void NominalPaths::note(bool has_conflict, bool on_other) noexcept
{
    if (!in_control_) {
        was_on_motion_ = has_conflict ? on_other : was_on_motion_;
    } else if (!has_conflict && on_motion_ && believes_leg()) {
        on_motion_ = false;  // the motion's own conflict is over, and the autopilot is going to fly the leg
    }
}

}  // namespace jink::app
