// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/clearance.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/glance.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {
namespace {

using world::ThreatKind;

/// Share by which boxes are grown before they are compared, so that rounding never passes over a contact.
constexpr float kRounding = 1e-5F;

/// Whether two boxes, one of them grown by `half` + `radius`, are apart along some axis.
bool apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b, const Vec3& half,
           float radius) noexcept
{
    for (int i = 0; i < 3; ++i) {
        const float edge =
            (half[i] + radius) * (1.0F + kRounding) + kRounding * (1.0F + std::abs(low_b[i]) + std::abs(high_b[i]));
        if (low_a[i] > high_b[i] + edge || high_a[i] < low_b[i] - edge) {
            return true;
        }
    }
    return false;
}

/// With more items than these it pays to see first which of them a curve is far from.
constexpr std::size_t kFew = 4;

Extent about(const Vec3& a, const Vec3& b) noexcept { return {a.cwiseMin(b), a.cwiseMax(b)}; }

}  // namespace

bool is_moving(const Threat& threat) noexcept
{
    return threat.motion.velocity.x() != 0.0F || threat.motion.velocity.y() != 0.0F ||
           threat.motion.velocity.z() != 0.0F;
}

Extent extent_of(const Curve& curve) noexcept
{
    Extent extent{curve.position(0), curve.position(0)};
    for (std::size_t i = 1; i < curve.points; ++i) {
        extent.low = extent.low.cwiseMin(curve.position(i));
        extent.high = extent.high.cwiseMax(curve.position(i));
    }
    return extent;
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
                                   static_cast<std::uint32_t>(problem_.threats.size() + problem_.obstacles.size())));
    add_threats(reach, longest, false);
    for (std::size_t i = 0; i < problem_.obstacles.size(); ++i) {
        add_obstacle(i, reach, budget);
    }
    add_threats(reach, longest, true);
}

std::uint32_t Clearance::solids() const noexcept
{
    return static_cast<std::uint32_t>(
        std::count_if(items_.begin(), items_.end(), [](const Item& item) { return item.kind == Kind::solid; }));
}

Seconds Clearance::sweep_end(std::size_t index) const noexcept
{
    if (!settings_.main_swept_to_collision_point || index != problem_.main) {
        return t_max_;
    }
    const geometry::Motion& motion = problem_.threats[index].motion;
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
    const Seconds longest = settings_.escape.speed > 0.0F
                                ? std::max(kLeast, 0.5F * settings_.escape.slack / settings_.escape.speed)
                                : duration;
    return std::max(1, static_cast<int>(std::ceil(duration / std::max(longest, kLeast))));
}

Clearance::Ball Clearance::ball_of(std::size_t threat) const noexcept
{
    const Threat& t = problem_.threats[threat];
    return {t.motion.position - problem_.frame.origin,
            t.motion.velocity,
            half_,
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

bool Clearance::is_out_of(const Extent& reach, const geometry::Shape& solid) const noexcept
{
    const Vec3 centre = solid.centre - problem_.frame.origin;
    const float bound = geometry::bounding_radius(solid) + problem_.obstacle_clearance;
    return apart(centre, centre, reach.low, reach.high, half_, bound);
}

Clearance::Item Clearance::as_item(Kind kind, std::size_t index, const Ball& ball) const noexcept
{
    const float start = geometry::box_distance(ball.half, ball.position);
    return {kind, static_cast<std::uint16_t>(index), shrink_to_clear(start - ball.radius)};
}

void Clearance::add_threats(const Extent& reach, Seconds longest, bool moving) noexcept
{
    for (std::size_t i = 0; i < problem_.threats.size(); ++i) {
        if (is_moving(problem_.threats[i]) == moving) {
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
    if (is_out_of(reach, shape)) {
        return;
    }
    Item item{Kind::solid, static_cast<std::uint16_t>(index), 0.0F};
    if (settings_.escape_from_margin && !is_out_of({}, shape)) {
        const Vec3& start = problem_.frame.origin;
        item.shrunk =
            shrink_to_clear(world::obstacle_margin(half_, start, start, shape, budget, problem_.obstacle_clearance));
        // Distances from solids are told apart no finer than this.
        item.shrunk += item.shrunk > 0.0F ? world::kObstacleResolution : 0.0F;
    }
    items_.unchecked_push_back(item);
    needs_extent_ = true;
}

/// Segment `i`, the curve being `before` and `after` from the ball's centre at its ends.
bool Clearance::touches(const Curve& curve, std::size_t i, const Ball& ball, float shrunk, const Vec3& before,
                        const Vec3& after, WorkBudget& budget) const noexcept
{
    // At its end and not shrunk the ball is at its largest.
    const geometry::Glance whole = geometry::glance(ball.half, before, after, ball.radius_at(curve.t[i + 1]));
    if (whole == geometry::Glance::apart) {
        return false;
    }
    const bool shrinks = shrink_at(shrunk, curve.t[i]) > 0.0F;
    return (!shrinks && whole == geometry::Glance::touches) ||
           touches_in_parts(curve, i, ball, shrunk, before, after,
                            shrinks ? escape_parts(curve.t[i + 1] - curve.t[i]) : 1, budget);
}

bool Clearance::touches_in_parts(const Curve& curve, std::size_t i, const Ball& ball, float shrunk, const Vec3& before,
                                 const Vec3& after, int parts, WorkBudget& budget) const noexcept
{
    Vec3 from = before;
    for (int part = 1; part <= parts; ++part) {
        // The size at the part's end: never too small.
        const float share = static_cast<float>(part) / static_cast<float>(parts);
        const Vec3 to = before + share * (after - before);
        const Seconds end = curve.t[i] + share * (curve.t[i + 1] - curve.t[i]);
        const float radius = ball.radius_at(end) - shrink_at(shrunk, end);
        if (!budget.spend(units::kBallLookPart)) {
            return true;
        }
        if (radius >= 0.0F && geometry::glance(ball.half, from, to, radius) != geometry::Glance::apart &&
            (!budget.spend(units::kBallContact) ||
             geometry::contact_interval(ball.half, {}, {-from, from - to}, radius, 1.0F))) {
            return true;
        }
        from = to;
    }
    return false;
}

bool Clearance::touches(const Curve& curve, const Ball& ball, float shrunk, WorkBudget& budget) const noexcept
{
    Room room(curve.fastest, ball.velocity.cwiseAbs().maxCoeff(), ball.radius_at(curve.duration()), curve.duration());
    std::size_t i = 0;
    Vec3 before = ball.apart(curve, 0);
    bool near = false;
    while (i + 1 < curve.points) {
        // Where there was no room a segment before there will hardly be any.
        if (!near) {
            room.look(before, ball.half, curve.t[i]);
            std::size_t next = i;
            while (next + 1 < curve.points && room.lasts_until(curve.t[next + 1])) {
                ++next;
            }
            if (next > i) {
                i = next;
                before = ball.apart(curve, i);
                continue;
            }
        }
        near = !near;
        if (!budget.spend(units::kBallLook)) {
            return true;
        }
        const Vec3 after = ball.apart(curve, i + 1);
        if (touches(curve, i, ball, shrunk, before, after, budget)) {
            return true;
        }
        before = after;
        ++i;
    }
    return false;
}

bool Clearance::touches_swept(const Curve& curve, const Extent& extent, const Ball& ball, Seconds end,
                              WorkBudget& budget) const noexcept
{
    const Vec3 to = ball.position + ball.velocity * end;
    const float radius = ball.radius_at(end);
    const Extent path = about(ball.position, to);
    if (apart(path.low, path.high, extent.low, extent.high, ball.half, radius)) {
        return false;
    }
    const float slack = kRounding * (1.0F + path.low.cwiseAbs().cwiseMax(path.high.cwiseAbs()).maxCoeff());
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        const Vec3 a = curve.position(i);
        const Vec3 b = curve.position(i + 1);
        const Extent piece = about(a, b);
        if (!budget.spend(units::kBallLookPart)) {
            return true;
        }
        if (!apart(path.low, path.high, piece.low, piece.high, ball.half, radius) &&
            (!budget.spend(units::kCapsuleQuery) ||
             geometry::swept_distance(ball.half, a, b, ball.position, to) <= radius + slack)) {
            return true;
        }
    }
    return false;
}

/// Segment `i` keeps off a solid that the escape rule has shrunk and that grows back meanwhile.
bool Clearance::leaves(const Curve& curve, std::size_t i, const geometry::Shape& shape, float shrunk,
                       WorkBudget& budget) const noexcept
{
    const Vec3 a = problem_.frame.origin + curve.position(i);
    const Vec3 step = curve.position(i + 1) - curve.position(i);
    const Seconds duration = curve.t[i + 1] - curve.t[i];
    const int parts = escape_parts(duration);
    for (int part = 0; part < parts; ++part) {
        const float from = static_cast<float>(part) / static_cast<float>(parts);
        const float to = static_cast<float>(part + 1) / static_cast<float>(parts);
        const float margin =
            world::obstacle_margin(half_, a + from * step, a + to * step, shape, budget, problem_.obstacle_clearance) +
            shrink_at(shrunk, curve.t[i] + to * duration);
        if (budget.exhausted() || margin < 0.0F) {
            return false;
        }
    }
    return true;
}

bool Clearance::touches(const Curve& curve, const Extent& extent, const geometry::Shape& shape, float shrunk,
                        WorkBudget& budget) const noexcept
{
    const Vec3& origin = problem_.frame.origin;
    const Vec3 centre = shape.centre - origin;
    const float clearance = problem_.obstacle_clearance;
    const float bound = geometry::bounding_radius(shape) + clearance;
    if (apart(centre, centre, extent.low, extent.high, half_, bound)) {
        return false;
    }
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        const Vec3 a = curve.position(i);
        const Vec3 b = curve.position(i + 1);
        const Extent piece = about(a, b);
        if (apart(centre, centre, piece.low, piece.high, half_, bound)) {
            continue;
        }
        if (shrink_at(shrunk, curve.t[i]) > 0.0F) {
            if (!leaves(curve, i, shape, shrunk, budget)) {
                return true;
            }
        } else if (geometry::swept_box_contact(half_, origin + a, origin + b, shape, clearance, budget) !=
                   geometry::Contact::clear) {
            return true;
        }
    }
    return false;
}

bool Clearance::touches(const Curve& curve, const Extent& extent, const Item& item, WorkBudget& budget) const noexcept
{
    switch (item.kind) {
    case Kind::static_ball: return touches(curve, ball_of(item.index), item.shrunk, budget);
    case Kind::obstacle_ball: return touches(curve, ball_of(problem_.obstacles[item.index].shape), item.shrunk, budget);
    case Kind::solid: return touches(curve, extent, problem_.obstacles[item.index].shape, item.shrunk, budget);
    case Kind::moving_ball: break;
    }
    const Ball ball = ball_of(item.index);
    return settings_.security == SecurityMode::swept ? touches_swept(curve, extent, ball, sweep_end(item.index), budget)
                                                     : touches(curve, ball, item.shrunk, budget);
}

Verdict Clearance::check(const Curve& curve, WorkBudget& budget) const noexcept
{
    if (const ThreatKind bound = left_airspace(curve); bound != ThreatKind::none) {
        return {CandidateStatus::hits_airspace, {bound, 0}};
    }
    const bool many = items_.size() > kFew;
    const Extent extent = needs_extent_ || many ? extent_of(curve) : Extent{};
    for (const Item& item : items_) {
        if (many && item.kind != Kind::solid) {
            if (!budget.spend(units::kFarItem)) {
                return {CandidateStatus::not_evaluated, {}};
            }
            if (is_ball_out_of(extent, item, curve.duration())) {
                continue;
            }
        }
        const bool hit = budget.spend(units_of(item, curve)) && touches(curve, extent, item, budget);
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

/// Of passing over what is far; closer looks come on top.
std::uint32_t Clearance::units_of(const Item& item, const Curve& curve) noexcept
{
    return item.kind == Kind::solid ? units::kSolidSegment * static_cast<std::uint32_t>(curve.points - 1)
                                    : units::kItem;
}

Verdict Clearance::verdict_of(const Item& item) noexcept
{
    const bool of_threat = item.kind == Kind::static_ball || item.kind == Kind::moving_ball;
    return {item.kind == Kind::moving_ball ? CandidateStatus::hits_moving : CandidateStatus::hits_static,
            {of_threat ? ThreatKind::track : ThreatKind::obstacle, item.index}};
}

}  // namespace jink::geometric::detail
