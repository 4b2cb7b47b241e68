// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "core/base/random.hpp"
#include "core/orca/velocity_filter.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

// Vehicles that each fly by a VelocityFilter of their own, closed over a plant in double precision with delays, and a
// judge that shares nothing with the filter: distances of centres across and in height, and of obstacles by Wolfe's
// method.

namespace jink::orca::closed_loop {

using Vec3d = Eigen::Vector3d;

/// How the world answers. Times in [s].
struct Plant {
    double period = 0.025;
    double sense = 0.0;  ///< everybody's states are told so late
    double act = 0.0;    ///< commands begin to act so late
    double lag = 0.0;    ///< of the velocity loop, first order
    double noise = 0.0;  ///< of what is told of velocities, standard deviation [m/s]
    std::uint64_t seed = 1;
};

struct Body {
    Vec3d centre;
    Vec3d half;            ///< box: half extents; capsule along `half`: to its end
    double radius = -1.0;  ///< of a capsule; below 0: a box
    std::vector<Vec3> hull{};

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
                for (const Vec3& vertex : hull) {
                    const Vec3d w = (centre + vertex.cast<double>() - point).cwiseProduct(scale);
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
    bool there_and_back = false;
};

class World {
public:
    explicit World(const Scene& scene) : scene_(scene), random_(scene.plant.seed)
    {
        FilterSettings settings = scene.settings;
        settings.limits.period = float(scene.plant.period);
        settings.own_stale = float(scene.plant.sense) + 0.2F;
        settings.loop =
            scene.knows_delay ? VelocityLoop{float(scene.plant.act), float(scene.plant.lag)} : VelocityLoop{};
        filters_.resize(scene.agents.size());
        for (std::size_t i = 0; i < filters_.size(); ++i) {
            settings.own_id = static_cast<std::uint32_t>(i + 1);
            Vehicle& v = vehicles_.emplace_back();
            v.at = scene.agents[i].start;
            v.goal = scene.agents[i].goal;
            configured_ = filters_[i].configure(settings) == Unsafe::none && configured_;
        }
        for (const Body& body : scene.bodies) {
            obstacles_.push_back({static_cast<world::ObstacleId>(obstacles_.size()), body.shape()});
        }
        out_.waits.resize(scene.agents.size(), 0.0);
    }

    [[nodiscard]] bool configured() const { return configured_; }

    Outcome fly()
    {
        const auto ticks = static_cast<int>(scene_.until / scene_.plant.period);
        for (int tick = 0; tick < ticks && out_.time < 0.0; ++tick) {
            now_ = tick * scene_.plant.period;
            remember();
            for (std::size_t i = 0; i < vehicles_.size(); ++i) {
                decide(i);
            }
            move();
            judge();
        }
        out_.command_rate = std::sqrt(rate2_ / std::max<double>(1.0, double(out_.solves)));
        return out_;
    }

private:
    struct State {
        Vec3d at = Vec3d::Zero();
        Vec3d velocity = Vec3d::Zero();
    };
    struct Vehicle : State {
        Vec3d goal;
        bool returns = false;
        std::deque<State> past;      ///< newest first, one a period
        std::deque<Vec3d> commands;  ///< newest first
        Vec3d change = Vec3d::Zero();
        double best_way = 1e9;
        double best_at = 0.0;
    };

    static constexpr std::int64_t kStart = 1'000'000'000;
    [[nodiscard]] TimePoint stamp(double t) const { return {kStart + std::llround(t * 1e6)}; }
    [[nodiscard]] std::size_t late() const
    {
        return std::size_t(std::lround(scene_.plant.sense / scene_.plant.period));
    }

    void remember()
    {
        for (Vehicle& v : vehicles_) {
            v.past.push_front(v);
            if (v.past.size() > late() + 1) {
                v.past.pop_back();
            }
        }
    }
    /// As told: late, and with noise.
    [[nodiscard]] State told(const Vehicle& v)
    {
        State out = v.past.back();
        const auto noise = float(scene_.plant.noise);
        for (int k = 0; k < 3 && noise > 0.0F; ++k) {
            out.velocity[k] += double(noise * random_.normal());
        }
        return out;
    }
    [[nodiscard]] Vec3d wanted(std::size_t i, const State& from) const
    {
        if (now_ < scene_.agents[i].wait) {
            return Vec3d::Zero();
        }
        const Vec3d way = vehicles_[i].goal - from.at;
        return way.norm() > scene_.cruise ? Vec3d(way * (scene_.cruise / way.norm())) : way;
    }

    void decide(std::size_t i)
    {
        Vehicle& v = vehicles_[i];
        VelocityFilter& filter = filters_[i];
        const TimePoint now = stamp(now_);
        const double age = double(v.past.size() - 1) * scene_.plant.period;
        const State own = told(v);
        vehicle::VehicleState measured;
        measured.stamp = scene_.knows_delay ? stamp(now_ - age) : now;
        measured.position = own.at.cast<float>();
        measured.velocity = own.velocity.cast<float>();
        FilterInput input;
        input.own = scene_.knows_delay ? filter.predicted(measured, now)
                                       : Predicted{measured.position, measured.velocity, false};
        input.own_age = float(scene_.knows_delay ? age : 0.0);
        input.preferred = wanted(i, own).cast<float>();
        std::vector<Neighbour> neighbours;
        for (std::size_t j = 0; j < vehicles_.size(); ++j) {
            if (j == i) {
                continue;
            }
            const State seen = told(vehicles_[j]);
            const double ahead = scene_.knows_delay ? age + scene_.plant.act : 0.0;
            Neighbour n;
            n.position = (seen.at + ahead * seen.velocity).cast<float>() - input.own.position;
            n.velocity = seen.velocity.cast<float>();
            n.half_width = filter.settings().half_width;
            n.half_height = filter.settings().half_height;
            n.max_speed = filter.settings().limits.max_speed;
            n.acceleration = filter.settings().limits.acceleration;
            n.id = static_cast<std::uint32_t>(j + 1);
            neighbours.push_back(n);
        }
        input.neighbours = neighbours;
        input.scene.obstacles = obstacles_;
        WorkBudget budget(1'000'000);
        const Decision decision = filter.decide(input, budget);
        static_cast<void>(filter.issued(now, decision.command));
        note(v, decision, filter.settings().limits);
    }

    void note(Vehicle& v, const Decision& decision, const MotionLimits& limits)
    {
        ++out_.solves;
        out_.warning += (decision.status & kRelaxedWarning) != 0 ? 1U : 0U;
        out_.conflict += (decision.status & kRelaxedConflict) != 0 ? 1U : 0U;
        out_.obstacle_relaxed += (decision.status & kRelaxedObstacle) != 0 ? 1U : 0U;
        out_.other += (decision.status & (kInfeasibleDynamics | kWorkLimit | kBadInput)) != 0 ? 1U : 0U;
        out_.blocked = out_.blocked || (decision.status & kBlocked) != 0;
        const bool fine = is_finite(decision.command) && decision.command.norm() <= limits.max_speed * 1.0001F;
        out_.outside += fine ? 0U : 1U;
        const Vec3d command = decision.command.cast<double>();
        const Vec3d last = v.commands.empty() ? Vec3d(Vec3d::Zero()) : v.commands.front();
        const Vec3d change = (command - last) / scene_.plant.period;
        rate2_ += change.squaredNorm();
        out_.turns += change.dot(v.change) < 0.0 && change.norm() > 0.05 ? 1U : 0U;
        v.change = change;
        v.commands.push_front(command);
        if (v.commands.size() > 256) {
            v.commands.pop_back();
        }
    }

    void move()
    {
        constexpr int kParts = 5;
        const double h = scene_.plant.period / kParts;
        const auto act = std::size_t(std::lround(scene_.plant.act / scene_.plant.period));
        for (int part = 0; part < kParts; ++part) {
            for (Vehicle& v : vehicles_) {
                const Vec3d command = act < v.commands.size() ? v.commands[act] : Vec3d(Vec3d::Zero());
                const double share = scene_.plant.lag > 0.0 ? std::exp(-h / scene_.plant.lag) : 0.0;
                const Vec3d off = v.velocity - command;
                v.at += command * h + off * (scene_.plant.lag * (1.0 - share));
                v.velocity = command + share * off;
                out_.climb = std::max(out_.climb, std::abs(v.velocity.z()));
            }
            measure();
        }
    }

    void measure()
    {
        for (std::size_t i = 0; i < vehicles_.size(); ++i) {
            for (std::size_t j = i + 1; j < vehicles_.size(); ++j) {
                const Vec3d d = vehicles_[j].at - vehicles_[i].at;
                const double across = std::hypot(d.x(), d.y());
                const double height = std::abs(d.z());
                out_.least = std::min(out_.least, d.norm());
                out_.least_across = std::min(out_.least_across, across);
                out_.ellipsoid = std::min(out_.ellipsoid, std::hypot(across / scene_.e_xy, height / scene_.e_z));
                out_.cylinder = std::min(out_.cylinder, std::max(across / scene_.e_xy, height / scene_.e_z));
            }
        }
    }

    void judge()
    {
        const ObstacleSettings& kept = scene_.settings.obstacles;
        const double stretch = double(kept.horizontal) / double(kept.vertical);
        bool all = true;
        for (std::size_t i = 0; i < vehicles_.size(); ++i) {
            Vehicle& v = vehicles_[i];
            for (const Body& body : scene_.bodies) {
                out_.obstacle = std::min(out_.obstacle, body.distance(v.at, stretch) / double(kept.horizontal));
            }
            const double way = (v.goal - v.at).norm();
            if (way < scene_.near_goal && scene_.there_and_back && !v.returns) {
                v.returns = true;
                v.goal = scene_.agents[i].start;
                v.best_way = 1e9;
            }
            if (way < v.best_way - 0.01 || way < scene_.near_goal || now_ < scene_.agents[i].wait) {
                v.best_way = way;
                v.best_at = now_;
            }
            out_.waits[i] = std::max(out_.waits[i], now_ - v.best_at);
            all = all && way < scene_.near_goal && (v.returns || !scene_.there_and_back);
        }
        if (all) {
            out_.time = now_;
        }
    }

    const Scene& scene_;
    Random random_;
    std::vector<VelocityFilter> filters_;
    std::vector<Vehicle> vehicles_;
    std::vector<world::Obstacle> obstacles_;
    bool configured_ = true;
    double now_ = 0.0;
    double rate2_ = 0.0;
    Outcome out_;
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
