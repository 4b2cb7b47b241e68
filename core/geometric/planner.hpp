// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "core/base/work_budget.hpp"
#include "core/cost/tables.hpp"
#include "core/geometric/candidate.hpp"
#include "core/path/follower.hpp"
#include "core/path/route.hpp"
#include "core/world/method.hpp"
#include "core/world/threat_set.hpp"

namespace jink::geometric {

/// swept: threats are the volume they sweep until the longest candidate ends (Pinheiro 3.4.2). time_aware: where they
/// are, when.
enum class SecurityMode : std::uint8_t { time_aware, swept };
/// source: -3.2 R + i 6.4 R / l, those inside the threat dropped (Pinheiro eq. 3.6). clearing: l offsets, half a side,
/// from the smallest one with which the family's curve clears the main threat, box and all, to 3.2 R of its body, or
/// one box width further where that is more, but none beyond 1.28 D.
enum class OffsetRule : std::uint8_t { clearing, source };

/// What a vehicle may overshoot the leg by where a simple candidate meets it again [m]: half the default safety box.
inline constexpr float kRejoinOvershoot = 0.5F;
/// Nearest distance to the main threat that is planned for, in its radii (Pinheiro 3.1.1).
inline constexpr float kMinDistanceInRadii = 2.5F;
/// Radius that is planned for at a distance from a threat, without what rounding may take over the limit [m].
[[nodiscard]] constexpr float largest_radius(float distance) noexcept { return 0.99F * distance / kMinDistanceInRadii; }
/// One go at a problem: which candidates, at a share of the leg's speed, over which part of the span of clearing
/// offsets.
struct Attempt {
    /// as_set: as the Settings say. plateau: that family instead of theirs. more_planes: twice the planes with half the
    /// offsets, or without the family simple where there is but one a side. wait: that family instead of theirs.
    /// in_a_row: around the main threat, and from beside it around what then is in the way back to the leg.
    enum class Kind : std::uint8_t { as_set, plateau, more_planes, wait, in_a_row };
    Kind kind = Kind::as_set;
    float speed_share = 1.0F;
    float span_from = 0.0F;
    float span_to = 1.0F;
    float apex_share = 1.0F;  ///< the apex lies so many D from the start, and the end point with it
};
/// What the Planner tries, in this order, until something is available: slower flight asks for less acceleration and
/// lets crossing traffic pass; an end point further out makes curves gentler; a wall of threats has its gap further
/// out, or is climbed over at once; what only passes is waited for. A fixed wing does not fly slower, nor wait. How
/// many of random situations each one solves is printed by tests/property/core/geometric (WhatEachAttemptAdds).
inline constexpr std::array<Attempt, 10> kAttempts{{
    {},
    {.speed_share = 0.6F},
    {.apex_share = 1.5F},
    {.span_from = 1.0F, .span_to = 2.0F},
    {.speed_share = 0.3F},
    {.kind = Attempt::Kind::plateau, .speed_share = 0.6F, .apex_share = 1.5F},
    {.span_from = 2.0F, .span_to = 3.5F},
    {.kind = Attempt::Kind::wait},
    {.kind = Attempt::Kind::more_planes},
    {.kind = Attempt::Kind::in_a_row, .speed_share = 0.6F, .apex_share = 1.5F},
}};

/// Waiting candidates: down to each of these shares of the leg's speed, until each of these times the time to the
/// collision point.
inline constexpr std::array kWaitShares{0.6F, 0.3F, 0.0F};
inline constexpr std::array kWaitTimes{0.75F, 1.0F, 1.5F, 2.0F};
inline constexpr std::size_t kWaits = kWaitShares.size() * kWaitTimes.size();
/// They slow down and speed up with this share of the greatest acceleration.
inline constexpr float kWaitAcceleration = 0.7F;

/// Planes of candidates about the leg.
inline constexpr std::size_t kMaxPlanes = 32;

struct Settings {
    std::uint16_t offsets = 4;       ///< l, even, 2..64
    std::uint16_t extra_planes = 3;  ///< n, 0..kMaxPlanes - 1
    bool simple = true;
    bool symmetric = true;
    bool smooth = false;
    bool plateau = false;
    bool wait = false;             ///< kWaits candidates more; multirotors only
    std::uint16_t waypoints = 25;  ///< per candidate, 8..kMaxPathPoints
    SecurityMode security = SecurityMode::time_aware;
    OffsetRule offset_rule = OffsetRule::clearing;
    bool main_swept_to_collision_point =
        false;  ///< swept mode: the main threat's volume ends at the collision point (source)
    float source_drop_margin =
        0.0F;  ///< source offsets: |w| < R + this is dropped; 0 as the text, 1 m as the reproduced distribution study
    /// Candidates beyond the acceleration limits are not flyable; off in source mode. The change of velocity from each
    /// segment to the next, and from straight flight to the first, must be within the limits (6 |w| v^2 / D^2 at the
    /// start of the curve); at the end of a simple candidate, where the slope of 4.5 |w| / D ends at once, the vehicle
    /// may overshoot by kRejoinOvershoot.
    bool check_acceleration = true;
    /// The cheapest must also be clear as the vehicle will fly it (path::predict_flight, then braking to a stand at the
    /// end), or else the next cheapest is tried; off in source mode.
    bool verify_flight = true;
    /// Every candidate is checked as a curve before the first is flown, so that Result says of each what it touches.
    /// Otherwise costs come first, and no candidate more expensive than the chosen one is checked: the choice is the
    /// same.
    bool evaluate_all = false;
    /// Work that one attempt may spend on checking candidates, cheapest first, as curves (but with evaluate_all) and in
    /// flight; as much again for each solid within reach that no closed form knows, and along a route. Those that it
    /// does not reach are not taken.
    std::uint32_t check_units = 1600;
    cost::SmoothnessMethod smoothness = cost::SmoothnessMethod::curvature;
    /// Where the smoothness of curves is read, those of other families and of another number of waypoints apart; null:
    /// computed (cost/tables.hpp says how far both are from each other). Outlives what is set up with it.
    const cost::tables::Tables* tables = nullptr;
    cost::ClosenessMethod closeness = cost::ClosenessMethod::time_aware;
    float rotation_penalty = 1.0F;  ///< k_p
    /// Energy and hover power of each candidate too, which are reported but do not count; 0 otherwise.
    bool all_terms = false;
    cost::Weights weights;
    cost::Caps caps;
    float flip_penalty = 0.15F;  ///< added to the total of candidates on the other side of Problem::preferred_side
    std::uint16_t closeness_nearest =
        0;  ///< only the k moving threats nearest to the start count for closeness; 0: all
    /// Only the k moving threats that come nearest to a straight flight along the leg count for closeness, and
    /// candidates are checked against those first: the others are checked once, for the candidate that would be
    /// taken, so that what is found is clear of all (as avoid/final_check.hpp sees to once more). The main threat is
    /// among them. 0: all.
    std::uint16_t moving_nearest = 0;
    float max_cost = 1.0F;  ///< (0, 1]; a cheapest candidate above this, flip penalty aside, counts as not found
    /// Time-aware mode: a start inside a margin is judged by this rule, so that there is a way out. Off in source mode.
    bool escape_from_margin = true;
    /// Planner: the manoeuvre begins where the vehicle is when it answers (FlightRules::latency). Off in source mode:
    /// Pinheiro's begins where the vehicle is now.
    bool starts_after_latency = true;
    std::uint8_t retries = 9;  ///< Planner: further attempts when nothing is available, 0..9
};
/// Pinheiro's planner: swept security ending at the collision point, source offsets, no feasibility, swept closeness.
[[nodiscard]] Settings source_settings() noexcept;
/// Which member says whether a family is used.
[[nodiscard]] bool Settings::*flag_of(Family family) noexcept;
/// At most, l (n + 1) for each curve and kWaits for waiting; fewer where offsets are dropped.
[[nodiscard]] std::size_t count_of_candidates(const Settings& settings) noexcept;
/// Everything in range and finite, and 1 to kMaxCandidates candidates.
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

/// Moving solids of one problem. They come from problem files and callers of `solve`; a Situation's tracks are spheres.
inline constexpr std::size_t kMaxMovingSolids = 4;
/// Threats of one problem: those of a Situation, and moving solids.
inline constexpr std::size_t kMaxProblemThreats = world::ThreatSet::kMaxThreats + kMaxMovingSolids;

/// Problem::main when the main threat is none of the moving or static spheres.
inline constexpr std::size_t kNoThreat = static_cast<std::size_t>(-1);

/// One planning problem on its own, free of Situation: what `jink plan`, the campaign and the reproduction tests solve.
struct Problem {
    /// Start of the manoeuvre and direction of the leg, or of the way at the start. Whatever y is: planes count from
    /// it.
    PathFrame frame;
    /// Null route: the leg is straight. Otherwise what the manoeuvre follows: straight along x, then the route, on
    /// which it ends. Outlives the solving.
    path::RouteAhead ahead;
    float distance = 0.0F;     ///< D: along the leg, or the reference, from the start to the collision point [m]
    float main_radius = 0.0F;  ///< R that has to be cleared, uncertainty included; scales Pinheiro's offsets [m]
    float body_radius = 0.0F;  ///< of the main threat without its uncertainty: scales the clearing fan and the 2.5 R
                               ///< rule [m]; 0: main_radius
    std::size_t main = kNoThreat;  ///< index of the main threat among the tracks of `threats`, or kNoThreat
    /// In the order of a world::ThreatSet, obstacles that move behind those at rest: at most kMaxTracks tracks,
    /// kMaxObstacles obstacles, kMaxMovingSolids of which move. Moving solids, time-aware: checked exactly, in their
    /// own frame; swept: as their bounding spheres. Cylinders are checked where they are, when, in either mode.
    std::span<const world::Threat> threats;
    bool keeps_soft_margins = false;         ///< cylinders are as wide as with their soft margins
    world::FlightRules rules;                ///< escape rule, and gains for Settings::verify_flight
    Vec3 start_velocity = Vec3::Zero();      ///< own velocity at the start, for verify_flight [m/s]
    float speed = 5.0F;                      ///< cruise speed along the candidates [m/s]
    Vec3 preferred_side = Vec3::Zero();      ///< world::passing_side, or of what is being flown; zero for none
    Vec3 main_centre_offset = Vec3::Zero();  ///< main threat's centre at the collision time minus the collision point
                                             ///< [m]; clearing offsets account for it
    const geometry::Shape* main_shape =
        nullptr;                    ///< of a main threat that is an obstacle; null: a sphere of main_radius
    float main_clearance = 0.0F;    ///< uncertainty of the own position and of main_shape's, kept from it [m]
    float main_half_height = 0.0F;  ///< of a main threat that is an upright capsule (Threat::half_height) [m]
    float span_from = 0.0F;    ///< clearing offsets: where they begin and end in the span from smallest to largest,
    float span_to = 1.0F;      ///< beyond 1 further out; with span_from > 0 the first one lies past it
    float apex_share = 1.0F;   ///< the apex of a curve lies so many D from the start; 1: at the collision point
    bool ends_at_top = false;  ///< curves end there, beside the main threat and along the leg
    /// Without a route: so far along x the leg goes on, >= 0; manoeuvres of two parts end before it does [m].
    float straight = std::numeric_limits<float>::infinity();
    Seconds lead = 0.0F;    ///< the start of `frame` is reached so long after time 0 of the threats, >= 0 [s]
    Seconds begins = 0.0F;  ///< second part of a two-stage manoeuvre: duration of the first part, >= 0 [s]
};

/// Along what `ahead` says.
[[nodiscard]] Vec3 collision_point_along(const Problem& problem) noexcept;
/// Where the leg or the reference is at D [m].
[[nodiscard]] inline Vec3 collision_point(const Problem& problem) noexcept
{
    return problem.ahead.route.empty() ? problem.frame.origin + problem.distance * problem.frame.axes.col(0)
                                       : collision_point_along(problem);
}

/// What curves scale with [m].
[[nodiscard]] inline float scale_of(const Problem& problem) noexcept { return problem.apex_share * problem.distance; }

/// R of the clearing fan and of the 2.5 R rule [m].
[[nodiscard]] inline float scale_radius(const Problem& problem) noexcept
{
    return problem.body_radius > 0.0F ? problem.body_radius : problem.main_radius;
}

struct Result {
    StaticVector<Candidate, kMaxCandidates> candidates;  ///< in the order of generation
    std::size_t chosen = 0;                              ///< index, valid on PlanStatus::found
    bool cut_short = false;    ///< work has ended before a candidate that was found to do, or before all were checked
    std::size_t attempt = 0;   ///< solve_with_retries: the last one made, an index of kAttempts
    path::TimedPath path;      ///< of the chosen one
    Vec3 side = Vec3::Zero();  ///< unit vector from the leg to its apex
};

/// Working memory of one `solve`, to be kept where there is space for it: a microcontroller's stack has none.
/// Holds nothing from one call to the next. kBytes, about 12 KiB with the default capacities.
class Workspace {
public:
    static constexpr std::size_t kBytes = kMaxPathPoints * (24 + 28 + 3 * 16) +
                                          16 * (kMaxTracks + kMaxObstacles + kMaxCylinders) + 3 * kMaxProblemThreats +
                                          2 * kMaxTracks + 2 * kMaxCandidates + 28 * kMaxPlanes + 768;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): `solve` fills what it reads, zeroing all of it costs
    Workspace() noexcept {}
    [[nodiscard]] void* bytes() noexcept { return bytes_.data(); }

private:
    alignas(std::max_align_t) std::array<std::byte, kBytes> bytes_;
};

/// Solves one problem.
///
/// Order of generation: families as in kFamilies, then planes, then offsets ascending; of equally cheap candidates the
/// first is chosen. Budget (base/work_budget.hpp): curves, contact tests, costs and flights, support calls for
/// obstacles that are no spheres. When it runs out, what has been found available until then is still fully checked and
/// may be chosen: up to half of it, Settings::check_units at most, is kept for that.
///
/// @return found; too_close (D < 2.5 R); none_available; budget_spent (nothing available until then); bad_input
///         (settings, limits, rules or problem not finite or out of range). `result.candidates` is filled as far as
///         evaluated on every status but bad_input and too_close.
/// O(candidates * waypoints * threats); with verify_flight that once more in the worst case.
[[nodiscard]] world::PlanStatus solve(const Problem& problem, const Settings& settings,
                                      const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe,
                                      WorkBudget& budget, Workspace& workspace, Result& result) noexcept;
/// The same with the working memory on the stack.
[[nodiscard]] world::PlanStatus solve(const Problem& problem, const Settings& settings,
                                      const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe,
                                      WorkBudget& budget, Result& result) noexcept;

/// `solve`, and where nothing is available again as kAttempts says, up to Settings::retries times; `attempts` says how
/// often. The problem's own span is ignored. `result` is that of the last attempt. All of it within `budget`.
[[nodiscard]] world::PlanStatus solve_with_retries(const Problem& problem, const Settings& settings,
                                                   const vehicle::VehicleLimits& limits,
                                                   const vehicle::Airframe& airframe, WorkBudget& budget,
                                                   Workspace& workspace, Result& result,
                                                   std::size_t& attempts) noexcept;

/// The timed path of one candidate, as `solve` makes it: `waypoints` points at equal steps of the abscissa. False (out
/// untouched) on bad input as above, for a candidate that waits, or with fewer than 8 or more than kMaxPathPoints
/// waypoints. O(waypoints).
[[nodiscard]] bool make_candidate_path(const Problem& problem, const CandidateShape& shape, std::uint16_t waypoints,
                                       const vehicle::VehicleLimits& limits, path::TimedPath& out) noexcept;

/// The method: satisfies world's AvoidanceMethod.
///
/// Memory: sizeof(Result), about kMaxCandidates * 100 bytes, and a Workspace. Reads the conflict with the leg out of
/// the Situation (collision point = own position on the leg at the closest approach of the main threat, R = its grown
/// radius then, at least kMinMainRadius; of a closed area its circle, at the own height), solves, and returns the
/// chosen path as a follow_path manoeuvre. Closed areas count with their soft margins first, and without them where
/// nothing is available so. It begins
/// with what the vehicle flies during FlightRules::latency, so that it is joined without a jump; threats are met where
/// and as large as they are from then on. The start is not moved where that would bring the collision point nearer than
/// kMinLeadRatio times that way or the 2.5 R, nor from inside a margin, nor with kMaxPathPoints waypoints.
///
/// When nothing is available it tries again as kAttempts says (source offsets: other speeds and ends only).
class Planner {
public:
    static constexpr world::MethodTraits kTraits{
        .id = 1, .reactive = false, .keeps_clearance = false, .needs_sets = false};
    /// Smaller main threats are planned for as if they had this radius, so that offsets have something to scale with
    /// [m].
    static constexpr float kMinMainRadius = 0.5F;
    static constexpr float kMinLeadRatio = 4.0F;

    explicit Planner(const Settings& settings) noexcept : settings_(settings) {}

    [[nodiscard]] world::PlanStatus plan(const world::Situation& situation, WorkBudget& budget,
                                         world::Manoeuvre& out) noexcept;

    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    /// Refused (false, nothing changed) when out of range.
    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    /// Candidates of the last plan, for diagnosis.
    [[nodiscard]] const Result& last() const noexcept { return result_; }

private:
    Settings settings_;
    Result result_;
    Workspace workspace_;
};

}  // namespace jink::geometric
