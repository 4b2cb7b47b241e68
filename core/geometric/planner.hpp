// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/work_budget.hpp"
#include "core/geometric/candidate.hpp"
#include "core/world/world.hpp"

namespace jink::geometric {

/// swept: threats are the volume they sweep until the longest candidate ends (Pinheiro 3.4.2). time_aware: where they are, when.
enum class SecurityMode : std::uint8_t { time_aware, swept };
/// source: -3.2 R + i 6.4 R / l, those inside the threat dropped. clearing: l offsets, half a side, from the smallest one
/// that clears the main threat with the box to max(3.2 R, twice that).
enum class OffsetRule : std::uint8_t { clearing, source };

struct Settings {
    std::uint16_t offsets = 4;             ///< l, even, 2..64
    std::uint16_t extra_planes = 3;        ///< n, 0..31
    bool simple = true;
    bool symmetric = true;
    std::uint16_t waypoints = 25;          ///< per candidate, 8..kMaxPathPoints
    SecurityMode security = SecurityMode::time_aware;
    OffsetRule offset_rule = OffsetRule::clearing;
    bool main_swept_to_collision_point = false;  ///< swept mode: the main threat's volume ends at the collision point (source)
    float source_drop_margin = 0.0F;       ///< source offsets: |w| < R + this is dropped; 0 as the text, 1 m as the reproduced distribution study
    bool check_acceleration = true;        ///< candidates beyond the acceleration limits are not flyable; off in source mode
    bool verify_flight = true;             ///< the cheapest must also be clear as the vehicle will fly it; off in source mode
    cost::SmoothnessMethod smoothness = cost::SmoothnessMethod::curvature;
    cost::ClosenessMethod closeness = cost::ClosenessMethod::time_aware;
    float rotation_penalty = 1.0F;         ///< k_p
    cost::Weights weights;
    cost::Caps caps;
    float flip_penalty = 0.15F;            ///< added to the total of candidates on the other side of what is being flown
    std::uint16_t closeness_nearest = 0;   ///< only the k nearest moving threats count for closeness; 0: all
    float max_cost = 1.0F;                 ///< a cheapest candidate above this counts as not found
};
/// The source's planner: swept security ending at the collision point, source offsets, no feasibility, swept closeness.
[[nodiscard]] Settings source_settings() noexcept;
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

/// A threat of the planning problem. Static when its velocity is zero.
struct Threat {
    geometry::Motion motion;
    float radius = 0.0F;            ///< at t = 0 [m], uncertainty included
    float radius_rate = 0.0F;       ///< growth by velocity uncertainty [m/s]
    float radius_acceleration = 0.0F;  ///< growth by unknown acceleration [m/s2], as radius += a t^2 / 2
};

/// One planning problem on its own, free of Situation: what `jink plan`, the campaign and the reproduction tests solve.
struct Problem {
    PathFrame frame;                 ///< start of the manoeuvre and leg direction
    float distance = 0.0F;           ///< D: start to the collision point [m]
    float main_radius = 0.0F;        ///< R that scales offsets and the 2.5 R rule [m]
    std::size_t main = 0;            ///< index of the main threat in `threats`
    std::span<const Threat> threats;
    std::span<const world::Obstacle> obstacles;
    const world::Airspace* airspace = nullptr;
    Vec3 start_velocity = Vec3::Zero();  ///< own velocity at the start, for verify_flight [m/s]
    float speed = 5.0F;              ///< cruise speed along the candidates [m/s]
    Vec3 preferred_side = Vec3::Zero();  ///< of what is being flown; zero for none
    Vec3 main_centre_offset = Vec3::Zero();  ///< main threat's centre at the collision time minus the collision point [m]; clearing offsets account for it
};

struct Result {
    StaticVector<Candidate, kMaxCandidates> candidates;  ///< in the order of generation
    std::size_t chosen = 0;          ///< index, valid on PlanStatus::found
    path::TimedPath path;            ///< of the chosen one
    Vec3 side = Vec3::Zero();        ///< unit vector from the leg to its apex
};

/// Solves one problem. Budget: one unit per candidate segment and threat test, support calls for obstacles.
/// found, too_close (D < 2.5 R), none_available, budget_spent, bad_input. `result.candidates` is filled as far as evaluated on every status but bad_input.
/// O(candidates * waypoints * threats).
[[nodiscard]] world::PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                                      const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept;

/// The timed path of one candidate, as `solve` makes it: `waypoints` points at equal steps of the abscissa.
[[nodiscard]] bool make_candidate_path(const Problem& problem, const CandidateShape& shape, std::uint16_t waypoints,
                                       const vehicle::VehicleLimits& limits, path::TimedPath& out) noexcept;

/// The method: satisfies world's AvoidanceMethod.
///
/// Reads the conflict with the leg out of the Situation (collision point = own position on the leg at the closest approach of the
/// main threat, R = its grown radius then), solves, and returns the chosen path as a follow_path manoeuvre.
class Planner {
public:
    explicit Planner(const Settings& settings) noexcept : settings_(settings) {}

    [[nodiscard]] world::PlanStatus plan(const world::Situation& situation, WorkBudget& budget, world::Manoeuvre& out) noexcept;

    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    /// Refused (false, nothing changed) when out of range.
    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    /// Candidates of the last plan, for diagnosis.
    [[nodiscard]] const Result& last() const noexcept { return result_; }

private:
    Settings settings_;
    Result result_;
};

}  // namespace jink::geometric
