// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/takeover.hpp"

namespace jink::app {

using link::FlightMode;

void Takeover::drop(bool by_fault) noexcept
{
    diagnostics_.lost_by_fault += by_fault && follows() ? 1U : 0U;
    if (!by_fault) {
        claim_.kind = Claim::none;
        request_.tries = 0;
        hold_.due = false;
        hold_.tries = 0;
        unfollowed_ = false;
    }
    control_ = Control::autopilot;
    back_.due = false;
    stream_.is_proving = false;
    mode_ = FlightMode::unknown;
}

/// When the newest HEARTBEAT came, and how often they come.
void Takeover::note_report(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool is_seen = last_action_ == TakeoverAction::request_external && mode_ == FlightMode::external;
    if (input.mode_accepted && !is_seen) {
        evidence_.note_accepted(now);
    }
    if (!input.has_report) {
        return;
    }
    mode_ = input.report.mode;
    claim_.is_seen = claim_.kind != Claim::none && (claim_.is_seen || mode_ == FlightMode::external);
    unfollowed_ = unfollowed_ && input.report.armed;
    if (evidence_.was_silent(kClaim, now) && !in_control() && claim_.kind != Claim::none) {
        // Nobody knows who flew meanwhile.
        claim_.kind = Claim::none;
        hold_.due = back_.due = false;
        found_ = false;
    }
    if (input.report_is_late) {
        return;
    }
    evidence_.note_heartbeat(now);
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
    claim_.kind = Claim::none;
    request_.tries = 0;
    ++diagnostics_.overruled;
    return {TakeoverAction::none, TakeoverEvent::overruled};
}

/// Another mode seen after the time for a confirmation: an external mode from now on is not due to us.
void Takeover::expire_claim(const TakeoverInput& input, TimePoint now) noexcept
{
    if (input.has_report && mode_ != FlightMode::external && (claim_.is_seen || now - request_.asked >= kConfirm)) {
        claim_.kind = Claim::none;
        back_.due = false;
    }
}

/// The HEARTBEAT shows the external mode that we asked for.
TakeoverOutput Takeover::take(TimePoint now) noexcept
{
    // Taken up again after a fault, the former mode may have been asked for just before it.
    asked_back_ = asked_back_ && claim_.kind == Claim::held && now - since_ < kConfirm;
    diagnostics_.taken += claim_.kind == Claim::asked ? 1U : 0U;
    claim_.kind = Claim::held;
    control_ = Control::ours;
    request_.tries = 0;
    hold_.due = false;
    return {TakeoverAction::none, TakeoverEvent::took_over};
}

/// May be taken over, as far as the autopilot is concerned and we are healthy.
bool Takeover::is_free(const TakeoverInput& input) const noexcept
{
    return input.may_act && mode_ == FlightMode::mission && input.report.armed && !input.report.landed &&
           input.report.steerable && !unfollowed_;
}

TakeoverOutput Takeover::idle(const TakeoverInput& input, TimePoint now) noexcept
{
    if (!input.in_conflict && !input.wants_control) {
        request_.tries = 0;
    }
    if (claim_.kind != Claim::none && foreign(input)) {
        // A loss of control has the application ask for the hold mode.
        if (!claim_.is_seen || mode_ != FlightMode::hold) {
            return overrule();
        }
        claim_.kind = Claim::none;
    }
    expire_claim(input, now);
    if (claim_.kind != Claim::none && input.may_act && mode_ == FlightMode::external && !unfollowed_) {
        // A fault of ours is over, or the grant came late, and nobody else has changed the mode: ours to give back.
        evidence_.need_heartbeat();
        return evidence_.is_fresh(now) ? take(now) : TakeoverOutput{};
    }
    if (const TakeoverAction hold = insist_on_hold(input, now); hold != TakeoverAction::none) {
        return {hold, TakeoverEvent::none};
    }
    if (!input.wants_control || !is_free(input)) {
        return {};
    }
    static_cast<void>(evidence_.is_clear_to_ask(now));  // the answer is there when the request is due
    if (evidence_.is_fresh(now)) {
        control_ = Control::announcing;
        former_mode_ = input.report.custom_mode;
        since_ = now;
        stream_.since = stream_.is_proving ? stream_.since : now;
        hold_.tries = 0;
        return input.stands_by ? ask(input, now) : TakeoverOutput{};
    }
    return {};
}

TakeoverOutput Takeover::ask(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        return overrule();
    }
    if (mode_ == FlightMode::external) {
        return claim_.kind == Claim::none ? overrule() : take(now);
    }
    if (control_ == Control::announcing) {
        expire_claim(input, now);
    }
    if (control_ == Control::announcing && (!input.wants_control || !evidence_.is_fresh(now))) {
        control_ = Control::autopilot;
        if (input.wants_control) {
            evidence_.need_heartbeat();
        }
        return {};
    }
    const Seconds waited = now - since_;
    // Asked for just before a fault that is over: its answer may be on the way.
    const bool is_open = claim_.kind == Claim::asked && now - request_.asked < kConfirm;
    const link::AutopilotStack stack = input.report.stack;
    const bool wants_none = input.stands_by && stack == link::AutopilotStack::ardupilot;
    if (control_ == Control::announcing && ((!wants_none && now - stream_.since < kAnnounce) || is_open)) {
        static_cast<void>(evidence_.is_clear_to_ask(now));
        return {};
    }
    // The newest answer counts: an earlier one may be that to a request before.
    request_.denied = control_ == Control::requesting && !input.mode_accepted && (request_.denied || input.mode_denied);
    request_.granted = !request_.denied && (request_.granted || input.mode_accepted);
    const bool unproven = stack == link::AutopilotStack::px4 && now - stream_.since < kProof;
    const bool again = request_.denied && waited >= (unproven ? kAskAgain : kRetry);
    if (control_ == Control::requesting && waited < kConfirm && !again) {
        return {};
    }
    if (control_ == Control::requesting && !input.wants_control) {
        control_ = Control::autopilot;  // not asked for again; a late grant is still ours to give back
        expire_claim(input, now);
        return {};
    }
    const bool may_try = unproven || request_.tries < kTries;
    const bool clear = may_try && evidence_.is_clear_to_ask(now);
    if (may_try && !clear && waited < static_cast<float>(kTries) * kConfirm) {
        return {};
    }
    if (clear) {
        request_.tries += unproven ? 0 : 1;
        ++diagnostics_.requests;
        request_.denied = request_.granted = false;
        control_ = Control::requesting;
        claim_.kind = Claim::asked;
        claim_.is_seen = false;
        since_ = request_.asked = now;
        return {TakeoverAction::request_external, TakeoverEvent::none};
    }
    control_ = Control::refused;
    expire_claim(input, now);
    ++diagnostics_.refused;
    request_.tries = 0;
    return {TakeoverAction::none, TakeoverEvent::refused};
}

TakeoverOutput Takeover::fly(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        if (!hold_is_ours(now) || !input.report.armed) {
            return overrule();
        }
        control_ = Control::autopilot;
        claim_.kind = Claim::none;
        ++diagnostics_.held;
        return {TakeoverAction::none, TakeoverEvent::held};
    }
    if (input.has_report && mode_ != FlightMode::external) {
        // The former mode: given back if we asked for it, the pilot's choice otherwise.
        if (control_ == Control::ours && !asked_back_) {
            return overrule();
        }
        control_ = Control::autopilot;
        claim_.kind = Claim::none;
        ++diagnostics_.given_back;
        return {TakeoverAction::none, TakeoverEvent::gave_back};
    }
    if (input.wants_control) {
        // Still external after the time for a confirmation: the request was lost.
        asked_back_ = asked_back_ && !(input.has_report && now - since_ >= kConfirm);
        control_ = Control::ours;
        return {};
    }
    const bool on_its_way = asked_back_ && now - since_ < kConfirm;
    control_ = on_its_way ? Control::returning : control_;
    if (!on_its_way && evidence_.is_clear_to_ask(now)) {
        control_ = Control::returning;
        asked_back_ = true;
        since_ = now;
        return {TakeoverAction::request_former, TakeoverEvent::none};
    }
    return {};
}

/// What HEARTBEATs before the newest one show counts, but is no evidence to ask on.
TakeoverEvent Takeover::heed_earlier(const TakeoverInput& input, TimePoint now) noexcept
{
    TakeoverEvent event = TakeoverEvent::none;
    TakeoverInput earlier = input;
    earlier.has_report = earlier.report_is_late = true;
    earlier.earlier = {};
    for (const link::AutopilotReport& report : input.earlier) {
        earlier.report = report;
        if (!foreign(earlier) && report.mode == mode_) {
            // The same mode, but later: what was asked for long ago has not come.
            if (control_ != Control::requesting) {
                expire_claim(earlier, now);
            }
            continue;
        }
        note_report(earlier, now);
        evidence_.discard();
        const TakeoverEvent seen = decide(earlier, now).event;
        event = seen != TakeoverEvent::none ? seen : event;
    }
    return event;
}

TakeoverOutput Takeover::update(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool was_streaming = streaming() || stream_.is_proving;
    const TakeoverEvent earlier = heed_earlier(input, now);
    note_report(input, now);
    TakeoverOutput output = decide(input, now);
    output.event = output.event == TakeoverEvent::none ? earlier : output.event;
    if (output.action != TakeoverAction::none) {
        evidence_.note_request(now);
        last_action_ = output.action;
    }
    if (input.has_report && !found_) {
        found_ = true;
        const bool lone = input.report.armed && mode_ == FlightMode::external && claim_.kind == Claim::none;
        output.event = lone && output.event == TakeoverEvent::none ? TakeoverEvent::found : output.event;
    }
    const bool guards =
        input.stands_by && control_ == Control::autopilot && claim_.kind == Claim::none && is_free(input);
    stream_.is_proving = guards && input.report.stack == link::AutopilotStack::px4;
    if (!was_streaming && (streaming() || stream_.is_proving)) {
        stream_.since = now;
    }
    output.ask_heartbeat = evidence_.is_due(guards || control_ == Control::requesting || in_control(), now);
    diagnostics_.heartbeats_asked += output.ask_heartbeat ? 1U : 0U;
    return output;
}

TakeoverOutput Takeover::decide(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool yields = foreign(input) || (in_control() && input.has_report && mode_ != FlightMode::external);
    if (streaming() && !yields) {
        if (input.sticks_moved) {
            return yield_to_sticks(input, now);
        }
        if (!input.may_act) {
            return lose(input, now);
        }
        if (in_control() && input.unfollowed) {
            return give_up(input, now);
        }
    }
    switch (control_) {
    case Control::autopilot: return idle(input, now);
    case Control::announcing:
    case Control::requesting: return ask(input, now);
    case Control::ours:
    case Control::returning: return fly(input, now);
    case Control::refused: return stand_by(input, now);
    case Control::overruled: return keep_off(input, now);
    }
    return {};
}

}  // namespace jink::app
