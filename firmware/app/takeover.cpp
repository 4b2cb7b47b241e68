// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/takeover.hpp"

namespace jink::app {

using link::FlightMode;

void Takeover::drop(bool by_fault) noexcept
{
    diagnostics_.lost_by_fault += by_fault && streaming() ? 1U : 0U;
    owed_ = by_fault && (in_control() || (owed_ && control_ == Control::autopilot));
    control_ = Control::autopilot;
    mode_ = FlightMode::unknown;
}

/// A mode that is neither the one we left nor the one we asked for, or no longer armed: somebody else decided.
bool Takeover::foreign(const TakeoverInput& input) const noexcept
{
    if (!input.has_report) {
        return false;
    }
    const bool ours = input.report.mode == FlightMode::external || input.report.custom_mode == former_mode_;
    return !ours || !input.report.armed;
}

TakeoverOutput Takeover::overrule() noexcept
{
    control_ = Control::overruled;
    ++diagnostics_.overruled;
    return {TakeoverAction::none, TakeoverEvent::overruled};
}

TakeoverOutput Takeover::idle(const TakeoverInput& input, TimePoint now) noexcept
{
    if (owed_ && input.has_report && mode_ != FlightMode::external) {
        owed_ = false;
    }
    if (owed_ && input.may_act && mode_ == FlightMode::external) {
        // A fault of ours is over and nobody has changed the mode since: it is still ours to give back.
        owed_ = false;
        control_ = Control::ours;
        return {TakeoverAction::none, TakeoverEvent::took_over};
    }
    const bool free = mode_ == FlightMode::mission && input.report.armed && !input.report.landed;
    if (input.wants_control && input.may_act && free) {
        control_ = Control::announcing;
        former_mode_ = input.report.custom_mode;
        since_ = now;
        tries_ = 0;
    }
    return {};
}

TakeoverOutput Takeover::ask(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        return overrule();
    }
    if (mode_ == FlightMode::external) {
        control_ = Control::ours;
        ++diagnostics_.taken;
        return {TakeoverAction::none, TakeoverEvent::took_over};
    }
    if (!input.wants_control && control_ == Control::announcing) {
        control_ = Control::autopilot;
        return {};
    }
    const Seconds waited = now - since_;
    if (control_ == Control::announcing && waited < kAnnounce) {
        return {};
    }
    if (control_ == Control::requesting && waited < kConfirm && !(input.mode_denied && waited >= kAnnounce)) {
        return {};
    }
    if (tries_ < kTries) {
        ++tries_;
        ++diagnostics_.requests;
        control_ = Control::requesting;
        since_ = now;
        return {TakeoverAction::request_external, TakeoverEvent::none};
    }
    control_ = Control::refused;
    ++diagnostics_.refused;
    tries_ = 0;
    return {TakeoverAction::none, TakeoverEvent::refused};
}

TakeoverOutput Takeover::fly(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        return overrule();
    }
    if (input.has_report && mode_ != FlightMode::external) {
        // The former mode: ours to give while returning, the pilot's choice otherwise.
        if (control_ == Control::ours) {
            return overrule();
        }
        control_ = Control::autopilot;
        ++diagnostics_.given_back;
        return {TakeoverAction::none, TakeoverEvent::gave_back};
    }
    if (input.wants_control) {
        control_ = Control::ours;
        return {};
    }
    if (control_ == Control::ours || now - since_ >= kConfirm) {
        control_ = Control::returning;
        since_ = now;
        return {TakeoverAction::request_former, TakeoverEvent::none};
    }
    return {};
}

/// Refused: all that is left is to have the autopilot stop by itself before it is too late.
TakeoverOutput Takeover::stand_by(const TakeoverInput& input, TimePoint now) noexcept
{
    if (input.has_report && mode_ == FlightMode::external) {
        // Granted late, after we had given up waiting: without a stream the vehicle would stop there for good.
        control_ = Control::ours;
        return {TakeoverAction::none, TakeoverEvent::took_over};
    }
    if (!input.in_conflict && !input.wants_control) {
        control_ = Control::autopilot;
        return {};
    }
    const bool still_flying = mode_ == FlightMode::mission;
    if (input.urgent_hold && input.may_act && still_flying && tries_ < kTries &&
        (tries_ == 0 || now - since_ >= kConfirm)) {
        ++tries_;
        since_ = now;
        return {TakeoverAction::request_hold, TakeoverEvent::none};
    }
    return {};
}

TakeoverOutput Takeover::update(const TakeoverInput& input, TimePoint now) noexcept
{
    if (input.has_report) {
        mode_ = input.report.mode;
    }
    if (streaming() && !input.may_act) {
        drop(true);
        return {TakeoverAction::none, TakeoverEvent::lost};
    }
    switch (control_) {
    case Control::autopilot: return idle(input, now);
    case Control::announcing:
    case Control::requesting: return ask(input, now);
    case Control::ours:
    case Control::returning: return fly(input, now);
    case Control::refused: return stand_by(input, now);
    case Control::overruled:
        if (!input.in_conflict && !input.wants_control) {
            control_ = Control::autopilot;
        }
        return {};
    }
    return {};
}

}  // namespace jink::app
