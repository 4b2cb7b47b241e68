// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tests/replay/recording.hpp"

namespace jink::replay_test {

/// Compares a believed nominal path with the true motion of the next seconds.
///
/// * A route claims the line to its end: the truth of the next 3 s stays within 3 m of it, and is not faster than the
///   route's speed by more than 30 % and 1 m/s. In steady flight its speed is the route's to 2 m/s; straight up and
///   down it is not compared, because the climb limit bounds the prediction too.
/// * The measured motion claims a second of constant velocity: 3 m, for accelerations up to 5 m/s2. Of an arc
///   the belief holds the end alone: nothing is compared.
/// * Nothing is claimed about the 3 s around a change: another mode, another mission item, a take-off.
///
/// @return the contradiction; empty: none, or undecidable
[[nodiscard]] std::string contradiction(const Recording& recording, const sim::Belief& belief);

}  // namespace jink::replay_test
