// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/clearance.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {
namespace {

using world::ThreatKind;

/// With more items than these it pays to see first which of them a curve is far from.
constexpr std::size_t kFew = 4;

}  // namespace

bool is_moving(const world::Threat& threat) noexcept
{
    return threat.velocity.x() != 0.0F || threat.velocity.y() != 0.0F || threat.velocity.z() != 0.0F;
}

AtStart at_start(const Problem& problem, const world::Threat& threat) noexcept
{
    AtStart start{{threat.position_at(problem.lead), threat.velocity}, threat.growth_from(problem.lead)};
    if (problem.begins > 0.0F) {
        start.motion.position += problem.begins * threat.velocity;
        start.growth = start.growth.from(problem.begins);
    }
    return start;
}

Clearance::Clearance(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept
    : problem_(problem), settings_(settings), half_(limits.half_extents), bounds_(bounds_of(problem, half_)),
      tracks_(world::of_kind(problem.threats, ThreatKind::track)),
      obstacles_(world::of_kind(problem.threats, ThreatKind::obstacle)),
      cylinders_(world::of_kind(problem.threats, ThreatKind::cylinder))
{
}

void Clearance::collect(const Extent& reach, Seconds longest, WorkBudget& budget) noexcept
{
    items_.clear();
    needs_extent_ = settings_.security == SecurityMode::swept;
    const std::size_t all = tracks_.size() + obstacles_.size() + cylinders_.size();
    static_cast<void>(budget.spend(units::kCollected * static_cast<std::uint32_t>(all)));
    add_tracks(reach, longest, Which::at_rest);
    add_obstacles(reach, longest, false, budget);
    add_tracks(reach, longest, Which::moving);
    add_obstacles(reach, longest, true, budget);
    add_cylinders(reach, longest);
    near_items_ = items_.size();
    add_tracks(reach, longest, Which::deferred);
}

std::uint32_t Clearance::solids() const noexcept
{
    return static_cast<std::uint32_t>(
        std::count_if(items_.begin(), items_.end(), [this](const Item& item) { return is_solid(item); }));
}

Seconds Clearance::sweep_end(const world::Threat& track) const noexcept
{
    if (!settings_.main_swept_to_collision_point || problem_.main == kNoThreat || &track != &tracks_[problem_.main]) {
        return t_max_;
    }
    const geometry::Motion motion = at_start(problem_, track).motion;
    const Vec3 goal = collision_point(problem_) + problem_.main_centre_offset;
    const float speed_squared = motion.velocity.squaredNorm();
    if (!(speed_squared > 0.0F)) {
        return t_max_;
    }
    return std::clamp((goal - motion.position).dot(motion.velocity) / speed_squared, 0.0F, t_max_);
}

float Clearance::shrink_to_clear(float start_margin) const noexcept
{
    return settings_.escape_from_margin && start_margin < 0.0F ? problem_.rules.escape.slack - start_margin : 0.0F;
}

/// Parts of a segment so short that a surface growing back takes half the slack at most in each.
int Clearance::escape_parts(Seconds duration) const noexcept
{
    constexpr Seconds kMin = 0.02F;
    const Seconds longest = problem_.rules.escape.speed > 0.0F
                                ? 0.5F * problem_.rules.escape.slack / problem_.rules.escape.speed
                                : duration;
    return std::max(1, static_cast<int>(std::ceil(duration / std::max(longest, kMin))));
}

Clearance::Sphere Clearance::sphere_of(const world::Threat& threat) const noexcept
{
    const Vec3& origin = problem_.frame.origin;
    if (threat.ref.kind == ThreatKind::track) {
        const AtStart start = at_start(problem_, threat);
        return {start.motion.position - origin, threat.velocity, threat.box_against(half_), start.growth};
    }
    return {threat.position - origin, threat.velocity, threat.box_against(half_), threat.growth};  // at rest
}

void Clearance::add_sphere(const world::Threat& threat, const Extent& reach, Seconds longest) noexcept
{
    const Sphere sphere = sphere_of(threat);
    if (!out_of(reach, sphere, longest)) {
        const float margin = geometry::box_distance(sphere.half, sphere.position) - sphere.growth.radius;
        items_.unchecked_push_back({index_of(threat), shrink_to_clear(margin)});
    }
}

bool Clearance::out_of(const Extent& reach, const Sphere& sphere, Seconds longest) noexcept
{
    const Extent path = about(sphere.position, sphere.position + sphere.velocity * longest);
    return apart(path.low, path.high, reach.low, reach.high, sphere.half, sphere.growth.at(longest));
}

bool Clearance::is_out_of(const Extent& reach, const geometry::Shape& solid, float clearance) const noexcept
{
    const Vec3 centre = solid.centre - problem_.frame.origin;
    const float bound = geometry::bounding_radius(solid) + clearance;
    return apart(centre, centre, reach.low, reach.high, half_, bound);
}

void Clearance::add_tracks(const Extent& reach, Seconds longest, Which which) noexcept
{
    for (const world::Threat& track : tracks_) {
        const Which its = !is_moving(track)            ? Which::at_rest
                          : deferred_[index_of(track)] ? Which::deferred
                                                       : Which::moving;
        if (its == which) {
            add_sphere(track, reach, longest);
        }
    }
}

void Clearance::add_obstacles(const Extent& reach, Seconds longest, bool moving, WorkBudget& budget) noexcept
{
    // Those that move come last.
    if (moving && (obstacles_.empty() || !is_moving(obstacles_.back()))) {
        return;
    }
    for (const world::Threat& obstacle : obstacles_) {
        if (is_moving(obstacle) != moving) {
            continue;
        }
        if (obstacle.form != world::ThreatForm::solid) {
            add_sphere(obstacle, reach, longest);
        } else if (moving ? !out_of(reach, sphere_about(obstacle), longest)
                          : !is_out_of(reach, *obstacle.solid, obstacle.growth.radius)) {
            add_solid(obstacle, budget);
        }
    }
}

void Clearance::add_solid(const world::Threat& threat, WorkBudget& budget) noexcept
{
    Item item{index_of(threat), 0.0F};
    const Solid solid = solid_of(threat, 0.0F);
    if (settings_.escape_from_margin && !is_out_of({}, solid.shape, solid.growth.radius)) {
        const Vec3& start = problem_.frame.origin;
        item.shrunk =
            shrink_to_clear(world::obstacle_margin(half_, start, start, solid.shape, budget, solid.growth.radius));
        // Distances from solids are resolved no finer than this.
        item.shrunk += item.shrunk > 0.0F ? world::kObstacleResolution : 0.0F;
    }
    items_.unchecked_push_back(item);
    needs_extent_ = true;
}

Clearance::Solid Clearance::solid_of(const world::Threat& threat, float shrunk) const noexcept
{
    return {*threat.solid, shrunk, at_start(problem_, threat).growth};
}

/// The bounding sphere of a moving solid.
Clearance::Sphere Clearance::sphere_about(const world::Threat& solid) const noexcept
{
    const AtStart start = at_start(problem_, solid);
    world::Growth growth = start.growth;
    growth.radius += geometry::bounding_radius(*solid.solid);
    return {start.motion.position - problem_.frame.origin, solid.velocity, half_, growth};
}

bool Clearance::touches_moving_solid(const View& view, const Item& item, WorkBudget& budget) const noexcept
{
    const world::Threat& solid = problem_.threats[item.index];
    if (settings_.security == SecurityMode::swept) {
        return touches_swept(view.curve, view.extent, sphere_about(solid), t_max_, budget);
    }
    if (!budget.spend(units::kSolidSegment * static_cast<std::uint32_t>(view.last()))) {
        return true;
    }
    const View seen = view_of(view.curve, solid.velocity, problem_.lead + problem_.begins);
    return touches(seen, solid_of(solid, item.shrunk), budget);
}

bool Clearance::touches(const View& view, const Item& item, WorkBudget& budget) const noexcept
{
    const world::Threat& threat = problem_.threats[item.index];
    const bool moving = is_moving(threat);
    if (is_solid(item)) {
        return moving ? touches_moving_solid(view, item, budget) : touches(view, solid_of(threat, item.shrunk), budget);
    }
    if (threat.form == world::ThreatForm::cylinder) {
        return touches_cylinder(view.curve, threat, item.shrunk, budget);
    }
    const Sphere sphere = sphere_of(threat);
    return moving && settings_.security == SecurityMode::swept
               ? touches_swept(view.curve, view.extent, sphere, sweep_end(threat), budget)
               : touches(view.curve, sphere, item.shrunk, budget);
}

Verdict Clearance::check(const Curve& curve, WorkBudget& budget, Part part) const noexcept
{
    if (!budget.spend(units::bounds_units(curve.points))) {
        return {CandidateStatus::not_evaluated, {}};
    }
    if (part != Part::deferred) {
        if (const ThreatKind bound = left_airspace(curve); bound != ThreatKind::none) {
            return {CandidateStatus::hits_airspace, {bound, 0}};
        }
    }
    const std::size_t first = part == Part::deferred ? near_items_ : 0;
    const std::size_t end = part == Part::near ? near_items_ : items_.size();
    const bool many = end - first > kFew;
    const View view = needs_extent_ || many ? view_of(curve) : View{curve};
    for (std::size_t i = first; i < end; ++i) {
        const Item& item = items_[i];
        if (many && !is_solid(item)) {
            if (!budget.spend(units::kFarItem)) {
                return {CandidateStatus::not_evaluated, {}};
            }
            if (is_sphere_out_of(view.extent, item, curve.duration())) {
                continue;
            }
        }
        const bool hit =
            budget.spend(is_solid(item) ? units::kSolidCheck : units::kItem) && touches(view, item, budget);
        if (budget.exhausted()) {
            return {CandidateStatus::not_evaluated, {}};
        }
        if (hit) {
            return verdict_of(item);
        }
    }
    return {};
}

bool Clearance::is_sphere_out_of(const Extent& extent, const Item& item, Seconds duration) const noexcept
{
    const world::Threat& threat = problem_.threats[item.index];
    if (threat.form == world::ThreatForm::cylinder) {
        return is_cylinder_out_of(extent, threat, 0.0F, duration);
    }
    if (settings_.security == SecurityMode::swept && is_moving(threat)) {
        return false;  // its volume ends when others say
    }
    return out_of(extent, sphere_of(threat), duration);
}

Verdict Clearance::verdict_of(const Item& item) const noexcept
{
    const world::Threat& threat = problem_.threats[item.index];
    if (threat.form == world::ThreatForm::cylinder) {
        return {CandidateStatus::hits_airspace, threat.ref};
    }
    return {is_moving(threat) ? CandidateStatus::hits_moving : CandidateStatus::hits_static, threat.ref};
}

}  // namespace jink::geometric::detail
