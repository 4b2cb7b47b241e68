// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/limits.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"

namespace jink::orca {

namespace {

constexpr float kEulersNumber = 2.7182818F;
constexpr float kNoDirection = 1e-6F;  // [m/s]

float speed_across(const Vec3& v) noexcept { return std::sqrt(v.x() * v.x() + v.y() * v.y()); }

void add_plane(LimitSet& set, const Vec3& normal, float offset) noexcept
{
    HalfSpace& plane = set.planes[set.size++];
    plane.normal = normal;
    plane.offset = offset;
    plane.level = Level::limits;
    plane.source = static_cast<std::uint16_t>(set.size - 1);
}

void add_turn(const MotionLimits& limits, LimitSet& set) noexcept
{
    const float level = speed_across(set.reference);
    if (limits.turn_radius <= 0.0F || level < kHover) {
        return;
    }
    // Beyond a right angle both half-spaces would cut each other off.
    const float angle = std::min(level * limits.period / limits.turn_radius, 0.5F * kPi - 0.01F);
    const float cosine = std::cos(angle);
    const float sine = std::sin(angle);
    const float x = set.reference.x() / level;
    const float y = set.reference.y() / level;
    // Not left of the heading turned to the left, not right of the one turned to the right.
    add_plane(set, {sine * x + cosine * y, sine * y - cosine * x, 0.0F}, 0.0F);
    add_plane(set, {sine * x - cosine * y, sine * y + cosine * x, 0.0F}, 0.0F);
}

void add_climb(const MotionLimits& limits, LimitSet& set) noexcept
{
    const bool apart = limits.climb_acceleration > 0.0F && limits.sink_acceleration > 0.0F;
    float most = limits.climb_rate > 0.0F ? limits.climb_rate : limits.max_speed;
    float least = limits.sink_rate > 0.0F ? -limits.sink_rate : -limits.max_speed;
    if (apart) {
        most = std::min(most, set.reference.z() + limits.climb_acceleration * limits.period);
        least = std::max(least, set.reference.z() - limits.sink_acceleration * limits.period);
    }
    if (most < limits.max_speed) {
        add_plane(set, -Vec3::UnitZ(), -most);
    }
    if (least > -limits.max_speed) {
        add_plane(set, Vec3::UnitZ(), least);
    }
}

}  // namespace

Reference reference_velocity(const Vec3& last_command, const Vec3& predicted, float most) noexcept
{
    const bool near = is_finite(last_command) && (last_command - predicted).norm() <= most;
    return near ? Reference{last_command, false} : Reference{predicted, true};
}

Vec3 clamped(const MotionLimits& limits, const Vec3& velocity) noexcept
{
    Vec3 out = velocity;
    if (limits.climb_rate > 0.0F) {
        out.z() = std::min(out.z(), limits.climb_rate);
    }
    if (limits.sink_rate > 0.0F) {
        out.z() = std::max(out.z(), -limits.sink_rate);
    }
    const float speed = out.norm();
    if (speed > limits.max_speed) {
        return out * (limits.max_speed / speed);
    }
    const float level = speed_across(out);
    if (speed < limits.min_speed && level > kNoDirection) {
        const float wanted = std::sqrt((limits.min_speed - out.z()) * (limits.min_speed + out.z()));
        out.x() *= wanted / level;
        out.y() *= wanted / level;
    }
    return out;
}

LimitSet limit_set(const MotionLimits& limits, const Vec3& reference) noexcept
{
    LimitSet set;
    set.reference = clamped(limits, reference);
    set.spheres[0] = {Vec3::Zero(), limits.max_speed};
    set.spheres[1] = {set.reference, limits.acceleration * limits.period};
    const float speed = set.reference.norm();
    if (limits.min_speed > 0.0F) {
        constexpr float kRounding = 1.0F - 1e-6F;
        if (speed >= limits.min_speed * kRounding) {
            add_plane(set, set.reference / speed, std::min(limits.min_speed, speed));
        } else {
            set.stalled = true;
        }
    }
    add_turn(limits, set);
    add_climb(limits, set);
    return set;
}

bool cap_speed(LimitSet& set, float cap) noexcept
{
    float& radius = set.spheres[0].radius;
    if (cap >= radius) {
        return true;
    }
    // What is left of the speed after a period of braking, as far as the least speed and the climb leave that, and a
    // little, so that the spheres and half-spaces have more than a point.
    constexpr float kBrake = 0.99F;
    const float speed = set.reference.norm();
    float share = speed > 0.0F ? std::max(1.0F - kBrake * set.spheres[1].radius / speed, 0.0F) : 0.0F;
    for (const HalfSpace& plane : set.half_spaces()) {
        if (plane.offset > 0.0F) {
            const float full = plane.offset / plane.normal.dot(set.reference);  // the reference keeps to the plane
            share = std::max(share, std::min(full + (1.0F - kBrake) * (1.0F - full), 1.0F));
        }
    }
    const float least = share * speed;
    radius = std::min(radius, std::max(cap, least));
    return cap >= least;
}

Seconds braking_time(const MotionLimits& limits) noexcept
{
    const Seconds across = limits.max_speed / limits.acceleration;
    const auto upright = [&](float rate, float acceleration) noexcept {
        const float speed = rate > 0.0F ? std::min(rate, limits.max_speed) : limits.max_speed;
        return speed / acceleration;
    };
    const bool apart = limits.climb_acceleration > 0.0F && limits.sink_acceleration > 0.0F;
    return !apart ? across
                  : std::max({across, upright(limits.climb_rate, limits.sink_acceleration),
                              upright(limits.sink_rate, limits.climb_acceleration)});
}

Unsafe check(const SafetyQuestion& q) noexcept
{
    const MotionLimits& limits = q.limits;
    const PairSettings& pair = q.pair;
    for (const float value : {limits.max_speed, limits.acceleration, limits.period, pair.horizon, pair.recovery_speed,
                              pair.recovery_time, pair.brake, pair.period, q.across, q.upright, q.obstacle_horizon}) {
        if (!is_positive(value)) {
            return Unsafe::not_positive;
        }
    }
    for (const float value : {limits.min_speed, limits.climb_acceleration, limits.sink_acceleration, limits.turn_radius,
                              limits.climb_rate, limits.sink_rate, pair.ramp_speed, q.delay}) {
        if (!is_not_negative(value)) {
            return Unsafe::not_positive;
        }
    }
    if (!(pair.conflict_ratio > 0.0F && pair.conflict_ratio < 1.0F) || limits.min_speed >= limits.max_speed) {
        return Unsafe::regions;
    }
    const float stretch = q.across / q.upright;
    if (stretch < kMinStretch || stretch > kMaxStretch) {
        return Unsafe::stretch;
    }
    const float brakes = braking_time(limits);
    const float delayed = kEulersNumber * q.delay;
    constexpr float kRounding = 1.0F + 1e-5F;  // defaults are just what is asked for
    if (q.obstacle_horizon * kRounding < brakes) {
        return Unsafe::obstacle_horizon_brakes;
    }
    if (q.obstacle_horizon * kRounding < delayed) {
        return Unsafe::obstacle_horizon_delay;
    }
    if (pair.horizon * kRounding < 2.0F * brakes) {
        return Unsafe::horizon_brakes;
    }
    if (pair.horizon * kRounding < delayed) {
        return Unsafe::horizon_delay;
    }
    if (pair.ramp_speed * delayed > q.across * (1.0F - pair.conflict_ratio) * kRounding) {
        return Unsafe::ramp_gain;
    }
    if (pair.ramp_speed > limits.acceleration * kRounding) {
        return Unsafe::ramp_acceleration;
    }
    if (pair.recovery_time * kRounding < delayed) {
        return Unsafe::recovery_delay;
    }
    const bool rests = pair.conflict == Conflict::at_rest;
    return rests && pair.brake * kRounding < std::max(brakes, delayed) ? Unsafe::rest_brake : Unsafe::none;
}

float ramp_speed_for(float across, float conflict_ratio, float delay, float acceleration) noexcept
{
    constexpr float kMax = 0.3F;  // [m/s]
    const float most = std::min(kMax, acceleration);
    const float width = across * (1.0F - conflict_ratio);
    return delay > 0.0F ? std::min(most, width / (kEulersNumber * delay)) : most;
}

}  // namespace jink::orca
