// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/flown.hpp"

#include <algorithm>
#include <optional>

#include "core/path/flight.hpp"

namespace jink::geometric::detail {
namespace {

/// Points that the braking tail of a verified flight takes.
constexpr std::size_t kTailPoints = std::min<std::size_t>(12, kMaxPathPoints / 4);
/// Step of a verified flight [s], longer where the path would not fit otherwise.
constexpr Seconds kFlightStep = 0.2F;
/// Frames that are not quite unitary, times that are rounded: no flight is faster than its bound by this.
constexpr float kSpeedTolerance = 1.01F;

void append(Curve& curve, const Vec3& position, Seconds t) noexcept
{
    const std::size_t i = curve.points++;
    curve.x[i] = position.x();
    curve.y[i] = position.y();
    curve.z[i] = position.z();
    curve.t[i] = t;
}

bool brakes_at_end(const vehicle::VehicleLimits& limits) noexcept
{
    return limits.kind == vehicle::VehicleKind::multirotor;
}

}  // namespace

Flown::Flown(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
             Clearance& clearance) noexcept
    : limits_(limits), settings_(settings), clearance_(clearance), start_velocity_(problem.start_velocity),
      // A velocity is always between the one before and a command: the path's, and a correction.
      fastest_(kSpeedTolerance * std::max(start_velocity_.norm(), problem.speed + settings.gains.max_correction)),
      fastest_vertical_(kSpeedTolerance *
                        std::max({std::abs(start_velocity_.z()), limits.max_climb, limits.max_descent})),
      longest_tail_(brakes_at_end(limits) ? std::max(vehicle::stopping_time(fastest_, limits), kFlightStep) : 0.0F),
      fading_(limits.velocity_lag)
{
}

path::TimedPath& Flown::add() noexcept { return lanes_[lanes_in_use_++].path; }

void Flown::fly() noexcept
{
    Seconds longest = 0.0F;
    for (std::size_t k = 0; k < lanes_in_use_; ++k) {
        longest = std::max(longest, lanes_[k].path.duration());
    }
    if (longest > reach_time_) {
        reach_time_ = longest;
        const Seconds time = longest + longest_tail_;
        const Vec3 reach = Vec3::Constant(fastest_ * time);
        has_first_ = clearance_.find_first({-reach, reach}, time);
    }
    fly_paths();
    if (brakes_at_end(limits_)) {
        fly_tails();
    }
}

/// Whether the lane's flight, which has just touched the first item, can end with nothing else.
bool Flown::stops(const Lane& lane, Room& room) noexcept
{
    const Curve& flight = lane.flight;
    if (!clearance_.touches_first(flight, flight.points - 2, room)) {
        return false;
    }
    const Seconds rest = lane.path.duration() - flight.duration() + longest_tail_;
    return clearance_.stays_in_airspace(flight, fastest_ * rest, fastest_vertical_ * rest);
}

/// The lane at the start of a flight of `steps`, and of its tail.
void Flown::start(Lane& lane, std::size_t steps) const noexcept
{
    lane.points = 1 + steps;
    if (brakes_at_end(limits_)) {
        lane.points = std::min(lane.points + kTailPoints - 1, kMaxPathPoints);
    }
    lane.stopped = false;
    lane.flight.points = 0;
    lane.flight.fastest = fastest_;
    append(lane.flight, Vec3::Zero(), 0.0F);
}

void Flown::fly_paths() noexcept
{
    vehicle::VehicleState state;
    state.velocity = start_velocity_;
    std::array<std::optional<path::detail::Flight>, kLanes> flights;
    std::array<std::optional<Room>, kLanes> rooms;
    std::size_t flying = 0;
    int parts = 0;
    for (std::size_t k = 0; k < lanes_in_use_; ++k) {
        Lane& lane = lanes_[k];
        const Seconds duration = lane.path.duration();
        const Seconds step = std::max(kFlightStep, duration / static_cast<float>(kMaxPathPoints - kTailPoints - 1));
        flights[k].emplace(state, lane.path, 0.0F, step, limits_, settings_.gains);
        start(lane, flights[k]->steps());
        rooms[k] = clearance_.room_of_first(fastest_, duration + longest_tail_);
        parts = std::max(parts, flights[k]->parts());
        flying += flights[k]->ended() ? 0U : 1U;
    }
    while (flying > 0) {
        const auto is_flying = [&](std::size_t k) { return !flights[k]->ended() && !lanes_[k].stopped; };
        for (int i = 0; i < parts; ++i) {
            for (std::size_t k = 0; k < lanes_in_use_; ++k) {
                if (is_flying(k) && i < flights[k]->parts()) {
                    flights[k]->fly(i, fading_);
                }
            }
        }
        for (std::size_t k = 0; k < lanes_in_use_; ++k) {
            if (is_flying(k)) {
                flights[k]->end_step();
                append(lanes_[k].flight, flights[k]->position(), flights[k]->time());
                lanes_[k].stopped = has_first_ && stops(lanes_[k], *rooms[k]);
                flying -= is_flying(k) ? 0U : 1U;
            }
        }
    }
}

/// Braking from the end of each flight on.
void Flown::fly_tails() noexcept
{
    struct Tail {
        Vec3 position, velocity;
        Seconds start;
        path::detail::Steps steps;
        Lane* lane;
    };
    std::array<std::optional<Tail>, kLanes> tails;
    for (std::size_t k = 0; k < lanes_in_use_; ++k) {
        Lane& lane = lanes_[k];
        if (lane.stopped) {
            continue;
        }
        const Curve& flight = lane.flight;
        const std::size_t last = flight.points - 1;
        const Vec3 velocity = last > 0 ? flight.velocity(last - 1) : start_velocity_;
        const Seconds span = std::max(vehicle::stopping_time(velocity.norm(), limits_), kFlightStep);
        tails[k].emplace(Tail{flight.position(last),
                              velocity,
                              flight.t[last],
                              {span, span / static_cast<float>(kTailPoints - 1), kMaxPathPoints - 1},
                              &lane});
    }
    for (std::size_t i = 1; i < kTailPoints; ++i) {
        for (std::optional<Tail>& tail : tails) {
            if (!tail || i > tail->steps.count || tail->lane->flight.points == kMaxPathPoints) {
                continue;
            }
            const Seconds from = i > 1 ? tail->steps.end_of(i - 1) : 0.0F;
            const Seconds to = tail->steps.end_of(i);
            vehicle::detail::move(tail->position, tail->velocity, Vec3::Zero(), limits_, to - from, fading_);
            append(tail->lane->flight, tail->position, to + tail->start);
        }
    }
}

Verdict Flown::judge(std::size_t lane, Seconds longest, WorkBudget& budget) noexcept
{
    const Lane& flown = lanes_[lane];
    if (flown.stopped) {
        return clearance_.first_verdict(flown.points - 1, budget);
    }
    clearance_.collect(extent_of(flown.flight), flown.flight.duration(), budget);
    clearance_.sweep_until(std::max(longest, flown.flight.duration()));
    return clearance_.check(flown.flight, budget);
}

}  // namespace jink::geometric::detail
