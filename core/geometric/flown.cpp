// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/flown.hpp"

#include <algorithm>
#include <cassert>

#include "core/base/work_units.hpp"
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

float fastest_goal(const Problem& problem, const vehicle::VehicleLimits& limits) noexcept
{
    const float commanded = problem.speed + problem.rules.gains.max_correction;
    const bool wing = limits.kind == vehicle::VehicleKind::fixed_wing;
    return wing ? std::max(commanded, limits.cruise_speed + std::max(limits.max_climb, limits.max_descent)) : commanded;
}

}  // namespace

Flown::Flown(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept
    : limits_(limits), gains_(problem.rules.gains), clearance_(problem, settings, limits),
      start_velocity_(problem.start_velocity),
      // A velocity is always between the one before and what a command leads to: the path's, and a correction.
      fastest_(kSpeedTolerance * std::max(start_velocity_.norm(), fastest_goal(problem, limits))),
      fading_(limits.velocity_lag)
{
}

/// False where the budget does not allow for all of it; otherwise it is flown to its end.
bool Flown::fly(const path::TimedPath& path, WorkBudget& budget) noexcept
{
    vehicle::VehicleState state;
    state.velocity = start_velocity_;
    const Seconds duration = path.duration();
    const Seconds step = std::max(kFlightStep, duration / static_cast<float>(kMaxPathPoints - kTailPoints - 1));
    path::detail::Flight flight(state, path, 0.0F, step, limits_, gains_, {kSettled, kSettledPart});
    const std::size_t tail = brakes_at_end(limits_) ? kTailPoints - 1 : 0;
    if (units::kCandidatePart * (flight.all_parts() + tail) + units::kCandidateStep * flight.steps() > budget.left()) {
        static_cast<void>(budget.spend(budget.left()));
        static_cast<void>(budget.spend());
        return false;
    }
    flight_.points = 0;
    flight_.fastest = fastest_;
    append(flight_, Vec3::Zero(), 0.0F);
    while (!flight.ended()) {
        static_cast<void>(
            budget.spend(units::kCandidatePart * static_cast<std::uint32_t>(flight.parts()) + units::kCandidateStep));
        for (int i = 0; i < flight.parts(); ++i) {
            flight.fly(i, fading_);
        }
        flight.end_step();
        append(flight_, flight.position(), flight.time());
    }
    if (brakes_at_end(limits_)) {
        brake(budget);
    }
    return true;
}

/// From the end of the flight on.
void Flown::brake(WorkBudget& budget) noexcept
{
    const std::size_t last = flight_.points - 1;
    Vec3 position = flight_.position(last);
    Vec3 velocity = last > 0 ? flight_.velocity(last - 1) : start_velocity_;
    const Seconds start = flight_.t[last];
    const Seconds span = std::max(vehicle::stopping_time(velocity, limits_), kFlightStep);
    const path::detail::Steps steps(span, span / static_cast<float>(kTailPoints - 1), kTailPoints - 1);
    assert(flight_.points + steps.count <= kMaxPathPoints);  // the flight's own step leaves space for them
    Seconds from = 0.0F;
    for (std::size_t i = 1; i <= steps.count; ++i) {
        static_cast<void>(budget.spend(units::kCandidatePart));
        const Seconds to = steps.end_of(i);
        vehicle::detail::move(position, velocity, Vec3::Zero(), limits_, to - from, fading_);
        append(flight_, position, start + to);
        from = to;
    }
}

Verdict Flown::judge(const path::TimedPath& path, Seconds swept_until, WorkBudget& budget) noexcept
{
    if (!fly(path, budget)) {
        return {CandidateStatus::not_evaluated, {}};
    }
    clearance_.collect(extent_of(flight_), flight_.duration(), budget);
    clearance_.sweep_until(std::max(swept_until, flight_.duration()));
    return clearance_.check(flight_, budget, Clearance::Part::near);
}

}  // namespace jink::geometric::detail
