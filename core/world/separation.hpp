// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/work_budget.hpp"
#include "core/path/prediction.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// Separations beyond this, either way, are not distinguished [m].
inline constexpr float kSeparationCap = 50.0F;

struct Separation {
    float margin = kSeparationCap;  ///< own box to the threat's grown surface [m]; below 0: contact
    Seconds when = 0.0F;            ///< path time of it
    ThreatRef against;
};

/// How closely a flight has to be checked.
struct Cutoff {
    float below = -kSeparationCap;  ///< a margin below this ends the check: it is no better than what a search has [m]
    float above = kSeparationCap;   ///< the margin saturates at this value [m]
    ThreatRef first;                ///< checked before all others: what was nearest on the flight before
    float uncertainty = 1.0F;       ///< share of the uncertainty of tracks and obstacles that counts, 0..1
};

/// Least separation along a timed path, from path time 0 (= Situation::now) to min(path end, `horizon`):
/// exact and time-aware for tracks (relative motion per segment in closed form, the threat at the size it has at the
/// segment's end, so never optimistic), swept and exact for obstacles (libccd under `budget`, a budget that runs out
/// counts as contact), cylinders exact and time-aware (the flight's box against the moving body; their margin does not
/// count), airspace bounds by their planes. All of them are met k_sigma * sigma_position of the own position early.
///
/// A flight that starts inside a margin is judged by `escape`: its margin is then measured to the shrunk surface, which
/// is checked in pieces in which it grows by half the slack at most. For solids other than spheres the slack is 0.15
/// m more (kObstacleResolution, and pieces of 0.2 s). A margin that is no number is contact.
///
/// Situation::threats is what is kept clear of; where it was never collected, the answer is contact.
///
/// Cooperative tracks are checked until Situation::shared_horizon at most.
///
/// Never above the truth by more than 1e-3 m within 100 m of the origin; below it by no more than what a track grows in
/// 0.25 s, half the slack inside a margin, kObstacleResolution for solids. Cut off, the margin is below
/// Cutoff::below, and no lower bound of the least. Cost in budget: core/base/work_units.hpp, by piece of the path,
/// threat, piece near a threat, and part of it; queries for solids. O(points * (tracks + obstacles + cylinders)).
[[nodiscard]] Separation least_separation(const Situation& situation, std::span<const path::PathPoint> points,
                                          Seconds horizon, WorkBudget& budget, const EscapeRule& escape = {},
                                          const Cutoff& cutoff = {}) noexcept;
[[nodiscard]] inline Separation least_separation(const Situation& situation, const path::TimedPath& path,
                                                 Seconds horizon, WorkBudget& budget, const EscapeRule& escape = {},
                                                 const Cutoff& cutoff = {}) noexcept
{
    return least_separation(situation, std::span(path.points.data(), path.points.size()), horizon, budget, escape,
                            cutoff);
}

/// The same for a predicted flight: each threat is met as much earlier as the flight may leave its chord there
/// (path::Sagitta; floor and ceiling: its vertical part). The margin is never above that of the flight itself by more
/// than said above, and below it by two sagittas more at most.
[[nodiscard]] Separation least_separation(const Situation& situation, const path::Prediction& flight, Seconds horizon,
                                          WorkBudget& budget, const EscapeRule& escape = {},
                                          const Cutoff& cutoff = {}) noexcept;

/// The same at one instant, `t` seconds after Situation::now, with no escape rule: how close is everything now.
/// `position`: own box centre. A budget that runs out counts as
/// contact.
[[nodiscard]] Separation separation_at(const Situation& situation, const Vec3& position, Seconds t,
                                       WorkBudget& budget) noexcept;

}  // namespace jink::world
