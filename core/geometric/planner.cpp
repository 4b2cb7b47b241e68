// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/planner.hpp"

#include <algorithm>

#include "core/world/conflict.hpp"
#include "core/world/method.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;
using world::Situation;

static_assert(world::AvoidanceMethod<Planner>);

/// The track with its growth as a polynomial of time from now: equal to world::threat_radius, and never below it where
/// the track's stamp lies ahead of now.
Threat threat_of(const Situation& situation, const world::Track& track) noexcept
{
    const Seconds age = std::max(situation.now - track.stamp, 0.0F);
    Threat threat;
    threat.motion = {track.position, track.velocity};
    threat.radius = world::threat_radius(situation, track, 0.0F);
    threat.radius_rate = situation.k_sigma * track.sigma_velocity + track.max_acceleration * age;
    threat.radius_acceleration = track.max_acceleration;
    return threat;
}

Problem problem_of(const Situation& situation, const world::Way& way, const world::Conflict& conflict) noexcept
{
    Problem problem;
    problem.frame = make_path_frame(way.origin, way.direction);
    problem.distance = (conflict.own_at_closest - way.origin).norm();
    problem.main_radius = std::max(conflict.radius_at_closest, Planner::kLeastMainRadius);
    if (conflict.threat.kind == world::ThreatKind::track) {
        problem.body_radius = std::max(situation.tracks[conflict.threat.index].radius, Planner::kLeastMainRadius);
    }
    problem.obstacles = situation.obstacles;
    problem.obstacle_clearance = situation.k_sigma * situation.own.sigma_position;
    problem.airspace = &situation.airspace;
    problem.start_velocity = situation.own.velocity;
    problem.speed = way.speed;
    problem.preferred_side = situation.flying != nullptr ? situation.flying->side : Vec3(Vec3::Zero());
    problem.main_centre_offset = conflict.threat_at_closest - conflict.own_at_closest;
    if (conflict.threat.kind == world::ThreatKind::track) {
        problem.main = conflict.threat.index;
    } else {
        const geometry::Shape& shape = situation.obstacles[conflict.threat.index].shape;
        problem.main_shape = shape.kind == geometry::ShapeKind::sphere ? nullptr : &shape;
    }
    return problem;
}

bool applies(const Attempt& attempt, const Settings& settings, vehicle::VehicleKind kind) noexcept
{
    const bool slower = attempt.speed_share < 1.0F;
    const bool wider = attempt.span_from > 0.0F;
    return !(slower && kind == vehicle::VehicleKind::fixed_wing) &&
           !(wider && settings.offset_rule == OffsetRule::source);
}

}  // namespace

PlanStatus solve_with_retries(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                              const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace,
                              Result& result, std::size_t& attempts) noexcept
{
    PlanStatus status = PlanStatus::none_available;
    Problem tried = problem;
    attempts = 0;
    bool cut_short = false;
    for (std::size_t i = 0; i <= settings.retries && i < kAttempts.size() && status == PlanStatus::none_available;
         ++i) {
        if (!applies(kAttempts[i], settings, limits.kind)) {
            continue;
        }
        tried.speed = kAttempts[i].speed_share * problem.speed;
        tried.span_from = kAttempts[i].span_from;
        tried.span_to = kAttempts[i].span_to;
        status = solve(tried, settings, limits, airframe, budget, workspace, result);
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
    if (!situation.reference.valid || !is_valid(settings_) || situation.tracks.size() > kMaxTracks) {
        return PlanStatus::bad_input;
    }
    const world::Way way = world::way_of(situation);
    world::Conflict conflict;
    if (!world::main_conflict(situation, way, settings_.lookahead, budget, conflict)) {
        return budget.exhausted() ? PlanStatus::budget_spent : PlanStatus::no_conflict;
    }
    threats_.clear();
    for (const world::Track& track : situation.tracks) {
        threats_.unchecked_push_back(threat_of(situation, track));
    }
    Problem problem = problem_of(situation, way, conflict);
    problem.threats = {threats_.data(), threats_.size()};
    if (problem.distance < kLeastDistanceInRadii * scale_radius(problem)) {
        return PlanStatus::too_close;
    }
    std::size_t attempts = 0;
    const PlanStatus status = solve_with_retries(problem, settings_, situation.limits, situation.airframe, budget,
                                                 workspace_, result_, attempts);
    if (status != PlanStatus::found) {
        return status;
    }
    out.kind = world::ManoeuvreKind::follow_path;
    out.by = world::MethodId::geometric;
    out.start = situation.now;
    out.valid_until = situation.now + result_.path.duration();
    out.command = Vec3::Zero();
    out.side = result_.side;
    out.cost = result_.candidates[result_.chosen].total;
    out.path = result_.path;
    return status;
}

}  // namespace jink::geometric
