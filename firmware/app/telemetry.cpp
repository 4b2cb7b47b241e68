// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/telemetry.hpp"

#include <algorithm>
#include <bit>

#include "firmware/app/conflict_warning.hpp"
#include "firmware/app/near_field.hpp"

namespace jink::app {
namespace {

constexpr Seconds kHeartbeatPeriod = 1.0F;
constexpr Seconds kCollisionPeriod = 0.5F;
/// Receivers of ArduPilot forget a Proximity after 0.5 s [s].
constexpr Seconds kNearPeriod = 0.2F;
/// Without a conflict for so long, the next one is another one [s].
constexpr Seconds kConflictOver = 5.0F;
/// Between two texts about the method.
constexpr Seconds kChoicePeriod = 2.0F;
/// A vehicle counts as not steerable after so many HEARTBEATs: EXTENDED_SYS_STATE and parameters may come later.
constexpr int kUnsteerableReports = 6;

}  // namespace

link::SystemState Telemetry::system_state(const StepReport& report, const Reported& of) noexcept
{
    const unsigned never_ready = bit(Fault::no_autopilot) | bit(Fault::own_state_missing) |
                                 bit(Fault::airspace_unplaced) |
                                 (of.was_bus_up ? 0U : static_cast<unsigned>(bit(Fault::bus_lost)));
    if (report.faults != 0) {
        const bool only_waiting = (report.faults & ~never_ready) == 0;
        return only_waiting ? link::SystemState::boot : link::SystemState::critical;
    }
    if (report.guidance.wants_control && report.guidance.margin < 0.0F &&
        report.guidance.state == avoid::State::braking) {
        return link::SystemState::emergency;
    }
    const bool on_guard = of.autopilot.report().armed && of.configuration.mode != ActMode::off;
    return on_guard ? link::SystemState::active : link::SystemState::standby;
}

void Telemetry::take_commands(std::span<const link::CommandRequest> commands, StepLog* log,
                              const Parameters& parameters) noexcept
{
    constexpr std::uint16_t kRequestMessage = 512;
    constexpr std::uint16_t kRequestCapabilities = 520;
    constexpr float kHeartbeat = 0.0F;
    constexpr float kVersion = 148.0F;
    constexpr float kText = 253.0F;
    for (const link::CommandRequest& request : commands) {
        ++counts_.commands;
        link::CommandResult result = link::CommandResult::unsupported;
        bool version = false;
        if (request.command == kRequestMessage) {
            const bool heartbeat = request.params[0] == kHeartbeat;
            const bool text = request.params[0] == kText && most_cycles_ > 0;
            version = request.params[0] == kVersion;
            result = heartbeat || text || version ? link::CommandResult::accepted : link::CommandResult::denied;
            heartbeat_.is_sent = heartbeat_.is_sent && !heartbeat;
            cycles_asked_ = cycles_asked_ || text;
        } else if (request.command == kRequestCapabilities) {
            version = request.params[0] == 1.0F;
            result = version ? link::CommandResult::accepted : link::CommandResult::denied;
        } else if (log != nullptr) {
            result = log->take(request, parameters);
        }
        counts_.commands_refused += result == link::CommandResult::accepted ? 0U : 1U;
        link_.acknowledge(request, result);
        if (version) {
            link_.send_version({JINK_VERSION_MAJOR, JINK_VERSION_MINOR, JINK_VERSION_PATCH});
        }
    }
}

void Telemetry::note(TakeoverEvent event, const StepReport& report) noexcept
{
    loss_unsaid_ = loss_unsaid_ || (event == TakeoverEvent::lost && (report.faults & kDeadLine) != 0);
}

void Telemetry::report_to_autopilot(TimePoint now, const StepReport& report, const Reported& of,
                                    Outbox& outbox) noexcept
{
    const bool changed = report.state != heartbeat_.state;
    if (changed && report.state == link::SystemState::critical) {
        ++counts_.faults;
        const unsigned digits = std::max((static_cast<unsigned>(std::bit_width(report.faults)) + 3U) / 4U, 1U);
        Text text;  // as the status line of jinkd has it
        text << "jink: fault 0x" << Hex{report.faults, digits};
        outbox.say(link::Severity::critical, text.view());
    }
    if (!heartbeat_.is_sent || changed || now - heartbeat_.at >= kHeartbeatPeriod) {
        link_.send_heartbeat(report.state);
        heartbeat_ = {true, now, report.state};
        if (cycles_asked_) {
            Text text;
            text << "jink: longest step " << most_cycles_ << " cycles";
            outbox.say(link::Severity::notice, text.view());
            cycles_asked_ = false;
        }
    }
    report_causes(of, outbox);
    report_autopilot(report, of, outbox);
    const avoid::Guidance& g = report.guidance;
    if (g.conflict && (!conflict_.is_reported || now - conflict_.reported_at >= kCollisionPeriod)) {
        warn_of_conflict(now, report, of, outbox);
    }
    conflict_.is_reported = g.conflict.has_value();
    report_choice(now, g, outbox);
    report_alert(g, outbox);
    report_braking(now, g, outbox);
}

/// Why the co-processor does less than it might; to an autopilot that listens.
void Telemetry::report_causes(const Reported& of, Outbox& outbox) noexcept
{
    const bool heard = of.autopilot.is_heard();
    if (heard) {
        outbox.send_notices();
    }
    if (of.decision.leaves_out_reach_sets() && !said_.left_out && heard) {
        outbox.say(link::Severity::critical, "jink: reach sets damaged, left out");
        said_.left_out = true;
    }
    const world::TrackDiagnostics& t = of.picture.track_table().diagnostics();
    const bool flooded = t.floods + t.replaced + t.full > 0;
    if (flooded && !said_.flood && heard) {
        outbox.say(link::Severity::warning, "jink: too much traffic, some is left out");
        said_.flood = true;
    }
    if (!said_.harder && heard &&
        of.picture.track_table().any_accelerates_harder(of.configuration.limits, of.configuration.rules)) {
        outbox.say(link::Severity::warning, "jink: neighbour accelerates beyond VEH_ACC");
        said_.harder = true;
    }
    if (of.picture.known_map().is_coarse() && !said_.coarse && heard) {
        outbox.say(link::Severity::warning, "jink: map too dense here, boxes close more");
        said_.coarse = true;
    }
    const bool unsuited = of.configuration.reach_unsuited && asks_reach_sets(of.configuration.supervisor);
    if (unsuited && !said_.unsuited && heard) {
        outbox.say(link::Severity::warning, "jink: reach sets do not suit this vehicle");
    }
    said_.unsuited = unsuited && heard;
}

/// Once each: that this vehicle is not steered, and, when the line is back, why it holds.
void Telemetry::report_autopilot(const StepReport& report, const Reported& of, Outbox& outbox) noexcept
{
    if (!of.autopilot.is_new()) {
        return;
    }
    const link::AutopilotReport& autopilot = of.autopilot.report();
    const bool advises =
        of.configuration.mode == ActMode::act && !can_steer(autopilot, of.configuration) && autopilot.armed;
    unsteerable_reports_ = advises ? std::min(unsteerable_reports_ + 1, kUnsteerableReports) : 0;
    if (unsteerable_reports_ == kUnsteerableReports && !said_.advising) {
        said_.advising = true;
        outbox.say(link::Severity::notice, "jink: cannot steer this vehicle, advising only");
    }
    if (loss_unsaid_ && (report.faults & kDeadLine) == 0) {
        loss_unsaid_ = false;
        outbox.say(link::Severity::warning, "jink: line lost while avoiding, control dropped");
    }
}

void Telemetry::warn_of_conflict(TimePoint now, const StepReport& report, const Reported& of, Outbox& outbox) noexcept
{
    link_.send_collision(warning_of(report.guidance, of.picture, of.own.measured(), of.configuration.limits,
                                    of.control.takeover().in_control(), of.decision.flying()));
    conflict_.reported_at = now;
    if (!conflict_.is_reported) {
        outbox.say(link::Severity::warning, text_of(report.guidance).view());
    }
}

/// At the first answer in a conflict and where the method changes, now and then at most.
void Telemetry::report_choice(TimePoint now, const avoid::Guidance& g, Outbox& outbox) noexcept
{
    const bool chosen = g.by != 0 && g.answers > 0 && g.by != conflict_.said_by;
    if (chosen && (conflict_.said_by == 0 || now - conflict_.said_by_at >= kChoicePeriod)) {
        conflict_.said_by = g.by;
        conflict_.said_by_at = now;
        outbox.say(link::Severity::notice, text_of_choice(g).view());
    }
}

/// Where an alert of aircraft rises.
void Telemetry::report_alert(const avoid::Guidance& g, Outbox& outbox) noexcept
{
    if (g.alert > conflict_.said_alert) {
        conflict_.said_alert = g.alert;
        const bool ahead = g.alert < world::Alert::high;
        const bool near = g.alert == world::Alert::critical;
        outbox.say(near    ? link::Severity::critical
                   : ahead ? link::Severity::notice
                           : link::Severity::warning,
                   text_of_alert(g.alert).view());
    }
}

/// That nothing is safe is CRITICAL once in a conflict; a fallback that keeps clear is a warning, and control for a
/// common stop alone a notice, once too. A conflict that comes and goes is one.
void Telemetry::report_braking(TimePoint now, const avoid::Guidance& g, Outbox& outbox) noexcept
{
    conflict_.last = g.conflict || g.alert != world::Alert::none || g.state == avoid::State::braking || g.for_stop
                         ? now
                         : conflict_.last;
    if (now - conflict_.last > kConflictOver) {
        conflict_.said_unsafe = conflict_.said_braking = conflict_.said_for_stop = false;
        conflict_.said_by = 0;
        conflict_.said_alert = world::Alert::none;
    }
    if (g.state == avoid::State::braking && g.wants_control) {
        if (g.margin < 0.0F && !conflict_.said_unsafe) {
            conflict_.said_unsafe = conflict_.said_braking = true;
            outbox.say(link::Severity::critical, "jink: nothing safe, braking");
        } else if (!conflict_.said_braking) {
            conflict_.said_braking = true;
            outbox.say(link::Severity::warning, "jink: no way around, braking");
        }
    }
    if (g.for_stop && !g.conflict && !conflict_.said_for_stop) {
        conflict_.said_for_stop = true;
        outbox.say(link::Severity::notice, "jink: slows for a neighbour, so that all can stop");
    }
}

void Telemetry::prepare_last_words(TimePoint last_step, const Reported& of) noexcept
{
    if (last_words_ == nullptr) {
        return;
    }
    const bool hold = of.control.takeover().may_ask_to_hold(last_step);
    const std::string_view text = of.is_passive ? ""  // said by then, and a row of faults would say it again and again
                                  : hold        ? "jink: processor fault, hold asked, restarting"
                                                : "jink: processor fault, restarting";
    last_words_->publish(link_.compose_last_words(last_words_->draft(), hold, text));
}

void Telemetry::report_to_bus(TimePoint now, const StepReport& report, const Reported& of, Outbox& outbox) noexcept
{
    if (bus_ == nullptr) {
        return;
    }
    const bool alone =
        report.own_source == OwnSource::bus && !of.autopilot.is_heard() && of.configuration.mode != ActMode::off;
    if (alone && !said_.alone) {
        outbox.say(link::Severity::warning, "jink: no autopilot heard, advising only");
    }
    said_.alone = alone;
    bus_->service(now, {report.state, alone, report.faults});
}

bool Telemetry::is_near_due(TimePoint now, const StepReport& report, const Reported& of) const noexcept
{
    return bus_ != nullptr && !of.is_passive && of.configuration.tell_near && of.own.is_yaw_known() &&
           report.own_source != OwnSource::none && !(now - last_near_ < kNearPeriod);
}

void Telemetry::report_near(TimePoint now, std::span<const world::Track> tracks, const Reported& of) noexcept
{
    last_near_ = now;
    const Configuration& c = of.configuration;
    for (const link::NearObject& object :
         find_near(of.own.at(now, c.own_age), tracks, of.picture.sensed(), c.rules.k_sigma)) {
        counts_.near_reported += bus_->send_near(object) ? 1U : 0U;
    }
}

void Telemetry::shut_down(TimePoint now, std::uint16_t faults, Outbox& outbox) noexcept
{
    link_.send_heartbeat(link::SystemState::critical);
    outbox.say(link::Severity::notice, "jink: stopped");
    if (bus_ != nullptr) {
        bus_->service(now, {link::SystemState::critical, false, faults});
    }
}

}  // namespace jink::app
