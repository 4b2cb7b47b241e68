// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/final_check.hpp"

#include <algorithm>
#include <cmath>

#include "core/avoid/prediction_units.hpp"
#include "core/base/work_units.hpp"
#include "core/path/prediction.hpp"

namespace jink::avoid {
namespace {

using path::PathPoint;
using path::Prediction;

/// Points kept free for the braking tail; it takes those that the flight leaves too.
constexpr std::size_t kTailPoints = std::min<std::size_t>(12, kMaxPathPoints / 4);
constexpr std::size_t kFlightPoints = kMaxPathPoints - kTailPoints;
constexpr world::Separation kContact{-world::kSeparationCap, 0.0F, {}};

/// The flight after the manoeuvre's end: to a stand, or straight on for as long as a stop would take for a fixed wing.
bool predict_tail(const world::Situation& s, const Settings& settings, WorkBudget& budget, Prediction& flight) noexcept
{
    const bool stops = s.limits.kind == vehicle::VehicleKind::multirotor;
    const Seconds span = vehicle::stopping_time(flight.velocity, s.limits);
    const std::size_t chords = kMaxPathPoints - flight.path.points.size();
    const Seconds step = std::max(settings.prediction_step, span / static_cast<float>(chords - 1));
    if (!budget.spend(detail::prediction_units(span + step, step, units::kCommandStep))) {
        return false;
    }
    path::extend_by_velocity_command(stops ? Vec3(Vec3::Zero()) : flight.velocity, span, step, s.limits, flight);
    if (stops && !flight.sagittas.empty()) {
        // What is left of the velocity fades with the lag.
        flight.sagittas.back().any += flight.velocity.norm() * s.limits.velocity_lag;
        flight.sagittas.back().vertical += std::abs(flight.velocity.z()) * s.limits.velocity_lag;
    }
    return true;
}

/// No method is trusted with this either: numbers, times that rise, a start that is not ahead.
bool is_well_formed(const world::Manoeuvre& manoeuvre, TimePoint now) noexcept
{
    if (!is_finite(manoeuvre.command)) {
        return false;
    }
    Seconds before = -1.0F;
    for (const PathPoint& p : manoeuvre.path.points) {
        if (!is_finite(p.position) || !is_finite(p.velocity) || !std::isfinite(p.time) || p.time <= before) {
            return false;
        }
        before = p.time;
    }
    return !manoeuvre.path.points.empty() && manoeuvre.path.points.front().time >= 0.0F && manoeuvre.start <= now;
}

/// The flight until the manoeuvre's end. False where it is not well formed or the budget ends.
bool predict_manoeuvre(const world::Situation& s, const world::Manoeuvre& manoeuvre, const Settings& settings,
                       WorkBudget& budget, Prediction& flight) noexcept
{
    if (!is_well_formed(manoeuvre, s.now)) {
        return false;
    }
    const Seconds start = std::max(0.0F, s.now - manoeuvre.start);
    const Seconds rest = std::max(0.0F, manoeuvre.path.duration() - start);
    if (manoeuvre.kind != world::ManoeuvreKind::velocity || !(rest > 0.0F)) {
        return path::predict_flight(s.own, manoeuvre.path, start, settings.prediction_step, s.limits, s.rules.gains,
                                    kFlightPoints, budget, flight);
    }
    const Seconds step = std::max(settings.prediction_step, rest / static_cast<float>(kFlightPoints - 4));
    if (!budget.spend(kFlightPoints * units::kCommandStep)) {
        return false;
    }
    path::predict_velocity_command(s.own, manoeuvre.command, rest, step, s.limits, flight);
    return true;
}

/// Least separation of a flight that is predicted to its manoeuvre's end, and of what follows.
world::Separation separation_of(const world::Situation& situation, world::ManoeuvreKind kind, const Settings& settings,
                                Seconds horizon, const world::Cutoff& cutoff, WorkBudget& budget,
                                Prediction& flight) noexcept
{
    if (!predict_tail(situation, settings, budget, flight)) {
        return kContact;
    }
    world::Situation s = situation;
    if (kind == world::ManoeuvreKind::velocity) {
        s.shared_horizon = time_to_stop(s, settings);
    }
    return world::least_separation(s, flight, std::min(flight.path.duration(), horizon), budget, s.rules.escape,
                                   cutoff);
}

}  // namespace

Seconds time_to_stop(const world::Situation& s, const Settings& settings) noexcept
{
    return vehicle::stopping_time(s.own.velocity, s.limits) + settings.reserve;
}

world::Separation check_manoeuvre(const world::Situation& situation, const world::Manoeuvre& manoeuvre,
                                  const Settings& settings, WorkBudget& budget, Seconds horizon,
                                  const world::Cutoff& cutoff) noexcept
{
    Prediction flight;
    return predict_manoeuvre(situation, manoeuvre, settings, budget, flight)
               ? separation_of(situation, manoeuvre.kind, settings, horizon, cutoff, budget, flight)
               : kContact;
}

Assessment assess(const world::Situation& situation, const world::Manoeuvre& manoeuvre, const Settings& settings,
                  float kept, WorkBudget& budget) noexcept
{
    constexpr world::Cutoff kClearOrNot{0.0F, world::kSeparationCap, {}};
    constexpr Seconds kAllOfIt = std::numeric_limits<Seconds>::infinity();
    Prediction flight;
    Assessment out;
    if (!predict_manoeuvre(situation, manoeuvre, settings, budget, flight)) {
        return out;
    }
    const std::size_t points = flight.path.points.size();
    world::Separation separation =
        separation_of(situation, manoeuvre.kind, settings, kAllOfIt, kClearOrNot, budget, flight);
    out.margin = separation.margin;
    if (out.margin >= 0.0F) {
        separation.margin += kept;
        const vehicle::VehicleLimits limits = vehicle::widened(situation.limits, -kept);
        out.cost = cost_of(world::with_limits(situation, limits), manoeuvre, {flight.path.points.data(), points},
                           separation, budget);
    }
    return out;
}

}  // namespace jink::avoid
