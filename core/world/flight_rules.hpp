// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/time.hpp"
#include "core/path/follower.hpp"

namespace jink::world {

/// How a flight that starts inside a margin is judged: each threat's sphere (or clearance) is shrunk to just clear the
/// start and grows back at `speed`, so that a flight which leaves the margin at least that fast, and does not come
/// back, is clear.
struct EscapeRule {
    float slack = 0.05F;  ///< the shrunk surface clears the start by this much, 0..1 [m]
    float speed = 0.5F;   ///< the surface grows back at this speed, 0..10 [m/s]
};

/// The volume that is kept clear of aircraft with people aboard: an upright cylinder about each (ASTM F3442: 2000 ft
/// and 250 ft).
struct WellClear {
    float radius = 0.0F;   ///< level [m]; 0: such aircraft are met like other traffic
    float height = 76.2F;  ///< above and below, 1..1000 [m]
};

/// What the supervisor and all methods share: how far ahead threats count, how large they are, and how the vehicle
/// answers. One value for all of them: what one sees as a conflict the others see too. 48 bytes.
struct FlightRules {
    Seconds lookahead = 8.0F;  ///< conflicts are predicted this far ahead, 1..60 [s]
    /// Until the vehicle answers, planning and the way to the autopilot included, it flies on as it does, 0..1 [s].
    Seconds latency = 0.1F;
    float k_sigma = 3.0F;  ///< standard deviations that count as possible, 0..6
    /// Plans keep this much more than the margin, so that noise does not undo them, 0..10 [m].
    float clearance = 0.4F;
    EscapeRule escape{};
    path::FollowerGains gains{};  ///< of the follower, 0..10 each
    WellClear well_clear{};
    /// Cooperative vehicles accelerate no harder than this or the own limit, whichever is more, 0..100 [m/s2].
    float fellow_acceleration = 0.0F;
};

/// Whether every rule is finite and within its range. O(1).
[[nodiscard]] inline bool is_valid(const FlightRules& r) noexcept
{
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    return within(r.lookahead, 1.0F, 60.0F) && within(r.latency, 0.0F, 1.0F) && within(r.k_sigma, 0.0F, 6.0F) &&
           within(r.clearance, 0.0F, 10.0F) && within(r.escape.slack, 0.0F, 1.0F) &&
           within(r.escape.speed, 0.0F, 10.0F) && within(r.gains.position_gain, 0.0F, 10.0F) &&
           within(r.gains.max_correction, 0.0F, 10.0F) && within(r.well_clear.radius, 0.0F, 5000.0F) &&
           within(r.well_clear.height, 1.0F, 1000.0F) && within(r.fellow_acceleration, 0.0F, 100.0F);
}

}  // namespace jink::world
