// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/own_state.hpp"

namespace jink::app {
namespace {

/// Own state may be stamped this far ahead of our clock before it is refused [s].
constexpr Seconds kFutureSlack = 0.05F;
/// A fix and an estimate farther apart than this, with what both say of their error on top, cannot both be right: a
/// receiver without corrections is within 10 m, twice that for height [m].
constexpr float kPlacesAgree = 30.0F;

}  // namespace

Jump OwnState::use(const link::OwnStateReport& report, OwnSource source) noexcept
{
    const bool changed = is_known() && source_ != source;
    state_ = report.state;
    is_yaw_known_ = report.has_yaw;
    source_ = source;
    return changed ? Jump::source : Jump::none;
}

Vec3 OwnState::place_at(TimePoint time, Seconds max_age) const noexcept
{
    return state_.position + state_.velocity * std::clamp(time - state_.stamp, -max_age, max_age);
}

Jump OwnState::take_autopilot(const link::OwnStateReport& report, TimePoint now) noexcept
{
    const TimePoint stamp = report.state.stamp;
    if (stamp > now + kFutureSlack || (autopilot_stamp_ && stamp < *autopilot_stamp_)) {
        ++counts_.own_state_refused;
        reset_refused_ = reset_refused_ || report.estimator_reset;
        return Jump::none;
    }
    const bool reset = (report.estimator_reset || reset_refused_) && is_known();
    reset_refused_ = false;
    counts_.estimator_resets += reset ? 1U : 0U;
    const Jump jump = use(report, OwnSource::autopilot);
    autopilot_stamp_ = stamp;
    ++counts_.own_states;
    if (!reset) {
        return jump;
    }
    return jump == Jump::none ? Jump::estimate : Jump::frame;
}

Jump OwnState::take_bus(const link::OwnStateReport& report, Seconds max_age, float k_sigma, TimePoint now,
                        Outbox& outbox) noexcept
{
    const TimePoint stamp = report.state.stamp;
    if (stamp > now + kFutureSlack || stamp < bus_stamp_) {
        ++counts_.bus_states_refused;
        bus_reset_refused_ = bus_reset_refused_ || report.estimator_reset;
        return Jump::none;
    }
    bus_stamp_ = stamp;
    const bool says_reset = report.estimator_reset || bus_reset_refused_;
    bus_reset_refused_ = false;
    if (autopilot_stamp_ && now - *autopilot_stamp_ <= max_age) {
        ++counts_.bus_states_beside;
        compare(report.state, max_age, k_sigma, outbox);
        return Jump::none;
    }
    const bool reset = says_reset && source_ == OwnSource::bus;
    counts_.estimator_resets += reset ? 1U : 0U;
    const Jump jump = use(report, OwnSource::bus);
    ++counts_.bus_states;
    return reset ? Jump::frame : jump;
}

void OwnState::compare(const vehicle::VehicleState& fix, Seconds max_age, float k_sigma, Outbox& outbox) noexcept
{
    const vehicle::VehicleState own = at(fix.stamp, max_age);
    const bool differ = (own.position - fix.position).norm() >
                        kPlacesAgree + k_sigma * (own.sigma_position + fix.sigma_position) + fix.velocity.norm();
    if (differ && !places_differ_) {
        ++counts_.places_disagree;
        outbox.say(link::Severity::critical, "jink: CAN and autopilot differ on own place");
    }
    places_differ_ = differ;
}

}  // namespace jink::app
