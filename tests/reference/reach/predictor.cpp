// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/predictor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"

namespace jink::reach {
namespace {

/// Single precision may make a sum of times longer by this share.
constexpr float kTimeSlack = 1e-6F;

float change_time(const TransitionTimes& times, Movement from, float from_speed, Movement to, float to_speed) noexcept
{
    const Turn a = turn_of(from);
    const Turn b = turn_of(to);
    const float turn = times.turn * std::abs(static_cast<float>(a.yaw - b.yaw));
    const float pitch = times.pitch * std::abs(static_cast<float>(a.pitch - b.pitch));
    return std::max({turn, pitch, from_speed == to_speed ? 0.0F : times.speed});
}

Pose<float> flown_on(const Pose<float>& from, float length) noexcept
{
    return apply(from, Movement::straight, MovementStep<float>{length, 0.0F, 0.0F});
}

}  // namespace

bool is_usable(const AutomatonSettings& settings) noexcept
{
    return is_positive(settings.period) && is_not_negative(settings.least_holding) &&
           is_not_negative(settings.transitions.turn) && is_not_negative(settings.transitions.pitch) &&
           is_not_negative(settings.transitions.speed) && is_not_negative(settings.payload);
}

float least_duration(const AutomatonSettings& settings, const Order& order) noexcept
{
    const TransitionTimes& times = settings.transitions;
    float longest = 0.0F;
    for (const Movement before : kAllMovements) {
        longest = std::max(longest, change_time(times, before, -1.0F, order.movement, order.speed));
    }
    const float leave = change_time(times, order.movement, order.speed, Movement::straight, order.speed);
    return settings.least_holding + longest + leave;
}

bool can_be_flown(const AutomatonSettings& settings, const Order& order) noexcept
{
    return static_cast<std::size_t>(order.movement) < kMovements && is_positive(order.duration) &&
           is_not_negative(order.speed) && order.duration >= least_duration(settings, order) * (1.0F - kTimeSlack);
}

Leg build_leg(const AutomatonSettings& settings, const SegmentLimits& limits, const FlightState& from,
              const Exit& before, const Order& order, float begin, bool last) noexcept
{
    Leg leg;
    leg.order = order;
    leg.begin = begin;
    leg.from = from;
    leg.entry = change_time(settings.transitions, before.movement, before.speed, order.movement, order.speed);
    leg.leave =
        last ? change_time(settings.transitions, order.movement, order.speed, Movement::straight, order.speed) : 0.0F;
    const Turn turn = turn_of(order.movement);
    leg.pitch_rate = static_cast<float>(turn.pitch) * limits.pitch / settings.period;
    leg.yaw_rate = static_cast<float>(turn.yaw) * limits.yaw / settings.period;
    leg.exit = {last ? Movement::straight : order.movement, order.speed};
    return leg;
}

bool build_leg(const AutomatonSettings& settings, const Segments& segments, const FlightState& from, const Exit& before,
               const Order& order, float begin, bool last, Leg& out, bool& outside) noexcept
{
    const SegmentAt segment = segments.at({from.speed, from.pose.pitch, from.pose.position.z(), settings.payload});
    const SegmentLimits& limits = segments.limits(segment.segment);
    if (!can_be_flown(settings, order) || std::abs(order.speed - from.speed) > limits.speed_change) {
        return false;
    }
    outside = segment.outside;
    out = build_leg(settings, limits, from, before, order, begin, last);
    return true;
}

FlightState at(const Leg& leg, float elapsed) noexcept
{
    FlightState state = leg.from;
    const float entry = std::min(elapsed, leg.entry);
    state.pose = flown_on(state.pose, entry * state.speed);
    if (elapsed <= leg.entry && leg.entry > 0.0F) {
        return state;
    }
    state.speed = leg.order.speed;
    const float whole = std::max(leg.order.duration - leg.entry - leg.leave, 0.0F);
    const float held = std::min(elapsed - entry, whole);
    const MovementStep<float> step{held * state.speed, held * std::abs(leg.pitch_rate), held * std::abs(leg.yaw_rate)};
    state.pose = apply(state.pose, leg.order.movement, step);
    state.pose = flown_on(state.pose, std::max(elapsed - entry - whole, 0.0F) * state.speed);
    return state;
}

PredictStatus predict(const AutomatonSettings& settings, const Segments& segments, const FlightState& start,
                      const Exit& before, float begin, std::span<const Order> orders, Trajectory& out) noexcept
{
    out.start = start;
    out.begin = begin;
    out.legs.clear();
    out.outside = 0;
    out.not_emitted = orders.size();
    if (!is_usable(settings)) {
        return PredictStatus::bad_setting;
    }
    FlightState state = start;
    Exit exit = before;
    for (const Order& order : orders) {
        if (out.legs.full()) {
            return PredictStatus::truncated;
        }
        // Orders before a refused order are flown as planned, as if the refused order followed.
        Leg leg;
        bool outside = false;
        if (!build_leg(settings, segments, state, exit, order, out.end(), out.not_emitted == 1, leg, outside)) {
            return PredictStatus::refused;
        }
        out.outside += outside ? 1U : 0U;
        out.legs.unchecked_push_back(leg);
        --out.not_emitted;
        state = at(leg, order.duration);
        exit = leg.exit;
    }
    return PredictStatus::complete;
}

bool project(const Trajectory& trajectory, float t, FlightState& out) noexcept
{
    if (!(t >= trajectory.begin && t <= trajectory.end())) {
        return false;
    }
    if (t == trajectory.begin) {
        out = trajectory.start;
        return true;
    }
    for (const Leg& leg : trajectory.legs) {
        if (t <= leg.end()) {
            out = at(leg, t - leg.begin);
            return true;
        }
    }
    return false;
}

PredictStatus sample(const Trajectory& trajectory, std::size_t per_order, Reference& out) noexcept
{
    out.samples.clear();
    out.not_emitted = trajectory.legs.size() + trajectory.not_emitted;
    if (per_order == 0) {
        return PredictStatus::bad_setting;
    }
    out.samples.unchecked_push_back({trajectory.begin, trajectory.start.pose.position});
    for (const Leg& leg : trajectory.legs) {
        if (out.samples.size() + per_order > kMaxReferenceSamples) {
            return PredictStatus::truncated;
        }
        for (std::size_t k = 1; k <= per_order; ++k) {
            const float share = static_cast<float>(k) / static_cast<float>(per_order);
            const float elapsed = k == per_order ? leg.order.duration : share * leg.order.duration;
            out.samples.unchecked_push_back({leg.begin + elapsed, at(leg, elapsed).pose.position});
        }
        --out.not_emitted;
    }
    return out.not_emitted == 0 ? PredictStatus::complete : PredictStatus::truncated;
}

}  // namespace jink::reach
