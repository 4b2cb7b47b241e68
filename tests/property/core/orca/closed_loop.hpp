// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/base/random.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/property/core/orca/closed_loop_scene.hpp"
#include "tests/reference/orca/broadcast.hpp"

// Vehicles that each fly by a VelocityFilter of their own, closed over a plant in double precision with delays, and a
// judge that is independent of the filter: distances of centres across and in height, and of obstacles by Wolfe's
// method.

namespace jink::orca::closed_loop {

class World {
public:
    explicit World(const Scene& scene) : scene_(scene), random_(scene.plant.seed), dice_(scene.plant.seed + 1000)
    {
        FilterSettings settings = scene.settings;
        settings.limits.period = float(scene.plant.period);
        settings.own_stale = float(scene.plant.sense) + 0.2F;
        settings.loop =
            scene.knows_delay ? VelocityLoop{float(scene.plant.act), float(scene.plant.known_lag())} : VelocityLoop{};
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
        threats_ = jink::oracle::threats_of(obstacles_);
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
        std::deque<Vec3d> commands;  ///< newest first, one a period, issued from the first tick on
        Vec3d rate = Vec3d::Zero();  ///< of the velocity, where its loop is of second order
        std::uint64_t issued = 0;
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
    /// As reported: delayed, with noise.
    [[nodiscard]] State reported(const Vehicle& v)
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

    /// The others' prediction of vehicle `j`, with all reports delayed by `age`.
    [[nodiscard]] Predicted seen_of(std::size_t j, double age)
    {
        const State seen = reported(vehicles_[j]);
        const double ahead = scene_.knows_delay ? age + scene_.plant.act : 0.0;
        if (!scene_.knows_delay || scene_.reported == Reported::velocity) {
            return {(seen.at + ahead * seen.velocity).cast<float>(), seen.velocity.cast<float>(), false};
        }
        Broadcast heard;
        heard.state.stamp = stamp(now_ - age);
        heard.state.position = seen.at.cast<float>();
        heard.state.velocity = seen.velocity.cast<float>();
        heard.loop = filters_[j].settings().loop;
        // Commands in transit at the time of the state; each represents as many as must share its slot.
        const Vehicle& v = vehicles_[j];
        const auto tick = std::llround(now_ / scene_.plant.period);
        const auto reported_at = tick - std::llround(age / scene_.plant.period);
        const auto on_their_way = std::llround(scene_.plant.act / scene_.plant.period) + 1;
        const auto share = std::max<long long>(1, (on_their_way + 7) / 8);
        const auto issued = static_cast<long long>(v.issued);
        for (auto k = reported_at - share * 7; k <= reported_at; k += share) {
            const auto back = issued - 1 - k;
            if (k >= 0 && back >= 0 && back < static_cast<long long>(v.commands.size())) {
                const Vec3d& command = v.commands[static_cast<std::size_t>(back)];
                static_cast<void>(
                    heard.commands.try_push_back({stamp(double(k) * scene_.plant.period), command.cast<float>()}));
            }
        }
        const PredictedNeighbour there =
            predict_neighbour(heard, stamp(now_) + float(scene_.plant.act), AgeRules{}, 1e6F);
        return {there.position, there.velocity, false};
    }

    void decide(std::size_t i)
    {
        Vehicle& v = vehicles_[i];
        VelocityFilter& filter = filters_[i];
        const TimePoint now = stamp(now_);
        const double age = double(v.past.size() - 1) * scene_.plant.period;
        const State own = reported(v);
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
            const Predicted seen = seen_of(j, age);
            Neighbour n;
            n.position = seen.position - input.own.position;
            n.velocity = seen.velocity;
            n.half_width = filter.settings().half_width;
            n.half_height = filter.settings().half_height;
            n.max_speed = filter.settings().limits.max_speed;
            n.acceleration = filter.settings().limits.acceleration;
            n.id = static_cast<std::uint32_t>(j + 1);
            neighbours.push_back(n);
        }
        input.neighbours = neighbours;
        input.obstacles = threats_;
        WorkBudget budget(1'000'000);
        const Decision decision = filter.decide(input, budget);
        static_cast<void>(filter.issued(now, decision.command));
        note(v, decision, filter.settings().limits);
        if (scene_.watch) {
            scene_.watch({now_, i, input, decision, filter});
        }
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
        ++v.issued;
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
                follow(v, command, h);
                out_.climb = std::max(out_.climb, std::abs(v.velocity.z()));
            }
            measure();
        }
    }

    void follow(Vehicle& v, const Vec3d& command, double h) const
    {
        const Plant& plant = scene_.plant;
        if (plant.natural > 0.0) {
            constexpr int kSteps = 4;
            for (int step = 0; step < kSteps; ++step) {
                v.rate += (h / kSteps) * (plant.natural * plant.natural * (command - v.velocity) -
                                          2.0 * plant.damping * plant.natural * v.rate);
                v.velocity += (h / kSteps) * v.rate;
                v.at += (h / kSteps) * v.velocity;
            }
            return;
        }
        const double share = plant.lag > 0.0 ? std::exp(-h / plant.lag) : 0.0;
        const Vec3d off = v.velocity - command;
        v.at += command * h + off * (plant.lag * (1.0 - share));
        v.velocity = command + share * off;
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
                if (body.lower_bound(v.at, stretch) / double(kept.horizontal) < out_.obstacle) {
                    out_.obstacle = std::min(out_.obstacle, body.distance(v.at, stretch) / double(kept.horizontal));
                }
            }
            double way = (v.goal - v.at).norm();
            if (way < scene_.near_goal && scene_.there_and_back && !v.returns) {
                v.returns = true;
                v.goal = scene_.agents[i].start;
                v.best_way = 1e9;
                way = (v.goal - v.at).norm();
            }
            if (way < v.best_way - 0.01 || way < scene_.near_goal || now_ < scene_.agents[i].wait) {
                v.best_way = way;
                v.best_at = now_;
            }
            out_.waits[i] = std::max(out_.waits[i], now_ - v.best_at);
            all = all && way < scene_.near_goal && (v.returns || !scene_.there_and_back);
        }
        if (all && scene_.swaps) {
            ++out_.missions;
            swap();
        } else if (all) {
            out_.time = now_;
        }
    }

    /// Each start becomes the goal of another vehicle than now: Sattolo's shuffle of the goals.
    void swap()
    {
        for (std::size_t i = vehicles_.size() - 1; i > 0; --i) {
            std::swap(vehicles_[i].goal, vehicles_[dice_.below(i)].goal);
        }
        for (Vehicle& v : vehicles_) {
            v.best_way = 1e9;
        }
    }

    const Scene& scene_;
    Random random_;
    Random dice_;  ///< for swaps
    std::vector<VelocityFilter> filters_;
    std::vector<Vehicle> vehicles_;
    std::vector<world::Obstacle> obstacles_;
    std::vector<world::Threat> threats_;  ///< of the obstacles
    bool configured_ = true;
    double now_ = 0.0;
    double rate2_ = 0.0;
    Outcome out_;
};

}  // namespace jink::orca::closed_loop
