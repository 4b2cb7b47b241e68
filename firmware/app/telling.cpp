// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor says of itself: heartbeats, texts and its last words.
#include <algorithm>

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/method_orders.hpp"

namespace jink::app {
namespace {

constexpr Seconds kHeartbeatPeriod = 1.0F;
constexpr Seconds kCollisionPeriod = 0.5F;
/// Without a conflict for so long, the next one is another one [s].
constexpr Seconds kConflictOver = 5.0F;
/// A vehicle counts as not steerable after so many HEARTBEATs: EXTENDED_SYS_STATE and parameters may come later.
constexpr int kUnsteerableReports = 6;

}  // namespace

link::SystemState Coprocessor::system_state(const StepReport& report) const noexcept
{
    const unsigned never_ready = bit(Fault::no_autopilot) | bit(Fault::own_state_missing) |
                                 bit(Fault::airspace_unplaced) |
                                 (bus_was_up_ ? 0U : static_cast<unsigned>(bit(Fault::bus_lost)));
    if (report.faults != 0) {
        const bool only_waiting = (report.faults & ~never_ready) == 0;
        return only_waiting ? link::SystemState::boot : link::SystemState::critical;
    }
    if (report.guidance.wants_control && report.guidance.margin < 0.0F &&
        report.guidance.state == avoid::State::braking) {
        return link::SystemState::emergency;
    }
    const bool on_guard = autopilot_.armed && parameters_.configuration().mode != ActMode::off;
    return on_guard ? link::SystemState::active : link::SystemState::standby;
}

void Coprocessor::announce(TakeoverEvent event) noexcept
{
    using link::Severity;
    switch (event) {
    case TakeoverEvent::took_over: say(Severity::warning, "jink: avoiding, has control"); break;
    case TakeoverEvent::gave_back: say(Severity::notice, "jink: clear, mission resumed"); break;
    case TakeoverEvent::refused: say(Severity::critical, "jink: control refused, advising only"); break;
    case TakeoverEvent::overruled: say(Severity::warning, "jink: mode changed by others, hands off"); break;
    case TakeoverEvent::lost: say(Severity::critical, "jink: fault while avoiding, control dropped"); break;
    case TakeoverEvent::held: say(Severity::warning, "jink: autopilot holds, as asked"); break;
    case TakeoverEvent::sticks: say(Severity::warning, "jink: sticks moved, hands off"); break;
    case TakeoverEvent::unfollowed: say(Severity::critical, "jink: set-points not followed, asks to hold"); break;
    case TakeoverEvent::found: say(Severity::notice, "jink: found in external mode, left alone"); break;
    case TakeoverEvent::none: break;
    }
}

void Coprocessor::tell(TimePoint now, const StepReport& report) noexcept
{
    const bool changed = report.state != told_state_;
    if (changed && report.state == link::SystemState::critical) {
        ++diagnostics_.faults;
        Text text;
        text << "jink: fault " << static_cast<std::uint32_t>(report.faults);
        say(link::Severity::critical, text.view());
    }
    if (!heartbeat_sent_ || changed || now - last_heartbeat_ >= kHeartbeatPeriod) {
        link_.send_heartbeat(report.state);
        heartbeat_sent_ = true;
        last_heartbeat_ = now;
        told_state_ = report.state;
    }
    tell_notices();
    tell_autopilot_state(report);
    const avoid::Guidance& g = report.guidance;
    if (g.conflict && (!told_conflict_ || now - last_collision_ >= kCollisionPeriod)) {
        warn_of_conflict(now, report);
    }
    told_conflict_ = g.conflict.has_value();
    tell_braking(now, g);
}

/// Once each: that this vehicle is not steered, and, when the line is back, why it holds.
void Coprocessor::tell_autopilot_state(const StepReport& report) noexcept
{
    if (!new_autopilot_report_) {
        return;
    }
    const bool advises = parameters_.configuration().mode == ActMode::act && !can_steer() && autopilot_.armed;
    unsteerable_reports_ = advises ? std::min(unsteerable_reports_ + 1, kUnsteerableReports) : 0;
    if (unsteerable_reports_ == kUnsteerableReports && !told_advising_) {
        told_advising_ = true;
        say(link::Severity::notice, "jink: cannot steer this vehicle, advising only");
    }
    const unsigned dead = bit(Fault::port_lost) | bit(Fault::autopilot_silent);
    if (loss_untold_ && (report.faults & dead) == 0) {
        loss_untold_ = false;
        say(link::Severity::warning, "jink: line lost while avoiding, control dropped");
    }
}

/// That nothing is safe is CRITICAL once in a conflict; a fallback that keeps clear is a warning, once too. A conflict
/// that comes and goes is one.
void Coprocessor::tell_braking(TimePoint now, const avoid::Guidance& g) noexcept
{
    last_conflict_ = g.conflict || g.state == avoid::State::braking ? now : last_conflict_;
    if (now - last_conflict_ > kConflictOver) {
        told_unsafe_ = told_braking_ = false;
    }
    if (g.state == avoid::State::braking && g.wants_control) {
        if (g.margin < 0.0F && !told_unsafe_) {
            told_unsafe_ = told_braking_ = true;
            say(link::Severity::critical, "jink: nothing safe, braking");
        } else if (!told_braking_) {
            told_braking_ = true;
            say(link::Severity::warning, "jink: no way around, braking");
        }
    }
}

/// Before anything of this step goes out, so that they are newer than all of it.
void Coprocessor::prepare_last_words() noexcept
{
    if (last_words_ == nullptr) {
        return;
    }
    const bool hold = takeover_.may_ask_to_hold(last_step_);
    const std::string_view text = passive_ ? ""  // told by then, and again and again in a row of faults
                                  : hold   ? "jink: processor fault, hold asked, restarting"
                                           : "jink: processor fault, restarting";
    last_words_->publish(link_.compose_last_words(last_words_->draft(), hold, text));
}

void Coprocessor::tell_notices() noexcept
{
    if (has_autopilot_) {
        for (const Notice& notice : notices_) {
            say(notice.severity, notice.text.view());
        }
        notices_.clear();
    }
    if (leaves_reach_out_ && !told_left_out_ && has_autopilot_) {
        say(link::Severity::critical, "jink: reach sets damaged, left out");
        told_left_out_ = true;
    }
    const world::TrackDiagnostics& t = tracks_.diagnostics();
    const bool flooded = t.floods + t.replaced + t.full > 0;
    if (flooded && !told_flood_ && has_autopilot_) {
        say(link::Severity::warning, "jink: too much traffic, some is left out");
        told_flood_ = true;
    }
    const Configuration& c = parameters_.configuration();
    const bool unsuited = c.reach_unsuited && c.supervisor.order != avoid::MethodOrder(kGeometric);
    if (unsuited && !told_unsuited_ && has_autopilot_) {
        say(link::Severity::warning, "jink: reach sets do not suit this vehicle");
    }
    told_unsuited_ = unsuited && has_autopilot_;
}

void Coprocessor::shut_down(TimePoint now) noexcept
{
    link_.drop_setpoint();
    link_.drop_mode_request();
    if (takeover_.may_ask_to_hold(now)) {
        link_.request_hold_mode();
    }
    takeover_.drop(false);
    link_.send_heartbeat(link::SystemState::critical);
    say(link::Severity::notice, "jink: stopped");
    if (bus_ != nullptr) {
        bus_->service(now, {link::SystemState::critical, false, last_faults_});
    }
    StepReport report;
    write_port(report);
}

}  // namespace jink::app
