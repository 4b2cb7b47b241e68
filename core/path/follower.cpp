// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/follower.hpp"

#include <algorithm>
#include <cmath>

#include "core/path/flight.hpp"

namespace jink::path {
namespace {

/// A corner of the path is flown as a turn that lasts this long on either side of the corner, at most half a segment
/// [s].
constexpr Seconds kCornerTime = 0.25F;

/// First point after `t`, limited to the range from the second point to the last. O(log points).
std::size_t search(const TimedPath& path, Seconds t) noexcept
{
    const auto& points = path.points;
    const PathPoint* const next =
        std::upper_bound(points.begin(), points.end(), t, [](Seconds at, const PathPoint& p) { return at < p.time; });
    const auto found = static_cast<std::size_t>(next - points.begin());
    return std::max<std::size_t>(std::min(found, points.size() - 1), 1);
}

/// The path's position at `t`; `next` as returned by `search`.
Vec3 position_at(const TimedPath& path, Seconds t, std::size_t next) noexcept
{
    const auto& points = path.points;
    if (t <= points.front().time) {
        return points.front().position;
    }
    if (t >= points.back().time) {
        return points.back().position;
    }
    const PathPoint& from = points[next - 1];
    const PathPoint& to = points[next];
    const float share = (t - from.time) / (to.time - from.time);
    return from.position + share * (to.position - from.position);
}

/// The path's velocity at `t`, blended linearly across the corners; `next` as returned by `search`. With points close
/// together the result is the velocity of the smooth curve through the points, not that of its chords.
Vec3 smooth_velocity(const TimedPath& path, Seconds t, std::size_t next_index) noexcept
{
    const auto& points = path.points;
    if (points.size() < 3) {
        return points.front().velocity;
    }
    const PathPoint* const next = points.begin() + next_index;
    const PathPoint& from = *(next - 1);
    const Seconds half = 0.5F * (next->time - from.time);
    const bool late = t - from.time > half;
    const PathPoint* const corner = late ? next : &from;
    if (corner == points.begin() || corner == points.end() - 1) {
        return from.velocity;
    }
    const PathPoint& before = *(corner - 1);
    const PathPoint& after = *(corner + 1);
    const Seconds in = std::min(0.5F * (corner->time - before.time), kCornerTime);
    const Seconds out = std::min(0.5F * (after.time - corner->time), kCornerTime);
    const float share = std::clamp((t - (corner->time - in)) / (in + out), 0.0F, 1.0F);
    return before.velocity + share * (corner->velocity - before.velocity);
}

/// Ends the last segment of `out`: its velocity is the one that leads to `position`.
void append(TimedPath& out, const Vec3& position, Seconds time) noexcept
{
    PathPoint& last = out.points.back();
    last.velocity = (position - last.position) / (time - last.time);
    out.points.unchecked_push_back({position, last.velocity, time});
}

}  // namespace

namespace detail {

Vec3 command(const TimedPath& path, Seconds t, std::size_t next, Seconds ahead, std::size_t next_ahead,
             const Vec3& position, const vehicle::VehicleLimits& limits, const FollowerGains& gains) noexcept
{
    Vec3 correction = gains.position_gain * (position_at(path, t, next) - position);
    // Squares are compared, so that most commands avoid two dependent square roots.
    const float size = correction.squaredNorm();
    if (size > gains.max_correction * gains.max_correction) {
        correction *= gains.max_correction / std::sqrt(size);
    }
    Vec3 command = correction;
    float fastest = limits.cruise_speed * limits.cruise_speed;
    if (t < path.duration()) {
        const Vec3 velocity = smooth_velocity(path, ahead, next_ahead);
        command += velocity;
        fastest = std::max(fastest, velocity.squaredNorm());
    }
    command.z() = std::clamp(command.z(), -limits.max_descent, limits.max_climb);
    const float speed = command.squaredNorm();
    return speed > fastest ? Vec3(command * std::sqrt(fastest / speed)) : command;
}

}  // namespace detail

Vec3 follow(const TimedPath& path, Seconds t, const Vec3& position, const vehicle::VehicleLimits& limits,
            const FollowerGains& gains) noexcept
{
    const Seconds ahead = t + limits.velocity_lag;
    return detail::command(path, t, search(path, t), ahead, search(path, ahead), position, limits, gains);
}

void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                              const vehicle::VehicleLimits& limits, TimedPath& out) noexcept
{
    out.points.clear();
    out.points.unchecked_push_back({state.position, state.velocity, 0.0F});
    vehicle::VehicleState flown = state;
    vehicle::detail::Fading fading(limits.velocity_lag);
    const detail::Steps steps(horizon, dt, kMaxPathPoints - 1);
    Seconds from = 0.0F;
    for (std::size_t step = 1; step <= steps.count && !out.points.full(); ++step) {
        const Seconds to = steps.end_of(step);
        vehicle::detail::move(flown.position, flown.velocity, command, limits, to - from, fading);
        append(out, flown.position, to);
        from = to;
    }
}

}  // namespace jink::path
