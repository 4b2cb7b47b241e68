// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/parameters.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/method_orders.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"

namespace jink::app {
namespace {

/// ArduPlane goes on straight from where it gets its mission back: nothing is gained by coming nearer to the leg [m].
constexpr float kWingOnLeg = 10.0F;

constexpr std::array<ParamInfo, kParamCount> kTable{{
    {"JNK_MODE", 2, 0, 2, true, "0 off, 1 advise only, 2 take over and avoid"},
    {"JNK_LOOKAHEAD", 8, 1, 60, false, "conflicts are looked for this far ahead [s]"},
    {"JNK_HALF_XY", 1, 0.1F, 20, false, "half extent of the own safety box, level [m]"},
    {"JNK_HALF_Z", 1, 0.1F, 20, false, "half extent of the own safety box, vertical [m]"},
    {"JNK_K_SIGMA", 3, 0, 6, false, "standard deviations that count as possible"},
    {"JNK_BOUNDS", 1, 0, 7, true, "sum of: 1 floor, 2 ceiling, 4 keep-in distance"},
    {"JNK_FLOOR", 2, -500, 5000, false, "floor above home [m]"},
    {"JNK_CEILING", 120, -500, 5000, false, "ceiling above home [m]"},
    {"JNK_KEEP_IN", 500, 10, 50000, false, "keep-in distance from home, level [m]"},
    {"JNK_RESERVE", 0.75F, 0, 5, false, "nothing is forced before the stopping time plus this [s]"},
    {"JNK_SETTLE", 1, 0, 10, false, "the way must be clear this long before it is trusted [s]"},
    {"JNK_RATE", 20, 10, 50, true, "set-points per second while avoiding"},
    {"TRK_RADIUS", 1, 0.05F, 500, false, "radius of traffic [m]"},
    {"TRK_RADIUS_PT", 1, 0.05F, 500, false, "radius of traffic that is an obstacle at rest [m]"},
    {"TRK_SIGMA_P", 1.5F, 0.01F, 500, false, "position noise of traffic, one standard deviation [m]"},
    {"TRK_SIGMA_V", 0.3F, 0.01F, 100, false, "velocity noise of traffic, one standard deviation [m/s]"},
    {"TRK_ACCEL", 0, 0, 50, false, "acceleration that traffic may show unannounced [m/s2]"},
    {"TRK_LATENCY", 0.1F, 0, 2, false, "age of a traffic report on arrival [s]"},
    {"TRK_AGE", 3, 1, 60, false, "traffic not heard for longer is dropped, cooperative after 10 s at least [s]"},
    {"OBS_HEIGHT", 10, 0.5F, 500, false, "half height given to what a level scan sees [m]"},
    {"OBS_LATENCY", 0.1F, 0, 1, false, "age of a range reading or scan on arrival [s]"},
    {"OBS_KEEP", 1, 0.1F, 60, false, "what a scan saw is kept this long [s]"},
    {"OWN_AGE", 0.5F, 0.05F, 2, false, "own state older than this is a fault [s]"},
    {"HB_AGE", 4.5F, 1.5F, 20, false, "autopilot heartbeat older than this is a fault [s]"},
    {"VEH_CRUISE", 5, 0.5F, 100, false, "cruise speed [m/s]"},
    {"VEH_CLIMB", 3, 0.1F, 50, false, "greatest rate of climb [m/s]"},
    {"VEH_DESCENT", 3, 0.1F, 50, false, "greatest rate of descent [m/s]"},
    {"VEH_ACC", 5, 0.2F, 50, false, "greatest level acceleration, and deceleration when braking [m/s2]"},
    {"VEH_ACC_Z", 3, 0.2F, 50, false, "greatest vertical acceleration [m/s2]"},
    {"VEH_LAG", 0.25F, 0, 2, false, "time constant of the velocity loop [s]"},
    {"VEH_FIXED_WING", 0, 0, 1, true, "1: cannot stop, holds by turning"},
    {"VEH_MASS", 3, 0.05F, 5000, false, "mass [kg]"},
    {"VEH_DRAG", 0.5F, 0.01F, 5, false, "drag coefficient"},
    {"VEH_AREA", 2.5F, 0.001F, 500, false, "effective area [m2]"},
    {"GEO_OFFSETS", kInitialOffsets, 2, 64, true, "candidates per plane and family, even"},
    {"GEO_PLANES", kInitialPlanes, 0, 31, true, "planes beyond the first"},
    {"GEO_FAMILIES", 3, 1, 31, true, "sum of: 1 simple, 2 symmetric, 4 smooth, 8 plateau, 16 wait"},
    {"GEO_WAYPOINTS", 25, 8, static_cast<float>(kMaxPathPoints - 1), true, "points per candidate"},
    {"GEO_SWEPT", 0, 0, 1, true, "0 time-aware security, 1 swept as the source"},
    {"GEO_K_S", 0.3F, 0, 0.9F, false, "weight of smoothness; closeness gets what is left of 1"},
    {"GEO_K_T", 0.2F, 0.1F, 1, false, "weight of time"},
    {"GEO_K_A", 0, 0, 0.9F, false, "weight of the angle: passing in front of traffic instead of behind it"},
    {"GEO_K_B", 0, 0, 0.9F, false, "weight of the time beyond the collision point"},
    {"GEO_K_P", 1, 0, 10, false, "penalty on planes that are not level"},
    {"GEO_FLIP", 0.15F, 0, 1, false, "penalty on changing sides"},
    {"GEO_NEAREST", 0, 0, static_cast<float>(kMaxTracks), true,
     "candidates look at so many moving tracks first; 0: all"},
    {"GEO_MAX_COST", 1, 0.01F, 1, false, "a plan that costs more counts as not found"},
    {"GEO_T_LOW", 1.2530F, 0, 1000, false, "flight time that costs 0 [s]"},
    {"GEO_T_HIGH", 7.0814F, 0.01F, 1000, false, "flight time that costs 1 (before the source's factor 1.15) [s]"},
    {"GEO_LATENCY", 0.1F, 0, 1, false, "from planning until the vehicle answers: plan, link and autopilot [s]"},
    {"JNK_STANDBY", 1, 0, 1, true, "1: on a mission, what a take-over needs is kept ready: HEARTBEATs, PX4's stream"},
    {"JNK_ASK_RATES", 1, 0, 1, true, "1: ask the autopilot for messages that come too seldom, and for its limits"},
    {"JNK_TELL_NEAR", 0, 0, 1, true, "1: tell the CAN bus what is near (Proximity)"},
    {"JNK_METHODS", kBuiltMethods, 1, kAllMethods, true,
     "methods that are asked, sum of: 1 geometric, 2 reach sets, 4 reciprocal; the best answer of all is flown"},
    {"RCH_UNSEEN", 1, 0, 1, true, "1: reach sets do not go where a point cloud does not see"},
    {"JNK_COOP", 7, 0, 15, true,
     "who shares the reaction, sum of: 1 systems of the link, 2 UTM, 4 UAVs of ADS-B, 8 all of it"},
    {"JNK_OWN_ICAO", 0, 0, 16777215, true, "own transponder's address: heard back, it is no traffic; 0 not known"},
    {"JNK_PATIENCE", 20, 0, 600, false, "blocked by what stands for so long: hand over to the hold mode [s]; 0 never"},
    {"JNK_STICKS", 30, 0, 100, false, "sticks moved by so much end a take-over [% of half their travel]; 0 never"},
    {"TRK_SIG_BARO", 30, 0, 300, false, "noise of a traffic's pressure altitude, one standard deviation [m]"},
    {"TRK_SIG_BARO_D", 5, 0, 300, false, "the same of its difference to the own pressure altitude [m]"},
    {"JNK_WELL_CLEAR", 0, 0, 5000, false,
     "kept clear of manned aircraft, level [m]; ASTM F3442: 610; 0 as other traffic"},
    {"JNK_WELL_HEIGHT", 76, 1, 1000, false, "the same above and below [m]; ASTM F3442: 76"},
}};

void bound(vehicle::VehicleLimits& limits, const link::ReportedLimits& reported) noexcept
{
    const auto lower = [](float& limit, float by) { limit = by > 0.0F ? std::min(limit, by) : limit; };
    lower(limits.max_acceleration, reported.acceleration);
    lower(limits.max_vertical_acceleration, reported.vertical_acceleration);
    lower(limits.max_climb, reported.climb);
    lower(limits.max_descent, reported.descent);
    limits.velocity_lag = std::max(limits.velocity_lag, reported.lag);
}

[[gnu::cold]] Configuration build(const std::array<float, kParamCount>& v,
                                  [[maybe_unused]] const reach::VehicleSets* sets,
                                  const link::ReportedLimits& reported) noexcept
{
    const auto at = [&](Param p) { return v[static_cast<std::size_t>(p)]; };
    const auto whole = [&](Param p) { return static_cast<std::uint32_t>(at(p)); };
    Configuration c;
    c.mode = static_cast<ActMode>(whole(Param::mode));
    c.rules.lookahead = at(Param::lookahead);
    c.supervisor.reserve = at(Param::reserve);
    c.supervisor.settle = at(Param::settle);
    c.supervisor.patience = at(Param::patience);
    const bool wing = whole(Param::fixed_wing) == 1;
    c.supervisor.on_leg = wing ? kWingOnLeg : c.supervisor.on_leg;
    c.limits.half_extents = Vec3(at(Param::half_xy), at(Param::half_xy), at(Param::half_z));
    c.limits.kind = wing ? vehicle::VehicleKind::fixed_wing : vehicle::VehicleKind::multirotor;
    c.limits.cruise_speed = at(Param::cruise);
    c.limits.max_climb = at(Param::climb);
    c.limits.max_descent = at(Param::descent);
    c.limits.max_acceleration = at(Param::acceleration);
    c.limits.max_vertical_acceleration = at(Param::vertical_acceleration);
    c.limits.velocity_lag = at(Param::lag);
    c.rules.fellow_acceleration = at(Param::acceleration);
    c.airframe.mass = at(Param::mass);
    c.airframe.drag_coefficient = at(Param::drag);
    c.airframe.effective_area = at(Param::area);
    c.rules.latency = at(Param::latency);
    c.rules.k_sigma = at(Param::k_sigma);
    c.rules.well_clear = {at(Param::well_clear), at(Param::well_clear_height)};
    c.floor_on = (whole(Param::bounds) & 1U) != 0;
    c.ceiling_on = (whole(Param::bounds) & 2U) != 0;
    c.keep_in_on = (whole(Param::bounds) & 4U) != 0;
    c.floor = at(Param::floor);
    c.ceiling = at(Param::ceiling);
    c.keep_in = at(Param::keep_in);
    c.track_radius = at(Param::track_radius);
    c.point_radius = at(Param::point_radius);
    c.track_sigma_position = at(Param::track_sigma_p);
    c.track_sigma_velocity = at(Param::track_sigma_v);
    c.track_acceleration = at(Param::track_acceleration);
    c.track_latency = at(Param::track_latency);
    c.tracks.max_age = at(Param::track_age);
    c.coop_systems = (whole(Param::coop) & 1U) != 0;
    c.coop_utm = (whole(Param::coop) & 2U) != 0;
    c.coop_unmanned = (whole(Param::coop) & 4U) != 0;
    c.coop_all = (whole(Param::coop) & 8U) != 0;
    c.own_address = whole(Param::own_address);
    c.sigma_baro = at(Param::sigma_baro);
    c.sigma_compared = at(Param::sigma_compared);
    c.scan_height = at(Param::scan_height);
    c.scan_latency = at(Param::scan_latency);
    c.scan_keep = at(Param::scan_keep);
    c.own_age = at(Param::own_age);
    c.heartbeat_age = at(Param::heartbeat_age);
    c.setpoint_period = 1.0F / at(Param::rate);
    c.stands_by = whole(Param::standby) == 1;
    c.ask_rates = whole(Param::ask_rates) == 1;
    c.tell_near = whole(Param::tell_near) == 1;
    c.sticks = 0.01F * at(Param::sticks);
    geometric::Settings& g = c.planner;
    // What the vehicle cannot fly shows in the predicted flight, which every answer has to pass.
    g.check_acceleration = false;
    g.offsets = static_cast<std::uint16_t>(whole(Param::offsets));
    g.extra_planes = static_cast<std::uint16_t>(whole(Param::planes));
    g.simple = (whole(Param::families) & 1U) != 0;
    g.symmetric = (whole(Param::families) & 2U) != 0;
    g.smooth = (whole(Param::families) & 4U) != 0;
    g.plateau = (whole(Param::families) & 8U) != 0;
    g.wait = (whole(Param::families) & 16U) != 0;
    g.waypoints = static_cast<std::uint16_t>(whole(Param::waypoints));
    g.security = whole(Param::swept) == 1 ? geometric::SecurityMode::swept : geometric::SecurityMode::time_aware;
    g.weights.smoothness = at(Param::weight_smoothness);
    g.weights.time = at(Param::weight_time);
    g.weights.passing = at(Param::weight_passing);
    g.weights.beyond = at(Param::weight_beyond);
    g.weights.closeness = 1.0F - g.weights.smoothness - g.weights.time - g.weights.passing - g.weights.beyond;
    if constexpr (kHasGeometric) {
        g.tables = &cost::tables::kDefault;  // smoothness, which is read there, is the same for every vehicle
    }
    g.rotation_penalty = at(Param::rotation_penalty);
    g.flip_penalty = at(Param::flip_penalty);
    g.moving_nearest = static_cast<std::uint16_t>(whole(Param::nearest));
    g.max_cost = at(Param::max_cost);
    c.supervisor.order = methods_of(whole(Param::methods));
    if (c.limits.kind == vehicle::VehicleKind::fixed_wing) {
        c.supervisor.order = for_wings(c.supervisor.order);
    }
    if constexpr (kHasReach) {
        c.reach.sets = sets;
        // Sets of more nodes or cells than the capacities are not flown.
        c.reach_unsuited = !reach::is_valid(c.reach) || !reach::suits(*sets, c.limits);
    }
    // After the sets: a path of theirs that asks for more than the autopilot flies is refused by its predicted flight.
    if (c.ask_rates) {
        bound(c.limits, reported);
    }
    c.blocks_unseen = whole(Param::unseen) == 1;
    c.orca.gives_up_blocked = c.supervisor.order != avoid::MethodOrder(kOrca);
    g.caps.time_low = at(Param::time_low);
    g.caps.time_high = at(Param::time_high);
    return c;
}

/// Between two reports of ADS-B [s]: traffic that is dropped sooner after a report has arrived is out of sight between
/// reports, or always.
constexpr Seconds kReportPeriod = 1.0F;

bool fits_together(const Configuration& c) noexcept
{
    const bool sees_traffic = c.tracks.max_age >= c.track_latency + kReportPeriod;
    const bool bounds = !(c.floor_on && c.ceiling_on) || c.ceiling - c.floor >= 4.0F * c.limits.half_extents.z();
    return bounds && sees_traffic && c.planner.caps.time_high * 1.15F > c.planner.caps.time_low &&
           world::is_valid(c.rules) && avoid::is_valid(c.supervisor) && vehicle::is_valid(c.limits) &&
           vehicle::is_valid(c.airframe) && geometric::is_valid(c.planner);
}

ParamStatus check_one(std::size_t index, float value) noexcept
{
    const ParamInfo& info = kTable[index];
    if (!std::isfinite(value)) {
        return ParamStatus::not_finite;
    }
    if (!(value >= info.low && value <= info.high) || (info.integer && value != std::floor(value))) {
        return ParamStatus::out_of_range;
    }
    if (index == static_cast<std::size_t>(Param::methods) && !is_built(static_cast<unsigned>(value))) {
        return ParamStatus::not_built;
    }
    return ParamStatus::ok;
}

}  // namespace

const std::array<ParamInfo, kParamCount>& param_table() noexcept { return kTable; }

Parameters::Parameters() noexcept : values_{}
{
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values_[i] = kTable[i].initial;
    }
    if constexpr (kHasReach) {
        sets_ = &reach_sets();
    }
    configuration_ = build(values_, sets_, reported_);
}

void Parameters::use(const reach::VehicleSets& sets) noexcept
{
    sets_ = &sets;
    configuration_ = build(values_, sets_, reported_);
    ++generation_;
}

void Parameters::believe(const link::ReportedLimits& reported) noexcept
{
    reported_ = reported;
    configuration_ = build(values_, sets_, reported_);
}

ParamStatus Parameters::set_all(const std::array<float, kParamCount>& values) noexcept
{
    for (std::size_t i = 0; i < kParamCount; ++i) {
        const ParamStatus status = check_one(i, values[i]);
        if (status != ParamStatus::ok) {
            return status;
        }
    }
    const Configuration candidate = build(values, sets_, reported_);
    if (!fits_together(candidate)) {
        return ParamStatus::inconsistent;
    }
    values_ = values;
    configuration_ = candidate;
    ++generation_;
    return ParamStatus::ok;
}

std::size_t Parameters::set_each(const ParamValues& values) noexcept
{
    std::size_t refused = set_all(values) == ParamStatus::ok ? 0 : kParamCount;
    for (int pass = 0; pass < 2 && refused > 0; ++pass) {
        refused = 0;
        for (std::size_t i = 0; i < kParamCount; ++i) {
            refused += set(static_cast<Param>(i), values[i]) == ParamStatus::ok ? 0U : 1U;
        }
    }
    return refused;
}

ParamStatus Parameters::set(Param p, float value) noexcept
{
    std::array<float, kParamCount> changed = values_;
    changed[static_cast<std::size_t>(p)] = value;
    return set_all(changed);
}

ParamStatus Parameters::set(std::string_view name, float value) noexcept
{
    const std::size_t index = find(name);
    return index < kParamCount ? set(static_cast<Param>(index), value) : ParamStatus::unknown_name;
}

std::size_t Parameters::find(std::string_view name) noexcept
{
    const std::string_view trimmed = name.substr(0, name.find('\0'));
    for (std::size_t i = 0; i < kParamCount; ++i) {
        if (kTable[i].name == trimmed) {
            return i;
        }
    }
    return kParamCount;
}

}  // namespace jink::app
