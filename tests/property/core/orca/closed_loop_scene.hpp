// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/orca/velocity_filter.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

// Closed-loop scenes: vehicles, plant and outcome.

namespace jink::orca::closed_loop {

using Vec3d = Eigen::Vector3d;

/// Response of the world. Times in [s].
struct Plant {
    double period = 0.025;
    double sense = 0.0;    ///< delay of all reported states and commands
    double act = 0.0;      ///< delay until commands take effect
    double lag = 0.0;      ///< of the velocity loop, first order
    double natural = 0.0;  ///< above 0 the velocity loop is of second order: its natural frequency [rad/s]
    double damping = 0.7;  ///< and damping ratio
    double noise = 0.0;    ///< of reported velocities, standard deviation [m/s]
    std::uint64_t seed = 1;

    /// Lag known to a filter that models its plant: the delay of a ramp response.
    [[nodiscard]] double known_lag() const { return natural > 0.0 ? 2.0 * damping / natural : lag; }
};

struct Body {
    Vec3d centre;
    Vec3d half;            ///< box: half extents; capsule along `half`: to its end
    double radius = -1.0;  ///< of a capsule; below 0: a box
    std::vector<Point3> hull{};

    [[nodiscard]] geometry::Shape shape() const
    {
        if (!hull.empty()) {
            return geometry::make_hull(hull, centre.cast<float>());
        }
        const Vec3d a = centre - half;
        const Vec3d b = centre + half;
        return radius < 0.0 ? geometry::make_box(centre.cast<float>(), half.cast<float>())
                            : geometry::make_capsule(a.cast<float>(), b.cast<float>(), float(radius));
    }
    /// A fast lower bound of distance(): stretching reduces distances at most by the smaller scale.
    [[nodiscard]] double lower_bound(const Vec3d& point, double stretch) const
    {
        const Vec3d from = point - centre;
        const double scale = std::min(stretch, 1.0);
        if (hull.empty() && radius >= 0.0) {
            const double along = half.squaredNorm() > 0.0 ? from.dot(half) / half.squaredNorm() : 0.0;
            return scale * ((from - std::clamp(along, -1.0, 1.0) * half).norm() - radius);
        }
        double most = half.norm();
        for (const Point3& vertex : hull) {
            most = std::max(most, vertex.vec().cast<double>().norm());
        }
        return scale * (from.norm() - most);
    }
    /// From `point` to the nearest point, heights times `stretch`; 0 within.
    [[nodiscard]] double distance(const Vec3d& point, double stretch) const
    {
        const Vec3d scale(1.0, 1.0, stretch);
        if (hull.empty() && radius < 0.0) {
            return ((point - centre).cwiseAbs() - half).cwiseMax(0.0).cwiseProduct(scale).norm();
        }
        const auto support = [&](const Vec3d& direction) -> Vec3d {
            Vec3d best = Vec3d::Zero();
            if (!hull.empty()) {
                double most = -1e300;
                for (const Point3& vertex : hull) {
                    const Vec3d w = (centre + vertex.vec().cast<double>() - point).cwiseProduct(scale);
                    if (w.dot(direction) > most) {
                        most = w.dot(direction);
                        best = w;
                    }
                }
                return best;
            }
            const Vec3d pulled = direction.cwiseProduct(scale);
            best = centre - point + (half.dot(pulled) > 0.0 ? half : Vec3d(-half));
            const double length = pulled.norm();
            if (length > 0.0) {
                best += radius * pulled / length;
            }
            return best.cwiseProduct(scale);
        };
        return geometry::oracle::distance_from_origin(support, 1e-6).upper;
    }
};

struct Agent {
    Vec3d start;
    Vec3d goal;
    double wait = 0.0;  ///< [s] before it sets out
};

/// Outcome of a scene.
struct Outcome {
    double time = -1.0;         ///< [s] until all were at their goals; -1: never
    double least = 1e9;         ///< distance of two centres [m]
    double least_across = 1e9;  ///< the same across [m]
    double ellipsoid = 1e9;     ///< least of sqrt((across / E_xy)^2 + (height / E_z)^2)
    double cylinder = 1e9;      ///< least of max(across / E_xy, height / E_z)
    double obstacle = 1e9;      ///< least stretched distance to an obstacle, over the required distance
    double climb = 0.0;         ///< fastest vertical velocity [m/s]
    double command_rate = 0.0;  ///< rms of the commands' rate of change [m/s2]
    std::uint64_t solves = 0;
    std::uint64_t warning = 0, conflict = 0, obstacle_relaxed = 0, other = 0;  ///< relaxations
    std::uint64_t outside = 0;  ///< commands that were not finite or faster than allowed
    std::uint64_t turns = 0;    ///< number of sign reversals of a command's rate of change
    bool blocked = false;
    std::vector<double> waits;  ///< [s] longest time without progress to the goal, per vehicle
    std::size_t missions = 0;   ///< with Scene::swaps: number of times that all were at their goals
};

/// Kind of reports about other vehicles.
enum class Reported : std::uint8_t {
    velocity,  ///< velocity, predicted constant (CONST_VEL of G-ORCA 11.4)
    commands,  ///< velocity and the last commands, eight at most (BROADCAST)
};

/// One vehicle's tick, for detailed tests.
struct Watched {
    double now;
    std::size_t vehicle;
    const FilterInput& input;
    const Decision& decision;
    const VelocityFilter& filter;  ///< after its decision
};

struct Scene {
    std::vector<Agent> agents;
    std::vector<Body> bodies{};
    FilterSettings settings{};
    Plant plant{};
    double cruise = 0.6;      ///< [m/s]
    double near_goal = 0.15;  ///< [m]
    double until = 60.0;      ///< [s]
    double e_xy = 0.7;        ///< judged conflict regions [m]
    double e_z = 0.45;
    bool knows_delay = true;  ///< accounts for own commands in transit, and the others' velocities
    Reported reported = Reported::velocity;
    bool there_and_back = false;
    bool swaps = false;  ///< once all are at their goals, each gets the start of another one for its next
    std::function<void(const Watched&)> watch{};
};

/// Settings of S1 to S4 (Alejo 7.3): pair separations 1.0 / 0.64 m and 0.7 / 0.45 m, obstacles 1.0 / 0.6 m.
inline FilterSettings testbed_settings()
{
    FilterSettings s;
    s.limits.max_speed = 1.5F;
    s.limits.acceleration = 2.0F;
    s.half_width = 0.5F;
    s.half_height = 0.32F;
    s.pair.horizon = 5.0F;
    s.pair.conflict_ratio = 0.7F;
    s.pair.recovery_time = 1.0F;
    s.pair.ramp_speed = 0.3F;
    s.delay = 0.1F;
    s.obstacles.horizontal = 1.0F;
    s.obstacles.vertical = 0.6F;
    return s;
}

/// Vehicles on a circle that exchange places with the opposite vehicle.
inline std::vector<Agent> on_a_circle(std::size_t count, double radius, double height)
{
    std::vector<Agent> agents;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * 3.14159265358979 * double(i) / double(count);
        const Vec3d out(radius * std::cos(angle), radius * std::sin(angle), 0.0);
        const Vec3d middle(0.0, 0.0, height);
        agents.push_back({middle + out, middle - out});
    }
    return agents;
}

}  // namespace jink::orca::closed_loop
