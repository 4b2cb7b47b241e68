// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

// The simulator's truth is in double precision, SI units, local ENU with home as its origin, and independent of core's
// arithmetic.

namespace jink::sim {

using Vec = Eigen::Vector3d;

/// Simulated time since the start of the flight [us]; whole steps, without drift.
using Micros = std::int64_t;

inline constexpr Micros kSecond = 1'000'000;
/// Step of the world [us].
inline constexpr Micros kStep = 5'000;

[[nodiscard]] constexpr double to_seconds(Micros t) noexcept { return static_cast<double>(t) * 1e-6; }
[[nodiscard]] constexpr Micros to_micros(double seconds) noexcept
{
    return static_cast<Micros>(seconds * 1e6 + (seconds < 0.0 ? -0.5 : 0.5));
}

}  // namespace jink::sim
