// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/reach/wave_front.hpp"

// The generators: selection of trajectories.

namespace jink::reach::build {

/// No limit.
inline constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

/// Planes of a set (Gomola eq. 6.87), as bits.
enum Separation : std::uint8_t { kHorizontal = 1, kVertical = 2, kSlash = 4, kBackslash = 8, kAllSeparations = 15 };

/// Candidates near the side walls of their cell: they spread into other rows and columns (Gomola algorithm 6.2).
/// `tail`: number of footprint cells in the key.
[[nodiscard]] Constraint chaotic(const Settings& settings, std::size_t spread = 9, std::size_t tail = 3);
/// Candidates near the centre of their cell, smooth candidates first (Gomola algorithm 6.3).
[[nodiscard]] Constraint harmonic(const Settings& settings, std::size_t spread = 9);
/// Whether the spread limits candidates per cell, or per plane and cell. With the latter, where planes cross, in the
/// middle column and row, one plane's candidates do not displace the others'.
enum class SpreadOf : std::uint8_t { cell, separation };
/// Candidates within one of the planes (Gomola algorithm 6.5), near the centre and smooth candidates first.
[[nodiscard]] Constraint acas(const Settings& settings, std::uint8_t separations, std::size_t spread = 9,
                              SpreadOf spread_of = SpreadOf::cell);

/// Distance from the centre over smoothness (Gomola eq. 6.80); candidates with zero smoothness rank last, by distance.
[[nodiscard]] double performance(const Node& node);

}  // namespace jink::reach::build
