// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/takeover.hpp"

namespace jink::app {

using link::FlightMode;

void Takeover::drop(bool by_fault) noexcept
{
    diagnostics_.lost_by_fault += by_fault && in_control() ? 1U : 0U;
    if (!by_fault) {
        claim_ = Claim::none;
        tries_ = 0;
        hold_due_ = false;
        hold_tries_ = 0;
    }
    control_ = Control::autopilot;
    proving_ = false;
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
    claim_ = Claim::none;
    tries_ = 0;
    ++diagnostics_.overruled;
    return {TakeoverAction::none, TakeoverEvent::overruled};
}

/// Another mode seen after the time for a confirmation: an external mode from now on is not due to us.
void Takeover::expire_claim(const TakeoverInput& input, TimePoint now) noexcept
{
    if (input.has_report && mode_ != FlightMode::external && (claim_ == Claim::held || now - asked_ >= kConfirm)) {
        claim_ = Claim::none;
    }
}

/// The hold mode, asked for when control was lost, until a HEARTBEAT shows that the external mode is over. A mode that
/// a pilot chose is not fought: whatever it is, it ends this.
TakeoverAction Takeover::insist_on_hold(const TakeoverInput& input, TimePoint now) noexcept
{
    hold_due_ = hold_due_ && claim_ == Claim::held && !(input.has_report && mode_ != FlightMode::external);
    hold_acked_ = hold_acked_ || input.mode_accepted;
    if (!hold_due_ || !input.link_alive || hold_tries_ >= kHoldTries) {
        return TakeoverAction::none;
    }
    const Seconds waited = now - hold_asked_;
    const bool unanswered = !hold_acked_ && waited >= kHoldRepeat;
    const bool unheeded = input.has_report && waited >= kConfirm;
    if (hold_tries_ > 0 && !unanswered && !unheeded) {
        return TakeoverAction::none;
    }
    ++hold_tries_;
    ++diagnostics_.hold_requests;
    hold_acked_ = false;
    hold_asked_ = now;
    return TakeoverAction::request_hold;
}

/// A hold seen now answers what was asked for at a loss.
bool Takeover::hold_is_ours(TimePoint now) const noexcept
{
    return mode_ == FlightMode::hold && hold_tries_ > 0 && now - hold_asked_ < kConfirm;
}

/// The HEARTBEAT shows the external mode that we asked for.
TakeoverOutput Takeover::take(TimePoint now) noexcept
{
    // Taken up again after a fault, the former mode may have been asked for just before it.
    asked_back_ = asked_back_ && claim_ == Claim::held && now - since_ < kConfirm;
    diagnostics_.taken += claim_ == Claim::asked ? 1U : 0U;
    claim_ = Claim::held;
    control_ = Control::ours;
    tries_ = 0;
    hold_due_ = false;
    return {TakeoverAction::none, TakeoverEvent::took_over};
}

TakeoverOutput Takeover::idle(const TakeoverInput& input, TimePoint now) noexcept
{
    if (!input.in_conflict && !input.wants_control) {
        tries_ = 0;
    }
    if (claim_ != Claim::none && foreign(input)) {
        // A loss of control has the application ask for the hold mode.
        if (claim_ == Claim::asked || mode_ != FlightMode::hold) {
            return overrule();
        }
        claim_ = Claim::none;
    }
    expire_claim(input, now);
    if (claim_ != Claim::none && input.may_act && mode_ == FlightMode::external) {
        // A fault of ours is over, or the grant came late, and nobody else has changed the mode: ours to give back.
        return take(now);
    }
    if (const TakeoverAction hold = insist_on_hold(input, now); hold != TakeoverAction::none) {
        return {hold, TakeoverEvent::none};
    }
    const bool free = mode_ == FlightMode::mission && input.report.armed && !input.report.landed;
    if (input.wants_control && input.may_act && free) {
        control_ = Control::announcing;
        former_mode_ = input.report.custom_mode;
        since_ = now;
        hold_tries_ = 0;
    }
    return {};
}

TakeoverOutput Takeover::ask(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        return overrule();
    }
    if (mode_ == FlightMode::external) {
        return claim_ == Claim::none ? overrule() : take(now);
    }
    if (control_ == Control::announcing) {
        expire_claim(input, now);
    }
    if (!input.wants_control && control_ == Control::announcing) {
        control_ = Control::autopilot;
        return {};
    }
    const Seconds waited = now - since_;
    if (control_ == Control::announcing && now - streaming_since_ < kAnnounce) {
        return {};
    }
    denied_ = control_ == Control::requesting && (denied_ || input.mode_denied);
    const bool unproven = input.report.stack == link::AutopilotStack::px4 && now - streaming_since_ < kProof;
    const bool again = unproven ? denied_ && waited >= kAskAgain : input.mode_denied && waited >= kAnnounce;
    if (control_ == Control::requesting && waited < kConfirm && !again) {
        return {};
    }
    if (unproven || tries_ < kTries) {
        tries_ += unproven ? 0 : 1;
        ++diagnostics_.requests;
        denied_ = false;
        control_ = Control::requesting;
        claim_ = Claim::asked;
        since_ = asked_ = now;
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
        if (!hold_is_ours(now) || !input.report.armed) {
            return overrule();
        }
        control_ = Control::autopilot;
        claim_ = Claim::none;
        ++diagnostics_.held;
        return {TakeoverAction::none, TakeoverEvent::held};
    }
    if (input.has_report && mode_ != FlightMode::external) {
        // The former mode: given back if we asked for it, the pilot's choice otherwise.
        if (control_ == Control::ours && !asked_back_) {
            return overrule();
        }
        control_ = Control::autopilot;
        claim_ = Claim::none;
        ++diagnostics_.given_back;
        return {TakeoverAction::none, TakeoverEvent::gave_back};
    }
    if (input.wants_control) {
        // Still external after the time for a confirmation: the request was lost.
        asked_back_ = asked_back_ && !(input.has_report && now - since_ >= kConfirm);
        control_ = Control::ours;
        return {};
    }
    if (control_ == Control::ours || now - since_ >= kConfirm) {
        control_ = Control::returning;
        asked_back_ = true;
        since_ = now;
        return {TakeoverAction::request_former, TakeoverEvent::none};
    }
    return {};
}

/// Refused: all that is left is to have the autopilot stop by itself before it is too late.
TakeoverOutput Takeover::stand_by(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        if (tries_ == 0 || mode_ != FlightMode::hold || !input.report.armed) {
            return overrule();
        }
        claim_ = Claim::none;  // the hold that we asked for: what follows it is somebody else's choice
    }
    if (mode_ == FlightMode::external && claim_ != Claim::none && input.may_act) {
        // Granted late, after we had given up waiting: without a stream the vehicle would stop there for good.
        return take(now);
    }
    if (!input.in_conflict && !input.wants_control) {
        control_ = Control::autopilot;
        return idle(input, now);
    }
    const bool still_flying = mode_ == FlightMode::mission;
    if (input.urgent_hold && input.may_act && still_flying && tries_ < kTries &&
        (tries_ == 0 || now - since_ >= kConfirm)) {
        ++tries_;
        ++diagnostics_.hold_requests;
        since_ = now;
        return {TakeoverAction::request_hold, TakeoverEvent::none};
    }
    return {};
}

TakeoverOutput Takeover::update(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool was_streaming = streaming() || proving_;
    const TakeoverOutput output = decide(input, now);
    proving_ = control_ == Control::autopilot && claim_ == Claim::none && input.keep_stream && input.may_act &&
               input.report.stack == link::AutopilotStack::px4 && mode_ == FlightMode::mission && input.report.armed &&
               !input.report.landed;
    if (!was_streaming && (streaming() || proving_)) {
        streaming_since_ = now;
    }
    return output;
}

TakeoverOutput Takeover::decide(const TakeoverInput& input, TimePoint now) noexcept
{
    if (input.has_report) {
        mode_ = input.report.mode;
    }
    const bool yields = foreign(input) || (in_control() && input.has_report && mode_ != FlightMode::external);
    if (streaming() && !input.may_act && !yields) {
        const bool flown = in_control();
        drop(true);
        if (flown) {
            hold_due_ = true;
            hold_acked_ = false;
            hold_tries_ = 0;
            return {insist_on_hold(input, now), TakeoverEvent::lost};
        }
        // Control was never given, nothing is lost: fall silent; this tick's report still counts.
        mode_ = input.has_report ? input.report.mode : FlightMode::unknown;
        return idle(input, now);
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
