// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/coprocessor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/reach/lidar_scan.hpp"
#include "firmware/app/hold_choice.hpp"
#include "firmware/app/method_orders.hpp"
#include "firmware/app/wing_course.hpp"

namespace jink::app {
namespace {

/// Set-points that a PX4 only has to see: it wants 2 Hz or more [s].
constexpr Seconds kProvingPeriod = 0.2F;
/// A command further than this from the last one sent goes out at once [m/s].
constexpr float kNewCommand = 1.0F;
/// A step that comes this long after the last one means that we were not there when we should have been [s].
constexpr Seconds kStall = 0.5F;

/// With so much waiting for the line, nothing is asked that may be asked again [bytes].
constexpr std::size_t kBacklog = 1024;

/// What is said in these goes nowhere.
constexpr unsigned kDeadLine = bit(Fault::port_lost) | bit(Fault::autopilot_silent);

/// What a plan by reach sets takes more where they see by a scan, at most; that is for computers that have LiDARs.
constexpr auto kPictureUnits =
    static_cast<std::uint32_t>(units::kReachScanCell * (kMaxReachCells + reach::LidarScan::kCells));

}  // namespace

Coprocessor::Coprocessor(link::Link& link, hal::SerialPort& port, hal::Watchdog& watchdog, const Parameters& parameters,
                         link::SensorBus* bus) noexcept
    : link_(link), port_(port), watchdog_(watchdog), parameters_(parameters), bus_(bus),
      applied_generation_(parameters.generation()), planner_(parameters.configuration().planner),
      reach_(parameters.configuration().reach), orca_(parameters.configuration().orca),
      supervisor_(supervisor_settings(), planner_, reach_, orca_), tracks_(parameters.configuration().tracks),
      param_service_(parameters_, diagnostics_.params_set, diagnostics_.params_refused)
{
    link_.ask_for_rates(parameters.configuration().ask_rates);
    if (bus_ != nullptr) {
        bus_->serve(param_service_);
    }
}

avoid::Settings Coprocessor::supervisor_settings() const noexcept
{
    const Configuration& c = parameters_.configuration();
    avoid::Settings settings = c.supervisor;
    if (leaves_reach_out_ || c.reach_unsuited) {
        settings.order = without_sets(settings.order);
        settings.order_in_clutter = {};
    }
    if (reach_picture_ != nullptr) {
        // Laying a scan over a set would take most of what a plan may, and a way through clutter takes more than the
        // rest: each of two methods has nearly a whole plan's units, and the checks and fallbacks keep theirs.
        const std::uint32_t more = kPictureUnits + settings.plan_budget;
        settings.plan_budget += more;
        settings.kept_for_next = settings.plan_budget / 2;  // whichever of both is asked first
        settings.budget += more;
    }
    return settings;
}

void Coprocessor::leave_out_reach_sets() noexcept
{
    leaves_reach_out_ = true;
    static_cast<void>(supervisor_.configure(supervisor_settings()));
}

void Coprocessor::apply_configuration() noexcept
{
    if (applied_generation_ == parameters_.generation()) {
        return;
    }
    applied_generation_ = parameters_.generation();
    const Configuration& c = parameters_.configuration();
    // Parameters admit only what both accept (fits_together).
    link_.ask_for_rates(c.ask_rates);
    static_cast<void>(planner_.configure(c.planner));
    static_cast<void>(reach_.configure(c.reach));
    static_cast<void>(orca_.configure(c.orca));
    static_cast<void>(supervisor_.configure(supervisor_settings()));
    tracks_.configure(c.tracks);
}

std::size_t Coprocessor::restore_parameters(const ParamValues& values) noexcept
{
    const std::size_t refused = parameters_.set_each(values);
    apply_configuration();
    return refused;
}

bool Coprocessor::is_disarmed(TimePoint now) const noexcept
{
    constexpr Seconds kFresh = 1.5F;  // one and a half periods: who has armed since is still on the ground
    return has_autopilot_ && now - autopilot_.stamp <= kFresh && !autopilot_.armed && !takeover_.streaming();
}

void Coprocessor::read_port(TimePoint now, StepReport& report) noexcept
{
    const std::size_t n = port_.read(bytes_);
    report.bytes_in = static_cast<std::uint32_t>(n);
    link_.receive({bytes_.data(), n}, now, inbox_);
}

void Coprocessor::write_port(StepReport& report) noexcept
{
    const bool open = port_.health().state == hal::PortState::open;
    if (!open) {
        // What could not go out when it was true must not go out when it no longer is.
        link_.discard_pending();
        return;
    }
    for (int part = 0; part < 2 && !link_.pending().empty(); ++part) {
        const std::size_t n = port_.write(link_.pending());
        link_.consume(n);
        report.bytes_out += static_cast<std::uint32_t>(n);
        if (n == 0) {
            break;
        }
    }
}

vehicle::VehicleState Coprocessor::own_at(TimePoint now) const noexcept
{
    vehicle::VehicleState own = own_;
    own.position += own.velocity * std::clamp(now - own.stamp, 0.0F, parameters_.configuration().own_age);
    own.stamp = now;
    return own;
}

/// The mission's leg, while the autopilot flies the mission or we lead it. An external mode that is not ours leads
/// somewhere else.
const world::Leg* Coprocessor::flown_leg() const noexcept
{
    const bool led_by_others = autopilot_.mode == link::FlightMode::external && !takeover_.streaming();
    return has_leg_ && !led_by_others ? &leg_ : nullptr;
}

world::Airspace Coprocessor::airspace(TimePoint now) const noexcept
{
    const Configuration& c = parameters_.configuration();
    world::Airspace air;
    // Without an autopilot there is no home that bounds could refer to; the ground is what it is.
    const bool sees_ground = c.floor_on && has_ground_ && now <= ground_expires_;
    air.has_floor = c.floor_on && (has_autopilot_ || sees_ground);
    air.has_ceiling = c.ceiling_on && has_autopilot_;
    air.has_keep_in = c.keep_in_on && has_autopilot_;
    air.floor = home_.z() + c.floor;
    air.ceiling = home_.z() + c.ceiling;
    air.home = home_;
    air.keep_in_radius = c.keep_in;
    if (sees_ground) {
        const float ground = ground_ + std::max(c.floor, 0.0F);
        air.floor = has_autopilot_ ? std::max(air.floor, ground) : ground;
    }
    // They are placed in the autopilot's frame: in a bus's own frame there are none.
    air.barrels = has_autopilot_ ? constraints_.barrels() : std::span<const world::Barrel>();
    return air;
}

std::uint16_t Coprocessor::find_faults(TimePoint now, bool stalled) const noexcept
{
    const Configuration& c = parameters_.configuration();
    unsigned faults = passive_ ? bit(Fault::passive) : 0U;
    faults |= port_.health().state == hal::PortState::open ? 0U : bit(Fault::port_lost);
    faults |= bus_ != nullptr && bus_->is_lost() ? bit(Fault::bus_lost) : 0U;
    faults |= stalled ? bit(Fault::late) : 0U;
    if (!has_autopilot_) {
        faults |= bit(Fault::no_autopilot);
    } else if (now - autopilot_.stamp > c.heartbeat_age) {
        faults |= bit(Fault::autopilot_silent);
    }
    if (!has_autopilot_own_) {
        faults |= bit(Fault::own_state_missing);
    } else if (now - autopilot_own_ > c.own_age) {
        faults |= bit(Fault::own_state_stale);
    }
    faults |= has_autopilot_ && constraints_.lacks_origin() ? bit(Fault::airspace_unplaced) : 0U;
    return static_cast<std::uint16_t>(faults);
}

/// Of the stream that is due; 0: none.
Seconds Coprocessor::setpoint_period() const noexcept
{
    if (takeover_.streaming()) {
        return parameters_.configuration().setpoint_period;
    }
    return takeover_.proving() ? kProvingPeriod : 0.0F;
}

void Coprocessor::send_setpoint(TimePoint now, const vehicle::VehicleState& own, StepReport& report) noexcept
{
    const Seconds period = setpoint_period();
    // Until the autopilot follows us, the stream says what it does anyway.
    const bool leads = takeover_.in_control();
    const Vec3 wanted = leads ? report.guidance.velocity : own.velocity;
    const Vec3 velocity = autopilot_.fixed_wing ? wing_course(wanted, own.velocity, last_velocity_) : wanted;
    // What is decided anew does not wait for its turn: a tenth of a second is half a metre at cruise speed.
    const bool anew = leads && (velocity - last_velocity_).squaredNorm() > kNewCommand * kNewCommand;
    if (period <= 0.0F || (!anew && now - last_setpoint_ < period - 0.5F * kTick)) {
        return;
    }
    link_.send_velocity(velocity, now);
    last_setpoint_ = now;
    last_velocity_ = velocity;
    report.setpoint_sent = true;
    ++diagnostics_.setpoints;
}

/// A request that waits for the line grows old like a set-point: nobody may be asked for a mode that was wanted a while
/// ago, least of all when somebody else has chosen one.
void Coprocessor::ask_autopilot(const TakeoverOutput& output, TimePoint now) noexcept
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
void Coprocessor::drop_stale(TimePoint now) noexcept
{
    const Seconds period = setpoint_period();
    if (period <= 0.0F || now - last_setpoint_ >= period) {
        link_.drop_setpoint();
    }
}

/// The way is blocked: the hold mode is asked for in place of the former one. What it holds in is our own choice; any
/// mode after it is somebody else's, who may be guarded again.
void Coprocessor::note_block(const avoid::Guidance& guidance) noexcept
{
    if (guidance.blocked && !way_blocked_) {
        say(link::Severity::warning, "jink: way blocked, autopilot holds");
    }
    way_blocked_ = guidance.blocked || (way_blocked_ && !takeover_.in_control());
    const bool chosen = new_autopilot_report_ && autopilot_.mode != link::FlightMode::hold;
    if (way_blocked_ && takeover_.control() == Control::overruled && chosen) {
        takeover_.drop(false);
        way_blocked_ = false;
    }
}

/// Not in control: it is time to stop, and to stop is safer than to go on.
bool Coprocessor::is_hold_urgent(TimePoint now, const vehicle::VehicleState& own,
                                 const avoid::Guidance& guidance) noexcept
{
    const Configuration& c = parameters_.configuration();
    const Seconds stopping = vehicle::stopping_time(own.velocity.norm(), c.limits) + c.supervisor.reserve;
    if (!guidance.conflict || guidance.conflict->time_to_loss > stopping) {
        return false;
    }
    const auto tracks = tracks_.snapshot(now);
    const world::ThreatRef threat = guidance.conflict->threat;
    const bool is_track = threat.kind == world::ThreatKind::track && threat.index < tracks.size();
    return is_stopping_safer(own, c.limits, *guidance.conflict, is_track ? &tracks[threat.index] : nullptr);
}

/// A plane is steered as the plane that VEH_FIXED_WING describes, never as a vehicle that stops.
bool Coprocessor::can_steer() const noexcept
{
    const Configuration& c = parameters_.configuration();
    // A plane keeps its own speed: it cannot fly what reciprocal avoidance asks for.
    const bool as_wing = c.limits.kind == vehicle::VehicleKind::fixed_wing && !is_reactive(c.supervisor.order);
    return autopilot_.steerable && (!autopilot_.fixed_wing || as_wing);
}

TakeoverInput Coprocessor::takeover_input(TimePoint now, const vehicle::VehicleState& own,
                                          const StepReport& report) noexcept
{
    const Configuration& c = parameters_.configuration();
    TakeoverInput input;
    input.wants_control = report.guidance.wants_control;
    input.in_conflict = report.guidance.conflict.has_value();
    input.may_act = report.faults == 0 && c.mode == ActMode::act;
    input.urgent_hold = !takeover_.in_control() && is_hold_urgent(now, own, report.guidance);
    input.has_report = new_autopilot_report_;
    input.report_is_late = (report.faults & bit(Fault::late)) != 0;
    input.report = autopilot_;
    input.report.steerable = can_steer() && (!autopilot_.fixed_wing || link_.origin().has_value());
    input.earlier = {earlier_reports_.begin(), earlier_reports_.end()};
    input.mode_denied = mode_denied_;
    input.mode_accepted = mode_accepted_;
    input.keep_stream = c.standby_stream;
    input.link_alive = (report.faults & bit(Fault::port_lost)) == 0;
    input.sticks_moved = sticks_moved_;
    if (takeover_.control() == Control::ours) {
        input.unfollowed = follow_check_.update(last_velocity_, own_.velocity, c.limits, now);
    } else {
        follow_check_.reset();
    }
    return input;
}

void Coprocessor::control(TimePoint now, StepReport& report) noexcept
{
    const Configuration& c = parameters_.configuration();
    const bool fresh = has_own_ && now - own_.stamp <= c.own_age;
    report.own_source = fresh ? own_source_ : OwnSource::none;
    const vehicle::VehicleState own = own_at(now);
    if (fresh && c.mode != ActMode::off && !passive_) {
        const vehicle::VehicleLimits limits = vehicle::limits_in_flight(c.limits, own.velocity);
        nominal_.update(own_, own, flown_leg(), limits, takeover_.in_control());
        const world::Airspace air = airspace(now);
        const world::Situation situation{
            now, own, limits,  c.airframe, nominal_.primary(), tracks_.snapshot(now), obstacles_.obstacles(),
            air, {},  nullptr, c.k_sigma,  link_.own_track()};
        report.tracks = static_cast<std::uint16_t>(situation.tracks.size());
        report.uncertain_heights = static_cast<std::uint16_t>(std::count_if(
            situation.tracks.begin(), situation.tracks.end(), [](const auto& t) { return t.half_height > 0.0F; }));
        report.obstacles = static_cast<std::uint16_t>(situation.obstacles.size());
        report.barrels = static_cast<std::uint16_t>(air.barrels.size());
        report.guidance = supervisor_.update(situation, takeover_.in_control(), nominal_.other());
        nominal_.note(report.guidance.conflict.has_value(), report.guidance.on_other, report.guidance.other_conflict);
        report.work = report.guidance.work;
    }
    if (!is_finite(own.velocity) || !is_finite(report.guidance.velocity)) {
        diagnostics_.setpoints_withheld += setpoint_period() > 0.0F ? 1U : 0U;
        report.faults = static_cast<std::uint16_t>(report.faults | bit(Fault::not_finite));
    }
    const TakeoverInput input = takeover_input(now, own, report);
    note_block(report.guidance);
    const TakeoverOutput output = takeover_.update(input, now);
    ask_autopilot(output, now);
    if (output.event == TakeoverEvent::overruled) {
        supervisor_.reset();
    }
    // The hold that was asked for, and said, is no news.
    const bool as_asked =
        way_blocked_ && output.event == TakeoverEvent::overruled && autopilot_.mode == link::FlightMode::hold;
    announce(as_asked ? TakeoverEvent::none : output.event);
    loss_untold_ = loss_untold_ || (output.event == TakeoverEvent::lost && (report.faults & kDeadLine) != 0);
    send_setpoint(now, own, report);
    drop_stale(now);
    report.control = takeover_.control();
}

StepReport Coprocessor::step(TimePoint now) noexcept
{
    StepReport report;
    ++diagnostics_.steps;
    const Seconds gap = has_stepped_ ? now - last_step_ : 0.0F;
    report.deadline_missed = gap > 2.0F * kTick;
    diagnostics_.deadlines_missed += report.deadline_missed ? 1U : 0U;
    last_step_ = now;
    has_stepped_ = true;

    read_bus(now);
    const std::size_t bus_tracks = inbox_.tracks.size();
    read_port(now, report);
    follow_origin();
    settle_frame(bus_tracks);
    take_inbox(now);
    link_.service(now);
    constraints_.place(link_.origin(), now);
    report.faults = find_faults(now, gap > kStall);
    control(now, report);
    report.state = system_state(report);
    tell(now, report);
    prepare_last_words();
    tell_bus(now, report);
    write_port(report);
    if ((report.faults & (bit(Fault::not_finite) | bit(Fault::late))) == 0) {
        watchdog_.feed();
    }
    last_faults_ = report.faults;
    return report;
}

}  // namespace jink::app
