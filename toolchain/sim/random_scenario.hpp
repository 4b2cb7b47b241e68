// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// An encounter drawn from a seed: the vehicle on a level or climbing leg; one to three intruders that pass the leg
/// within 1.5 m (the first one within 0.5 m) of where the vehicle then is, from any direction, at 0 to 12 m/s, radius
/// 0.5 to 2 m, seen 2 to 8 s before. Noise 0.3 m and 0.2 m/s, latency 0.1 s, jitter 0.05 s, 5 % dropouts. Either
/// stack. The same seed gives the same scenario on every machine.
[[nodiscard]] Scenario random_scenario(std::uint64_t seed);

/// An encounter of the campaign (encounter_campaign.hpp): the same, but for one to eight intruders, each count as
/// likely as the other, at 0 to 15 m/s. Of another stream of numbers than random_scenario of the same seed.
[[nodiscard]] Scenario open_encounter(std::uint64_t seed);

/// The fullest world that the link can bring: 32 intruders as above at once, inside a ring of pillars that fills every
/// sector of the range scan. There may be no way out: only a broken rule of the protocol counts as unexpected.
[[nodiscard]] Scenario crowded_scenario(std::uint64_t seed);

}  // namespace jink::sim
