// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/avoid/fallback.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "tests/property/core/avoid/flown_densely.hpp"

// Random vehicles, manoeuvres of all kinds and of the methods, and threats of all kinds, placed so that the flight
// grazes them.

namespace jink::avoid::dense {

using geometry::oracle::in_cube;

/// Between set-points of the application, by default [s].
inline constexpr float kPeriod = 0.05F;
inline constexpr std::uint32_t kAmple = 50'000'000;

enum class Flying { path, velocity, brake, turn, planned, reciprocal, held, fallback_turn, count };

/// A situation, its manoeuvre, and the state of the flight.
struct Drawn {
    Scene scene;
    Settings settings;
    world::Manoeuvre manoeuvre;
    Flying flying = Flying::path;
    std::vector<std::vector<Point3>> vertices;  // of hulls
};

inline Vec3 any_direction(Random& random)
{
    const Vec3 v = in_cube(random, 1.0F);
    return v.norm() > 0.1F ? Vec3(v.normalized()) : Vec3(Vec3::UnitX());
}

/// Level for the most part, within the climb limits.
inline Vec3 any_velocity(Random& random, const vehicle::VehicleLimits& limits, float speed)
{
    const float course = random.uniform(-kPi, kPi);
    Vec3 v = speed * Vec3(std::cos(course), std::sin(course), 0.0F);
    if (random.below(2) == 0) {
        v.z() = random.uniform(-limits.max_descent, limits.max_climb);
    }
    return v;
}

inline vehicle::VehicleLimits any_vehicle(Random& random)
{
    vehicle::VehicleLimits v;
    v.kind = random.below(6) == 0 ? vehicle::VehicleKind::fixed_wing : vehicle::VehicleKind::multirotor;
    v.cruise_speed = random.below(2) == 0 ? 5.0F : random.uniform(1.0F, 20.0F);
    v.max_climb = random.uniform(0.5F, 8.0F);
    v.max_descent = random.uniform(0.5F, 8.0F);
    v.max_acceleration = random.uniform(1.0F, 8.0F);
    v.max_vertical_acceleration = random.uniform(0.5F, 6.0F);
    v.velocity_lag = random.below(8) == 0 ? 0.0F : random.uniform(0.05F, 0.6F);
    v.half_extents = Vec3(random.uniform(0.2F, 1.5F), random.uniform(0.2F, 1.5F), random.uniform(0.2F, 1.5F));
    return v;
}

/// A curve of the planner's kind, or legs with corners.
inline path::TimedPath any_path(Random& random, const Scene& scene)
{
    std::vector<Vec3> points;
    const float speed = random.uniform(0.3F, 1.0F) * scene.limits.cruise_speed;
    Vec3 along = scene.own.velocity.norm() > 0.1F ? Vec3(scene.own.velocity.normalized()) : Vec3(Vec3::UnitX());
    const float length = random.uniform(1.0F, 8.0F) * speed;
    if (random.below(2) == 0) {
        const Vec3 side = along.cross(any_direction(random)).normalized();
        const float offset = random.uniform(-0.6F, 0.6F) * length;
        const auto count = 8 + static_cast<int>(random.below(40));
        for (int i = 0; i < count; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(count - 1);
            const float out = 0.5F * (1.0F - std::cos(2.0F * kPi * u));
            points.push_back(scene.own.position + along * (length * u) + side * (offset * out));
        }
    } else {
        Vec3 at = scene.own.position;
        points.push_back(at);
        for (std::size_t n = 1 + random.below(6); n > 0; --n) {
            at += along * random.uniform(0.1F, 0.5F) * length;
            points.push_back(at);
            along = (along + 0.8F * in_cube(random, 1.0F)).normalized();
        }
    }
    path::TimedPath path;
    EXPECT_TRUE(path::make_timed_path(points, speed, scene.limits, path));
    return path;
}

/// Under a turn, or under a braking command.
inline path::TimedPath path_under(const Scene& scene, bool turn, float duration)
{
    path::TimedPath path;
    vehicle::VehicleState state = scene.own;
    constexpr int kPoints = 30;
    const float step = duration / static_cast<float>(kPoints);
    path.points.unchecked_push_back({state.position, state.velocity, 0.0F});
    for (int i = 1; i <= kPoints; ++i) {
        const Vec3 from = state.position;
        vehicle::advance(state, turn ? turn_command(state, scene.limits, 1.0F) : Vec3(Vec3::Zero()), scene.limits,
                         step);
        path.points.back().velocity = (state.position - from) / step;
        path.points.unchecked_push_back({state.position, path.points.back().velocity, step * static_cast<float>(i)});
    }
    return path;
}

/// Some time after the start of the manoeuvre, with a tracking error.
inline void take_up_midway(Random& random, Drawn& d)
{
    const float into = random.uniform(0.0F, 0.8F) * d.manoeuvre.path.duration();
    d.manoeuvre.start = d.scene.now - into;
    const path::PathSample at = path::sample(d.manoeuvre.path, into);
    d.scene.own.position = at.position + in_cube(random, 0.5F);
    d.scene.own.velocity = at.velocity + in_cube(random, 0.5F);
}

/// A method's answer; false without an answer.
inline bool plan(Random& random, Drawn& d)
{
    static const auto planner = std::make_unique<geometric::Planner>(geometric::Settings{});
    static const auto reciprocal = std::make_unique<orca::Planner>();
    Scene& s = d.scene;
    const Vec3 along(std::cos(s.own.yaw), std::sin(s.own.yaw), 0.0F);
    const float speed = random.uniform(0.5F, 1.0F) * s.limits.cruise_speed;
    s.leg(s.own.position, s.own.position + 60.0F * along, speed);
    s.own.velocity = speed * along;
    world::Track& met = s.track(s.own.position + speed * random.uniform(2.0F, 5.0F) * along + in_cube(random, 0.7F),
                                Vec3::Zero(), random.uniform(0.3F, 1.0F));
    met.cooperative = random.below(3) == 0;
    WorkBudget budget(kAmple);
    if (d.flying == Flying::planned) {
        return planner->plan(s.situation(), budget, d.manoeuvre) == world::PlanStatus::found;
    }
    reciprocal->reset();
    return reciprocal->plan(s.situation(), budget, d.manoeuvre) == world::PlanStatus::found;
}

/// False where there is nothing to fly.
inline bool draw_manoeuvre(Random& random, Drawn& d)
{
    Scene& s = d.scene;
    world::Manoeuvre& m = d.manoeuvre;
    m.kind = world::ManoeuvreKind::follow_path;
    m.start = s.now;
    switch (d.flying) {
    case Flying::path: m.path = any_path(random, s); break;
    case Flying::velocity:
        m.kind = world::ManoeuvreKind::velocity;
        m.command = any_velocity(random, s.limits, random.uniform(0.0F, 1.2F) * s.limits.cruise_speed);
        path::predict_velocity_command(s.own, m.command, random.uniform(0.3F, 8.0F), 0.2F, s.limits, m.path);
        return true;
    case Flying::brake:
        m.kind = world::ManoeuvreKind::brake;
        m.path = path_under(s, false, random.uniform(0.5F, 4.0F));
        break;
    case Flying::turn:
        m.kind = world::ManoeuvreKind::hold_turn;
        m.path = path_under(s, true, random.uniform(0.5F, 6.0F));
        break;
    case Flying::planned:
    case Flying::reciprocal: return plan(random, d);
    case Flying::held:
        m.command = random.below(3) == 0 ? Vec3(Vec3::Zero()) : any_velocity(random, s.limits, s.limits.cruise_speed);
        return true;
    default: s.limits.kind = vehicle::VehicleKind::fixed_wing; return true;
    }
    if (random.below(2) == 0) {
        take_up_midway(random, d);
    }
    return true;
}

/// A fixed wing turns to the command's course at its lateral limit, set-point by set-point, and flies on along it.
inline void hold_as_wing(const Drawn& d, DenseFlight& flight)
{
    const vehicle::VehicleLimits& limits = d.scene.limits;
    const Vec3& command = d.manoeuvre.command;
    vehicle::VehicleState state = d.scene.own;
    for (int i = 0; i < static_cast<int>(std::ceil(d.settings.fallback_horizon / kPeriod)); ++i) {
        const Vec3d v = flight.last().velocity;
        state.velocity = v.cast<float>();
        const double off = std::remainder(
            std::atan2(double(command.y()), double(command.x())) - std::atan2(v.y(), v.x()), 2.0 * double(kPi));
        const Vec3 turn = turn_command(state, limits, off < 0.0 ? -1.0F : 1.0F);
        const double lead = std::abs(std::remainder(
            std::atan2(double(turn.y()), double(turn.x())) - std::atan2(v.y(), v.x()), 2.0 * double(kPi)));
        const bool none = std::hypot(command.x(), command.y()) < 1.0F;
        const Vec3 flown = none || std::abs(off) <= lead ? command : Vec3(turn.x(), turn.y(), command.z());
        flight.hold(flown.cast<double>(), double(kPeriod));
    }
}

/// `direction`: of a turn; 0: a held command.
inline DenseFlight fly(const Drawn& d, float direction)
{
    if (d.flying != Flying::held && d.flying != Flying::fallback_turn) {
        return fly_densely(d.scene, d.manoeuvre, kPeriod);
    }
    DenseFlight flight(d.scene.own, d.scene.limits);
    const bool held = d.flying == Flying::held || direction == 0.0F;
    if (held && d.scene.limits.kind == vehicle::VehicleKind::fixed_wing) {
        hold_as_wing(d, flight);
        return flight;
    }
    if (held) {
        flight.hold(d.manoeuvre.command.cast<double>(), double(d.settings.fallback_horizon));
        return flight;
    }
    vehicle::VehicleState state = d.scene.own;
    for (int i = 0; i < static_cast<int>(std::ceil(d.settings.fallback_horizon / kPeriod)); ++i) {
        state.velocity = flight.last().velocity.cast<float>();
        flight.hold(turn_command(state, d.scene.limits, direction).cast<double>(), double(kPeriod));
    }
    return flight;
}

/// Distance along `along` at which `margin_at(distance)`, which grows with it, is `wanted`.
template <class Margin>
double placed(const Margin& margin_at, double wanted)
{
    double low = 0.0;
    double high = 300.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (margin_at(middle) < wanted ? low : high) = middle;
    }
    return high;
}

/// A track, a sphere or a pillar whose surface the flight passes at `wanted` at some instant.
inline void place_sphere(Random& random, Drawn& d, const DenseFlight& flight, double wanted, bool moves)
{
    Scene& s = d.scene;
    const double t = double(random.uniform()) * flight.end();
    const FlownState own = flight.at(t);
    Vec3 across = any_direction(random);
    const Vec3 relative = moves ? in_cube(random, 10.0F) : Vec3((-own.velocity).cast<float>());
    if (relative.norm() > 0.2F && random.below(4) != 0) {
        across -= relative * (across.dot(relative) / relative.squaredNorm());
        across = across.norm() > 0.05F ? Vec3(across.normalized()) : Vec3(Vec3::UnitZ());
    }
    world::Track track;
    track.stamp = s.now - random.uniform(0.0F, 1.5F);
    track.velocity = moves ? Vec3(own.velocity.cast<float>() + relative) : Vec3(Vec3::Zero());
    track.radius = random.uniform(0.0F, 2.0F);
    if (moves) {
        track.sigma_position = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.5F);
        track.sigma_velocity = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.3F);
        track.max_acceleration = random.below(3) == 0 ? random.uniform(0.0F, 0.5F) : 0.0F;
        track.cooperative = random.below(4) == 0;
        track.half_height = random.below(4) == 0 ? random.uniform(0.0F, 60.0F) : 0.0F;
    }
    const double radius = moves ? world::oracle::radius_of(s, track, t)
                                : double(track.radius) + double(s.rules.k_sigma) * double(s.own.sigma_position);
    const Vec3d half = s.limits.half_extents.cast<double>();
    const Vec3d direction = across.cast<double>();
    const double far = placed([&](double x) { return world::oracle::point_box(direction * x, half) - radius; }, wanted);
    // For an uncertain height, the flight grazes the end facing this direction.
    const double shift = std::copysign(double(track.half_height), direction.z());
    const Vec3d centre = own.position + direction * far + shift * Vec3d::UnitZ() - track.velocity.cast<double>() * t;
    if (moves) {
        track.position = centre.cast<float>();
        s.tracks.push_back(track);
    } else {
        s.obstacle(geometry::make_sphere(centre.cast<float>(), track.radius));
    }
}

inline void place_cylinder(Random& random, Drawn& d, const DenseFlight& flight, double wanted)
{
    Scene& s = d.scene;
    const double t = double(random.uniform()) * flight.end();
    const Vec3d own = flight.at(t).position;
    const float course = random.uniform(-kPi, kPi);
    const Eigen::Vector2d direction(std::cos(double(course)), std::sin(double(course)));
    world::Cylinder cylinder;
    cylinder.circle.radius = random.uniform(0.5F, 20.0F);
    cylinder.velocity = random.below(2) == 0 ? world::Vec2(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F))
                                             : world::Vec2(world::Vec2::Zero());
    const bool beside = random.below(3) != 0;
    const float below =
        beside ? 10.0F : float(wanted) + s.limits.half_extents.z() + s.rules.k_sigma * s.own.sigma_position;
    cylinder.top = beside ? float(own.z()) + below : float(own.z()) - below;
    cylinder.bottom = cylinder.top - 20.0F;
    const auto put = [&](double x) {
        cylinder.circle.centre =
            (own.head<2>() + direction * x - cylinder.velocity.cast<double>() * t).template cast<float>();
    };
    put(beside ? placed(
                     [&](double x) {
                         put(x);
                         return world::oracle::cylinder_margin_at(s, own, cylinder, t);
                     },
                     wanted)
               : 0.0);
    s.cylinders.push_back(cylinder);
    s.airspace.cylinders = s.cylinders;
}

inline void place_bound(Random& random, Drawn& d, const DenseFlight& flight, double wanted)
{
    Scene& s = d.scene;
    const double extra = double(s.rules.k_sigma) * double(s.own.sigma_position);
    const double height = double(s.limits.half_extents.z()) + extra + wanted;
    const Vec3d home = flight.at(0.0).position + in_cube(random, 20.0F).cast<double>();
    double low = 1e9;
    double high = -1e9;
    double out = 0.0;
    for (int i = 0; i <= 200; ++i) {
        const Vec3d at = flight.at(flight.end() * i / 200.0).position;
        low = std::min(low, at.z());
        high = std::max(high, at.z());
        out = std::max(out, (at - home).head<2>().norm());
    }
    switch (random.below(3)) {
    case 0:
        s.airspace.has_floor = true;
        s.airspace.floor = float(low - height);
        break;
    case 1:
        s.airspace.has_ceiling = true;
        s.airspace.ceiling = float(high + height);
        break;
    default:
        s.airspace.has_keep_in = true;
        s.airspace.home = home.cast<float>();
        s.airspace.keep_in_radius =
            float(out + wanted + extra + double(std::hypot(s.limits.half_extents.x(), s.limits.half_extents.y())));
        break;
    }
}

inline void place_solid(Random& random, Drawn& d, const DenseFlight& flight, double wanted)
{
    using geometry::ShapeKind;
    constexpr ShapeKind kKinds[] = {ShapeKind::box, ShapeKind::cylinder, ShapeKind::capsule, ShapeKind::hull};
    Scene& s = d.scene;
    const Vec3d own = flight.at(double(random.uniform()) * flight.end()).position;
    const Vec3 across = any_direction(random);
    d.vertices.emplace_back();
    geometry::Shape shape = geometry::oracle::any_shape(random, kKinds[random.below(4)], Vec3::Zero(),
                                                        random.uniform(0.5F, 4.0F), d.vertices.back());
    shape.centre = (own + across.cast<double>() * double(geometry::bounding_radius(shape) + 3.0F)).cast<float>();
    for (int i = 0; i < 3; ++i) {
        shape.centre -= across * float(obstacle_margin_at(s, shape, own) - wanted);
    }
    s.obstacle(shape);
}

inline void place_threats(Random& random, Drawn& d, const DenseFlight& flight, bool solids)
{
    // Most flights are clear of all of it, by less than a chord's sagitta or by little more.
    const auto wanted = [&] { return double(random.uniform(-0.03F, 0.3F)); };
    d.vertices.reserve(4);
    for (std::size_t n = 1 + random.below(2); n > 0; --n) {
        switch (solids ? 5 : random.below(5)) {
        case 0:
        case 1: place_sphere(random, d, flight, wanted(), true); break;
        case 2: place_sphere(random, d, flight, wanted(), false); break;
        case 3: place_cylinder(random, d, flight, wanted()); break;
        case 4: place_bound(random, d, flight, wanted()); break;
        default: place_solid(random, d, flight, wanted()); break;
        }
    }
}

/// False where nothing is flown.
inline bool draw(Random& random, Drawn& d, bool solids)
{
    Scene& s = d.scene;
    s.limits = any_vehicle(random);
    s.own.stamp = s.now;
    s.own.position = in_cube(random, 40.0F);
    s.own.velocity = any_velocity(random, s.limits, random.uniform(0.0F, 1.0F) * s.limits.cruise_speed);
    s.own.yaw = std::atan2(s.own.velocity.y(), s.own.velocity.x());
    s.own.sigma_position = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.3F);
    s.rules.k_sigma = random.uniform(0.0F, 3.0F);
    if (random.below(4) == 0) {
        d.settings.prediction_step = random.uniform(0.02F, 0.5F);
        d.scene.rules.gains = {random.uniform(0.0F, 2.0F), random.uniform(0.0F, 4.0F)};
    }
    d.flying = static_cast<Flying>(random.below(static_cast<std::size_t>(Flying::count)));
    if (!draw_manoeuvre(random, d)) {
        return false;
    }
    place_threats(random, d, fly(d, 1.0F), solids);
    return true;
}

}  // namespace jink::avoid::dense
