// SPDX-License-Identifier: BSD-3-Clause
// Hands off: what is still asked for once control was refused, lost or given up.
#include "firmware/app/takeover.hpp"

namespace jink::app {

using link::FlightMode;

/// The hold mode, asked for when control was lost, until a HEARTBEAT shows that the external mode is over. A mode that
/// a pilot chose is not fought: whatever it is, it ends this.
TakeoverAction Takeover::insist_on_hold(const TakeoverInput& input, TimePoint now) noexcept
{
    // Granted but not seen yet: a HEARTBEAT may have been sent before that.
    const bool is_over = input.has_report && input.report.mode != FlightMode::external &&
                         (claim_.is_seen || now - request_.asked >= kConfirm);
    hold_.due = hold_.due && claim_.kind != Claim::none && !is_over;
    hold_.accepted = hold_.accepted || input.mode_accepted;
    if (!hold_.due || !claim_.is_seen || !input.link_alive || hold_.tries >= kHoldTries) {
        return TakeoverAction::none;
    }
    const Seconds waited = now - hold_.asked;
    const bool unanswered = !hold_.accepted && waited >= kHoldRepeat;
    const bool unheeded = input.has_report && waited >= kConfirm;
    if (hold_.tries > 0 && !unanswered && !unheeded) {
        return TakeoverAction::none;
    }
    if (!evidence_.is_clear_to_ask(now)) {
        return TakeoverAction::none;
    }
    ++hold_.tries;
    ++diagnostics_.hold_requests;
    hold_.accepted = false;
    hold_.asked = now;
    return TakeoverAction::request_hold;
}

/// Control was lost.
TakeoverAction Takeover::begin_hold(const TakeoverInput& input, TimePoint now) noexcept
{
    hold_.due = true;
    hold_.accepted = false;
    hold_.tries = 0;
    return insist_on_hold(input, now);
}

/// A hold seen now answers what was asked for at a loss.
bool Takeover::hold_is_ours(TimePoint now) const noexcept
{
    return mode_ == FlightMode::hold && hold_.tries > 0 && now - hold_.asked < kConfirm;
}

/// Refused: all that is left is to have the autopilot stop by itself before it is too late.
TakeoverOutput Takeover::stand_by(const TakeoverInput& input, TimePoint now) noexcept
{
    if (foreign(input)) {
        if (request_.tries == 0 || mode_ != FlightMode::hold || !input.report.armed) {
            return overrule();
        }
        const bool news = unfollowed_ && claim_.kind != Claim::none;
        claim_.kind = Claim::none;  // the hold that we asked for: what follows it is somebody else's choice
        if (news) {
            ++diagnostics_.held;
            return {TakeoverAction::none, TakeoverEvent::held};
        }
    }
    if (unfollowed_) {
        return keep_off(input, now);
    }
    expire_claim(input, now);
    if (mode_ == FlightMode::external && claim_.kind != Claim::none && input.may_act) {
        // Granted late, after we had given up waiting: without a stream the vehicle would stop there for good.
        return take(now);
    }
    if (!input.in_conflict && !input.wants_control) {
        control_ = Control::autopilot;
        return idle(input, now);
    }
    const bool still_flying = mode_ == FlightMode::mission;
    if (input.urgent_hold && input.may_act && still_flying && request_.tries < kTries &&
        (request_.tries == 0 || now - since_ >= kConfirm) && evidence_.is_clear_to_ask(now)) {
        ++request_.tries;
        ++diagnostics_.hold_requests;
        since_ = now;
        return {TakeoverAction::request_hold, TakeoverEvent::none};
    }
    return {};
}

/// Hands off after the pilot's choice, after sticks that moved or after commands that were not followed.
TakeoverOutput Takeover::keep_off(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool over = input.has_report && (mode_ != FlightMode::external || !input.report.armed);
    // A HEARTBEAT may have been sent before a request of ours was granted.
    if (over && (claim_.is_seen || foreign(input) || now - request_.asked >= kConfirm)) {
        back_.due = false;
        claim_.kind = Claim::none;
    }
    if (!input.in_conflict && !input.wants_control && !back_.due) {
        control_ = Control::autopilot;
        return idle(input, now);
    }
    if (unfollowed_) {
        return {insist_on_hold(input, now), TakeoverEvent::none};
    }
    const bool due = back_.due && input.link_alive && mode_ == FlightMode::external && back_.tries < kTries &&
                     (back_.tries == 0 || now - back_.asked >= kConfirm);
    if (due && evidence_.is_clear_to_ask(now)) {
        ++back_.tries;
        back_.asked = now;
        return {TakeoverAction::request_former, TakeoverEvent::none};
    }
    back_.due = back_.due && (back_.tries < kTries || now - back_.asked < kConfirm);
    return {};
}

/// The pilot has the sticks: no command of ours from here on. Whatever mode the pilot chooses stands; until then the
/// former one is asked for, so that the vehicle is not left without anybody who commands it.
TakeoverOutput Takeover::yield_to_sticks(const TakeoverInput& input, TimePoint now) noexcept
{
    control_ = Control::overruled;
    request_.tries = 0;
    back_.due = claim_.kind != Claim::none;
    const bool on_its_way = asked_back_ && now - since_ < kConfirm;
    back_.tries = on_its_way ? 1 : 0;
    back_.asked = since_;
    ++diagnostics_.sticks;
    return {keep_off(input, now).action, TakeoverEvent::sticks};
}

TakeoverOutput Takeover::give_up(const TakeoverInput& input, TimePoint now) noexcept
{
    control_ = Control::refused;
    unfollowed_ = true;
    request_.tries = kTries;
    ++diagnostics_.unfollowed;
    return {begin_hold(input, now), TakeoverEvent::unfollowed};
}

/// A fault of ours while streaming.
TakeoverOutput Takeover::lose(const TakeoverInput& input, TimePoint now) noexcept
{
    const bool flown = follows();
    drop(true);
    if (flown) {
        return {begin_hold(input, now), TakeoverEvent::lost};
    }
    // Control was never given, nothing is lost: fall silent; this tick's report still counts.
    mode_ = input.has_report ? input.report.mode : FlightMode::unknown;
    return idle(input, now);
}

}  // namespace jink::app
