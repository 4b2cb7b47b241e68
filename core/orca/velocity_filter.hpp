// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/base/work_budget.hpp"
#include "core/capacity.hpp"
#include "core/orca/bias.hpp"
#include "core/orca/command_ring.hpp"
#include "core/orca/limits.hpp"
#include "core/orca/neighbours.hpp"
#include "core/orca/obstacle_plane.hpp"
#include "core/orca/prediction.hpp"
#include "core/orca/program.hpp"
#include "core/orca/smoothing.hpp"
#include "core/vehicle/vehicle.hpp"

namespace jink::orca {

/// What else a decision says of itself; or-ed with StatusBit.
enum FilterBit : std::uint32_t {
    kObstaclePenetration = 1U << 8U,   ///< the envelope meets an obstacle's margin
    kConflictOverlap = 1U << 9U,       ///< the conflict region of a pair is entered
    kObstaclesTruncated = 1U << 10U,   ///< more obstacles than half-spaces: the speed is capped for the rest
    kNeighboursTruncated = 1U << 11U,  ///< the same of other vehicles
    kDistanceBounded = 1U << 12U,      ///< an obstacle's distance is a lower bound, its search was cut short
    kNeighbourStale = 1U << 13U,       ///< one that was not heard of for long: nothing is expected of it
    kNeighbourRefused = 1U << 14U,     ///< one that is not finite, or has sizes and speeds that are none
    kResynchronised = 1U << 15U,       ///< the last command is not what is flown: from the predicted velocity on
    kDelayClipped = 1U << 16U,         ///< commands that are still to be flown are not all known
    kBlocked = 1U << 17U,              ///< no progress for long: a plan from above is needed
    kStalled = 1U << 18U,              ///< slower than the least speed, without a direction
    kCapBroken = 1U << 19U,            ///< a cap of the speed is below what one period of braking leaves
    kNotSmoothed = 1U << 20U,          ///< the mean of the last commands breaks a half-space: the newest itself
    kOwnStale = 1U << 21U,             ///< the own state is too old: braking
    kConfigUnsafe = 1U << 22U,         ///< settings were refused: braking
    kObstacleAhead = 1U << 23U,        ///< along the command an obstacle's margin is met within its horizon
    kBoundsOverlap = 1U << 24U,        ///< outside of the airspace's bounds
};

/// Largest FilterSettings::cover: a conflict region of half the warning region's size that covers the cylinder
/// takes 2.83.
inline constexpr float kLargestCover = 3.0F;

/// Everything that is set beforehand.
struct FilterSettings {
    MotionLimits limits;
    Seconds tick = 0.0F;  ///< between decisions, for what is timed, >= 0; 0: limits.period
    PairSettings pair;
    float half_width = 0.6F;   ///< own share of the warning region's radius [m], > 0
    float half_height = 0.3F;  ///< [m], > 0
    float cover = 1.0F;        ///< in [1, kLargestCover]; kCylinderCover to keep the cylinder of the same widths
    std::uint32_t own_id = 0;
    Seconds stale = 1.0F;  ///< of a neighbour's age, after which nothing is expected of it
    ObstacleSettings obstacles;
    BiasSettings bias;
    VelocityLoop loop;            ///< of the own vehicle
    Seconds delay = 0.5F;         ///< from sensing to flying, filters included: gains are checked against it
    float most_apart = 1.0F;      ///< command and flown velocity [m/s], > 0
    Seconds own_stale = 0.2F;     ///< of the own state, > 0
    std::size_t smoothing = 1;    ///< commands in the mean, CommandFilter::kMax at most; 1: none
    bool slows_down = true;       ///< where conflict regions overlap
    bool looks_along = true;      ///< along the command once it is chosen, for what half-spaces leave out
    bool accepts_unsafe = false;  ///< settings that check() refuses, but for those that are no numbers: for studies
};

/// Bounds of the airspace as seen from the own vehicle's place, each with what is needed from its own centre.
struct Bound {
    Vec3 outward = Vec3::UnitZ();  ///< unit vector towards it
    float gap = 0.0F;              ///< [m] to it, less the distance to be kept; below 0: beyond it
    float speed = 0.0F;            ///< its own along `outward` [m/s]: below 0 it comes nearer
};
/// Floor, ceiling, keep-in, and closed volumes or storm cells that are near.
inline constexpr std::size_t kMaxBounds = 8;

/// What is known at one tick, at the instant that the decision begins to act.
struct FilterInput {
    Predicted own;                            ///< VelocityFilter::predicted
    Seconds own_age = 0.0F;                   ///< of the measured own state
    Vec3 preferred = Vec3::Zero();            ///< [m/s]
    std::span<const Neighbour> neighbours{};  ///< relative to own.position, at the same instant
    Obstacles obstacles{};
    std::span<const Bound> bounds{};  ///< kMaxBounds at most: more is kBadInput
};

/// A half-space that holds the command where it is.
struct Binding {
    Level level = Level::limits;
    std::uint16_t source = 0;  ///< place in FilterInput::neighbours or obstacles, kBoundSource + bound
};
inline constexpr std::uint16_t kBoundSource = 0xFF00U;

/// One command, with what can be said of it. Where commands are smoothed, `status`, `level`, `broken` and `bindings`
/// are those of the solution that went into the mean: the mean keeps to all that is hard, not to warning half-spaces.
struct Decision {
    /// [m/s], always finite and within the limits' spheres: no faster than may be, and one period's acceleration from
    /// what was sent last; with kNotSmoothed from the last solution, with kResynchronised from what is flown. What can
    /// not be solved or is too old (kBadInput, kOwnStale, kConfigUnsafe) brakes.
    Vec3 command = Vec3::Zero();
    std::uint32_t status = 0;             ///< StatusBit, FilterBit
    Level level = Level::warning;         ///< the strongest that is broken, where one is
    std::array<float, kLevels> broken{};  ///< by level, as Solution::broken
    StaticVector<Binding, 3> bindings;
    /// Least distance of a pair's centres over the conflict region's radius, in its stretched space; infinite for none.
    float nearest = std::numeric_limits<float>::infinity();
    std::uint32_t nearest_id = 0;
    float margin = std::numeric_limits<float>::infinity();  ///< to the nearest obstacle, as ObstaclePlanes::margin
    std::uint16_t nearest_obstacle = 0;
    Seconds horizon = 0.0F;      ///< towards other vehicles, effective
    Seconds clear_until = 0.0F;  ///< along the command no obstacle's margin is met until then; with looks_along
    std::uint32_t work = 0;
};

/// G-ORCA's tick: a filter on the preferred velocity, the identity while nothing is foreseen within the horizons, else
/// the smallest change that keeps to the half-spaces of what can be flown, of obstacles and bounds, and of other
/// vehicles (Alejo 7; van den Berg et al.). One instance for each vehicle.
///
/// Each tick: predicted() - neighbours relative to it, made by the caller - decide() - issued() with what was really
/// sent. Answers depend on nothing but the calls so far.
///
/// Memory: about 6 KiB with the default capacities. decide() is bounded by its budget; when that is spent the command
/// is the best of a few, as solve() says, and kWorkLimit is reported.
class VelocityFilter {
public:
    explicit VelocityFilter(const FilterSettings& settings = {}) noexcept { static_cast<void>(configure(settings)); }

    /// Refused (not Unsafe::none; the settings before stay, and without any every command brakes) when out of range or
    /// not fit to stop in time, see check().
    [[nodiscard]] Unsafe configure(const FilterSettings& settings) noexcept;
    [[nodiscard]] const FilterSettings& settings() const noexcept { return settings_; }

    /// The own vehicle when a command of now begins to act.
    [[nodiscard]] Predicted predicted(const vehicle::VehicleState& measured, TimePoint now) const noexcept
    {
        return predict(measured, issued_, settings_.loop, now + settings_.loop.act);
    }

    [[nodiscard]] Decision decide(const FilterInput& input, WorkBudget& budget) noexcept;

    /// `velocity` was sent at `now`: the decision's command, or what somebody else made of it. False where it is not
    /// finite or not later than the one before, and nothing is remembered.
    bool issued(TimePoint now, const Vec3& velocity) noexcept;

    /// After a pause, or when somebody else flew: what was commanded says nothing of what is flown.
    void reset() noexcept;
    [[nodiscard]] Seconds stalled() const noexcept { return bias_.stalled(); }

private:
    static constexpr std::size_t kPlanes = kMaxLimitPlanes + kMaxBounds + kMaxObstaclePlanes + 2 * kMaxOrcaNeighbours;
    using Planes = std::array<HalfSpace, kPlanes>;

    struct Tick;
    void add_bounds(Tick& tick) const noexcept;
    void add_obstacles(Tick& tick, WorkBudget& budget) const noexcept;
    void add_neighbours(Tick& tick, WorkBudget& budget) noexcept;
    [[nodiscard]] Vec3 preferred_of(Tick& tick) noexcept;
    void choose(Tick& tick, WorkBudget& budget) noexcept;
    void smooth(Tick& tick, const Solution& solution, WorkBudget& budget) noexcept;
    void brake(Tick& tick) noexcept;

    FilterSettings settings_;
    NeighbourSettings neighbours_;
    Bias bias_;
    SlowDown slow_down_;
    CommandFilter mean_;
    CommandRing issued_;
    Vec3 last_solution_ = Vec3::Zero();
    bool has_solution_ = false;
    bool configured_ = false;
    Planes planes_;  ///< of a decision; not on the stack
    Scratch<kPlanes> scratch_;
};

}  // namespace jink::orca
