// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// A random encounter. The vehicle is on a level or climbing leg. One to three intruders pass within 1.5 m (the first
/// within 0.5 m) of the vehicle's position at that time, from any direction, at 0 to 12 m/s, radius 0.5 to 2 m,
/// detected 2 to 8 s before. Noise 0.3 m and 0.2 m/s, latency 0.1 s, jitter 0.05 s, 5 % dropouts. Either stack. The
/// same seed gives the same scenario on every machine.
[[nodiscard]] Scenario random_scenario(std::uint64_t seed);

/// An encounter of the campaign (encounter_campaign.hpp): the same with one to eight intruders, all counts equally
/// likely, at 0 to 15 m/s. Uses another random stream than random_scenario of the same seed.
[[nodiscard]] Scenario open_encounter(std::uint64_t seed);

/// The largest world that the link can report: 32 intruders as above at once, inside a ring of pillars that fills every
/// sector of the range scan. Avoidance may be impossible: only a broken rule of the protocol counts as unexpected.
[[nodiscard]] Scenario crowded_scenario(std::uint64_t seed);

}  // namespace jink::sim
