// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <optional>

#include "firmware/link/mavlink/geodesy.hpp"
#include "firmware/linux/c_interface/session.hpp"

namespace jink::c_interface {
namespace {

// The header's numbers are those of the enumerations.
static_assert(JINK_FAULT_MAP_UNRESOLVED == app::bit(app::Fault::map_unresolved));
static_assert(JINK_EMERGENCY == static_cast<int>(link::SystemState::emergency));
static_assert(JINK_BRAKING == static_cast<int>(avoid::State::braking));
static_assert(JINK_CONTROL_OVERRULED == static_cast<int>(app::Control::overruled));
static_assert(JINK_OWN_BUS == static_cast<int>(app::OwnSource::bus));
static_assert(JINK_STACK_PX4 == static_cast<int>(link::AutopilotStack::px4));
static_assert(JINK_MODE_OTHER == static_cast<int>(link::FlightMode::other));
static_assert(JINK_PLAN_RUNNING == static_cast<int>(world::PlanStatus::running));
static_assert(JINK_HOLD_TURN == static_cast<int>(world::ManoeuvreKind::hold_turn));
static_assert(JINK_THREAT_CLOSED_AREA == static_cast<int>(world::ThreatKind::cylinder));
static_assert(JINK_SOURCE_UTM == static_cast<int>(world::TrackSource::utm));

void put(const Vec3& v, float (&into)[3]) noexcept { std::copy_n(v.data(), 3, into); }

std::uint32_t flag(bool is_set, std::uint32_t bit) noexcept { return is_set ? bit : 0U; }

void put(const link::AutopilotReport& autopilot, jink_status& status) noexcept
{
    status.flags |= JINK_FLAG_AUTOPILOT_HEARD | flag(autopilot.armed, JINK_FLAG_ARMED) |
                    flag(autopilot.landed, JINK_FLAG_LANDED) | flag(autopilot.fixed_wing, JINK_FLAG_FIXED_WING) |
                    flag(autopilot.steerable, JINK_FLAG_STEERABLE);
    status.stack = static_cast<std::int32_t>(autopilot.stack);
    status.flight_mode = static_cast<std::int32_t>(autopilot.mode);
    status.custom_mode = autopilot.custom_mode;
}

void put(const app::Coprocessor& coprocessor, TimePoint now, jink_status& status) noexcept
{
    status.flags |= JINK_FLAG_OWN_STATE;
    const vehicle::VehicleState& own = coprocessor.own();
    put(own.position + own.velocity * (now - own.stamp), status.position);
    put(own.velocity, status.velocity);
    status.yaw = own.yaw;
    const app::NominalPaths& paths = coprocessor.nominal_paths();
    const world::Reference& nominal = paths.primary();
    const path::RouteView route = nominal.route();
    status.flags |= flag(paths.is_intended(), JINK_FLAG_NOMINAL_IS_LEG);
    put(route.at(route.length()).position, status.nominal_end);
    status.nominal_speed = nominal.speed;
}

void put(const avoid::Guidance& guidance, jink_status& status) noexcept
{
    status.state = static_cast<std::int32_t>(guidance.state);
    status.margin = guidance.margin;
    status.plan = static_cast<std::int32_t>(guidance.plan_status);
    status.manoeuvre = static_cast<std::int32_t>(guidance.kind);
    status.method = guidance.by;
    if (guidance.wants_control) {
        status.flags |= JINK_FLAG_WANTS_CONTROL;
        put(guidance.velocity, status.command);
    }
    if (guidance.conflict) {
        const world::Conflict& conflict = *guidance.conflict;
        status.flags |= JINK_FLAG_CONFLICT;
        status.threat = static_cast<std::int32_t>(conflict.threat.kind);
        status.time_to_loss = conflict.time_to_loss;
        status.time_to_closest = conflict.time_to_closest;
        status.conflict_margin = conflict.margin;
        status.miss_distance = conflict.miss_distance;
        put(conflict.own_at_closest, status.own_at_closest);
        put(conflict.threat_at_closest, status.threat_at_closest);
    }
}

}  // namespace

void Session::write(jink_status& status) const noexcept
{
    status = {};
    status.size = sizeof status;
    status.time_us = last_step_ ? last_step_->us : -1;
    status.system_state = static_cast<std::int32_t>(report_.state);
    status.flags = flag(reach_damaged_, JINK_FLAG_REACH_SETS_DAMAGED) |
                   flag(report_.setpoint_sent, JINK_FLAG_SETPOINT_SENT) | flag(report_.deadline_missed, JINK_FLAG_LATE);
    status.faults = report_.faults;
    status.control = static_cast<std::int32_t>(report_.control);
    status.own_source = static_cast<std::int32_t>(report_.own_source);
    status.system_id = endpoint_.system_id();
    if (const link::AutopilotReport* const autopilot = coprocessor_->autopilot()) {
        put(*autopilot, status);
    }
    const auto origin = endpoint_.origin();
    if (const auto home =
            origin && endpoint_.has_home() ? link::mavlink::to_global(coprocessor_->home(), *origin) : std::nullopt) {
        status.flags |= JINK_FLAG_HOME;
        put(coprocessor_->home(), status.home);
        status.home_lat = home->lat;
        status.home_lon = home->lon;
        status.home_alt = home->alt;
    }
    if (last_step_ && report_.own_source != app::OwnSource::none) {
        put(*coprocessor_, *last_step_, status);
    }
    put(report_.guidance, status);
    status.tracks = report_.tracks;
    status.obstacles = report_.obstacles;
    status.closed_areas = report_.cylinders;
    status.work = report_.work;
    status.bytes_in = report_.bytes_in;
    status.bytes_out = report_.bytes_out;
}

void Session::write(jink_counters& counters) const noexcept
{
    const app::Diagnostics& d = coprocessor_->diagnostics();
    const link::LinkDiagnostics& l = endpoint_.diagnostics();
    const world::TrackDiagnostics& t = coprocessor_->track_diagnostics();
    const avoid::Diagnostics& s = coprocessor_->supervisor_diagnostics();
    const app::TakeoverDiagnostics& c = coprocessor_->takeover_diagnostics();
    const app::ConstraintDiagnostics& a = coprocessor_->constraint_diagnostics();
    const hal::PortHealth line = line_.health();
    counters = {
        .size = sizeof counters,
        .steps = d.steps,
        .steps_late = d.deadlines_missed,
        .setpoints = d.setpoints,
        .setpoints_withheld = d.setpoints_withheld,
        .frames_in = l.frames_in,
        .frames_out = l.frames_out,
        .frames_refused = l.frames_refused,
        .reports_refused = l.not_finite + l.out_of_range + l.stale_stamp + l.no_origin,
        .inbox_full = l.inbox_full,
        .outbox_full = l.outbox_full,
        .own_states = d.own_states,
        .own_states_refused = d.own_state_refused,
        .autopilot_reboots = d.autopilot_reboots,
        .tracks_created = t.created,
        .tracks_replaced = t.replaced,
        .tracks_expired = t.expired,
        .track_reports_refused = t.not_finite + t.out_of_range + t.stale + t.future + t.full,
        .conflicts = s.conflicts,
        .plans = s.plans,
        .plans_found = s.plans_found,
        .answers_rejected = s.answers_rejected,
        .manoeuvres = s.manoeuvres,
        .brakes = s.brakes,
        .escapes = s.escapes,
        .blocked = s.blocked,
        .take_overs = c.taken,
        .given_back = c.given_back,
        .refused = c.refused,
        .overruled = c.overruled,
        .lost_by_fault = c.lost_by_fault,
        .parameters_set = d.params_set,
        .parameters_refused = d.params_refused,
        .closed_areas_refused = a.refused,
        .closed_areas_merged = a.merged,
        .caller_reports = link_.reported(),
        .caller_reports_refused = link_.refused(),
        .autopilot_bytes_in = line.bytes_in,
        .autopilot_bytes_out = line.bytes_out,
        .cloud_bytes_in = clouds_.bytes_in(),
    };
}

}  // namespace jink::c_interface
