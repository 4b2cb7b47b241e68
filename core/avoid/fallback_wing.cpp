// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/fallback_wing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/angle.hpp"
#include "core/base/work_units.hpp"
#include "core/path/prediction.hpp"
#include "core/vehicle/motion.hpp"

namespace jink::avoid {
namespace {

using path::Prediction;

/// Flight of a fixed wing in small steps, by the vehicle model, under `command_at(state)`. False, and nothing
/// predicted, without the units for it.
template <class Command>
bool predict_wing(const world::Situation& s, Seconds horizon, const Settings& settings, WorkBudget& budget,
                  Command&& command_at, Prediction& out) noexcept
{
    const std::uint32_t setpoints = path::setpoints_of(horizon);
    if (!budget.spend(setpoints * units::kTurnStep)) {
        return false;
    }
    const auto chords = static_cast<std::uint32_t>(kMaxPathPoints - 1);
    const std::uint32_t length =
        std::max(path::setpoints_of(settings.prediction_step), (setpoints + chords - 1) / chords);
    vehicle::VehicleState state = s.own;
    path::ChordWriter writer(s.limits, out);
    writer.begin(s.own);
    for (std::uint32_t i = 1; i <= setpoints; ++i) {
        state.velocity = writer.velocity();
        writer.fly(command_at(state), path::kSetpointPeriod);
        if (i % length == 0 || i == setpoints) {
            writer.end_chord(static_cast<float>(i) * path::kSetpointPeriod);
        }
    }
    return true;
}

/// Flight under a turn that never ends.
bool predict_turn(const world::Situation& s, float direction, const Settings& settings, WorkBudget& budget,
                  Prediction& out) noexcept
{
    const auto turn = [&](const vehicle::VehicleState& state) { return turn_command(state, s.limits, direction); };
    return predict_wing(s, settings.fallback_horizon, settings, budget, turn, out);
}

/// What a fixed wing flies of a command: a turn at the lateral limit until it is on the course; straight on where the
/// command has none.
Vec3 towards(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits, const Vec3& command) noexcept
{
    const Vec3& v = own.velocity;
    const float across = v.x() * command.y() - v.y() * command.x();
    const float along = v.x() * command.x() + v.y() * command.y();
    Vec3 turn = turn_command(own, limits, across < 0.0F ? -1.0F : 1.0F);
    // Nearer to the course than the turn leads, the command itself is flown.
    const float lead_across = v.x() * turn.y() - v.y() * turn.x();
    const float lead_along = v.x() * turn.x() + v.y() * turn.y();
    const bool none = command.head<2>().norm() < vehicle::detail::kNoCourse;
    const bool on_course = none || (along > 0.0F && std::abs(across) * lead_along <= std::abs(lead_across) * along);
    turn.z() = command.z();
    return on_course ? command : turn;
}

/// The better one of both turns that never end.
Fallback better_turn(const world::Situation& s, const Fallback* previous, const Settings& settings,
                     WorkBudget& budget) noexcept
{
    Fallback best{world::ManoeuvreKind::hold_turn, Vec3::Zero(), -world::kSeparationCap};
    bool first = true;
    float best_rank = 0.0F;
    Prediction flight;
    for (const float direction : {1.0F, -1.0F}) {
        const float margin =
            predict_turn(s, direction, settings, budget, flight)
                ? world::least_separation(s, flight, settings.fallback_horizon, budget, s.rules.escape).margin
                : -world::kSeparationCap;
        const bool kept = previous != nullptr && previous->kind == world::ManoeuvreKind::hold_turn &&
                          previous->command.z() * direction > 0.0F;
        const float rank = margin + (kept ? detail::kFallbackHysteresis : 0.0F);
        if (first || rank > best_rank) {
            // The sense of the turn travels in z: there is no vertical command in a hold turn.
            best.command = Vec3(0.0F, 0.0F, direction);
            best.margin = margin;
            best_rank = rank;
            first = false;
        }
    }
    return best;
}

/// Courses of a fixed wing that is in no turn for good: on, and to both sides [rad].
constexpr std::array<float, 5> kWingCourses = {0.0F, 0.5F, -0.5F, 1.0F, -1.0F};

}  // namespace

Vec3 detail::command_on(const Vec3& ahead, float course, float climb, const vehicle::VehicleLimits& limits) noexcept
{
    const float level = std::sqrt(std::max(limits.cruise_speed * limits.cruise_speed - climb * climb, 0.0F));
    const SineCosine turned = sine_cosine(course);
    const float c = level * turned.cosine;
    const float s = level * turned.sine;
    return {c * ahead.x() - s * ahead.y(), s * ahead.x() + c * ahead.y(), climb};
}

Vec3 turn_command(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits, float direction) noexcept
{
    Vec3 level(own.velocity.x(), own.velocity.y(), 0.0F);
    const float speed = level.norm();
    const SineCosine nose = sine_cosine(own.yaw);
    level = speed > 0.1F ? Vec3(level / speed) : Vec3(nose.cosine, nose.sine, 0.0F);
    // The command leads the velocity by as much as the lag needs for full lateral acceleration.
    const float lead =
        std::min(limits.max_acceleration * std::max(limits.velocity_lag, 0.1F) / limits.cruise_speed, 0.7F);
    const SineCosine led = sine_cosine(lead);
    const float c = led.cosine;
    const float d = direction * led.sine;
    return limits.cruise_speed * Vec3(c * level.x() - d * level.y(), d * level.x() + c * level.y(), 0.0F);
}

float detail::wing_margin(const world::Situation& s, const Vec3& command, Seconds horizon, const Settings& settings,
                          WorkBudget& budget) noexcept
{
    Prediction flight;
    const auto turn = [&](const vehicle::VehicleState& state) { return towards(state, s.limits, command); };
    return is_finite(command) && predict_wing(s, horizon, settings, budget, turn, flight)
               ? world::least_separation(s, flight, horizon, budget, s.rules.escape).margin
               : -world::kSeparationCap;
}

Fallback detail::wing_fallback(const world::Situation& s, const Fallback* previous, const Settings& settings,
                               WorkBudget& budget) noexcept
{
    Fallback best = better_turn(s, previous, settings, budget);
    const Vec3 level(s.own.velocity.x(), s.own.velocity.y(), 0.0F);
    const float speed = level.norm();
    if (best.margin >= 0.0F || !(speed > vehicle::kStandstillSpeed)) {
        return best;
    }
    float kept_margin = -world::kSeparationCap;
    if (previous != nullptr && previous->kind == world::ManoeuvreKind::velocity) {
        kept_margin = detail::wing_margin(s, previous->command, settings.fallback_horizon, settings, budget);
    }
    const std::array<float, 3> climbs = {0.0F, s.limits.max_climb, -s.limits.max_descent};
    for (const float climb : climbs) {
        for (const float course : kWingCourses) {
            const Vec3 command = detail::command_on(level / speed, course, climb, s.limits);
            const float margin = detail::wing_margin(s, command, settings.fallback_horizon, settings, budget);
            best = margin > best.margin ? Fallback{world::ManoeuvreKind::velocity, command, margin} : best;
        }
    }
    const bool as_good =
        kept_margin > -world::kSeparationCap && kept_margin + detail::kFallbackHysteresis >= best.margin;
    return as_good ? Fallback{world::ManoeuvreKind::velocity, previous->command, kept_margin} : best;
}

}  // namespace jink::avoid
