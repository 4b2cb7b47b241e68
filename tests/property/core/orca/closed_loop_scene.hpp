// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/orca/velocity_filter.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

// What is flown in a closed loop, by whom and how, and what came of it.

namespace jink::orca::closed_loop {

using Vec3d = Eigen::Vector3d;

/// How the world answers. Times in [s].
struct Plant {
    double period = 0.025;
    double sense = 0.0;    ///< everybody's states and commands are told so late
    double act = 0.0;      ///< commands begin to act so late
    double lag = 0.0;      ///< of the velocity loop, first order
    double natural = 0.0;  ///< above 0 the velocity loop is of second order: its natural frequency [rad/s]
    double damping = 0.7;  ///< and damping ratio
    double noise = 0.0;    ///< of what is told of velocities, standard deviation [m/s]
    std::uint64_t seed = 1;

    /// What a filter that knows its plant takes for the lag: the time by which a ramp comes late.
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
    /// No more than distance(), and quickly: stretching does not bring anything nearer than the lesser scale does.
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

/// What happened.
struct Outcome {
    double time = -1.0;         ///< [s] until all were at their goals; -1: never
    double least = 1e9;         ///< distance of two centres [m]
    double least_across = 1e9;  ///< the same across [m]
    double ellipsoid = 1e9;     ///< least of sqrt((across / E_xy)^2 + (height / E_z)^2)
    double cylinder = 1e9;      ///< least of max(across / E_xy, height / E_z)
    double obstacle = 1e9;      ///< least distance to one, stretched, over what is to be kept
    double climb = 0.0;         ///< fastest vertical velocity [m/s]
    double command_rate = 0.0;  ///< rms of the commands' rate of change [m/s2]
    std::uint64_t solves = 0;
    std::uint64_t warning = 0, conflict = 0, obstacle_relaxed = 0, other = 0;  ///< relaxations
    std::uint64_t outside = 0;  ///< commands that were not finite or faster than allowed
    std::uint64_t turns = 0;    ///< times a command's rate of change turned round
    bool blocked = false;
    std::vector<double> waits;  ///< [s] longest that each did not get nearer to its goal
    std::size_t missions = 0;   ///< with Scene::swaps: how often all were at their goals
};

/// How others are told of.
enum class Told : std::uint8_t {
    velocity,  ///< and fly on at it (CONST_VEL of G-ORCA 11.4)
    commands,  ///< and the last of their commands, eight at most (BROADCAST)
};

/// One vehicle's tick, for tests that look closer.
struct Watched {
    double now;
    std::size_t vehicle;
    const FilterInput& input;
    const Decision& decision;
    const VelocityFilter& filter;  ///< once it has decided
};

struct Scene {
    std::vector<Agent> agents;
    std::vector<Body> bodies{};
    FilterSettings settings{};
    Plant plant{};
    double cruise = 0.6;      ///< [m/s]
    double near_goal = 0.15;  ///< [m]
    double until = 60.0;      ///< [s]
    double e_xy = 0.7;        ///< what is judged: conflict regions [m]
    double e_z = 0.45;
    bool knows_delay = true;  ///< own commands on their way, and the others' velocities, are reckoned with
    Told told = Told::velocity;
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

/// Vehicles on a circle that change places with those across.
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
