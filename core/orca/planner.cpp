// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/planner.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/path/follower.hpp"
#include "core/world/conflict.hpp"
#include "core/world/threat_set.hpp"

namespace jink::orca {

namespace {

constexpr float kDelayMargin = 2.72F;   ///< e: horizons and times in delays, against overshoot
constexpr Seconds kPathStep = 0.2F;     ///< of the predicted flight
constexpr Seconds kLongestTick = 0.5F;  ///< a pause counts as this for what is timed
constexpr Seconds kUsualTick = 0.02F;   ///< before there were two plans
constexpr float kMinSpeed = 0.05F;      ///< [m/s] of a leg
constexpr float kNearEnd = 1.0F;        ///< [1/s] the last metres of a reference are flown at so much of what is left
constexpr float kFlattest = kMaxStretch * 0.99F;
constexpr float kTallest = kMinStretch * 1.01F;

/// Units of what the filter does not count itself: settings and reference; each track or cylinder checked.
constexpr std::uint32_t kPlanUnits = 40;
constexpr std::uint32_t kThreatUnits = 3;

/// The upright cylinder about the own box, no flatter or taller than half-spaces can be made for.
struct Cylinder {
    float half_width = 0.0F;
    float half_height = 0.0F;
};

Cylinder cylinder_of(const Vec3& half, float extra) noexcept
{
    Cylinder out{std::hypot(half.x(), half.y()) + extra, half.z() + extra};
    out.half_height = std::max(out.half_height, out.half_width / kFlattest);
    out.half_width = std::max(out.half_width, out.half_height * kTallest);
    return out;
}

/// Seconds until two that fly straight are nearest to each other, within [0, horizon].
Seconds time_of_closest(const Vec3& position, const Vec3& velocity, Seconds horizon) noexcept
{
    const float speed2 = velocity.squaredNorm();
    return speed2 > 1e-6F ? std::clamp(-position.dot(velocity) / speed2, 0.0F, horizon) : 0.0F;
}

/// A track's threat as it will be when the command acts; its sphere with all that is not known of it by the time it is
/// nearest.
Neighbour neighbour_of(const world::Situation& s, const world::Threat& threat, const Predicted& own,
                       const FilterSettings& settings, Seconds stale) noexcept
{
    const Seconds ahead = s.rules.latency;
    Neighbour out;
    out.position = threat.nearest_in_height(ahead, own.position.z()) - own.position;
    out.velocity = threat.velocity;
    const Seconds t = time_of_closest(out.position, threat.velocity - own.velocity, settings.pair.horizon);
    const float radius = world::threat_radius(s, *threat.track, t + ahead);
    out.half_width = radius;
    // No taller than half-spaces can be made for: what is left of an uncertain height the final check keeps clear.
    out.half_height = std::max(radius, std::min(radius + threat.half_height, radius / kTallest));
    out.max_speed = std::max(settings.limits.max_speed, threat.velocity.norm());
    out.acceleration = threat.track->max_acceleration;
    if (threat.reciprocal) {
        // It changes its velocity as much as a vehicle that avoids us may, and that since its report.
        out.acceleration = std::max(out.acceleration, world::fellow_acceleration(s.limits, s.rules));
        out.age = std::max(s.now - threat.track->stamp, 0.0F);
    }
    out.id = threat.track->id;
    out.cooperative = threat.reciprocal && s.now - threat.track->stamp <= stale;
    return out;
}

using Bounds = StaticVector<Bound, kMaxBounds>;

/// A bound of the airspace; nothing of the keep-in where the vehicle is at its middle.
void add_bound(const world::Threat& threat, const Vec3& position, const Cylinder& own, Bounds& out) noexcept
{
    if (threat.form == world::ThreatForm::floor) {
        out.unchecked_push_back({-Vec3::UnitZ(), position.z() - own.half_height - threat.position.z(), 0.0F});
    } else if (threat.form == world::ThreatForm::ceiling) {
        out.unchecked_push_back({Vec3::UnitZ(), threat.position.z() - position.z() - own.half_height, 0.0F});
    } else {
        const Vec3 from_home(position.x() - threat.position.x(), position.y() - threat.position.y(), 0.0F);
        const float off = from_home.norm();
        if (off > 0.0F) {
            out.unchecked_push_back({from_home / off, threat.level_radius - off - own.half_width, 0.0F});
        }
    }
}

/// The level or the upright side of the cylinder that is farther off: all of it lies behind.
Bound bound_of(const world::Cylinder& cylinder, const Vec3& position, const Cylinder& own, Seconds ahead) noexcept
{
    const world::Vec2 centre = cylinder.circle.centre + ahead * cylinder.velocity;
    const Vec3 to(centre.x() - position.x(), centre.y() - position.y(), 0.0F);
    const float off = to.norm();
    const Vec3 outward = off > 0.0F ? Vec3(to / off) : Vec3(Vec3::UnitX());
    Bound level{outward, off - cylinder.circle.radius - own.half_width,
                outward.x() * cylinder.velocity.x() + outward.y() * cylinder.velocity.y()};
    const float above = position.z() - own.half_height - cylinder.top;
    const float below = cylinder.bottom - position.z() - own.half_height;
    if (std::max(above, below) > level.gap) {
        return above > below ? Bound{-Vec3::UnitZ(), above, 0.0F} : Bound{Vec3::UnitZ(), below, 0.0F};
    }
    return level;
}

/// The nearest cylinders, as many as fit behind the airspace's bounds; what is left out the final check
/// sees.
void add_cylinder(const Bound& bound, std::size_t first, Bounds& out) noexcept
{
    if (out.full()) {
        if (out.size() == first || bound.gap >= out.back().gap) {
            return;
        }
        out.pop_back();
    }
    std::size_t at = out.size();
    out.unchecked_push_back(bound);
    for (; at > first && bound.gap < out[at - 1].gap; --at) {
        out[at] = out[at - 1];
    }
    out[at] = bound;
}

Bounds bounds_of(const world::Situation& s, const Vec3& position, const Cylinder& own, Seconds ahead) noexcept
{
    Bounds out;
    std::size_t first = 0;
    for (const world::Threat& threat : s.threats) {
        if (threat.is_bound()) {
            add_bound(threat, position, own, out);
            first = out.size();
        } else if (threat.form == world::ThreatForm::cylinder) {
            add_cylinder(bound_of(*threat.cylinder, position, own, ahead), first, out);
        }
    }
    return out;
}

/// Along the way, slower before its end.
Vec3 preferred_velocity(const world::Situation& s) noexcept
{
    const world::Way way = world::way_of(s);
    const bool stops = s.limits.kind == vehicle::VehicleKind::multirotor;
    const float speed = stops ? std::min(way.speed, kNearEnd * way.length) : way.speed;
    return speed * way.direction;
}

}  // namespace

bool is_valid(const Settings& s) noexcept
{
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    return within(s.conflict_ratio, 0.5F, 0.95F) && within(s.reach, 0.1F, 5.0F) && within(s.stale, 0.01F, 60.0F) &&
           s.smoothing >= 1 && s.smoothing <= CommandFilter::kMax;
}

bool Planner::configure(const Settings& settings) noexcept
{
    if (!is_valid(settings)) {
        return false;
    }
    settings_ = settings;
    return true;
}

FilterSettings Planner::filter_settings(const world::Situation& s, Seconds tick) const noexcept
{
    const vehicle::VehicleLimits& limits = s.limits;
    const bool wing = limits.kind == vehicle::VehicleKind::fixed_wing;
    FilterSettings out;
    MotionLimits& motion = out.limits;
    motion.max_speed = std::max(limits.cruise_speed, std::max(s.reference.speed, kMinSpeed));
    motion.acceleration = limits.max_acceleration;
    motion.climb_acceleration = motion.sink_acceleration = limits.max_vertical_acceleration;
    motion.climb_rate = limits.max_climb;
    motion.sink_rate = limits.max_descent;
    motion.period = settings_.reach;
    if (wing) {
        motion.min_speed = kWingShare * limits.cruise_speed;
        motion.turn_radius = limits.cruise_speed * limits.cruise_speed / limits.max_acceleration;
    }
    out.tick = tick;
    out.delay = s.rules.latency + limits.velocity_lag + CommandFilter(settings_.smoothing).delay(tick);
    const Seconds delayed = kDelayMargin * out.delay;
    const Seconds brakes = braking_time(motion);
    const Cylinder own = cylinder_of(limits.half_extents, 0.0F);
    out.half_width = own.half_width;
    out.half_height = own.half_height;
    out.cover = kCylinderCover / settings_.conflict_ratio;
    out.own_id = s.own_id;
    PairSettings& pair = out.pair;
    pair.conflict = settings_.conflict;
    pair.conflict_ratio = settings_.conflict_ratio;
    pair.horizon = std::max(s.rules.lookahead, std::max(2.0F * brakes, delayed));
    pair.brake = std::max(brakes, delayed);
    pair.recovery_time = std::max(1.0F, delayed);
    pair.ramp_speed =
        ramp_speed_for(2.0F * out.cover * own.half_width, pair.conflict_ratio, out.delay, motion.acceleration);
    const Cylinder kept = cylinder_of(limits.half_extents, world::own_uncertainty(s));
    out.obstacles.horizontal = kept.half_width;
    out.obstacles.vertical = kept.half_height;
    out.obstacles.covers_cylinder = true;
    out.obstacles.horizon = std::max(brakes, std::max(1.0F, delayed));
    out.obstacles.braking = motion.acceleration;
    out.obstacles.delay = out.delay;
    out.bias = settings_.bias;
    out.loop = {s.rules.latency, limits.velocity_lag};
    out.most_apart = 0.5F * motion.max_speed + 0.5F;
    out.own_stale = kLongestTick;
    out.stale = settings_.stale;
    out.smoothing = settings_.smoothing;
    return out;
}

/// What was really sent since the last plan; after a pause nothing is known of it.
void Planner::take_command(const world::Situation& s) noexcept
{
    if (s.commanded == nullptr || !has_planned_ || s.now - last_plan_ > kLongestTick) {
        filter_.reset();
        return;
    }
    static_cast<void>(filter_.issued(s.commanded->at, s.commanded->velocity));
}

world::PlanStatus Planner::plan(const world::Situation& s, WorkBudget& budget, world::Manoeuvre& out) noexcept
{
    if (!world::is_complete(s)) {
        return world::PlanStatus::bad_input;
    }
    const std::span tracks = world::of_kind(s.threats, world::ThreatKind::track);
    if (!budget.spend(kPlanUnits + kThreatUnits * static_cast<std::uint32_t>(
                                                      tracks.size() +
                                                      world::of_kind(s.threats, world::ThreatKind::cylinder).size()))) {
        return world::PlanStatus::budget_spent;
    }
    take_command(s);
    const Seconds since = has_planned_ ? s.now - last_plan_ : kUsualTick;
    has_planned_ = true;
    last_plan_ = s.now;
    const FilterSettings settings = filter_settings(s, std::clamp(since, 0.001F, kLongestTick));
    if (filter_.configure(settings) != Unsafe::none) {
        return world::PlanStatus::bad_input;
    }
    const Seconds ahead = s.rules.latency;
    FilterInput input;
    input.own = filter_.predicted(s.own, s.now);
    input.own_age = s.now - s.own.stamp;
    input.preferred = preferred_velocity(s);
    neighbours_.clear();
    for (const world::Threat& threat : tracks) {
        static_cast<void>(neighbours_.try_push_back(neighbour_of(s, threat, input.own, settings, settings_.stale)));
    }
    input.neighbours = {neighbours_.data(), neighbours_.size()};
    input.obstacles = world::of_kind(s.threats, world::ThreatKind::obstacle);
    const Cylinder kept = cylinder_of(s.limits.half_extents, world::own_uncertainty(s));
    const Bounds bounds = bounds_of(s, input.own.position, kept, ahead);
    input.bounds = {bounds.data(), bounds.size()};
    decision_ = filter_.decide(input, budget);
    const Seconds step = std::max(kPathStep, settings.pair.horizon / static_cast<float>(kMaxPathPoints - 2));
    const auto steps = static_cast<std::uint32_t>(settings.pair.horizon / step) + 1;
    static_cast<void>(budget.spend(steps * units::kCommandStep));
    if ((decision_.status & kWorkLimit) != 0 || budget.exhausted()) {
        return world::PlanStatus::budget_spent;
    }
    constexpr std::uint32_t kNoAnswer = kInfeasibleDynamics | kBadInput | kOwnStale | kConfigUnsafe;
    const bool blocked = settings_.gives_up_blocked && (decision_.status & kBlocked) != 0;
    if ((decision_.status & kNoAnswer) != 0 || blocked) {
        return world::PlanStatus::none_available;
    }
    out.kind = world::ManoeuvreKind::velocity;
    out.start = s.now;
    out.valid_until = s.now + settings.pair.horizon;
    out.command = decision_.command;
    out.side = Vec3::Zero();
    out.cost = 0.0F;
    path::predict_velocity_command(s.own, out.command, settings.pair.horizon, step, s.limits, out.path);
    return world::PlanStatus::found;
}

}  // namespace jink::orca
