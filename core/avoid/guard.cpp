// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/avoid/wing.hpp"
#include "core/base/work_units.hpp"

namespace jink::avoid {
namespace {

using path::PathPoint;
using path::Prediction;

/// Points kept free for the braking tail; it takes those that the flight leaves too.
constexpr std::size_t kTailPoints = std::min<std::size_t>(12, kMaxPathPoints / 4);
constexpr std::size_t kFlightPoints = kMaxPathPoints - kTailPoints;

/// Units of a prediction over `span` in steps of `step`, each of `each`: more than any budget for a span beyond
/// measure.
std::uint32_t prediction_units(Seconds span, Seconds step, std::uint32_t each) noexcept
{
    constexpr float kBeyondMeasure = 1e9F;
    const float units = std::ceil(span / step) * static_cast<float>(each);
    return units < kBeyondMeasure ? static_cast<std::uint32_t>(units) : std::numeric_limits<std::uint32_t>::max();
}

/// Until the vehicle stands, level and vertically.
Seconds time_to_stand(const Vec3& velocity, const vehicle::VehicleLimits& limits) noexcept
{
    vehicle::VehicleLimits vertical = limits;
    vertical.max_acceleration = limits.max_vertical_acceleration;
    return std::max(vehicle::stopping_time(velocity.norm(), limits),
                    vehicle::stopping_time(std::abs(velocity.z()), vertical));
}

/// The flight after the manoeuvre's end: to a stand, or straight on for as long as a stop would take for a fixed wing.
bool predict_tail(const world::Situation& s, const Settings& settings, WorkBudget& budget, Prediction& flight) noexcept
{
    const bool stops = s.limits.kind == vehicle::VehicleKind::multirotor;
    const Seconds span = time_to_stand(flight.velocity, s.limits);
    const std::size_t chords = kMaxPathPoints - flight.path.points.size();
    const Seconds step = std::max(settings.prediction_step, span / static_cast<float>(chords - 1));
    if (!budget.spend(prediction_units(span + step, step, units::kCommandStep))) {
        return false;
    }
    path::extend_by_velocity_command(stops ? Vec3(Vec3::Zero()) : flight.velocity, span, step, s.limits, flight);
    return true;
}

/// Level directions that are tried; and each of them climbing and descending.
constexpr int kCourses = 8;
/// Rounds of finer steps about the best of them: to 6 degrees, and an eighth of the climb.
constexpr int kRefinements = 3;

/// A slanted command climbs as fast as the vehicle can, where that leaves at least as much for the level part.
float slant(float limit, const vehicle::VehicleLimits& limits) noexcept
{
    constexpr float kHalfAndHalf = 0.70710678F;
    return std::min(limit, kHalfAndHalf * limits.cruise_speed);
}

/// The search for the command of greatest margin: each is looked at only until it is no better than the best so far.
class LeastHarm {
public:
    LeastHarm(const world::Situation& s, const Settings& settings, Seconds horizon, WorkBudget& budget) noexcept
        : s_(s), settings_(settings), budget_(budget), horizon_(horizon),
          step_(std::max(settings.prediction_step, horizon / static_cast<float>(kMaxPathPoints - 2)))
    {
        // As many chords as steps of this length: the first two are short.
        constexpr Seconds kFirstTwo = 3.0F * path::kSetpointPeriod;
        const float chords = std::ceil(horizon / step_);
        later_step_ = chords > 2.0F && horizon > kFirstTwo ? (horizon - kFirstTwo) / (chords - 2.0F) : step_;
    }

    /// Margin of a command; below `cut` where it is less than that, and then perhaps not the least.
    float margin_of(const Vec3& command, float cut = -world::kSeparationCap) noexcept
    {
        if (!is_finite(command) || !budget_.spend(prediction_units(horizon_, step_, units::kCommandStep))) {
            return -world::kSeparationCap;
        }
        path::predict_velocity_command(s_.own, command, horizon_, later_step_, s_.limits, flight_);
        const world::Separation least = world::least_separation(s_, flight_, horizon_, budget_, settings_.escape,
                                                                {cut, world::kSeparationCap, nearest_});
        nearest_ = least.margin < cut || nearest_.kind == world::ThreatKind::none ? least.against : nearest_;
        return least.margin;
    }

    /// True when it is the best now.
    bool attempt(const Vec3& command, Fallback& best) noexcept
    {
        const float margin = margin_of(command, best.margin);
        if (margin > best.margin) {
            best = {world::ManoeuvreKind::velocity, command, margin};
            return true;
        }
        return false;
    }

private:
    const world::Situation& s_;
    const Settings& settings_;
    WorkBudget& budget_;
    Seconds horizon_;
    Seconds step_;
    Seconds later_step_ = 0.0F;
    world::ThreatRef nearest_;
    Prediction flight_;
};

/// A command at cruise speed by its course from `ahead` [rad] and its climb [m/s].
struct Course {
    float angle = 0.0F;
    float climb = 0.0F;
};

/// Eight level courses, each of them climbing and descending too, straight up and down; then steps to all sides of the
/// best, each time half as far.
void search_ways_out(const world::Situation& s, const world::Way& way, LeastHarm& search, Fallback& best) noexcept
{
    Vec3 ahead(way.direction.x(), way.direction.y(), 0.0F);
    const float length = ahead.norm();
    ahead = length > 1e-3F ? Vec3(ahead / length) : Vec3::UnitX();
    const float up = slant(s.limits.max_climb, s.limits);
    const float down = slant(s.limits.max_descent, s.limits);
    constexpr float kTurn = 2.0F * kPi / static_cast<float>(kCourses);
    Course best_course;
    bool on_course = false;
    const auto attempt = [&](const Course& course) noexcept {
        const bool better = search.attempt(detail::command_on(ahead, course.angle, course.climb, s.limits), best);
        best_course = better ? course : best_course;
        on_course = on_course || better;
    };
    for (const float climb : {0.0F, up, -down}) {
        for (int i = 0; i < kCourses; ++i) {
            attempt({kTurn * static_cast<float>(i), climb});
        }
    }
    const float fastest = s.limits.cruise_speed;
    for (const float climb : {std::min(s.limits.max_climb, fastest), -std::min(s.limits.max_descent, fastest)}) {
        on_course = !search.attempt(Vec3(0.0F, 0.0F, climb), best) && on_course;
    }
    if (!on_course) {
        return;
    }
    float turn = 0.5F * kTurn;
    float rise = 0.5F;
    for (int round = 0; round < kRefinements; ++round) {
        const Course centre = best_course;
        attempt({centre.angle - turn, centre.climb});
        attempt({centre.angle + turn, centre.climb});
        attempt({centre.angle, std::min(centre.climb + rise * up, up)});
        attempt({centre.angle, std::max(centre.climb - rise * down, -down)});
        turn *= 0.5F;
        rise *= 0.5F;
    }
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

}  // namespace

bool is_valid(const Settings& s) noexcept
{
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    return within(s.lookahead, 1.0F, 60.0F) && within(s.commit, 0.5F, 60.0F) && within(s.room, 0.0F, 10.0F) &&
           within(s.prediction_step, 0.02F, 0.5F) && within(s.fallback_horizon, 1.0F, 20.0F) &&
           within(s.reserve, 0.0F, 5.0F) && within(s.settle, 0.0F, 10.0F) && within(s.clear_extra, 0.0F, 10.0F) &&
           within(s.on_leg, 0.05F, 50.0F) && within(s.blocked_patience, 0.0F, 600.0F) &&
           within(s.give_ground_speed, 0.0F, 5.0F) && within(s.give_ground_limit, 0.0F, 600.0F) &&
           within(s.least_control, 0.0F, 60.0F) && within(s.patience, 0.0F, 600.0F) && s.budget >= 1000 &&
           s.order <= LadderOrder::last && s.reactive <= Reactive::alone && within(s.clutter_radius, 1.0F, 200.0F) &&
           s.plan_budget >= 100 && s.plan_budget <= s.budget && s.kept_for_next <= s.plan_budget &&
           within(s.gains.position_gain, 0.0F, 10.0F) && within(s.gains.max_correction, 0.0F, 10.0F) &&
           within(s.escape.slack, 0.0F, 1.0F) && within(s.escape.speed, 0.0F, 10.0F);
}

Seconds time_to_stop(const world::Situation& s, const Settings& settings) noexcept
{
    return vehicle::stopping_time(s.own.velocity.norm(), s.limits) + settings.reserve;
}

world::Separation check_manoeuvre(const world::Situation& situation, const world::Manoeuvre& manoeuvre,
                                  const Settings& settings, WorkBudget& budget, Seconds horizon,
                                  const world::Cutoff& cutoff) noexcept
{
    if (!is_well_formed(manoeuvre, situation.now)) {
        return {-world::kSeparationCap, 0.0F, {}};
    }
    world::Situation s = situation;
    const bool is_command = manoeuvre.kind == world::ManoeuvreKind::velocity;
    if (is_command) {
        s.shared_horizon = time_to_stop(s, settings);
    }
    const world::Separation contact{-world::kSeparationCap, 0.0F, {}};
    const Seconds start = std::max(0.0F, s.now - manoeuvre.start);
    const Seconds rest = std::max(0.0F, manoeuvre.path.duration() - start);
    Prediction flight;
    if (is_command && rest > 0.0F) {
        const Seconds step = std::max(settings.prediction_step, rest / static_cast<float>(kFlightPoints - 4));
        if (!budget.spend(kFlightPoints * units::kCommandStep)) {
            return contact;
        }
        path::predict_velocity_command(s.own, manoeuvre.command, rest, step, s.limits, flight);
    } else {
        if (!budget.spend(prediction_units(rest, path::kSetpointPeriod, units::kFlightPart))) {
            return contact;
        }
        path::predict_flight(s.own, manoeuvre.path, start, settings.prediction_step, s.limits, settings.gains,
                             kFlightPoints, flight);
    }
    if (!predict_tail(s, settings, budget, flight)) {
        return contact;
    }
    return world::least_separation(s, flight, std::min(flight.path.duration(), horizon), budget, settings.escape,
                                   cutoff);
}

float command_margin(const world::Situation& s, const Vec3& command, Seconds horizon, const Settings& settings,
                     WorkBudget& budget) noexcept
{
    return s.limits.kind == vehicle::VehicleKind::fixed_wing
               ? detail::wing_margin(s, command, horizon, settings, budget)
               : LeastHarm(s, settings, horizon, budget).margin_of(command);
}

float command_margin(const world::Situation& s, const Vec3& command, const Settings& settings,
                     WorkBudget& budget) noexcept
{
    return command_margin(s, command, settings.fallback_horizon, settings, budget);
}

Fallback choose_fallback(const world::Situation& s, const world::Way& way, const Fallback* previous,
                         const Settings& settings, WorkBudget& budget) noexcept
{
    if (s.limits.kind == vehicle::VehicleKind::fixed_wing) {
        return detail::wing_fallback(s, previous, settings, budget);
    }
    LeastHarm search(s, settings, settings.fallback_horizon, budget);
    Fallback best{world::ManoeuvreKind::brake, Vec3::Zero(), search.margin_of(Vec3::Zero())};
    if (best.margin >= 0.0F) {
        return best;
    }
    float kept_margin = -world::kSeparationCap;
    if (previous != nullptr && previous->kind == world::ManoeuvreKind::velocity) {
        kept_margin = search.margin_of(previous->command);
        if (kept_margin >= 0.0F) {
            return {world::ManoeuvreKind::velocity, previous->command, kept_margin};
        }
    }
    search_ways_out(s, way, search, best);
    const bool as_good = best.margin < 0.0F && kept_margin + detail::kFallbackHysteresis >= best.margin;
    if (as_good && kept_margin > -world::kSeparationCap) {
        return {world::ManoeuvreKind::velocity, previous->command, kept_margin};
    }
    return best;
}

}  // namespace jink::avoid
