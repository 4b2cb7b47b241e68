// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>

#include "core/base/finite.hpp"
#include "core/geometric/attempt.hpp"
#include "core/geometric/run.hpp"

namespace jink::geometric {
namespace {

using detail::Curve;
using world::PlanStatus;

bool is_valid(const world::Threat& t) noexcept
{
    const bool has_shape = t.ref.kind == world::ThreatKind::obstacle;
    return is_finite(t.position) && is_finite(t.velocity) && is_not_negative(t.growth.radius) &&
           is_not_negative(t.growth.rate) && is_not_negative(t.growth.acceleration) && is_not_negative(t.half_height) &&
           (!has_shape || (t.solid != nullptr && geometry::is_valid(*t.solid)));
}

std::uint32_t units_of_validity(const geometry::Shape* solid) noexcept
{
    return units::kThreatValid + units::hull_units(solid != nullptr ? solid->vertices.size() : 0);
}

const geometry::Shape* solid_of(const world::Threat& threat) noexcept
{
    return threat.form == world::ThreatForm::solid ? threat.solid : nullptr;
}

bool is_valid(const PathFrame& frame) noexcept
{
    return is_finite(frame.origin) && frame.axes.allFinite() && frame.axes.isUnitary(1e-3F);
}

bool is_valid(const path::RouteAhead& ahead) noexcept
{
    return ahead.route.empty() || (is_not_negative(ahead.straight) && is_not_negative(ahead.joined_at));
}

bool has_valid_scales(const Problem& p) noexcept
{
    return is_valid(p.frame) && is_valid(p.ahead) && world::is_valid(p.rules) && is_positive(p.distance) &&
           is_positive(p.main_radius) && is_positive(p.speed) && is_not_negative(p.main_clearance) &&
           is_not_negative(p.main_half_height) && is_not_negative(p.body_radius) && is_not_negative(p.span_from) &&
           is_not_negative(p.span_to) && is_positive(p.apex_share) && is_not_negative(p.lead) &&
           is_not_negative(p.begins) && p.straight >= 0.0F && is_finite(p.start_velocity) &&
           is_finite(p.preferred_side) && is_finite(p.main_centre_offset);
}

}  // namespace

bool detail::has_valid_threats(const Problem& p, WorkBudget& budget) noexcept
{
    std::size_t tracks = 0;
    std::size_t at_rest = 0;
    std::size_t moving = 0;
    for (const world::Threat& threat : p.threats) {
        if (!budget.spend(units_of_validity(solid_of(threat))) || !is_valid(threat)) {
            return false;
        }
        tracks += threat.ref.kind == world::ThreatKind::track ? 1U : 0U;
        if (threat.ref.kind == world::ThreatKind::obstacle) {
            ++(is_moving(threat) ? moving : at_rest);
        }
    }
    return p.threats.size() <= kMaxProblemThreats && tracks <= kMaxTracks && moving <= kMaxMovingSolids &&
           at_rest <= kMaxObstacles && (p.main == kNoThreat || p.main < tracks) &&
           (p.main_shape == nullptr ||
            (budget.spend(units_of_validity(p.main_shape)) && geometry::is_valid(*p.main_shape)));
}

PlanStatus detail::solve_valid(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                               const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace,
                               Result& result) noexcept
{
    clear(result);
    if (!is_valid(settings) || !has_valid_scales(problem)) {
        return PlanStatus::bad_input;
    }
    if (problem.distance < kMinDistanceInRadii * scale_radius(problem)) {
        return PlanStatus::too_close;
    }
    static_assert(sizeof(Run) <= Workspace::kBytes && Workspace::kBytes <= sizeof(Run) + sizeof(Run) / 4 + 1024);
    static_assert(alignof(Run) <= alignof(std::max_align_t) && std::is_trivially_destructible_v<Run>);
    return (*new (workspace.bytes()) Run(problem, settings, limits, airframe, budget, result))();
}

PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                 const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace, Result& result) noexcept
{
    if (!vehicle::is_valid(limits) || !vehicle::is_valid(airframe) || !detail::has_valid_threats(problem, budget)) {
        return detail::refused(budget, result);
    }
    return detail::solve_valid(problem, settings, limits, airframe, budget, workspace, result);
}

PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                 const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept
{
    Workspace workspace;
    return solve(problem, settings, limits, airframe, budget, workspace, result);
}

bool make_candidate_path(const Problem& problem, const CandidateShape& shape, std::uint16_t waypoints,
                         const vehicle::VehicleLimits& limits, path::TimedPath& out) noexcept
{
    if (waypoints < 8 || waypoints > kMaxPathPoints || !has_valid_scales(problem) || !vehicle::is_valid(limits) ||
        shape.family == Family::wait || !std::isfinite(shape.plane) || !std::isfinite(shape.offset)) {
        return false;
    }
    Curve curve;
    const detail::UnitCurve unit = detail::make_unit_curve(shape.family, waypoints);
    detail::BaseCurve base;
    detail::make_candidate(unit, problem, limits, detail::plane_direction(problem.frame, shape.plane), shape.offset,
                           base, curve);
    detail::to_timed_path(curve, problem.frame.origin, out);
    return true;
}

}  // namespace jink::geometric
