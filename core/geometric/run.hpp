// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/work_units.hpp"
#include "core/geometric/along_reference.hpp"
#include "core/geometric/clearance.hpp"
#include "core/geometric/curve.hpp"
#include "core/geometric/flown.hpp"
#include "core/geometric/offsets.hpp"
#include "core/geometric/planner.hpp"

// Private to this module.

namespace jink::geometric::detail {

/// One run of `solve`: what its steps share.
class Run {
public:
    Run(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
        const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept
        : problem_(problem), settings_(settings), limits_(limits), airframe_(airframe), budget_(budget),
          result_(result), along_(problem.frame.axes.col(0)), clearance_(problem, settings, limits),
          flown_(problem, settings, limits)
    {
    }

    world::PlanStatus operator()() noexcept
    {
        if (!budget_.spend(units_of_set_up())) {
            result_.cut_short = true;
            return world::PlanStatus::budget_spent;
        }
        generate();
        prepare();
        // What has been found must not be left unchecked.
        const std::uint32_t kept = std::min(units_of_checks(), budget_.left() / 2);
        WorkBudget curves = budget_.part(budget_.left() - kept);
        for (Candidate& candidate : result_.candidates) {
            if (!evaluate(candidate, curves)) {
                break;
            }
        }
        budget_.charge(curves);
        spent_ = curves.exhausted();
        return choose();
    }

private:
    void generate() noexcept;
    void generate_curves(const Problem& seen) noexcept;
    void generate_curves(Family family, const Problem& seen) noexcept;
    void generate_waits() noexcept;
    void prepare() noexcept;
    [[nodiscard]] Wait waiting(float share, Seconds until) const noexcept;
    [[nodiscard]] bool evaluate(Candidate& candidate, WorkBudget& budget) noexcept;
    void assess(Candidate& candidate) noexcept;
    [[nodiscard]] std::uint32_t units_of_checks() const noexcept
    {
        constexpr std::uint64_t kMax = std::numeric_limits<std::uint32_t>::max();
        // Curves along a route are more expensive: one share more.
        const std::uint64_t shares =
            (!problem_.ahead.route.empty() ? 2U : 1U) + std::uint64_t{units::kSolidShares} * clearance_.solids();
        return static_cast<std::uint32_t>(std::min(kMax, settings_.check_units * shares));
    }
    [[nodiscard]] std::uint32_t units_of_costs() const noexcept
    {
        const std::size_t each = settings_.weights.passing > 0.0F ? 2 : 1;
        return units::kCostPoint * settings_.waypoints +
               units::closeness_units(settings_.waypoints, each * moving_.size());
    }
    /// Before the first candidate is evaluated.
    [[nodiscard]] std::uint32_t units_of_set_up() const noexcept
    {
        const auto families = static_cast<std::uint32_t>(std::count_if(
            kCurves.begin(), kCurves.end(), [this](Family family) { return settings_.*flag_of(family); }));
        const std::uint32_t planes = settings_.extra_planes + 1U;
        const std::size_t vertices = problem_.main_shape != nullptr ? problem_.main_shape->vertices.size() : 0;
        return units::kAttempt + units::kPlanned * static_cast<std::uint32_t>(count_of_candidates(settings_)) +
               families * (units::points_units(settings_.waypoints) + units::kPlaneOffsets * planes) +
               2U * (planes + 1U) * (units::kMainExtent + units::hull_units(vertices));
    }
    [[nodiscard]] std::uint32_t units_of_curve() const noexcept
    {
        const std::uint32_t each = units::kCandidatePoint + (!problem_.ahead.route.empty() ? units::kRoutePoint : 0);
        return each * settings_.waypoints;
    }
    [[nodiscard]] float smoothness_of(const CandidateShape& shape) const noexcept;
    [[nodiscard]] cost::Waypoints waypoints() const noexcept;
    [[nodiscard]] float closeness() const noexcept;
    [[nodiscard]] float passing() const noexcept;
    void list_moving() noexcept;
    [[nodiscard]] AtStart about_start(const world::Threat& threat) const noexcept;
    [[nodiscard]] Selection far_threats(Seconds longest) noexcept;
    void build(const CandidateShape& shape) noexcept;
    [[nodiscard]] bool can_be_flown(const CandidateShape& shape) const noexcept;
    [[nodiscard]] bool is_wait_flyable(const CandidateShape& shape) const noexcept;
    /// Of a curve.
    [[nodiscard]] const Vec3& side_of(const CandidateShape& shape) const noexcept
    {
        const float planes = static_cast<float>(settings_.extra_planes) + 1.0F;
        return sides_[static_cast<std::size_t>(std::lround(shape.plane * (planes / kPi)))];
    }
    /// Candidates still to be tried, a heap with the cheapest at its front, of equally cheap ones the first.
    using Order = StaticVector<std::uint16_t, kMaxCandidates>;
    [[nodiscard]] auto by_cost() const noexcept
    {
        return [this](std::uint16_t a, std::uint16_t b) {
            const float cost_a = result_.candidates[a].total + result_.candidates[a].flip_penalty;
            const float cost_b = result_.candidates[b].total + result_.candidates[b].flip_penalty;
            return cost_b < cost_a || (cost_b == cost_a && b < a);
        };
    }
    [[nodiscard]] bool try_in_turn(WorkBudget& budget) noexcept;
    [[nodiscard]] Verdict verdict_of(const CandidateShape& shape, WorkBudget& budget) noexcept;
    void take(std::size_t index) noexcept;
    [[nodiscard]] world::PlanStatus choose() noexcept;

    const Problem& problem_;
    const Settings& settings_;
    const vehicle::VehicleLimits& limits_;
    const vehicle::Airframe& airframe_;
    WorkBudget& budget_;
    Result& result_;
    const Vec3 along_;
    bool spent_ = false;                          ///< the budget has ended before all candidates were checked
    Seconds longest_ = 0.0F;                      ///< duration of any candidate, where threats sweep volumes
    std::array<UnitCurve, kCurves.size()> unit_;  ///< by family
    std::array<Vec3, kMaxPlanes> sides_;
    std::array<MainExtent, kMaxPlanes> extents_;  ///< by plane
    Clearance clearance_;
    Flown flown_;
    Selection far_{};  ///< moving threats beyond Settings::moving_nearest
    Order order_;
    BaseCurve base_;        ///< of the candidate at hand: with a route all of it, else its end
    Curve curve_;           ///< of the candidate at hand
    path::TimedPath path_;  ///< the same, about the start
    /// Tracks and solids that count for closeness and passing, by their index in Problem::threats.
    static constexpr std::size_t kMaxMoving = kMaxTracks + kMaxMovingSolids;
    StaticVector<std::uint16_t, kMaxMoving> moving_;
};

}  // namespace jink::geometric::detail
