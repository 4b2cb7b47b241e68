// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/in_a_row.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "core/base/work_units.hpp"
#include "core/geometric/attempt.hpp"
#include "core/geometric/flown.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {
namespace {

using world::PlanStatus;

/// First parts that are tried: the cheapest, and the cheapest on another side.
constexpr int kFirstParts = 2;
/// No candidate on the other side is more expensive than one on this side by that.
constexpr float kOtherSide = 10.0F;

/// Radius of the main threat where none is met [m].
constexpr float kNothingMet = 0.01F;

/// The first part, as it was chosen.
struct Beginning {
    CandidateShape shape;
    Vec3 side = Vec3::Zero();
    Seconds duration = 0.0F;
    float total = 0.0F;
    std::uint16_t waypoints = 0;
};

/// What is met first on a straight flight.
struct Meeting {
    std::size_t threat = kNoThreat;
    geometry::Motion motion;
    float radius = 0.0F;
    float rate = 0.0F;
    Seconds when = 0.0F;
    float half_height = 0.0F;

    [[nodiscard]] float radius_at(Seconds t) const noexcept { return radius + t * rate; }
};

/// What a flight from `own` meets first within `horizon`, of threats and obstacles that are spheres to it; false when
/// nothing. O(threats + obstacles).
bool first_met(const Problem& problem, const geometry::Motion& own, const Vec3& half, Seconds horizon,
               WorkBudget& budget, Meeting& out) noexcept
{
    bool met = false;
    const auto look = [&](std::size_t index, const geometry::Motion& motion, const Vec3& box, float radius,
                          float rate) {
        const auto touch = geometry::contact_interval(box, own, motion, radius + rate * horizon, horizon);
        if (touch && (!met || touch->first < out.when)) {
            met = true;
            out = {index, motion, radius, rate, touch->first, box.z() - half.z()};
        }
    };
    const std::span tracks = world::of_kind(problem.threats, world::ThreatKind::track);
    const std::span obstacles = world::of_kind(problem.threats, world::ThreatKind::obstacle);
    const auto moving = std::count_if(obstacles.begin(), obstacles.end(), is_moving);
    const std::size_t all = tracks.size() + obstacles.size() - static_cast<std::size_t>(moving);
    if (!budget.spend(units::kSphereContact * static_cast<std::uint32_t>(all))) {
        return false;
    }
    for (const world::Threat& threat : tracks) {
        const AtStart start = at_start(problem, threat);
        look(static_cast<std::size_t>(&threat - tracks.data()), start.motion, threat.box_against(half),
             start.growth.radius, start.growth.rate + 0.5F * start.growth.acceleration * horizon);
    }
    for (const world::Threat& obstacle : obstacles) {
        if (obstacle.form == world::ThreatForm::point) {
            look(kNoThreat, {obstacle.position, Vec3::Zero()}, obstacle.box_against(half), obstacle.growth.radius,
                 0.0F);
        }
    }
    return met;
}

/// The problem of the second part: from the end of the first one back to the leg, around what is first in the way.
bool second_part(const Problem& problem, const Beginning& first, const vehicle::VehicleLimits& limits,
                 WorkBudget& budget, Problem& out) noexcept
{
    const Vec3 along = problem.frame.axes.col(0);
    const float aside = std::abs(first.shape.offset);
    const float top = scale_of(problem);
    out = problem;
    out.begins = problem.begins + first.duration;
    out.frame.origin = problem.frame.origin + top * along + aside * first.side;
    out.start_velocity = vehicle::clamped_velocity(along, problem.speed, limits);
    out.preferred_side = Vec3::Zero();
    out.main_shape = nullptr;
    out.main_half_height = 0.0F;
    // Twice: where it ends on the leg depends on what is met, and that on the way there.
    float back = top;
    for (int look = 0; look < 2; ++look) {
        if (top + back > problem.straight) {
            return false;  // it would end where the way goes elsewhere
        }
        const Vec3 way = back * along - aside * first.side;
        const Vec3 velocity = vehicle::clamped_velocity(way, problem.speed, limits);
        const float speed = velocity.norm();
        Meeting met;
        out.frame = make_path_frame(out.frame.origin, way);
        if (!first_met(out, {out.frame.origin, velocity}, limits.half_extents, way.norm() / speed, budget, met)) {
            // Something that is no sphere, or that the flight comes too near to: a little to a side may do.
            out.main = kNoThreat;
            out.distance = 0.5F * way.norm();
            out.apex_share = 1.0F;
            out.main_radius = kNothingMet;
            out.body_radius = 0.0F;
            out.main_centre_offset = Vec3::Zero();
            return !budget.exhausted();
        }
        const Vec3 closing = velocity - met.motion.velocity;
        const float squared = closing.squaredNorm();
        const Vec3 apart = met.motion.position - out.frame.origin;
        const Seconds when = squared > 0.0F ? std::max(apart.dot(closing) / squared, 0.0F) : 0.0F;
        out.distance = when * speed;
        out.main = met.threat;
        out.main_radius = met.radius_at(when);
        out.main_half_height = met.half_height;
        out.main_centre_offset =
            met.motion.position + when * met.motion.velocity - (out.frame.origin + when * velocity);
        // So near to the main threat the next one often is nearer than the 2.5 R; whether a curve clears it is checked.
        out.body_radius = std::min(out.main_radius, largest_radius(out.distance));
        out.apex_share = out.distance > 0.0F ? 0.5F * way.norm() / out.distance : 0.0F;
        const float reach = 4.0F * out.distance * out.distance - aside * aside;
        back = reach > 0.0F ? std::max(std::sqrt(reach), 0.5F * top) : top;
    }
    return out.body_radius > 0.0F;
}

/// Working memory: the whole path about the start, and its flight.
struct Whole {
    Whole(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept
        : flown(problem, settings, limits)
    {
    }
    UnitCurve unit;
    Curve curve;
    path::TimedPath path;
    Flown flown;
};
static_assert(sizeof(Whole) <= Workspace::kBytes);

/// Puts the first part before the second one, which is in `result`, and flies both.
bool join_parts(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                const Beginning& first, WorkBudget& budget, Workspace& workspace, Result& result) noexcept
{
    Whole& whole = *new (workspace.bytes()) Whole(problem, settings, limits);
    whole.unit = make_unit_curve(first.shape.family, first.waypoints, 1.0F);
    make_curve(whole.unit, problem.frame.axes.col(0), plane_direction(problem.frame, first.shape.plane),
               scale_of(problem), first.shape.offset, problem.speed, limits, whole.curve);
    to_timed_path(whole.curve, Vec3::Zero(), whole.path);
    whole.path.points.pop_back();  // where the second part begins
    for (path::PathPoint point : result.path.points) {
        point.position -= problem.frame.origin;
        point.time += first.duration;
        whole.path.points.unchecked_push_back(point);  // parts_of has seen to the space
    }
    if (!budget.spend(units::kCandidatePoint * static_cast<std::uint32_t>(whole.path.points.size()))) {
        return false;
    }
    WorkBudget checks = budget.part(settings.check_units);
    const bool is_short = checks.left() < settings.check_units;
    const bool clear = whole.flown.judge(whole.path, 0.0F, checks).status == CandidateStatus::available;
    budget.charge(checks);
    if (checks.exhausted() && is_short) {
        budget.exhaust();  // it was the budget that did not do
    }
    result.cut_short = result.cut_short || checks.exhausted();
    if (!clear) {
        return false;
    }
    result.path = whole.path;
    for (path::PathPoint& point : result.path.points) {
        point.position += problem.frame.origin;
    }
    Candidate& chosen = result.candidates[result.chosen];
    chosen.duration = result.path.duration();
    chosen.total = std::max(chosen.total, first.total);
    result.side = first.side;
    return true;
}

}  // namespace

PlanStatus solve_in_a_row(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                          const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace,
                          Result& result) noexcept
{
    // One of each for both parts: a microcontroller's stack is small.
    Problem part_of = problem;
    Settings with = settings;
    const auto first_points = static_cast<std::uint16_t>(std::max(settings.waypoints / 2 + 1, 8));
    PlanStatus status = PlanStatus::none_available;
    bool cut_short = false;
    const auto solve_part = [&] {
        status = solve_valid(part_of, with, limits, airframe, budget, workspace, result);
        cut_short = cut_short || result.cut_short;
        result.cut_short = cut_short;
    };
    Vec3 side = problem.preferred_side;
    for (int part = 0; part < kFirstParts; ++part) {
        part_of = problem;
        part_of.ends_at_top = true;
        part_of.preferred_side = side;
        with.waypoints = first_points;
        with.escape_from_margin = settings.escape_from_margin;
        solve_part();
        if (status != PlanStatus::found) {
            break;
        }
        const Candidate& chosen = result.candidates[result.chosen];
        const Beginning first{chosen.shape, result.side, chosen.duration, chosen.total, first_points};
        status = PlanStatus::none_available;
        if (second_part(problem, first, limits, budget, part_of)) {
            with.waypoints =
                static_cast<std::uint16_t>(std::min<std::size_t>(settings.waypoints, kMaxPathPoints - first_points));
            with.escape_from_margin = false;  // the whole is judged by it
            solve_part();
        }
        if (status == PlanStatus::found && join_parts(problem, settings, limits, first, budget, workspace, result)) {
            return status;
        }
        cut_short = result.cut_short;
        side = -first.side;
        with.flip_penalty = kOtherSide;
    }
    result.path.points.clear();
    const bool is_spent = status == PlanStatus::budget_spent || budget.exhausted();
    result.cut_short = result.cut_short || is_spent;
    return is_spent ? PlanStatus::budget_spent : PlanStatus::none_available;
}

}  // namespace jink::geometric::detail
