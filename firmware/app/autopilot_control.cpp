// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/autopilot_control.hpp"

#include "firmware/app/hold_choice.hpp"
#include "firmware/app/wing_course.hpp"

namespace jink::app {
namespace {

/// Set-points that a PX4 only has to see: it wants 2 Hz or more [s].
constexpr Seconds kProvingPeriod = 0.2F;
/// A command further than this from the last one sent goes out at once [m/s].
constexpr float kNewCommand = 1.0F;
/// With so much waiting for the line, nothing is asked that may be asked again [bytes].
constexpr std::size_t kBacklog = 1024;

/// Not in control: it is time to stop, and to stop is safer than to go on.
bool is_hold_urgent(const ControlInput& input, const Configuration& c, const avoid::Guidance& guidance) noexcept
{
    const Seconds stopping = vehicle::stopping_time(input.own.velocity.norm(), c.limits) + c.supervisor.reserve;
    if (!guidance.conflict || guidance.conflict->time_to_loss > stopping) {
        return false;
    }
    const world::ThreatRef threat = guidance.conflict->threat;
    const bool is_track = threat.kind == world::ThreatKind::track && threat.index < input.tracks.size();
    return is_stopping_safer(input.own, c.limits, *guidance.conflict, is_track ? &input.tracks[threat.index] : nullptr);
}

void announce(TakeoverEvent event, Outbox& outbox) noexcept
{
    using link::Severity;
    switch (event) {
    case TakeoverEvent::took_over: outbox.say(Severity::warning, "jink: avoiding, has control"); break;
    case TakeoverEvent::gave_back: outbox.say(Severity::notice, "jink: clear, mission resumed"); break;
    case TakeoverEvent::refused: outbox.say(Severity::critical, "jink: control refused, advising only"); break;
    case TakeoverEvent::overruled: outbox.say(Severity::warning, "jink: mode changed by others, hands off"); break;
    case TakeoverEvent::lost: outbox.say(Severity::critical, "jink: fault while avoiding, control dropped"); break;
    case TakeoverEvent::held: outbox.say(Severity::warning, "jink: autopilot holds, as asked"); break;
    case TakeoverEvent::sticks: outbox.say(Severity::warning, "jink: sticks moved, hands off"); break;
    case TakeoverEvent::unfollowed:
        outbox.say(Severity::critical, "jink: set-points not followed, asks to hold");
        break;
    case TakeoverEvent::found: outbox.say(Severity::notice, "jink: found in external mode, left alone"); break;
    case TakeoverEvent::none: break;
    }
}

}  // namespace

bool can_steer(const link::AutopilotReport& autopilot, const Configuration& c) noexcept
{
    // A plane keeps its own speed: it cannot fly what reciprocal avoidance asks for.
    const bool as_wing = c.limits.kind == vehicle::VehicleKind::fixed_wing && !is_reactive(c.supervisor.order);
    return autopilot.steerable && (!autopilot.fixed_wing || as_wing);
}

void AutopilotControl::note_restart(Outbox& outbox) noexcept
{
    outbox.say(link::Severity::warning,
               takeover_.in_control() ? "jink: autopilot restarted, control dropped" : "jink: autopilot restarted");
    takeover_.drop(false);
}

void AutopilotControl::shut_down(TimePoint now) noexcept
{
    link_.drop_setpoint();
    link_.drop_mode_request();
    if (takeover_.may_ask_to_hold(now)) {
        link_.request_hold_mode();
    }
    takeover_.drop(false);
}

/// Of the stream that is due; 0: none.
Seconds AutopilotControl::setpoint_period(const Configuration& c) const noexcept
{
    if (takeover_.streaming()) {
        return c.setpoint_period;
    }
    return takeover_.proving() ? kProvingPeriod : 0.0F;
}

/// Neither autopilot flies a set-point from before its external mode: what is wanted is said at once when it begins.
void AutopilotControl::send_setpoint(const ControlInput& input, Seconds period, bool followed,
                                     StepReport& report) noexcept
{
    const Vec3& own = input.own.velocity;
    // Until the autopilot follows us, the stream says what it does anyway. A fallback does not wait for the answer.
    const bool follows = takeover_.follows() && (followed || report.guidance.wants_control);
    const bool flees =
        takeover_.control() == Control::requesting && report.guidance.wants_control && report.guidance.by == 0;
    const bool leads = follows || flees;
    const Vec3& wanted = leads ? report.guidance.velocity : own;
    const Vec3 velocity = input.autopilot.report().fixed_wing ? wing_course(wanted, own, last_velocity_) : wanted;
    // What is decided anew does not wait for its turn: a tenth of a second is half a metre at cruise speed.
    const bool anew =
        leads && ((follows && !followed) || (velocity - last_velocity_).squaredNorm() > kNewCommand * kNewCommand);
    if (period <= 0.0F || (!anew && input.now - last_setpoint_ < period - 0.5F * kTick)) {
        return;
    }
    link_.send_velocity(velocity, input.now);
    last_setpoint_ = input.now;
    last_velocity_ = velocity;
    report.setpoint_sent = true;
    ++counts_.setpoints;
}

/// A request that waits for the line grows old like a set-point: nobody may be asked for a mode that was wanted a while
/// ago, least of all when somebody else has chosen one.
void AutopilotControl::request(const TakeoverOutput& output, TimePoint now) noexcept
{
    if (output.event != TakeoverEvent::none || now - last_mode_request_ >= ModeEvidence::kAnswer) {
        link_.drop_mode_request();
    }
    switch (output.action) {
    case TakeoverAction::request_external: link_.request_external_mode(); break;
    case TakeoverAction::request_former:
        if (way_blocked_) {
            link_.request_hold_mode();
        } else {
            link_.request_mode(takeover_.former_mode());
        }
        break;
    case TakeoverAction::request_hold: link_.request_hold_mode(); break;
    case TakeoverAction::none:
        if (output.ask_heartbeat && link_.pending().size() < kBacklog) {
            link_.request_heartbeat();
        }
        return;
    }
    last_mode_request_ = now;
}

/// The line may be open and take nothing: what is queued must not go out when it is no longer true.
void AutopilotControl::drop_stale(Seconds period, TimePoint now) noexcept
{
    if (period <= 0.0F || now - last_setpoint_ >= period) {
        link_.drop_setpoint();
    }
}

/// Blocked: the hold mode is asked for in place of the former one. A hold that follows is our own choice; any mode
/// after it is somebody else's, who may be guarded again.
void AutopilotControl::note_block(const AutopilotState& autopilot, const avoid::Guidance& guidance,
                                  Outbox& outbox) noexcept
{
    if (guidance.blocked && !way_blocked_) {
        outbox.say(link::Severity::warning, "jink: way blocked, autopilot holds");
    }
    way_blocked_ = guidance.blocked || (way_blocked_ && !takeover_.in_control());
    const bool chosen = autopilot.is_new() && autopilot.report().mode != link::FlightMode::hold;
    if (way_blocked_ && takeover_.control() == Control::overruled && chosen) {
        takeover_.drop(false);
        way_blocked_ = false;
    }
}

TakeoverInput AutopilotControl::takeover_input(const ControlInput& input, const Configuration& c,
                                               const StepReport& report) noexcept
{
    const link::AutopilotReport& autopilot = input.autopilot.report();
    TakeoverInput out;
    out.wants_control = report.guidance.wants_control;
    out.in_conflict = report.guidance.conflict.has_value();
    out.may_act = report.faults == 0 && c.mode == ActMode::act;
    out.urgent_hold = !takeover_.in_control() && is_hold_urgent(input, c, report.guidance);
    out.has_report = input.autopilot.is_new();
    out.report_is_late = (report.faults & bit(Fault::late)) != 0;
    out.report = autopilot;
    out.report.steerable = can_steer(autopilot, c) && (!autopilot.fixed_wing || link_.origin().has_value());
    out.earlier = input.autopilot.earlier();
    out.mode_denied = input.autopilot.has_denied_mode();
    out.mode_accepted = input.autopilot.has_accepted_mode();
    out.stands_by = c.stands_by;
    out.link_alive = (report.faults & bit(Fault::port_lost)) == 0;
    out.sticks_moved = sticks_moved_;
    if (takeover_.control() == Control::ours) {
        out.unfollowed = follow_check_.update(last_velocity_, input.velocity, c.limits, input.now);
    } else {
        follow_check_.reset();
    }
    return out;
}

TakeoverEvent AutopilotControl::update(const ControlInput& input, const Configuration& c, StepReport& report,
                                       Outbox& outbox) noexcept
{
    if (!is_finite(input.own.velocity) || !is_finite(report.guidance.velocity)) {
        counts_.setpoints_withheld += setpoint_period(c) > 0.0F ? 1U : 0U;
        report.faults = static_cast<std::uint16_t>(report.faults | bit(Fault::not_finite));
    }
    const bool followed = takeover_.follows();
    const TakeoverInput takeover = takeover_input(input, c, report);
    note_block(input.autopilot, report.guidance, outbox);
    const TakeoverOutput output = takeover_.update(takeover, input.now);
    request(output, input.now);
    // The hold that was asked for, and said, is no news.
    const bool as_asked = way_blocked_ && output.event == TakeoverEvent::overruled &&
                          input.autopilot.report().mode == link::FlightMode::hold;
    announce(as_asked ? TakeoverEvent::none : output.event, outbox);
    const Seconds period = setpoint_period(c);
    send_setpoint(input, period, followed, report);
    drop_stale(period, input.now);
    report.control = takeover_.control();
    return output.event;
}

}  // namespace jink::app
