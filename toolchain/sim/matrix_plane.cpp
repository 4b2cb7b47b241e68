// SPDX-License-Identifier: BSD-3-Clause
// Plane flights in the cells of the matrix.
#include "toolchain/sim/arduplane.hpp"
#include "toolchain/sim/matrix_parts.hpp"

namespace jink::sim::detail {
namespace {

constexpr double kPlaneCruise = 18.0;
constexpr double kPlaneFast = 22.0;
/// The mission ends on a circle: distance from its centre that counts as on the circle, radius plus tracking error [m].
constexpr double kOnLastCircle = 75.0;
/// LAND ends within this distance of its place [m].
constexpr double kTouchdown = 10.0;

Item circle_at(const Vec& place) { return {ItemKind::circle, place, 0.0, 0}; }

/// Flights that begin in the mission mode, on the course of the first leg.
Times lay_out_plane_mission(Behaviour behaviour, const Field& f, Scenario& s, NominalFlight& flight)
{
    Items& items = flight.items;
    const auto fill = [&](const Items& given) { items = given; };
    switch (behaviour) {
    case Behaviour::fast: s.vehicle.cruise = kPlaneFast; break;
    case Behaviour::speed_change:
        fill({waypoint(f.at(100, 0)),
              {ItemKind::speed, Vec::Zero(), kPlaneFast, 0},
              waypoint(f.at(800, 0)),
              circle_at(f.at(1000, 0))});
        return {18.0, 30.0};
    case Behaviour::turns:
        fill({waypoint(f.at(100, 0)), {ItemKind::turns, f.at(300, 0), 80.0, 1}, circle_at(f.at(700, 0))});
        return {20.0, 38.0};
    case Behaviour::wait:
        fill({waypoint(f.at(100, 0)), {ItemKind::wait, f.at(300, 0), 25.0, 0}, circle_at(f.at(700, 0))});
        return {20.0, 38.0};
    case Behaviour::take_off:
        s.start_position = f.at(0, 0, 5.0);
        fill({{ItemKind::take_off, f.at(0, 0, 70.0), 0.0, 0}, waypoint(f.at(800, 0)), circle_at(f.at(1000, 0))});
        return {12.0, 24.0};
    case Behaviour::land_item:
        s.start_position = f.at(0, 0, 60.0);
        fill({waypoint(f.at(200, 0, 60.0)), {ItemKind::land, f.at(1000, 0, 0.0), 0.0, 0}});
        s.at_goal = kTouchdown;
        return {20.0, 38.0};
    case Behaviour::upload:
        fill({waypoint(f.at(100, 0)), waypoint(f.at(900, 0)), circle_at(f.at(1000, 0))});
        flight.uploaded = {waypoint(f.at(100, 0)), waypoint(f.at(600, 500)), circle_at(f.at(600, 700))};
        flight.upload_at = 12.0;
        return {22.0, 32.0};
    case Behaviour::jump:
        fill({waypoint(f.at(250, 0)),
              waypoint(f.at(250, 250)),
              {ItemKind::jump, Vec::Zero(), 0.0, 1},
              circle_at(f.at(-150, 300))});
        return {32.0, 42.0};
    default: break;
    }
    fill({waypoint(f.at(200, 0)), waypoint(f.at(900, 0)), circle_at(f.at(1100, 0))});
    return {22.0, 34.0};
}

}  // namespace

void set_plane(Scenario& s)
{
    // As tests/scenario/plane_*.yaml: 30 degrees of bank.
    s.stack = Stack::ardupilot;
    s.vehicle.cruise = kPlaneCruise;
    s.vehicle.min_speed = 12.0;
    s.vehicle.max_acceleration = 5.66;
    s.vehicle.max_vertical_acceleration = 1.5;
    s.vehicle.max_climb = s.vehicle.max_descent = 2.5;
    s.at_goal = kOnLastCircle;
    s.parameters = {{"VEH_FIXED_WING", 1}, {"VEH_CRUISE", kPlaneCruise},
                    {"VEH_ACC", 4},        {"VEH_ACC_Z", 1},
                    {"VEH_CLIMB", 2},      {"VEH_DESCENT", 2},
                    {"VEH_LAG", 1.8},      {"GEO_LATENCY", 0.5},
                    {"JNK_HALF_XY", 8},    {"JNK_HALF_Z", 6},
                    {"JNK_LOOKAHEAD", 12}};
}

Times lay_out_plane(Behaviour behaviour, const Field& f, Scenario& s, NominalFlight& flight)
{
    s.start_velocity = f.along_course(kPlaneCruise, 0.0);
    switch (behaviour) {
    case Behaviour::first_leg:
        flight.mode = Mode::guided;
        flight.target = f.at(0, -kPlaneLoiterRadius);
        flight.mission_at = 6.0;
        flight.items = {waypoint(f.at(700, 200)), circle_at(f.at(900, 200))};
        return {18.0, 32.0};
    case Behaviour::off_leg:
        flight.mode = Mode::pilot;
        flight.moved_at = 0.0;
        flight.stick = f.along_course(15.0, 10.0);
        flight.mission_at = 6.0;
        flight.items = {waypoint(f.at(700, 0)), circle_at(f.at(900, 0))};
        return {18.0, 32.0};
    case Behaviour::home:
        flight.mode = Mode::home;
        s.start_position = f.at(500, 0);
        return {16.0, 36.0};
    case Behaviour::pilot:
        flight.mode = Mode::pilot;
        flight.moved_at = 12.0;
        flight.stick = f.along_course(10.0, 15.0, 1.0);
        return {14.0, 26.0};
    case Behaviour::guided:
        flight.mode = Mode::guided;
        flight.target = f.at(300, 300);
        return {16.0, 36.0};
    case Behaviour::hold: flight.mode = Mode::hold; return {14.0, 30.0};
    default: break;
    }
    const Times times = lay_out_plane_mission(behaviour, f, s, flight);
    s.start_velocity = f.along_course(s.vehicle.cruise, 0.0);
    return times;
}

}  // namespace jink::sim::detail
