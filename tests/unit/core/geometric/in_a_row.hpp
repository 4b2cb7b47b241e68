// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/geometric/in_a_row.hpp"
#include "core/world/obstacle_distance.hpp"
#include "tests/unit/core/geometric/scene.hpp"

// Two-stage manoeuvres, and their second stage in double precision: the contact on the straight path back to the leg by
// dense sampling and bisection.

namespace jink::geometric {

using Vec3d = Eigen::Vector3d;

/// A main threat 20 m ahead, and both stages, also around threats after it.
struct InARow : Scene {
    Workspace workspace;

    InARow()
    {
        settings.simple = settings.check_acceleration = false;
        settings.offsets = 8;
        problem.speed = 2.0F;
        problem.start_velocity = Vec3(2.0F, 0.0F, 0.0F);
    }
    world::PlanStatus run_in_a_row()
    {
        put_into(problem);
        return detail::solve_in_a_row(problem, settings, limits, airframe, budget, workspace, result);
    }
    [[nodiscard]] std::uint16_t first_points() const
    {
        return static_cast<std::uint16_t>(std::max(settings.waypoints / 2 + 1, 8));
    }
    /// The cheapest curve that ends beside the main threat; on another side than `not_on` if given.
    world::PlanStatus first_part(Result& first, const Vec3& not_on = Vec3::Zero())
    {
        put_into(problem);
        Problem part = problem;
        part.ends_at_top = true;
        Settings with = settings;
        with.waypoints = first_points();
        if (not_on != Vec3::Zero()) {
            part.preferred_side = -not_on;
            with.flip_penalty = 10.0F;
        }
        WorkBudget unlimited(100'000'000);
        return solve(part, with, limits, airframe, unlimited, first);
    }
};

/// The point at `share` of the path from beside the main threat to the leg, 20 m on.
inline Vec3 on_way_back(InARow& scene, float share)
{
    auto first = std::make_unique<Result>();
    EXPECT_EQ(scene.first_part(*first), world::PlanStatus::found);
    const Vec3 beside = std::abs(first->candidates[first->chosen].shape.offset) * first->side;
    return Vec3(20.0F, 0.0F, 50.0F) + (1.0F - share) * beside + share * Vec3(20.0F, 0.0F, 0.0F);
}

/// The first contact of a straight flight, with a body that grows linearly to its size at the flight's end.
struct Met {
    bool any = false;
    double first = 0.0;
    Vec3d position, velocity;
    double radius = 0.0;
    double at_end = 0.0;
};

inline double gap(const Vec3d& half, const Vec3d& apart) { return (apart.cwiseAbs() - half).cwiseMax(0.0).norm(); }

/// `met`, or this sphere if the contact is earlier; `at_end`: its size at the end.
inline void look(const Vec3d& half, const Vec3d& from, const Vec3d& velocity, double duration, const Met& sphere,
                 Met& met)
{
    const auto distance = [&](double t) {
        return gap(half, sphere.position + t * sphere.velocity - from - t * velocity) - sphere.at_end;
    };
    constexpr int kSteps = 4000;
    int i = 0;
    while (i <= kSteps && distance(duration * i / kSteps) > 0.0) {
        ++i;
    }
    if (i > kSteps) {
        return;
    }
    double outside = duration * std::max(i - 1, 0) / kSteps;
    double touching = duration * i / kSteps;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (outside + touching);
        (distance(middle) > 0.0 ? outside : touching) = middle;
    }
    if (!met.any || touching < met.first) {
        met = sphere;
        met.any = true;
        met.first = touching;
    }
}

inline Met first_met(const Problem& problem, const Vec3& half, const Vec3d& from, const Vec3d& velocity, double begins,
                     double duration)
{
    Met met;
    for (const world::Threat& threat : problem.threats) {
        if (threat.form != world::ThreatForm::point) {
            continue;
        }
        const auto radius = [&](double t) {
            return double(threat.growth.radius) +
                   t * (double(threat.growth.rate) + 0.5 * double(threat.growth.acceleration) * t);
        };
        const Vec3d v = threat.velocity.cast<double>();
        look(half.cast<double>(), from, velocity, duration,
             {false, 0.0, threat.position.cast<double>() + begins * v, v, radius(begins), radius(begins + duration)},
             met);
    }
    return met;
}

/// The problem of the second stage: from beside the main threat back to the leg, around the first contact on that path.
/// The path ends at twice the contact's distance, and at least half the main threat's distance farther; false without
/// such a manoeuvre.
inline bool second_problem(const InARow& scene, const Result& first, Problem& out)
{
    const Problem& problem = scene.problem;
    const CandidateShape& shape = first.candidates[first.chosen].shape;
    const Vec3d along = Vec3(problem.frame.axes.col(0)).cast<double>();
    const Vec3d side = first.side.cast<double>();
    const double aside = std::abs(double(shape.offset));
    const double top = double(scale_of(problem));
    const double begins = double(first.candidates[first.chosen].duration);
    const Vec3d from = problem.frame.origin.cast<double>() + top * along + aside * side;
    out = problem;
    out.begins += static_cast<float>(begins);
    out.start_velocity = vehicle::clamped_velocity(problem.frame.axes.col(0), problem.speed, scene.limits);
    out.preferred_side = Vec3::Zero();
    double back = top;
    for (int i = 0; i < 2; ++i) {
        if (top + back > double(problem.straight)) {
            return false;
        }
        const Vec3d way = back * along - aside * side;
        const Vec3d velocity = vehicle::clamped_velocity(way.cast<float>(), problem.speed, scene.limits).cast<double>();
        const double speed = velocity.norm();
        out.frame = make_path_frame(from.cast<float>(), way.cast<float>());
        const double duration = way.norm() / speed;
        const Met met =
            first_met(problem, scene.limits.half_extents, from, velocity, begins + double(problem.begins), duration);
        if (!met.any) {
            out.main = kNoThreat;
            out.main_radius = 0.01F;
            out.body_radius = 0.0F;
            out.main_centre_offset = Vec3::Zero();
            out.distance = static_cast<float>(0.5 * way.norm());
            out.apex_share = 1.0F;
            return true;
        }
        // The closest approach of the centres, by golden section, also past the end.
        const auto apart = [&](double t) { return Vec3d(met.position + t * met.velocity - from - t * velocity); };
        double low = 0.0;
        double high = 100.0 * duration;
        for (int k = 0; k < 200; ++k) {
            const double a = high - 0.6180339887498949 * (high - low);
            const double b = low + 0.6180339887498949 * (high - low);
            (apart(a).norm() < apart(b).norm() ? high : low) = apart(a).norm() < apart(b).norm() ? b : a;
        }
        const double when = 0.5 * (low + high);
        const double distance = when * speed;
        const double radius = met.radius + (met.at_end - met.radius) * when / duration;
        if (!(distance > 1e-6) || !(radius > 0.0)) {
            return false;
        }
        out.main = kNoThreat;
        out.distance = static_cast<float>(distance);
        out.apex_share = static_cast<float>(0.5 * way.norm() / distance);
        out.main_radius = static_cast<float>(radius);
        out.body_radius = static_cast<float>(std::min(radius, 0.99 * distance / double(kMinDistanceInRadii)));
        out.main_centre_offset = apart(when).cast<float>();
        const double squared = 4.0 * distance * distance - aside * aside;
        back = squared > 0.0 ? std::max(std::sqrt(squared), 0.5 * top) : top;
    }
    return true;
}

}  // namespace jink::geometric
