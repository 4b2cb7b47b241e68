// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/velocity_filter.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"
#include "core/orca/obstacle_way.hpp"

namespace jink::orca {

namespace {

NeighbourSettings neighbour_settings(const FilterSettings& s) noexcept
{
    NeighbourSettings out;
    out.half_width = s.half_width;
    out.half_height = s.half_height;
    out.max_speed = s.limits.max_speed;
    out.horizon = s.pair.horizon;
    out.cover = s.cover;
    const bool at_rest = s.pair.conflict == Conflict::at_rest;
    out.cap_horizon = at_rest ? s.pair.brake : s.pair.horizon;
    out.cap_ratio = at_rest ? s.pair.conflict_ratio : 1.0F;
    out.stale = s.stale;
    out.own_id = s.own_id;
    return out;
}

bool has_good_bias(const BiasSettings& s) noexcept
{
    return is_positive(s.near) && is_not_negative(s.sideways) && is_not_negative(s.vertical) &&
           is_not_negative(s.stalled_below) && is_not_negative(s.stall) && is_positive(s.blocked);
}

/// Settings that check() does not cover, or lets studies choose.
bool has_good_numbers(const FilterSettings& s) noexcept
{
    return is_valid(s.obstacles) && has_good_bias(s.bias) && is_positive(s.pair.conflict_ratio) &&
           is_positive(s.half_width) && is_positive(s.half_height) && s.cover >= 1.0F && s.cover <= kLargestCover &&
           is_positive(s.most_apart) && is_positive(s.own_stale) && is_not_negative(s.stale) &&
           is_not_negative(s.tick) && is_not_negative(s.loop.act) && is_not_negative(s.loop.lag) && s.smoothing >= 1 &&
           s.smoothing <= CommandFilter::kMax;
}

Unsafe check_filter(const FilterSettings& s) noexcept
{
    if (!has_good_numbers(s)) {
        return Unsafe::not_positive;
    }
    SafetyQuestion question;
    question.limits = s.limits;
    question.pair = s.pair;
    question.across = 2.0F * s.cover * s.half_width;
    question.upright = 2.0F * s.cover * s.half_height;
    question.obstacle_horizon = s.obstacles.horizon;
    question.delay = s.delay;
    return check(question);
}

/// Away from a bound, or no faster towards it than meets it at the horizon.
HalfSpace bound_half_space(const Bound& bound, const ObstacleSettings& settings) noexcept
{
    const float speed = bound.gap >= 0.0F ? bound.gap / settings.horizon
                                          : -std::min(settings.recovery_speed, -bound.gap / settings.recovery_time);
    HalfSpace out;
    out.normal = -bound.outward;
    out.offset = -(speed + bound.speed);
    out.level = Level::obstacles;
    return out;
}

bool is_whole(const FilterInput& input) noexcept
{
    const bool bounds = input.bounds.size() <= kMaxBounds &&
                        std::all_of(input.bounds.begin(), input.bounds.end(), [](const Bound& bound) {
                            return is_finite(bound.outward) && std::isfinite(bound.gap) && std::isfinite(bound.speed);
                        });
    return bounds && is_finite(input.own.position) && is_finite(input.own.velocity) && is_finite(input.preferred) &&
           std::isfinite(input.own_age);
}

}  // namespace

/// Half-spaces by level, those of limits ending where the others begin, so that others can take their place.
struct VelocityFilter::Tick {
    const FilterInput& input;
    Decision out;
    LimitSet limits;
    Planes& planes;
    std::size_t first = kMaxLimitPlanes;  ///< of limits
    std::size_t hard = kMaxLimitPlanes;   ///< one after those that are kept when the command is smoothed
    std::size_t end = kMaxLimitPlanes;
    StaticVector<BiasNeighbour, kMaxOrcaNeighbours> seen;

    Tick(const FilterInput& given, Planes& memory) noexcept : input(given), planes(memory) {}

    void add(const HalfSpace& plane) noexcept { planes[end++] = plane; }
    void put_limits(const LimitSet& set) noexcept
    {
        first = kMaxLimitPlanes - set.size;
        std::copy_n(set.planes.begin(), set.size, planes.begin() + static_cast<std::ptrdiff_t>(first));
    }
    [[nodiscard]] std::span<const HalfSpace> until(std::size_t last) const noexcept
    {
        return {planes.data() + first, last - first};
    }
    void say(bool condition, std::uint32_t bit) noexcept { out.status |= condition ? bit : 0U; }
};

Unsafe VelocityFilter::configure(const FilterSettings& settings) noexcept
{
    const Unsafe found = check_filter(settings);
    if (found == Unsafe::not_positive || (found != Unsafe::none && !settings.accepts_unsafe)) {
        return found;
    }
    if (settings.smoothing != mean_.length()) {
        mean_ = CommandFilter(settings.smoothing);
    }
    settings_ = settings;
    neighbours_ = neighbour_settings(settings);
    bias_.configure(settings.bias);
    configured_ = true;
    return Unsafe::none;
}

void VelocityFilter::reset() noexcept
{
    bias_.reset();
    slow_down_.reset();
    mean_.clear();
    issued_.clear();
    has_solution_ = false;
}

bool VelocityFilter::issued(TimePoint now, const Vec3& velocity) noexcept
{
    return issued_.add(now, velocity) == RingStatus::ok;
}

void VelocityFilter::add_bounds(Tick& tick) const noexcept
{
    for (std::size_t i = 0; i < tick.input.bounds.size(); ++i) {
        HalfSpace plane = bound_half_space(tick.input.bounds[i], settings_.obstacles);
        plane.source = static_cast<std::uint16_t>(kBoundSource + i);
        tick.say(tick.input.bounds[i].gap < 0.0F, kBoundsOverlap);
        tick.add(plane);
    }
}

void VelocityFilter::add_obstacles(Tick& tick, WorkBudget& budget) const noexcept
{
    OwnMotion own;
    own.position = tick.input.own.position;
    own.velocity = tick.input.own.velocity;
    own.reach_speed =
        std::min(tick.limits.spheres[0].radius, tick.limits.reference.norm() + tick.limits.spheres[1].radius);
    const ObstaclePlanes found = obstacle_planes(tick.input.obstacles, own, settings_.obstacles, budget);
    for (const HalfSpace& plane : found.planes) {
        tick.add(plane);
    }
    tick.say(!cap_speed(tick.limits, found.speed_cap), kCapBroken);
    tick.say(found.truncated, kObstaclesTruncated);
    tick.say(found.penetrating, kObstaclePenetration);
    tick.say(found.bounded, kDistanceBounded);
    tick.out.margin = found.margin;
    tick.out.nearest_obstacle = found.nearest;
}

void VelocityFilter::add_neighbours(Tick& tick, WorkBudget& budget) noexcept
{
    const Selection chosen = select(neighbours_, tick.input.neighbours, budget);
    tick.say(!cap_speed(tick.limits, chosen.speed_cap), kCapBroken);
    tick.say(chosen.truncated > 0, kNeighboursTruncated);
    tick.say(chosen.stale > 0, kNeighbourStale);
    tick.say(chosen.refused > 0, kNeighbourRefused);
    tick.say(chosen.exhausted, kWorkLimit);
    tick.out.horizon = chosen.horizon;
    StaticVector<HalfSpace, kMaxOrcaNeighbours> warnings;
    for (const std::uint16_t index : chosen.chosen) {
        const Neighbour& other = tick.input.neighbours[index];
        // The half-spaces of all that are chosen are made even so: there are few of them.
        static_cast<void>(budget.spend(units::kOrcaPair));
        const Pair pair = pair_of(neighbours_, tick.input.own.velocity, other, index);
        const PairPlanes planes = pair_planes(pair, settings_.pair);
        tick.add(planes.conflict);
        warnings.unchecked_push_back(planes.warning);
        const float share = planes.distance / (settings_.pair.conflict_ratio * pair.across);
        if (share < tick.out.nearest) {
            tick.out.nearest = share;
            tick.out.nearest_id = other.id;
        }
        constexpr float kCoincident2 = 1e-12F;  // [m2], below which there is no side to pass on
        if (other.position.squaredNorm() > kCoincident2) {
            tick.seen.unchecked_push_back({other.id, other.position, side(other.position)});
        }
    }
    tick.say(tick.out.nearest < 1.0F, kConflictOverlap);
    tick.hard = tick.end;
    for (const HalfSpace& plane : warnings) {
        tick.add(plane);
    }
}

Vec3 VelocityFilter::preferred_of(Tick& tick) noexcept
{
    const Seconds period = settings_.tick > 0.0F ? settings_.tick : settings_.limits.period;
    const float factor = settings_.slows_down ? slow_down_.update(tick.out.nearest, period) : 1.0F;
    const Biased biased = bias_.apply(settings_.own_id, factor * tick.input.preferred, tick.input.own.velocity,
                                      {tick.seen.data(), tick.seen.size()}, period);
    tick.say(biased.blocked, kBlocked);
    return biased.preferred;
}

/// Filtering keeps the slew, not the half-spaces: what comes out goes once more through all but the warning ones
/// (Alejo 8.4 with G-ORCA's D18b). The solutions' own reference stays that of the solutions, or the two would lag each
/// other.
void VelocityFilter::smooth(Tick& tick, const Solution& solution, WorkBudget& budget) noexcept
{
    tick.out.command = solution.velocity;
    if (settings_.smoothing <= 1) {
        return;
    }
    const bool anew = (tick.out.status & kResynchronised) != 0;
    if (anew) {
        mean_.clear();  // of commands that nobody flew
    }
    const Vec3 mean = mean_.add(solution.velocity);
    const Vec3 last = anew || issued_.empty() ? tick.input.own.velocity : issued_.newest().velocity;
    LimitSet limits = limit_set(settings_.limits, last);
    limits.spheres[0].radius = std::min(limits.spheres[0].radius, tick.limits.spheres[0].radius);
    tick.put_limits(limits);
    const Solution smoothed =
        solve({tick.until(tick.hard), limits.spheres, mean, limits.reference}, scratch_.view(), budget);
    if (smoothed.status == 0) {
        tick.out.command = smoothed.velocity;
    } else {
        tick.say(true, kNotSmoothed);
    }
}

void VelocityFilter::choose(Tick& tick, WorkBudget& budget) noexcept
{
    const Vec3 preferred = preferred_of(tick);
    const Solution solution =
        solve({tick.until(tick.end), tick.limits.spheres, preferred, tick.limits.reference}, scratch_.view(), budget);
    tick.out.status |= solution.status;
    if ((solution.status & kBadInput) != 0) {
        brake(tick);
        return;
    }
    tick.out.level = solution.level;
    tick.out.broken = solution.broken;
    for (std::size_t i = 0; i < solution.actives; ++i) {
        const HalfSpace& plane = tick.planes[tick.first + solution.active[i]];
        tick.out.bindings.unchecked_push_back({plane.level, plane.source});
    }
    last_solution_ = solution.velocity;
    has_solution_ = true;
    smooth(tick, solution, budget);
    if (settings_.looks_along) {
        const WayClearance way = clearance_along(tick.input.obstacles, tick.input.own.position, tick.out.command,
                                                 settings_.obstacles.horizon, settings_.obstacles, budget);
        tick.out.clear_until = way.clear_until;
        tick.say(!way.clear, kObstacleAhead);
    }
}

/// All the braking that one period allows, from what was sent last: the mean of solutions is not the last of them.
void VelocityFilter::brake(Tick& tick) noexcept
{
    const Vec3& flown = tick.input.own.velocity;
    const Vec3 start = is_finite(flown) ? flown : Vec3(Vec3::Zero());
    const Vec3 last = !has_solution_ ? start : issued_.empty() ? last_solution_ : issued_.newest().velocity;
    const MotionLimits& limits = settings_.limits;
    const float speed = last.norm();
    const float most = limits.acceleration * limits.period;
    const Vec3 braked = speed > most ? Vec3(last * (1.0F - most / speed)) : Vec3(Vec3::Zero());
    tick.out.command = clamped(limits, braked);
    last_solution_ = tick.out.command;
    has_solution_ = true;
    mean_.clear();
}

Decision VelocityFilter::decide(const FilterInput& input, WorkBudget& budget) noexcept
{
    const std::uint32_t before = budget.spent();
    Tick tick(input, planes_);
    tick.say(!configured_, kConfigUnsafe);
    tick.say(!is_whole(input), kBadInput);
    tick.say(input.own_age > settings_.own_stale, kOwnStale);
    if (tick.out.status != 0) {
        brake(tick);
        return tick.out;
    }
    tick.say(input.own.clipped, kDelayClipped);
    const Vec3 last = has_solution_ ? last_solution_ : input.own.velocity;
    const Reference reference = reference_velocity(last, input.own.velocity, settings_.most_apart);
    tick.say(has_solution_ && reference.resynchronised, kResynchronised);
    tick.limits = limit_set(settings_.limits, reference.velocity);
    tick.say(tick.limits.stalled, kStalled);
    tick.put_limits(tick.limits);
    add_bounds(tick);
    add_obstacles(tick, budget);
    add_neighbours(tick, budget);
    choose(tick, budget);
    tick.out.work = budget.spent() - before;
    return tick.out;
}

}  // namespace jink::orca
