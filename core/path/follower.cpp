// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/follower.hpp"

#include <algorithm>
#include <cmath>

namespace jink::path {
namespace {

/// A rest of the path shorter than this share of a step is flown with the step before it: no point of `out` may be so
/// near to the next one that the velocity between them is rounding.
constexpr float kLeastStep = 1e-3F;

/// A corner of the path is flown as a turn over this long on either side of it, or half a segment where that is shorter
/// [s].
constexpr Seconds kCornerTime = 0.25F;

/// The path's velocity at `t`, blended linearly across the corners: with points close together it is the velocity of
/// the smooth curve that the points were taken from, not that of its chords.
Vec3 smooth_velocity(const TimedPath& path, Seconds t) noexcept
{
    const auto& points = path.points;
    if (points.size() < 3) {
        return points.front().velocity;
    }
    const PathPoint* const next = std::clamp(
        std::upper_bound(points.begin(), points.end(), t, [](Seconds at, const PathPoint& p) { return at < p.time; }),
        points.begin() + 1, points.end() - 1);
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

/// Ends the segment that `out` ends with: its velocity is what led to `position`.
void append(TimedPath& out, const Vec3& position, Seconds time) noexcept
{
    PathPoint& last = out.points.back();
    last.velocity = (position - last.position) / (time - last.time);
    out.points.unchecked_push_back({position, last.velocity, time});
}

/// Steps of `dt` from 0 to `length`, `fly(from, to)` flown in each and a point added after each.
template <class Fly>
void fly_steps(vehicle::VehicleState& state, Seconds length, Seconds dt, TimedPath& out, const Fly& fly) noexcept
{
    out.points.clear();
    out.points.unchecked_push_back({state.position, state.velocity, 0.0F});
    Seconds now = 0.0F;
    while (!out.points.full() && length - now > kLeastStep * dt) {
        const auto step = static_cast<float>(out.points.size());  // not summed up: 60 steps of 0.1 s end at 6 s
        const Seconds next = length - step * dt > kLeastStep * dt ? step * dt : length;
        fly(now, next);
        append(out, state.position, next);
        now = next;
    }
}

}  // namespace

Vec3 follow(const TimedPath& path, Seconds t, const Vec3& position, const vehicle::VehicleLimits& limits,
            const FollowerGains& gains) noexcept
{
    Vec3 correction = gains.position_gain * (sample(path, t).position - position);
    const float size = correction.norm();
    if (size > gains.max_correction) {
        correction *= gains.max_correction / size;
    }
    Vec3 command = correction;
    if (t < path.duration()) {
        command += smooth_velocity(path, t + limits.velocity_lag);
    }
    command.z() = std::clamp(command.z(), -limits.max_descent, limits.max_climb);
    return command;
}

void predict_flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start, Seconds dt,
                    const vehicle::VehicleLimits& limits, const FollowerGains& gains, TimedPath& out) noexcept
{
    vehicle::VehicleState flown = state;
    const int parts = std::max(1, static_cast<int>(std::ceil(dt / kFollowerPeriod - 1e-3F)));
    fly_steps(flown, path.duration() - start, dt, out, [&](Seconds from, Seconds to) {
        const Seconds part = (to - from) / static_cast<float>(parts);
        for (int i = 0; i < parts; ++i) {
            const Seconds t = start + from + static_cast<float>(i) * part;
            vehicle::advance(flown, follow(path, t, flown.position, limits, gains), limits, part);
        }
    });
}

void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                              const vehicle::VehicleLimits& limits, TimedPath& out) noexcept
{
    vehicle::VehicleState flown = state;
    fly_steps(flown, horizon, dt, out,
              [&](Seconds from, Seconds to) { vehicle::advance(flown, command, limits, to - from); });
}

}  // namespace jink::path
