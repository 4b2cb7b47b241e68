// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/planner.hpp"

#include <algorithm>

#include "core/base/work_units.hpp"
#include "core/geometric/along_reference.hpp"
#include "core/geometric/attempt.hpp"
#include "core/geometric/in_a_row.hpp"
#include "core/world/conflict.hpp"
#include "core/world/passing_side.hpp"
#include "core/world/threat_set.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;
using world::Situation;

static_assert(world::AvoidanceMethod<Planner>);

const world::Threat& main_threat(const Situation& situation, const world::Conflict& conflict) noexcept
{
    return world::of_kind(situation.threats, conflict.threat.kind)[conflict.threat.index];
}

/// How far the vehicle goes until it answers, 0 where the start is not moved there.
Vec3 way_until_answer(const Situation& situation, const Settings& settings) noexcept
{
    return situation.own.velocity * (settings.starts_after_latency ? situation.rules.latency : 0.0F);
}

Problem problem_of(const Situation& situation, const world::Way& way, const world::Conflict& conflict,
                   bool keeps_soft_margins, const Settings& settings) noexcept
{
    const world::Threat& main = main_threat(situation, conflict);
    Problem problem;
    problem.frame = make_path_frame(way.origin, way.direction);
    problem.distance = (conflict.own_at_closest - way.origin).norm();
    problem.main_radius = std::max(conflict.radius_at_closest, Planner::kMinMainRadius);
    problem.keeps_soft_margins = keeps_soft_margins;
    if (conflict.threat.kind == world::ThreatKind::track) {
        problem.body_radius = std::max(main.track->radius, Planner::kMinMainRadius);
    }
    problem.threats = situation.threats;
    problem.rules = situation.rules;
    problem.start_velocity = situation.own.velocity;
    problem.speed = way.speed;
    // Where both give way, a side that both know comes before the side that is flown.
    problem.preferred_side = world::passing_side(situation, main);
    if (problem.preferred_side == Vec3::Zero() && situation.flying != nullptr) {
        problem.preferred_side = situation.flying->side;
    }
    problem.main_centre_offset = conflict.threat_at_closest - conflict.own_at_closest;
    if (conflict.threat.kind == world::ThreatKind::track) {
        problem.main = conflict.threat.index;
        problem.main_half_height = main.half_height;
    } else if (conflict.threat.kind == world::ThreatKind::obstacle) {
        problem.main_shape = main.solid->kind == geometry::ShapeKind::sphere ? nullptr : main.solid;
        problem.main_clearance = world::own_uncertainty(situation) + main.slack;
    } else {
        problem.main_radius += keeps_soft_margins ? main.cylinder->margin : 0.0F;
        // A body that is large beside the distance to it is passed by the curves that are as long as that allows.
        const float left = problem.distance - way_until_answer(situation, settings).norm();
        problem.body_radius = std::clamp(largest_radius(left), Planner::kMinMainRadius, problem.main_radius);
    }
    detail::follow_route(situation, way, conflict, problem);
    return problem;
}

/// The conflict to plan for, and the way that it is on. Off a leg, curves about the line on which the vehicle comes
/// back to it are clear more often than curves that bend where the way does: conflicts on that line, taken beyond the
/// leg, are planned for first.
bool find_conflict(const Situation& situation, Seconds lookahead, WorkBudget& budget, world::Way& way,
                   world::Conflict& conflict) noexcept
{
    const path::RouteAhead ahead = way.ahead;
    if (detail::is_leg(ahead.route) && ahead.joined_at < ahead.route.length()) {
        way.ahead = {ahead.route, way.length, ahead.route.length()};
        if (world::main_conflict(situation, way, lookahead, budget, conflict)) {
            return true;
        }
        way.ahead = ahead;
    }
    return world::main_conflict(situation, way, lookahead, budget, conflict);
}

/// Moves the start to where the vehicle is when it answers. How long that takes, 0 where it is not moved [s].
Seconds move_start(const Situation& situation, const Vec3& collision_point, const Settings& settings, Problem& problem,
                   WorkBudget& budget) noexcept
{
    const Seconds latency = situation.rules.latency;
    const Vec3 way = way_until_answer(situation, settings);
    const Vec3 left = collision_point - problem.frame.origin - way;
    const float least = std::max(Planner::kMinLeadRatio * way.norm(), kMinDistanceInRadii * scale_radius(problem));
    if (!(way.squaredNorm() > 0.0F) || left.norm() < least || settings.waypoints >= kMaxPathPoints) {
        return 0.0F;
    }
    // Within a margin the escape rule counts from where the vehicle is.
    if (world::separation_at(situation, problem.frame.origin + way, latency, budget).margin < 0.0F) {
        return 0.0F;
    }
    if (!problem.ahead.route.empty()) {
        return detail::move_start_along(situation, way, least, problem) ? latency : 0.0F;
    }
    problem.frame = make_path_frame(problem.frame.origin + way, left);
    problem.distance = left.norm();
    problem.straight -= way.norm();  // of which it has far more: follow_route has seen to it
    return latency;
}

/// `path` from its start, with the way to there before it.
void join(const Vec3& from, const Vec3& velocity, Seconds lead, const path::TimedPath& path,
          path::TimedPath& out) noexcept
{
    out.points.clear();
    if (lead > 0.0F) {
        out.points.unchecked_push_back({from, velocity, 0.0F});
    }
    for (path::PathPoint point : path.points) {
        point.time += lead;
        out.points.unchecked_push_back(point);  // move_start has checked the space for one more
    }
}

/// The settings of one attempt; false where it has nothing to add.
bool apply(const Attempt& attempt, vehicle::VehicleKind kind, Settings& settings) noexcept
{
    using Kind = Attempt::Kind;
    const bool waits = attempt.kind == Kind::wait;
    if (kind == vehicle::VehicleKind::fixed_wing && (attempt.speed_share < 1.0F || waits)) {
        return false;
    }
    if (settings.offset_rule == OffsetRule::source && (attempt.span_from > 0.0F || attempt.kind != Kind::as_set)) {
        return false;
    }
    const bool in_a_row = attempt.kind == Kind::in_a_row;
    if (in_a_row && settings.security == SecurityMode::swept) {
        return false;
    }
    if (attempt.kind == Kind::plateau || waits || in_a_row) {
        settings.simple = settings.symmetric = settings.smooth = settings.wait = false;
        settings.symmetric = in_a_row;
        settings.plateau = attempt.kind == Kind::plateau;
        settings.wait = waits;
        settings.extra_planes = waits ? 0 : settings.extra_planes;
    }
    if (attempt.kind == Kind::more_planes) {
        // As many candidates as before: where there is one offset a side already, one of Pinheiro's families.
        settings.simple = settings.simple && (settings.offsets > 2 || !settings.symmetric);
        settings.extra_planes = static_cast<std::uint16_t>(2U * settings.extra_planes + 1U);
        settings.offsets = static_cast<std::uint16_t>(std::max(settings.offsets / 4 * 2, 2));
    }
    return is_valid(settings);
}

}  // namespace

PlanStatus solve_with_retries(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                              const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace,
                              Result& result, std::size_t& attempts) noexcept
{
    PlanStatus status = PlanStatus::none_available;
    attempts = 0;
    if (!vehicle::is_valid(limits) || !vehicle::is_valid(airframe) || !detail::has_valid_threats(problem, budget)) {
        return detail::refused(budget, result);
    }
    bool cut_short = false;
    for (std::size_t i = 0; i <= settings.retries && i < kAttempts.size() && status == PlanStatus::none_available;
         ++i) {
        const Attempt& attempt = kAttempts[i];
        Settings with = settings;
        if (i > 0 && !apply(attempt, limits.kind, with)) {  // the first is as set: refused there where it is invalid
            continue;
        }
        const bool in_a_row = attempt.kind == Attempt::Kind::in_a_row;
        if (in_a_row && !problem.ahead.route.empty()) {
            continue;  // both of its parts are about a straight leg
        }
        Problem tried = problem;
        tried.speed = attempt.speed_share * problem.speed;
        tried.span_from = attempt.span_from;
        tried.span_to = attempt.span_to;
        tried.apex_share = attempt.apex_share * problem.apex_share;
        status = in_a_row ? detail::solve_in_a_row(tried, with, limits, airframe, budget, workspace, result)
                          : detail::solve_valid(tried, with, limits, airframe, budget, workspace, result);
        result.attempt = i;
        ++attempts;
        cut_short = cut_short || result.cut_short;
    }
    result.cut_short = cut_short;
    return status;
}

bool Planner::configure(const Settings& settings) noexcept
{
    if (!is_valid(settings)) {
        return false;
    }
    settings_ = settings;
    return true;
}

PlanStatus Planner::plan(const Situation& situation, WorkBudget& budget, world::Manoeuvre& out) noexcept
{
    result_.candidates.clear();
    result_.chosen = 0;
    result_.cut_short = false;
    if (!world::is_complete(situation) || !is_valid(settings_)) {
        return PlanStatus::bad_input;
    }
    static_cast<void>(budget.spend(units::kPlan));
    world::Way way = world::way_of(situation);
    world::Conflict conflict;
    const bool found = find_conflict(situation, situation.rules.lookahead, budget, way, conflict);
    if (budget.exhausted()) {
        result_.cut_short = true;
        return PlanStatus::budget_spent;
    }
    if (!found) {
        return PlanStatus::no_conflict;
    }
    const std::span areas = world::of_kind(situation.threats, world::ThreatKind::cylinder);
    const bool soft =
        std::any_of(areas.begin(), areas.end(), [](const auto& area) { return area.cylinder->margin > 0.0F; });
    Problem problem;
    PlanStatus status = PlanStatus::none_available;
    for (const bool keeps_soft_margins : {soft, false}) {
        problem = problem_of(situation, way, conflict, keeps_soft_margins, settings_);
        if (problem.distance < kMinDistanceInRadii * scale_radius(problem)) {
            return PlanStatus::too_close;
        }
        problem.lead = move_start(situation, conflict.own_at_closest, settings_, problem, budget);
        std::size_t attempts = 0;
        status = solve_with_retries(problem, settings_, situation.limits, situation.airframe, budget, workspace_,
                                    result_, attempts);
        if (status == PlanStatus::found || !keeps_soft_margins || budget.exhausted()) {
            break;
        }
    }
    if (status != PlanStatus::found) {
        return status;
    }
    out.kind = world::ManoeuvreKind::follow_path;
    out.start = situation.now;
    out.command = Vec3::Zero();
    out.side = result_.side;
    out.cost = result_.candidates[result_.chosen].total;
    join(situation.own.position, situation.own.velocity, problem.lead, result_.path, out.path);
    out.valid_until = situation.now + out.path.duration();
    return status;
}

}  // namespace jink::geometric
