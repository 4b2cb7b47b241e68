// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/coprocessor.hpp"

#include <algorithm>

#include "firmware/app/reach_picture.hpp"

namespace jink::app {
namespace {

/// A step that comes this long after the last one means that we were not there when we should have been [s].
constexpr Seconds kStall = 0.5F;

}  // namespace

Coprocessor::Coprocessor(link::Link& link, hal::SerialPort& port, hal::Watchdog& watchdog, const Parameters& parameters,
                         link::SensorBus* bus) noexcept
    : link_(link), watchdog_(watchdog), params_(parameters, diagnostics_), outbox_(link, port, bus),
      intake_(link, port, bus, diagnostics_), autopilot_(diagnostics_), own_(diagnostics_),
      picture_(parameters.configuration().tracks, diagnostics_), decision_(parameters.configuration()),
      control_(link, diagnostics_), telemetry_(link, bus, diagnostics_)
{
    link_.ask_for_rates(parameters.configuration().ask_rates);
    if (bus != nullptr) {
        bus->serve(params_.service());
    }
}

void Coprocessor::let_reach_sets_see(ReachPicture& picture) noexcept
{
    picture_.show_scans_in(picture);
    decision_.let_reach_sets_see(picture, params_.configuration());
}

void Coprocessor::apply_configuration() noexcept
{
    if (!params_.take_change()) {
        return;
    }
    const Configuration& c = params_.configuration();
    link_.ask_for_rates(c.ask_rates);
    decision_.configure(c);
    picture_.configure(c.tracks);
}

std::size_t Coprocessor::restore_parameters(const ParamValues& values) noexcept
{
    const std::size_t refused = params_.restore(values);
    apply_configuration();
    return refused;
}

bool Coprocessor::is_disarmed(TimePoint now) const noexcept
{
    constexpr Seconds kFresh = 1.5F;  // one and a half periods: who has armed since is still on the ground
    const link::AutopilotReport& autopilot = autopilot_.report();
    return autopilot_.is_heard() && now - autopilot.stamp <= kFresh && !autopilot.armed &&
           !control_.takeover().streaming();
}

/// Forgets what no longer holds.
void Coprocessor::heed(Jump jump) noexcept
{
    if (jump == Jump::none) {
        return;
    }
    decision_.reset();
    if (jump == Jump::estimate) {
        picture_.forget_measured();
    } else if (jump == Jump::frame) {
        picture_.forget_places();
    }
}

void Coprocessor::take_inbox(TimePoint now) noexcept
{
    const link::Inbox& inbox = intake_.inbox();
    if (StepLog* const log = outbox_.log(); log != nullptr) {
        log->begin(now, inbox.log_acks);
    }
    const Configuration& c = params_.configuration();
    if (autopilot_.take(inbox)) {
        control_.note_restart(outbox_);
        heed(Jump::frame);
        own_.forget();
        picture_.forget_home();
    }
    if (inbox.has_own_state) {
        heed(own_.take_autopilot(inbox.own_state, now));
    }
    if (inbox.has_bus_state) {
        heed(own_.take_bus(inbox.bus_state, c.own_age, c.rules.k_sigma, now, outbox_));
    }
    picture_.take_home(inbox);
    control_.watch_sticks(inbox.has_sticks ? &inbox.sticks : nullptr, c.sticks);
    picture_.take_tracks(inbox, own_, c, now);
    picture_.take_ranges(inbox, own_, c, now);
    picture_.take_clouds(own_, autopilot_.is_heard(), c, now);
    params_.take(inbox.params, link_, outbox_);
    if (inbox.has_limits) {
        params_.believe(inbox.limits, outbox_);
    }
    apply_configuration();
    params_.continue_list(link_);
    telemetry_.take_commands(inbox.commands, outbox_.log(), params_.parameters());
    picture_.take_constraints(inbox, own_, link_, now);
    intake_.clear();
}

std::uint16_t Coprocessor::find_faults(TimePoint now, bool stalled) const noexcept
{
    const Configuration& c = params_.configuration();
    unsigned faults = passive_ ? bit(Fault::passive) : 0U;
    faults |= intake_.is_port_open() ? 0U : bit(Fault::port_lost);
    faults |= intake_.is_bus_lost() ? bit(Fault::bus_lost) : 0U;
    faults |= stalled ? bit(Fault::late) : 0U;
    const bool heard = autopilot_.is_heard();
    if (!heard) {
        faults |= bit(Fault::no_autopilot);
    } else if (now - autopilot_.report().stamp > c.heartbeat_age) {
        faults |= bit(Fault::autopilot_silent);
    }
    const std::optional<TimePoint>& stamp = own_.autopilot_stamp();
    if (!stamp) {
        faults |= bit(Fault::own_state_missing);
    } else if (now - *stamp > c.own_age) {
        faults |= bit(Fault::own_state_stale);
    }
    const bool unplaced = picture_.constraints().lacks_origin() || picture_.known_map().lacks_place();
    faults |= heard && unplaced ? bit(Fault::airspace_unplaced) : 0U;
    faults |= picture_.known_map().is_unresolved() ? bit(Fault::map_unresolved) : 0U;
    return static_cast<std::uint16_t>(faults);
}

/// Its id; 0: a conflict with none.
static std::uint32_t track_of(const std::optional<world::Conflict>& conflict,
                              std::span<const world::Track> tracks) noexcept
{
    const bool is_one =
        conflict && conflict->threat.kind == world::ThreatKind::track && conflict->threat.index < tracks.size();
    return is_one ? tracks[conflict->threat.index].id : 0;
}

avoid::Guidance Coprocessor::decide(TimePoint now, const vehicle::VehicleState& own,
                                    std::span<const world::Track> tracks, StepReport& report) noexcept
{
    const Configuration& c = params_.configuration();
    const Takeover& takeover = control_.takeover();
    const world::Airspace air = picture_.airspace(autopilot_.is_heard(), c, now);
    report.tracks = static_cast<std::uint16_t>(tracks.size());
    report.uncertain_heights = static_cast<std::uint16_t>(
        std::count_if(tracks.begin(), tracks.end(), [](const auto& t) { return t.half_height > 0.0F; }));
    report.obstacles = static_cast<std::uint16_t>(picture_.obstacles().size());
    report.map_pieces = static_cast<std::uint16_t>(picture_.obstacles().size() - picture_.sensed().size());
    report.cylinders = static_cast<std::uint16_t>(air.cylinders.size());
    return decision_.update({now,
                             own_.measured(),
                             own,
                             autopilot_.flown_leg(takeover.streaming()),
                             takeover.follows(),
                             {tracks, picture_.obstacles(), air},
                             link_.own_track()},
                            c);
}

std::span<const world::Track> Coprocessor::decide_and_control(TimePoint now, StepReport& report) noexcept
{
    const Configuration& c = params_.configuration();
    const bool fresh = own_.is_fresh(now, c.own_age);
    report.own_source = fresh ? own_.source() : OwnSource::none;
    const vehicle::VehicleState own = own_.at(now, c.own_age);
    std::span<const world::Track> tracks;
    if (fresh && c.mode != ActMode::off && !passive_) {
        tracks = picture_.tracks(now);
        report.guidance = decide(now, own, tracks, report);
        report.work = report.guidance.work;
        report.conflict_track = track_of(report.guidance.conflict, tracks);
    }
    const TakeoverEvent event =
        control_.update({now, own, own_.measured().velocity, tracks, autopilot_}, c, report, outbox_);
    if (event == TakeoverEvent::overruled) {
        decision_.reset_supervisor();
    }
    const Progress background = decision_.advance_background(report.work, c);
    diagnostics_.tables_checked += background == Progress::done ? 1U : 0U;
    telemetry_.note(event, report);
    return tracks;
}

void Coprocessor::report_state(TimePoint now, std::span<const world::Track> tracks, StepReport& report) noexcept
{
    StepLog* const log = outbox_.log();
    const bool is_line_free = log != nullptr && intake_.is_port_open() && outbox_.is_line_empty();
    const Reported of{params_.configuration(), autopilot_, own_, picture_, decision_, control_, passive_,
                      intake_.was_bus_up()};
    report.state = Telemetry::system_state(report, of);
    telemetry_.report_to_autopilot(now, report, of, outbox_);
    if (log != nullptr) {
        report.bytes_out = outbox_.last_written();
        log->end({now, report, own_.measured(), tracks, params_.parameters(), diagnostics_, decision_.diagnostics(),
                  last_plan(), last_duration_us_, is_line_free},
                 link_);
    }
    telemetry_.prepare_last_words(now, of);
    telemetry_.report_to_bus(now, report, of, outbox_);
    if (telemetry_.is_near_due(now, report, of)) {
        telemetry_.report_near(now, picture_.tracks(now), of);
    }
}

StepReport Coprocessor::step(TimePoint now) noexcept
{
    StepReport report;
    ++diagnostics_.steps;
    const Seconds gap = last_step_ ? now - *last_step_ : 0.0F;
    report.deadline_missed = gap > 2.0F * kTick;
    diagnostics_.deadlines_missed += report.deadline_missed ? 1U : 0U;
    last_step_ = now;

    report.bytes_in = intake_.read(now);
    picture_.follow_origin(link_.origin());
    const FrameChange change = intake_.settle_frame(autopilot_.is_heard());
    if (change != FrameChange::none) {
        own_.forget_bus();
        heed(change == FrameChange::begun ? Jump::frame : Jump::none);
    }
    take_inbox(now);
    link_.service(now);
    picture_.place_constraints(link_.origin(), now);
    picture_.place_map(link_.origin(), own_, autopilot_.is_heard(), params_.configuration(), now);
    report.faults = find_faults(now, gap > kStall);
    const std::span<const world::Track> tracks = decide_and_control(now, report);
    report_state(now, tracks, report);
    report.bytes_out = outbox_.write();
    if ((report.faults & (bit(Fault::not_finite) | bit(Fault::late))) == 0) {
        watchdog_.feed();
    }
    last_faults_ = report.faults;
    return report;
}

void Coprocessor::shut_down(TimePoint now) noexcept
{
    control_.shut_down(now);
    telemetry_.shut_down(now, last_faults_, outbox_);
    static_cast<void>(outbox_.write());
}

}  // namespace jink::app
