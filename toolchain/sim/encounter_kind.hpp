// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Encounters of a campaign, and harder ones: the same encounters by their seeds, one thing made worse. The built-up
/// areas are scenes of their own, without intruders.
enum class EncounterKind : std::uint8_t {
    open,       ///< intruders fly straight on: open_encounter()
    turning,    ///< each turns by 1 to 6 deg/s for 3 to 15 s, from up to 10 s before they meet
    climbing,   ///< each changes its climb by 1 to 4 m/s, from 5 s before to 3 s after they meet
    speeding,   ///< each speeds up or slows down by 0.5 to 2 m/s2 for 1 to 5 s, at most to a stop
    seldom,     ///< reported once a second
    drifting,   ///< errors of positions that stay: 1.5 m of traffic (20 s), 1 m of the own position (60 s)
    windy,      ///< gusts of a wind of 8 m/s
    cluttered,  ///< 12 pillars of up to 1.5 m about the leg, seen by a level scan
    late,       ///< the first intruder alone, reported 0.4 to 1.6 s before they meet
    built_up,   ///< 2 to 6 boxes about the leg, seen by a LiDAR alone: built_up_area()
};
inline constexpr std::array kEncounterKinds{EncounterKind::open,     EncounterKind::turning,   EncounterKind::climbing,
                                            EncounterKind::speeding, EncounterKind::seldom,    EncounterKind::drifting,
                                            EncounterKind::windy,    EncounterKind::cluttered, EncounterKind::late,
                                            EncounterKind::built_up};
[[nodiscard]] std::string_view to_string(EncounterKind kind) noexcept;
/// True if a flight ends at the goal (Scenario::to_goal), so that a goal can be missed.
[[nodiscard]] constexpr bool flies_to_goal(EncounterKind kind) noexcept { return kind == EncounterKind::built_up; }

/// The same seed gives the same encounter. Intruders that do not fly straight on pass the place where the straight ones
/// are nearest to the leg's traffic at the same time, at the same velocity.
[[nodiscard]] Scenario encounter_of(EncounterKind kind, std::uint64_t seed);

}  // namespace jink::sim
