// SPDX-License-Identifier: BSD-3-Clause
// Flights in the cells of the matrix.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/random.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/matrix.hpp"
#include "toolchain/sim/matrix_parts.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {
namespace {

constexpr double kHomeHeight = 12.0;  ///< of home above the estimator's origin [m]
constexpr double kHeight = 30.0;      ///< of the missions above home [m]
constexpr double kPlaneHeight = 100.0;
constexpr double kMissionTime = 150.0;
constexpr double kPlaneMissionTime = 300.0;
constexpr double kAfterwards = 8.0;
constexpr double kCruiseSpeed = 5.0;
constexpr double kFast = 12.0;

void set_vehicle(Scenario& s, Flyer flyer)
{
    // ArduCopter as recorded, docs/guides/setup.md; PX4 with its defaults (MPC_ACC_HOR, MPC_Z_V_AUTO_UP,
    // MPC_Z_V_AUTO_DN).
    const bool px4 = flyer == Flyer::px4;
    s.stack = px4 ? Stack::px4 : Stack::ardupilot;
    s.vehicle.cruise = kCruiseSpeed;
    s.vehicle.omega = px4 ? 5.0 : 3.3;
    s.vehicle.max_acceleration = px4 ? 3.0 : 2.5;
    s.vehicle.max_vertical_acceleration = px4 ? 3.0 : 2.5;
    s.vehicle.max_climb = px4 ? 3.0 : 2.5;
    s.vehicle.max_descent = 1.5;
    s.parameters = {{"VEH_ACC", s.vehicle.max_acceleration},
                    {"VEH_ACC_Z", s.vehicle.max_vertical_acceleration},
                    {"VEH_CLIMB", s.vehicle.max_climb},
                    {"VEH_DESCENT", s.vehicle.max_descent},
                    {"VEH_LAG", px4 ? 0.36 : 0.55}};
}

using detail::Field;
using detail::Items;
using detail::Times;
using detail::waypoint;

/// Missions that begin in the mission mode. Returns the times at which the intruder reaches the vehicle.
Times lay_out_mission(Behaviour behaviour, const Field& f, Scenario& s, NominalFlight& flight)
{
    Items& items = flight.items;
    const auto fill = [&](const Items& given) { items = given; };
    switch (behaviour) {
    case Behaviour::fast:
        s.vehicle.cruise = kFast;
        fill({waypoint(f.at(0, 0)), waypoint(f.at(120, 0)), waypoint(f.at(420, 0))});
        return {18.0, 24.0};
    case Behaviour::speed_change:
        fill({waypoint(f.at(0, 0)),
              {ItemKind::speed, Vec::Zero(), 10.0, 0},
              waypoint(f.at(250, 0)),
              waypoint(f.at(330, 0))});
        return {14.0, 20.0};
    case Behaviour::turns:
        fill({waypoint(f.at(0, 0)), {ItemKind::turns, f.at(50, 0), 20.0, 2}, waypoint(f.at(150, 0))});
        return {20.0, 40.0};
    case Behaviour::wait:
        fill({waypoint(f.at(40, 0)), {ItemKind::wait, f.at(60, 0), 40.0, 0}, waypoint(f.at(180, 0))});
        return {22.0, 40.0};
    case Behaviour::take_off:
        s.start_position = f.at(0, 0, 3.0);
        s.start_velocity = Vec::Zero();
        fill({{ItemKind::take_off, f.at(0, 0), 0.0, 0}, waypoint(f.at(150, 0))});
        return {6.0, 10.0};
    case Behaviour::land_item:
        fill({waypoint(f.at(40, 0)), {ItemKind::land, f.at(80, 0, 0.0), 0.0, 0}});
        return {20.0, 26.0};
    case Behaviour::home_item:
        fill({waypoint(f.at(60, 0)), {ItemKind::home, f.at(0, 0, 0.0), 0.0, 0}});
        return {17.0, 21.0};
    case Behaviour::upload:
        fill({waypoint(f.at(0, 0)), waypoint(f.at(250, 0)), waypoint(f.at(260, 0))});
        flight.uploaded = {waypoint(f.at(0, 0)), waypoint(f.at(200, 150)), waypoint(f.at(210, 150))};
        flight.upload_at = 10.0;
        return {18.0, 24.0};
    case Behaviour::jump:
        fill({waypoint(f.at(0, 0)),
              waypoint(f.at(40, 0)),
              waypoint(f.at(40, 40)),
              {ItemKind::jump, Vec::Zero(), 0.0, 1},
              waypoint(f.at(-60, 40))});
        return {19.0, 24.0};
    case Behaviour::spline:
        fill({waypoint(f.at(0, 0)),
              {ItemKind::spline, f.at(60, 30), 0.0, 0},
              {ItemKind::spline, f.at(120, -30), 0.0, 0},
              waypoint(f.at(200, 0))});
        return {12.0, 24.0};
    default: fill({waypoint(f.at(0, 0)), waypoint(f.at(60, 0)), waypoint(f.at(260, 0))}); return {18.0, 25.0};
    }
}

/// Flights that begin in another mode.
Times lay_out_other(Behaviour behaviour, const Field& f, Scenario& s, NominalFlight& flight)
{
    s.start_velocity = Vec::Zero();
    switch (behaviour) {
    case Behaviour::first_leg:
        flight.mode = Mode::guided;
        flight.target = f.at(0, 0);
        flight.mission_at = 5.0;
        flight.items = {waypoint(f.at(100, 40)), waypoint(f.at(200, 40))};
        s.start_position = f.at(0, 0, 24.0);
        return {12.0, 20.0};
    case Behaviour::off_leg:
        flight.mode = Mode::pilot;
        flight.moved_at = 0.0;
        flight.stick = f.along_course(2.0, 3.0);
        flight.mission_at = 6.0;
        flight.items = {waypoint(f.at(200, 0)), waypoint(f.at(230, 0))};
        return {14.0, 24.0};
    case Behaviour::home:
        flight.mode = Mode::home;
        s.start_position = f.at(120, 0);
        return {10.0, 18.0};
    case Behaviour::land: flight.mode = Mode::land; return {9.0, 14.0};
    case Behaviour::pilot:
        flight.mode = Mode::pilot;
        flight.moved_at = 10.0;
        flight.stick = f.along_course(5.0, 0.0);
        return {16.0, 20.0};
    case Behaviour::guided:
        flight.mode = Mode::guided;
        flight.target = f.at(200, 0);
        return {12.0, 20.0};
    default: flight.mode = Mode::hold; return {14.0, 20.0};
    }
}

bool begins_in_mission(Behaviour behaviour) noexcept
{
    return is_mission(behaviour) && behaviour != Behaviour::first_leg && behaviour != Behaviour::off_leg;
}

Vec level(const Vec& v) { return {v.x(), v.y(), 0.0}; }

Vec turned(const Vec& v, double angle)
{
    return {std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y(),
            v.z()};
}

/// Intruder speeds that suit the vehicle.
struct Intruders {
    double radius = 0.5;                            ///< [m]
    double slowest = 6.0, fastest = 12.0;           ///< [m/s]
    double overtakes_by = 3.0, overtakes_at = 6.0;  ///< excess speed over the vehicle, from .. to [m/s]
    double seen_late = 8.0, seen_early = 14.0;      ///< before they reach the vehicle, from .. to [s]
};

Intruders intruders_of(Flyer flyer)
{
    return flyer == Flyer::arduplane ? Intruders{3.0, 10.0, 20.0, 4.0, 8.0, 12.0, 18.0} : Intruders{};
}

/// The intruder's velocity when it reaches a vehicle that flies at `own`, `height` above home.
Vec velocity_of(Meeting meeting, const Intruders& kind, const Vec& own, double height, double seen_before,
                Random& random)
{
    const double course = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double own_speed = level(own).norm();
    const Vec forward = own_speed > 0.5 ? Vec(level(own) / own_speed) : Vec(std::cos(course), std::sin(course), 0.0);
    const double speed = uniform(random, kind.slowest, kind.fastest);
    switch (meeting) {
    case Meeting::head_on: return -forward * speed;
    case Meeting::from_left: return turned(forward, -0.5 * std::numbers::pi) * speed;
    case Meeting::from_right: return turned(forward, 0.5 * std::numbers::pi) * speed;
    case Meeting::overtaking: return forward * (own_speed + uniform(random, kind.overtakes_by, kind.overtakes_at));
    case Meeting::from_above: return turned(forward, course) * speed + Vec(0.0, 0.0, -uniform(random, 1.0, 3.0));
    case Meeting::from_below:
        return turned(forward, course) * speed +
               Vec(0.0, 0.0, std::min(uniform(random, 1.0, 3.0), std::max(0.2, (height - 2.0) / seen_before)));
    case Meeting::at_turn: break;
    }
    return turned(forward, course) * speed;
}

/// Own motion without a co-processor.
Sample motion_at(const Scenario& scenario, double time)
{
    const Record alone = fly_alone(scenario);
    const auto after = std::find_if(alone.samples.begin(), alone.samples.end(),
                                    [&](const Sample& sample) { return sample.time >= time; });
    return after == alone.samples.end() ? alone.samples.back() : *after;
}

void roughen(Scenario& s)
{
    s.traffic.rate = 1.0;
    s.traffic.quantised = true;
    s.own.latency = 0.15;
    s.own.bias = 1.5;
    s.own.bias_vertical = 1.5;
    s.wind.at_20_ft = 7.7;
}

}  // namespace

bool is_mission(Behaviour behaviour) noexcept { return behaviour < Behaviour::hold; }

bool can_fly(Flyer flyer, Behaviour behaviour) noexcept
{
    switch (flyer) {
    case Flyer::px4: return behaviour != Behaviour::turns && behaviour != Behaviour::spline;
    case Flyer::arduplane:
        return behaviour != Behaviour::spline && behaviour != Behaviour::home_item && behaviour != Behaviour::land;
    case Flyer::arducopter: break;
    }
    return true;
}

Nominal nominal_flight(Flyer flyer, Behaviour behaviour, std::uint64_t seed)
{
    Random random(seed * 6700417U + static_cast<std::uint64_t>(behaviour) * 257U + static_cast<std::uint64_t>(flyer));
    Nominal nominal;
    Scenario& s = nominal.scenario;
    s.name = std::string(to_string(flyer)) + "_" + std::string(to_string(behaviour)) + "_" + std::to_string(seed);
    s.seed = seed;
    const bool plane = flyer == Flyer::arduplane;
    if (plane) {
        detail::set_plane(s);
    } else {
        set_vehicle(s, flyer);
    }
    const double bearing = uniform(random, -std::numbers::pi, std::numbers::pi);
    s.home = uniform(random, 20.0, 60.0) * Vec(std::cos(bearing), std::sin(bearing), 0.0) + Vec(0.0, 0.0, kHomeHeight);
    const Field field(s.home, uniform(random, -std::numbers::pi, std::numbers::pi), plane ? kPlaneHeight : kHeight);
    s.start_position = field.at(0, 0);
    s.start_velocity = Vec::Zero();
    NominalFlight flight;
    Times times{};
    if (plane) {
        times = detail::lay_out_plane(behaviour, field, s, flight);
    } else if (begins_in_mission(behaviour)) {
        times = lay_out_mission(behaviour, field, s, flight);
        const bool climbs = behaviour == Behaviour::take_off;
        s.start_velocity = climbs ? Vec(Vec::Zero()) : field.along_course(s.vehicle.cruise, 0.0);
    } else {
        times = lay_out_other(behaviour, field, s, flight);
    }
    nominal.meets_at = uniform(random, times.from, times.to);
    s.to_goal = is_mission(behaviour);
    s.duration = s.to_goal ? plane ? kPlaneMissionTime : kMissionTime : nominal.meets_at + kAfterwards;
    const Items& last = flight.uploaded.empty() ? flight.items : flight.uploaded;
    s.mission = {s.start_position,
                 last.empty() ? Vec(s.start_position + field.along_course(200.0, 0.0)) : last.back().place};
    const bool grounded = behaviour == Behaviour::take_off || behaviour == Behaviour::land_item ||
                          behaviour == Behaviour::home_item || behaviour == Behaviour::land;
    if (!grounded) {
        s.floor = s.home.z();
    }
    s.flight = flight;
    s.traffic.sigma_position = 0.3;
    s.traffic.sigma_velocity = 0.2;
    s.traffic.jitter = 0.05;
    s.traffic.dropout = 0.05;
    s.expect.outcomes = {Outcome::clear, Outcome::avoided, Outcome::braked};
    return nominal;
}

Scenario matrix_scenario(Flyer flyer, Behaviour behaviour, Meeting meeting, std::uint64_t seed, Conditions conditions)
{
    Nominal nominal = nominal_flight(flyer, behaviour, seed);
    Scenario& s = nominal.scenario;
    if (conditions == Conditions::rough) {
        roughen(s);
    }
    const double meets_at = nominal.meets_at;
    const Sample own = motion_at(s, meets_at);
    Random random(seed * 2147483647U + static_cast<std::uint64_t>(behaviour) * 101U +
                  static_cast<std::uint64_t>(meeting) * 11U + 5U);
    const Intruders kind = intruders_of(flyer);
    const double seen_before = std::min(meets_at, uniform(random, kind.seen_late, kind.seen_early));
    Threat threat;
    threat.name = "intruder";
    threat.radius = kind.radius;
    const Vec velocity = velocity_of(meeting, kind, own.velocity, own.position.z() - s.home.z(), seen_before, random);
    const Vec miss(uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2));
    const Vec place = own.position + miss;
    threat.velocity = velocity;
    threat.position = place - velocity * meets_at;
    if (meeting == Meeting::at_turn) {
        constexpr double kTurnsBefore = 6.0;
        const double turns_at = meets_at - std::min(kTurnsBefore, 0.7 * meets_at);
        const double angle = uniform(random, 0.6, 1.2);
        threat.velocity = turned(velocity, random.below(2) == 0 ? angle : -angle);
        threat.position = place - velocity * (meets_at - turns_at) - threat.velocity * turns_at;
        threat.turns = {{turns_at, velocity}};
    }
    threat.appears_at = meets_at - seen_before;
    s.threats = {threat};
    s.name.append("_").append(to_string(meeting));
    default_radii(s);
    return s;
}

}  // namespace jink::sim
