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

bool is_moving(const Threat& threat) noexcept
{
    return threat.motion.velocity.x() != 0.0F || threat.motion.velocity.y() != 0.0F ||
           threat.motion.velocity.z() != 0.0F;
}

Threat threat_at_start(const Problem& problem, std::size_t index) noexcept
{
    Threat threat = problem.threats[index];
    const Seconds t = problem.begins;
    if (t <= 0.0F) {
        return threat;
    }
    threat.motion.position += t * threat.motion.velocity;
    threat.radius += t * (threat.radius_rate + 0.5F * threat.radius_acceleration * t);
    threat.radius_rate += threat.radius_acceleration * t;
    return threat;
}

Clearance::Clearance(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept
    : problem_(problem), settings_(settings), half_(limits.half_extents), bounds_(bounds_of(problem, half_))
{
}

void Clearance::collect(const Extent& reach, Seconds longest, WorkBudget& budget) noexcept
{
    items_.clear();
    needs_extent_ = settings_.security == SecurityMode::swept;
    static_cast<void>(budget.spend(units::kCollected *
                                   static_cast<std::uint32_t>(problem_.threats.size() + problem_.obstacles.size() +
                                                              problem_.moving_solids.size())));
    add_threats(reach, longest, Which::at_rest);
    for (std::size_t i = 0; i < problem_.obstacles.size(); ++i) {
        add_obstacle(i, reach, budget);
    }
    add_threats(reach, longest, Which::moving);
    for (std::size_t i = 0; i < problem_.moving_solids.size(); ++i) {
        add_moving_solid(i, reach, longest, budget);
    }
    near_items_ = items_.size();
    add_threats(reach, longest, Which::deferred);
}

std::uint32_t Clearance::solids() const noexcept
{
    return static_cast<std::uint32_t>(std::count_if(items_.begin(), items_.end(), [](const Item& item) {
        return item.kind == Kind::solid || item.kind == Kind::moving_solid;
    }));
}

Seconds Clearance::sweep_end(std::size_t index) const noexcept
{
    if (!settings_.main_swept_to_collision_point || index != problem_.main) {
        return t_max_;
    }
    const geometry::Motion motion = threat_at_start(problem_, index).motion;
    const Vec3 goal = collision_point(problem_) + problem_.main_centre_offset;
    const float speed_squared = motion.velocity.squaredNorm();
    if (!(speed_squared > 0.0F)) {
        return t_max_;
    }
    return std::clamp((goal - motion.position).dot(motion.velocity) / speed_squared, 0.0F, t_max_);
}

float Clearance::shrink_to_clear(float start_margin) const noexcept
{
    return settings_.escape_from_margin && start_margin < 0.0F ? settings_.escape.slack - start_margin : 0.0F;
}

/// Parts of a segment so short that a surface growing back takes half the slack at most in each.
int Clearance::escape_parts(Seconds duration) const noexcept
{
    constexpr Seconds kLeast = 0.02F;
    const Seconds longest =
        settings_.escape.speed > 0.0F ? 0.5F * settings_.escape.slack / settings_.escape.speed : duration;
    return std::max(1, static_cast<int>(std::ceil(duration / std::max(longest, kLeast))));
}

Clearance::Ball Clearance::ball_of(std::size_t threat) const noexcept
{
    const Threat t = threat_at_start(problem_, threat);
    return {t.motion.position - problem_.frame.origin,
            t.motion.velocity,
            half_ + t.half_height * Vec3::UnitZ(),
            t.radius,
            t.radius_rate,
            t.radius_acceleration};
}

Clearance::Ball Clearance::ball_of(const geometry::Shape& shape) const noexcept
{
    Ball ball;
    static_cast<void>(world::as_sphere(shape, half_, ball.half, ball.radius));
    ball.position = shape.centre - problem_.frame.origin;
    ball.velocity = Vec3::Zero();
    ball.radius += problem_.obstacle_clearance;
    return ball;
}

void Clearance::add_ball(Kind kind, std::size_t index, const Ball& ball, const Extent& reach, Seconds longest) noexcept
{
    if (!out_of(reach, ball, longest)) {
        items_.unchecked_push_back(as_item(kind, index, ball));
    }
}

bool Clearance::out_of(const Extent& reach, const Ball& ball, Seconds longest) noexcept
{
    const Extent path = about(ball.position, ball.position + ball.velocity * longest);
    return apart(path.low, path.high, reach.low, reach.high, ball.half, ball.radius_at(longest));
}

bool Clearance::is_out_of(const Extent& reach, const geometry::Shape& solid, float clearance) const noexcept
{
    const Vec3 centre = solid.centre - problem_.frame.origin;
    const float bound = geometry::bounding_radius(solid) + clearance;
    return apart(centre, centre, reach.low, reach.high, half_, bound);
}

Clearance::Item Clearance::as_item(Kind kind, std::size_t index, const Ball& ball) const noexcept
{
    const float start = geometry::box_distance(ball.half, ball.position);
    return {kind, static_cast<std::uint16_t>(index), shrink_to_clear(start - ball.radius)};
}

void Clearance::add_threats(const Extent& reach, Seconds longest, Which which) noexcept
{
    for (std::size_t i = 0; i < problem_.threats.size(); ++i) {
        const bool moving = is_moving(problem_.threats[i]);
        const Which its = !moving ? Which::at_rest : deferred_[i] ? Which::deferred : Which::moving;
        if (its == which) {
            add_ball(moving ? Kind::moving_ball : Kind::static_ball, i, ball_of(i), reach, longest);
        }
    }
}

void Clearance::add_obstacle(std::size_t index, const Extent& reach, WorkBudget& budget) noexcept
{
    const geometry::Shape& shape = problem_.obstacles[index].shape;
    Ball ball;
    if (world::as_sphere(shape, half_, ball.half, ball.radius)) {
        add_ball(Kind::obstacle_ball, index, ball_of(shape), reach, 0.0F);
        return;
    }
    if (is_out_of(reach, shape, problem_.obstacle_clearance)) {
        return;
    }
    add_solid(Kind::solid, index, {shape, 0.0F, problem_.obstacle_clearance}, budget);
}

void Clearance::add_moving_solid(std::size_t index, const Extent& reach, Seconds longest, WorkBudget& budget) noexcept
{
    if (!out_of(reach, ball_about(index), longest)) {
        add_solid(Kind::moving_solid, index, solid_of(problem_.moving_solids[index], 0.0F), budget);
    }
}

void Clearance::add_solid(Kind kind, std::size_t index, const Solid& solid, WorkBudget& budget) noexcept
{
    Item item{kind, static_cast<std::uint16_t>(index), 0.0F};
    if (settings_.escape_from_margin && !is_out_of({}, solid.shape, solid.clearance)) {
        const Vec3& start = problem_.frame.origin;
        item.shrunk =
            shrink_to_clear(world::obstacle_margin(half_, start, start, solid.shape, budget, solid.clearance));
        // Distances from solids are told apart no finer than this.
        item.shrunk += item.shrunk > 0.0F ? world::kObstacleResolution : 0.0F;
    }
    items_.unchecked_push_back(item);
    needs_extent_ = true;
}

Clearance::Solid Clearance::solid_of(const MovingSolid& solid, float shrunk) const noexcept
{
    const Seconds t = problem_.begins;
    return {solid.shape, shrunk, solid.uncertainty + t * (solid.radius_rate + 0.5F * solid.radius_acceleration * t),
            solid.radius_rate + solid.radius_acceleration * t, solid.radius_acceleration};
}

/// Of a moving solid, the ball about it.
Clearance::Ball Clearance::ball_about(std::size_t index) const noexcept
{
    const MovingSolid& solid = problem_.moving_solids[index];
    const Solid grown = solid_of(solid, 0.0F);
    return {solid.shape.centre + problem_.begins * solid.velocity - problem_.frame.origin,
            solid.velocity,
            half_,
            geometry::bounding_radius(solid.shape) + grown.clearance,
            grown.rate,
            grown.acceleration};
}

bool Clearance::touches_moving_solid(const View& view, const Item& item, WorkBudget& budget) const noexcept
{
    if (settings_.security == SecurityMode::swept) {
        return touches_swept(view.curve, view.extent, ball_about(item.index), t_max_, budget);
    }
    if (!budget.spend(units::kSolidSegment * static_cast<std::uint32_t>(view.last()))) {
        return true;
    }
    const MovingSolid& solid = problem_.moving_solids[item.index];
    const View seen = view_of(view.curve, solid.velocity, problem_.begins);
    return touches(seen, solid_of(solid, item.shrunk), budget);
}

bool Clearance::touches(const View& view, const Item& item, WorkBudget& budget) const noexcept
{
    const Curve& curve = view.curve;
    switch (item.kind) {
    case Kind::static_ball: return touches(curve, ball_of(item.index), item.shrunk, budget);
    case Kind::obstacle_ball: return touches(curve, ball_of(problem_.obstacles[item.index].shape), item.shrunk, budget);
    case Kind::solid:
        return touches(view, {problem_.obstacles[item.index].shape, item.shrunk, problem_.obstacle_clearance}, budget);
    case Kind::moving_solid: return touches_moving_solid(view, item, budget);
    case Kind::moving_ball: break;
    }
    const Ball ball = ball_of(item.index);
    return settings_.security == SecurityMode::swept
               ? touches_swept(curve, view.extent, ball, sweep_end(item.index), budget)
               : touches(curve, ball, item.shrunk, budget);
}

Verdict Clearance::check(const Curve& curve, WorkBudget& budget, Part part) const noexcept
{
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
            if (is_ball_out_of(view.extent, item, curve.duration())) {
                continue;
            }
        }
        const bool hit = budget.spend(is_solid(item) ? units::kSolidLook : units::kItem) && touches(view, item, budget);
        if (budget.exhausted()) {
            return {CandidateStatus::not_evaluated, {}};
        }
        if (hit) {
            return verdict_of(item);
        }
    }
    return {};
}

bool Clearance::is_ball_out_of(const Extent& extent, const Item& item, Seconds duration) const noexcept
{
    if (item.kind == Kind::moving_ball && settings_.security == SecurityMode::swept) {
        return false;  // its volume ends when others say
    }
    const Ball ball =
        item.kind == Kind::obstacle_ball ? ball_of(problem_.obstacles[item.index].shape) : ball_of(item.index);
    return out_of(extent, ball, duration);
}

Verdict Clearance::verdict_of(const Item& item) const noexcept
{
    const bool of_threat = item.kind == Kind::static_ball || item.kind == Kind::moving_ball;
    const std::size_t behind = item.kind == Kind::moving_solid ? problem_.obstacles.size() : 0;
    const bool moves = item.kind == Kind::moving_solid || item.kind == Kind::moving_ball;
    return {moves ? CandidateStatus::hits_moving : CandidateStatus::hits_static,
            {of_threat ? ThreatKind::track : ThreatKind::obstacle, static_cast<std::uint16_t>(item.index + behind)}};
}

}  // namespace jink::geometric::detail
