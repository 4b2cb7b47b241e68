// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/oracle/problem_threats.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/cost/cost.hpp"
#include "core/geometric/planner.hpp"
#include "core/geometry/sweep.hpp"
#include "core/path/flight.hpp"

// `solve` without its optimisations: every candidate against every sphere on every segment by contact_interval, every
// flight flown by `follow` and `advance`, then checked. Time-aware, threats and airspace, the start of the manoeuvre in
// the world's origin. The list of candidates is that of `solve`.

namespace jink::geometric {

class PlainPlanner {
public:
    PlainPlanner(const ProblemThreats& threats, const Problem& problem, const Settings& settings,
                 const vehicle::VehicleLimits& limits)
        : world_(threats), problem_(problem), settings_(settings), limits_(limits)
    {
    }

    struct Answer {
        world::PlanStatus status = world::PlanStatus::none_available;
        std::vector<Candidate> candidates;
        std::size_t chosen = 0;
        path::TimedPath path;
    };

    Answer solve(std::vector<Candidate> candidates)
    {
        Answer answer;
        for (Candidate& c : candidates) {
            path::TimedPath path;
            EXPECT_TRUE(make_candidate_path(problem_, c.shape, settings_.waypoints, limits_, path));
            c.hit = {};
            c.status = verdict(path, c.hit);
            c.total = cost_of(c, path);
        }
        answer.candidates = std::move(candidates);
        while (try_cheapest(answer)) {
        }
        return answer;
    }

private:
    /// True: refused, and others may remain.
    bool try_cheapest(Answer& answer)
    {
        Candidate* best = nullptr;
        for (Candidate& c : answer.candidates) {
            if (c.status == CandidateStatus::available && c.total <= settings_.max_cost &&
                (best == nullptr || c.total + c.flip_penalty < best->total + best->flip_penalty)) {
                best = &c;
            }
        }
        if (best == nullptr) {
            return false;
        }
        EXPECT_TRUE(make_candidate_path(problem_, best->shape, settings_.waypoints, limits_, answer.path));
        if (settings_.verify_flight) {
            best->status = verdict(flown(answer.path), best->hit);
        }
        if (best->status != CandidateStatus::available) {
            return true;
        }
        best->status = CandidateStatus::chosen;
        answer.chosen = static_cast<std::size_t>(best - answer.candidates.data());
        answer.status = world::PlanStatus::found;
        return false;
    }

    float cost_of(const Candidate& c, const path::TimedPath& path) const
    {
        std::vector<float> y;
        const float step = curve_length_x(c.shape.family, 1.0F) / static_cast<float>(settings_.waypoints - 1);
        for (int i = 0; i < settings_.waypoints; ++i) {
            y.push_back(std::abs(c.shape.offset) * unit_offset(c.shape.family, step * static_cast<float>(i)));
        }
        std::vector<float> closeness;
        for (const Sphere& t : world_.threats) {
            if (t.motion.velocity.squaredNorm() > 0.0F) {
                closeness.push_back(cost::closeness(path, t.motion, t.radius, settings_.closeness));
            }
        }
        cost::Terms terms;
        terms.time = path.duration();
        terms.smoothness_penalised =
            cost::penalised_smoothness(cost::smoothness(problem_.distance * step, y, settings_.smoothness), c.sin_alpha,
                                       settings_.rotation_penalty);
        terms.closeness = cost::combined_closeness(closeness);
        return std::min(cost::total(cost::normalise(terms, settings_.caps), settings_.weights), 1.0F);
    }

    std::vector<path::PathPoint> flown(const path::TimedPath& path) const
    {
        constexpr float kMin = 1e-3F;
        std::vector<path::PathPoint> out{{Vec3::Zero(), problem_.start_velocity, 0.0F}};
        vehicle::VehicleState state;
        state.velocity = problem_.start_velocity;
        const float dt = std::max(0.2F, path.duration() / static_cast<float>(kMaxPathPoints - 13));
        const auto parts_of = [](float step, float longest) {
            return std::max(1, static_cast<int>(std::ceil(step / longest - 1e-3F)));
        };
        const float length = path.duration();
        const auto add = [&](float t) {
            out.back().velocity = (state.position - out.back().position) / (t - out.back().time);
            out.push_back({state.position, out.back().velocity, t});
        };
        for (int k = 1; length - out.back().time > kMin * dt; ++k) {
            const float from = out.back().time;
            const float to = length - static_cast<float>(k) * dt > kMin * dt ? static_cast<float>(k) * dt : length;
            const int parts = parts_of(dt, from >= 3.0F ? 0.25F : path::kFollowerPeriod);
            // Whole steps have the same length, independent of the rounding of their ends.
            const float part = (to == length ? to - from : dt) / static_cast<float>(parts);
            for (int i = 0; i < parts; ++i) {
                const float t = from + static_cast<float>(i) * part;
                vehicle::advance(state, command(path, t, part, state.position), limits_, part);
            }
            add(to);
        }
        if (limits_.kind == vehicle::VehicleKind::fixed_wing) {
            return out;
        }
        state.velocity = out.back().velocity;
        const float end = out.back().time;
        const float span = std::max(vehicle::stopping_time(state.velocity, limits_), 0.2F);
        for (int k = 1; k <= 11 && out.size() < kMaxPathPoints; ++k) {
            const float step = span / 11.0F;
            const float from = k == 1 ? 0.0F : static_cast<float>(k - 1) * step;
            const float to = k == 11 ? span : static_cast<float>(k) * step;
            vehicle::advance(state, Vec3::Zero(), limits_, to - from);
            add(to + end);
        }
        return out;
    }

    /// `follow`, or its average over a part longer than the follower's.
    Vec3 command(const path::TimedPath& path, float t, float part, const Vec3& position) const
    {
        if (part <= path::kFollowerPeriod) {
            return path::follow(path, t, position, limits_, problem_.rules.gains);
        }
        const float ahead = t + limits_.velocity_lag + 0.5F * (part - path::kFollowerPeriod);
        const auto after = [&](float at) {
            std::size_t next = 1;
            while (next + 1 < path.points.size() && path.points[next].time <= at) {
                ++next;
            }
            return next;
        };
        return path::detail::command(path, t, after(t), ahead, after(ahead), position, limits_, problem_.rules.gains);
    }

    CandidateStatus verdict(const path::TimedPath& path, world::ThreatRef& hit) const
    {
        return verdict(std::vector<path::PathPoint>(path.points.begin(), path.points.end()), hit);
    }

    CandidateStatus verdict(const std::vector<path::PathPoint>& points, world::ThreatRef& hit) const
    {
        if (const world::ThreatKind bound = left_airspace(points); bound != world::ThreatKind::none) {
            hit = {bound, 0};
            return CandidateStatus::hits_airspace;
        }
        for (const bool moving : {false, true}) {
            for (std::size_t i = 0; i < world_.threats.size(); ++i) {
                const Sphere& t = world_.threats[i];
                if ((t.motion.velocity.squaredNorm() > 0.0F) == moving && touches(points, t)) {
                    hit = {world::ThreatKind::track, static_cast<std::uint16_t>(i)};
                    return moving ? CandidateStatus::hits_moving : CandidateStatus::hits_static;
                }
            }
        }
        return CandidateStatus::available;
    }

    float shrunk_to_clear(float margin) const
    {
        return settings_.escape_from_margin && margin < 0.0F ? problem_.rules.escape.slack - margin : 0.0F;
    }
    float shrunk_at(float shrunk, float t) const { return std::max(0.0F, shrunk - problem_.rules.escape.speed * t); }

    bool touches(const std::vector<path::PathPoint>& points, const Sphere& t) const
    {
        const Vec3& half = limits_.half_extents;
        const float shrunk = shrunk_to_clear(
            geometry::least_distance(half, {}, {t.motion.position, Vec3::Zero()}, 0.0F).distance - t.radius);
        Vec3 before = points[0].position - t.motion.position;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const float start = points[i].time;
            const float duration = points[i + 1].time - start;
            const Vec3 after = points[i + 1].position - (t.motion.position + t.motion.velocity * points[i + 1].time);
            const float longest =
                problem_.rules.escape.speed > 0.0F
                    ? std::max(0.02F, 0.5F * problem_.rules.escape.slack / problem_.rules.escape.speed)
                    : duration;
            const int parts = shrunk_at(shrunk, start) > 0.0F
                                  ? std::max(1, static_cast<int>(std::ceil(duration / std::max(longest, 0.02F))))
                                  : 1;
            Vec3 from = before;
            for (int part = 1; part <= parts; ++part) {
                const float share = static_cast<float>(part) / static_cast<float>(parts);
                const Vec3 to = before + share * (after - before);
                const float end = start + share * duration;
                const float radius =
                    t.radius + end * (t.radius_rate + 0.5F * t.radius_acceleration * end) - shrunk_at(shrunk, end);
                if (radius >= 0.0F && geometry::contact_interval(half, {}, {-from, from - to}, radius, 1.0F)) {
                    return true;
                }
                from = to;
            }
            before = after;
        }
        return false;
    }

    world::ThreatKind left_airspace(const std::vector<path::PathPoint>& points) const
    {
        const world::Airspace& air = world_.airspace;
        const Vec3& half = limits_.half_extents;
        const float floor = air.floor + half.z();
        const float ceiling = air.ceiling - half.z();
        const float radius = air.keep_in_radius - std::sqrt(half.x() * half.x() + half.y() * half.y());
        for (const path::PathPoint& p : points) {
            if (air.has_floor && p.position.z() - floor + shrunk_at(shrunk_to_clear(-floor), p.time) < 0.0F) {
                return world::ThreatKind::floor;
            }
            if (air.has_ceiling && ceiling - p.position.z() + shrunk_at(shrunk_to_clear(ceiling), p.time) < 0.0F) {
                return world::ThreatKind::ceiling;
            }
            const float x = p.position.x() - air.home.x();
            const float y = p.position.y() - air.home.y();
            const float reach = radius + shrunk_at(shrunk_to_clear(radius - air.home.head<2>().norm()), p.time);
            if (air.has_keep_in && (reach < 0.0F || x * x + y * y > reach * reach)) {
                return world::ThreatKind::keep_in;
            }
        }
        return world::ThreatKind::none;
    }

    const ProblemThreats& world_;
    const Problem& problem_;
    const Settings& settings_;
    const vehicle::VehicleLimits& limits_;
};

}  // namespace jink::geometric
