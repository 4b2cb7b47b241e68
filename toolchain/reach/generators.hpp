// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/reach/wave_front.hpp"

// The generators: which trajectories are worth keeping.

namespace jink::reach::build {

/// As many as wanted.
inline constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

/// Planes that a set keeps to (Gomola eq. 6.87), as bits.
enum Separation : std::uint8_t { kHorizontal = 1, kVertical = 2, kSlash = 4, kBackslash = 8, kAllSeparations = 15 };

/// Candidates that come near the side walls of their cell: they break into other rows and columns (Gomola algorithm
/// 6.2). `tail`: cells of the footprint that are told apart.
[[nodiscard]] Constraint chaotic(const Settings& settings, std::size_t spread = 9, std::size_t tail = 3);
/// Candidates near the centre of their cell, smooth ones first (Gomola algorithm 6.3).
[[nodiscard]] Constraint harmonic(const Settings& settings, std::size_t spread = 9);
/// Whether candidates of a cell are counted together, or those of each plane apart: where planes cross, in the middle
/// column and row, one plane's candidates do not displace those of the others then.
enum class SpreadOf : std::uint8_t { cell, separation };
/// Candidates that keep to one of the planes (Gomola algorithm 6.5), near the centre and smooth ones first.
[[nodiscard]] Constraint acas(const Settings& settings, std::uint8_t separations, std::size_t spread = 9,
                              SpreadOf spread_of = SpreadOf::cell);

/// Distance from the centre over smoothness (Gomola eq. 6.80); without smoothness beyond all others, by distance.
[[nodiscard]] double performance(const Node& node);

}  // namespace jink::reach::build
