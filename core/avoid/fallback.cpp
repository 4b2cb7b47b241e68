// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/fallback.hpp"

#include <algorithm>
#include <cmath>

#include "core/avoid/fallback_wing.hpp"
#include "core/avoid/prediction_units.hpp"
#include "core/base/work_units.hpp"
#include "core/path/prediction.hpp"
#include "core/world/passing_side.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

using path::Prediction;

/// Level directions that are tried; and each of them climbing and descending.
constexpr int kCourses = 8;
/// Repetitions with finer steps about the best of them: to 6 degrees, and an eighth of the climb.
constexpr int kRefinements = 3;

/// Where nothing is clear of all that is possible, threats as large as is likely decide: so many standard deviations.
constexpr float kLikely = 1.0F;
/// A command that is no farther from being clear is refined [m].
constexpr float kNearlyClear = 0.5F;
/// What is flown then stays unless another command is better by this much [m].
constexpr float kHoldOn = 0.02F;

/// Share of the other one's radius that a command to its side has to be better by.
constexpr float kOtherSide = 0.5F;
/// Sine of the angle within which a command leads to neither side.
constexpr float kAside = 0.1F;

/// A slanted command climbs as fast as the vehicle can, where that leaves at least as much for the level part.
float slant(float limit, const vehicle::VehicleLimits& limits) noexcept
{
    constexpr float kHalfAndHalf = 0.70710678F;
    return std::min(limit, kHalfAndHalf * limits.cruise_speed);
}

/// Search for the command of greatest margin: the check of each ends once it is no better than the best so far.
class MaxClearance {
public:
    [[gnu::noinline]] MaxClearance(const world::Situation& s, const Settings& settings, Seconds horizon,
                                   WorkBudget& budget) noexcept
        : s_(s), corner_(s.limits.half_extents.minCoeff()), inner_limits_(vehicle::widened(s.limits, -corner_)),
          inner_(world::with_limits(s, inner_limits_)), budget_(budget), horizon_(horizon),
          step_(std::max(settings.prediction_step, horizon / static_cast<float>(kMaxPathPoints - 2)))
    {
        // As many chords as steps of this length: the first two are short.
        constexpr Seconds kFirstTwo = 3.0F * path::kSetpointPeriod;
        const float chords = std::ceil(horizon / step_);
        later_step_ = chords > 2.0F && horizon > kFirstTwo ? (horizon - kFirstTwo) / (chords - 2.0F) : step_;
    }

    /// Margin of a command; below `cut` where it is less than that, and then perhaps not the least.
    [[gnu::noinline]] float margin_of(const Vec3& command, float cut = -world::kSeparationCap) noexcept
    {
        if (!is_finite(command) || !budget_.spend(detail::prediction_units(horizon_, step_, units::kCommandStep))) {
            return -world::kSeparationCap;
        }
        path::predict_velocity_command(s_.own, command, horizon_, later_step_, s_.limits, flight_);
        const float corner = rounded_ ? corner_ : 0.0F;
        const world::Separation least =
            world::least_separation(rounded_ ? inner_ : s_, flight_, horizon_, budget_, s_.rules.escape,
                                    {cut + corner, world::kSeparationCap, nearest_, uncertainty_});
        // No worse than a command that is not checked at all for want of units: of equals the first one stays.
        const float margin = std::max(least.margin - corner, -world::kSeparationCap);
        nearest_ = margin < cut || nearest_.kind == world::ThreatKind::none ? least.against : nearest_;
        return margin;
    }

    /// From now on all of the uncertainty counts, and the whole box.
    void count_all() noexcept
    {
        uncertainty_ = 1.0F;
        rounded_ = false;
    }
    /// From now on this share of the uncertainty counts, and the box with its corners rounded off: all that is within
    /// its least half extent of the inner box. Where the box cannot be kept clear, equal margins are then equal
    /// distances from the vehicle, whatever side the threat passes on.
    void count_likely(float uncertainty) noexcept
    {
        uncertainty_ = uncertainty;
        rounded_ = true;
    }

    /// From now on commands to the side on which the other one of two vehicles passes count as worse. Of the threat
    /// that was met last.
    void pass_by_rule() noexcept
    {
        const std::span tracks = world::of_kind(s_.threats, world::ThreatKind::track);
        if (nearest_.kind == world::ThreatKind::track && nearest_.index < tracks.size()) {
            side_ = world::passing_side(s_, tracks[nearest_.index]);
            handicap_ = kOtherSide * tracks[nearest_.index].radius_at(0.0F);
        }
    }
    /// What a command's margin counts as less.
    [[nodiscard]] float handicap_of(const Vec3& command) const noexcept
    {
        return command.dot(side_) < -kAside * command.norm() ? handicap_ : 0.0F;
    }

    /// True when it is the best now.
    bool attempt(const Vec3& command, Fallback& best) noexcept
    {
        const float handicap = handicap_of(command);
        const float least = best.margin - handicap_of(best.command) + handicap;
        const float margin = margin_of(command, least);
        if (margin > least) {
            best = {world::ManoeuvreKind::velocity, command, margin};
            return true;
        }
        return false;
    }

    /// A command of this margin against the best.
    [[nodiscard]] bool is_as_good(float margin, const Vec3& command, const Fallback& best) const noexcept
    {
        return margin - handicap_of(command) >= best.margin - handicap_of(best.command);
    }

private:
    const world::Situation& s_;
    float corner_;                         ///< radius of the rounded corners [m]
    vehicle::VehicleLimits inner_limits_;  ///< with the box that is left without them
    world::Situation inner_;
    WorkBudget& budget_;
    Seconds horizon_;
    Seconds step_;
    Seconds later_step_ = 0.0F;
    world::ThreatRef nearest_;
    float uncertainty_ = 1.0F;
    bool rounded_ = false;
    Vec3 side_ = Vec3::Zero();
    float handicap_ = 0.0F;
    Prediction flight_;
};

/// A command at cruise speed by its course from `ahead` [rad] and its climb [m/s].
struct Course {
    float angle = 0.0F;
    float climb = 0.0F;
};

/// Eight level courses, each of them climbing and descending too, straight up and down; then steps to all sides of the
/// best, each time half as far.
void search_escapes(const world::Situation& s, const world::Way& way, MaxClearance& search, Fallback& best) noexcept
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
    for (int i = 0; i < kRefinements; ++i) {
        const Course centre = best_course;
        attempt({centre.angle - turn, centre.climb});
        attempt({centre.angle + turn, centre.climb});
        attempt({centre.angle, std::min(centre.climb + rise * up, up)});
        attempt({centre.angle, std::max(centre.climb - rise * down, -down)});
        turn *= 0.5F;
        rise *= 0.5F;
    }
}

/// Of all that is possible: `likely`, or else the best of all that are clear; below 0 where none is.
Fallback search_clear(const world::Situation& s, const world::Way& way, MaxClearance& search,
                      const Fallback& likely) noexcept
{
    const float margin = search.margin_of(likely.command, 0.0F);
    if (margin >= 0.0F) {
        return {likely.kind, likely.command, margin};
    }
    Fallback clear{world::ManoeuvreKind::brake, Vec3::Zero(), -kNearlyClear};
    search_escapes(s, way, search, clear);
    return clear;
}

}  // namespace

float command_margin(const world::Situation& s, const Vec3& command, Seconds horizon, const Settings& settings,
                     WorkBudget& budget) noexcept
{
    return s.limits.kind == vehicle::VehicleKind::fixed_wing
               ? detail::wing_margin(s, command, horizon, settings, budget)
               : MaxClearance(s, settings, horizon, budget).margin_of(command);
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
    MaxClearance search(s, settings, settings.fallback_horizon, budget);
    const Fallback brake{world::ManoeuvreKind::brake, Vec3::Zero(), search.margin_of(Vec3::Zero())};
    if (brake.margin >= 0.0F) {
        // NOLINTNEXTLINE(performance-no-automatic-move): numbers alone, which are copied either way
        return brake;
    }
    const bool escaped = previous != nullptr && previous->kind == world::ManoeuvreKind::velocity;
    if (escaped) {
        const float margin = search.margin_of(previous->command);
        if (margin >= 0.0F) {
            return {world::ManoeuvreKind::velocity, previous->command, margin};
        }
    }
    search.pass_by_rule();
    const float likely = s.rules.k_sigma > kLikely ? kLikely / s.rules.k_sigma : 1.0F;
    search.count_likely(likely);
    // First, so that it is compared with whatever the budget lasts for.
    const float former = escaped ? search.margin_of(previous->command) : -world::kSeparationCap;
    // Before all commands: where the budget ends early, none that happened to be checked is taken in its place.
    Fallback best{brake.kind, brake.command, search.margin_of(brake.command)};
    search_escapes(s, way, search, best);
    if (best.margin >= 0.0F) {
        search.count_all();
        const Fallback clear = search_clear(s, way, search, best);
        if (clear.margin >= 0.0F) {
            // NOLINTNEXTLINE(performance-no-automatic-move): numbers alone, which are copied either way
            return clear;
        }
    }
    if (former > -world::kSeparationCap && search.is_as_good(former + kHoldOn, previous->command, best)) {
        best = {previous->kind, previous->command, former};
    }
    if (best.margin >= 0.0F) {
        search.count_all();
        best.margin = search.margin_of(best.command, 0.0F);
    }
    return best;
}

}  // namespace jink::avoid
