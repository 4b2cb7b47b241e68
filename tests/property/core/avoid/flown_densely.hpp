// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/avoid/final_check.hpp"
#include "tests/property/core/world/separation_oracle.hpp"

// A manoeuvre as flown, in double precision: set-points one period apart, the vehicle model between them solved
// independently, and the separation from each threat. Shares only the follower, which makes the commands, with the code
// under test.

namespace jink::avoid::dense {

using geometry::oracle::Vec3d;
using world::test::Scene;

/// The model while one command is held: the velocity error decays at the rate min(error / lag, limit).
struct Decayed {
    double left = 0.0;      ///< of the error [m/s]
    double integral = 0.0;  ///< [m]
};

inline Decayed decayed(double error, double lag, double limit, double t)
{
    const double knee = limit * lag;
    const double ramp = std::max(error - knee, 0.0) / limit;
    const double on_ramp = std::min(t, ramp);
    Decayed d{error - limit * on_ramp, (error - 0.5 * limit * on_ramp) * on_ramp};
    if (t > ramp) {
        const double start = std::min(error, knee);
        const double kept = lag > 0.0 ? std::exp(-(t - ramp) / lag) : 0.0;
        d.integral += start * lag * (1.0 - kept);
        d.left = start * kept;
    }
    return d;
}

struct FlownState {
    Vec3d position = Vec3d::Zero();
    Vec3d velocity = Vec3d::Zero();
};

/// A flight of commands held in sequence.
class DenseFlight {
public:
    DenseFlight(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits)
        : limits_(limits), state_{own.position.cast<double>(), own.velocity.cast<double>()}
    {
    }

    void hold(const Vec3d& command, double dt)
    {
        Vec3d goal = command;
        goal.z() = std::clamp(goal.z(), -double(limits_.max_descent), double(limits_.max_climb));
        if (limits_.kind == vehicle::VehicleKind::fixed_wing) {
            // Course of the command, or its own, at cruise speed.
            const bool has_course = std::hypot(command.x(), command.y()) >= 1.0;
            const Vec3d& course = has_course ? command : state_.velocity;
            const double size = std::hypot(course.x(), course.y());
            goal.x() = size > 0.0 ? course.x() * double(limits_.cruise_speed) / size : 0.0;
            goal.y() = size > 0.0 ? course.y() * double(limits_.cruise_speed) / size : 0.0;
        }
        parts_.push_back({end_, state_, goal});
        farthest_ = farthest();
        fastest_ = std::max({fastest_, state_.velocity.norm(), goal.norm()});
        state_ = after(parts_.back(), dt);
        end_ += dt;
    }
    [[nodiscard]] const FlownState& last() const { return state_; }
    [[nodiscard]] double end() const { return end_; }
    /// No speed is above this [m/s].
    [[nodiscard]] double fastest() const { return fastest_; }
    /// No coordinate at a set-point is above this [m].
    [[nodiscard]] double farthest() const { return std::max(farthest_, state_.position.cwiseAbs().maxCoeff()); }
    [[nodiscard]] std::size_t commands() const { return parts_.size(); }
    [[nodiscard]] FlownState at(double t) const
    {
        if (parts_.empty()) {
            return state_;
        }
        auto next = std::upper_bound(parts_.begin(), parts_.end(), t,
                                     [](double time, const Part& part) { return time < part.start; });
        const Part& part = next == parts_.begin() ? parts_.front() : *(next - 1);
        return after(part, t - part.start);
    }

private:
    struct Part {
        double start = 0.0;
        FlownState from;
        Vec3d goal = Vec3d::Zero();
    };
    [[nodiscard]] FlownState after(const Part& part, double t) const
    {
        const Vec3d error = part.from.velocity - part.goal;
        const double level = std::hypot(error.x(), error.y());
        const double up = std::abs(error.z());
        const double lag = double(limits_.velocity_lag);
        const Decayed l = decayed(level, lag, double(limits_.max_acceleration), t);
        const Decayed v = decayed(up, lag, double(limits_.max_vertical_acceleration), t);
        const auto share = [](double part_of, double whole) { return whole > 0.0 ? part_of / whole : 0.0; };
        const Vec3d left(share(l.left, level), share(l.left, level), share(v.left, up));
        const Vec3d way(share(l.integral, level), share(l.integral, level), share(v.integral, up));
        return {part.from.position + part.goal * t + error.cwiseProduct(way), part.goal + error.cwiseProduct(left)};
    }

    const vehicle::VehicleLimits& limits_;
    FlownState state_;
    std::vector<Part> parts_;
    double end_ = 0.0;
    double fastest_ = 0.0;
    double farthest_ = 0.0;
};

/// As the supervisor does: to a stop, or straight on for fixed wings.
inline void fly_on(const vehicle::VehicleLimits& limits, DenseFlight& flight)
{
    const Vec3d velocity = flight.last().velocity;
    const double speed = velocity.norm();
    if (limits.kind == vehicle::VehicleKind::fixed_wing) {
        flight.hold(velocity, std::max(0.0, double(vehicle::stopping_time(float(speed), limits)) - 1e-3));
        return;
    }
    const double lag = double(limits.velocity_lag);
    double stop = 0.0;
    for (const auto& [v, limit] : {std::pair(std::hypot(velocity.x(), velocity.y()), double(limits.max_acceleration)),
                                   std::pair(std::abs(velocity.z()), double(limits.max_vertical_acceleration))}) {
        double t = 0.0;
        while (decayed(v, lag, limit, t).left > double(vehicle::kStandstillSpeed)) {
            t += 1e-3;
        }
        stop = std::max(stop, t - 1e-3);
    }
    if (stop > 0.0) {
        flight.hold(Vec3d::Zero(), stop);
    }
}

/// The rest of a manoeuvre with a set-point every `period`, and the flight after it.
inline DenseFlight fly_densely(const Scene& scene, const world::Manoeuvre& m, float period)
{
    DenseFlight flight(scene.own, scene.limits);
    const float start = std::max(0.0F, scene.now - m.start);
    const float rest = std::max(0.0F, m.path.duration() - start);
    if (m.kind == world::ManoeuvreKind::velocity) {
        if (rest > 0.0F) {
            flight.hold(m.command.cast<double>(), double(rest));
        }
    } else {
        const auto count = static_cast<int>(std::ceil(rest / period));
        for (int i = 0; i < count; ++i) {
            const Vec3 position = flight.last().position.cast<float>();
            flight.hold(
                path::follow(m.path, start + static_cast<float>(i) * period, position, scene.limits, scene.rules.gains)
                    .cast<double>(),
                double(period));
        }
    }
    fly_on(scene.limits, flight);
    return flight;
}

/// A margin over the time of a flight, and the escape rule's reduction if the flight starts inside.
struct Judged {
    double start = 0.0;
    double slack = 0.0;
    double speed = 0.0;

    [[nodiscard]] double operator()(double margin, double t) const
    {
        // A start within rounding of the surface may count as inside.
        constexpr double kRounding = 1e-4;
        return start < kRounding ? margin + std::max(0.0, slack - start - speed * t) : margin;
    }
};

/// Minimum of `judged(t)`, as exact as needed to decide whether it is below `floor`. Steps in time as far as `rate`
/// [m/s] lets the margin fall, at least a millisecond. The distance to a convex body is smooth, so that between two
/// such instants it falls by less than a millimetre more.
template <class Margin>
double least_margin(const Margin& margin, double end, double rate, const world::EscapeRule& escape, double floor)
{
    constexpr double kFinest = 1e-3;
    const Judged judged{margin(0.0), double(escape.slack), double(escape.speed)};
    double least = 1e9;
    for (double t = 0.0;;) {
        const double value = judged(margin(t), t);
        least = std::min(least, value);
        if (t >= end) {
            return least;
        }
        t = std::min(end, t + std::max((value - floor) / rate, kFinest));
    }
}

/// Least margin over all threats that are not solids, and its threat.
inline double least_of_all(const Scene& scene, const DenseFlight& flight, double shared, double floor)
{
    const double end = flight.end();
    const double own_rate = flight.fastest() + double(scene.rules.escape.speed);
    const Vec3d half = scene.limits.half_extents.cast<double>();
    double least = double(world::kSeparationCap);
    for (const world::Track& track : scene.tracks) {
        const double until = track.cooperative ? std::min(end, shared) : end;
        const double age = std::max(0.0, double(scene.now - track.stamp)) + until;
        const double rate = own_rate + double(track.velocity.norm()) +
                            double(scene.rules.k_sigma) * double(track.sigma_velocity) +
                            double(track.max_acceleration) * age + world::oracle::hidden_speed(scene, track);
        const auto margin = [&](double t) {
            Vec3d gap = track.position.cast<double>() + track.velocity.cast<double>() * t - flight.at(t).position;
            // The nearest of its possible heights.
            gap.z() -= std::clamp(gap.z(), -double(track.half_height), double(track.half_height));
            return world::oracle::point_box(gap, half) - world::oracle::radius_of(scene, track, t);
        };
        least = std::min(least, least_margin(margin, until, rate, scene.rules.escape, floor));
    }
    for (const world::Cylinder& cylinder : scene.airspace.cylinders) {
        const auto margin = [&](double t) {
            return world::oracle::cylinder_margin_at(scene, flight.at(t).position, cylinder, t);
        };
        const double rate = own_rate + double(cylinder.velocity.norm());
        least = std::min(least, least_margin(margin, end, rate, scene.rules.escape, floor));
    }
    const auto bound = [&](bool active, world::ThreatKind kind) {
        if (active) {
            const auto margin = [&](double t) {
                return world::oracle::bound_margin_at(scene, flight.at(t).position, kind);
            };
            least = std::min(least, least_margin(margin, end, own_rate, scene.rules.escape, floor));
        }
    };
    bound(scene.airspace.has_floor, world::ThreatKind::floor);
    bound(scene.airspace.has_ceiling, world::ThreatKind::ceiling);
    bound(scene.airspace.has_keep_in, world::ThreatKind::keep_in);
    return least;
}

/// Margin to an obstacle at an instant; 0 in contact for all but spheres.
inline double obstacle_margin_at(const Scene& scene, const geometry::Shape& shape, const Vec3d& own)
{
    const double extra = double(scene.rules.k_sigma) * double(scene.own.sigma_position);
    if (shape.kind == geometry::ShapeKind::sphere) {
        return world::oracle::point_box(shape.centre.cast<double>() - own, scene.limits.half_extents.cast<double>()) -
               double(shape.radius) - extra;
    }
    const Vec3 at = own.cast<float>();
    return geometry::oracle::swept_box_bounds(scene.limits.half_extents, at, at, shape, 1e-4).lower - extra;
}

}  // namespace jink::avoid::dense
