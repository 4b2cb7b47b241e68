// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// A scenario as text of a scenario file (tests/scenario/README.md), from which parse_scenario makes the same one bit
/// by bit: numbers stand in the shortest decimal form that reads back to them, seeds of the noise included. The name is
/// the file's to carry, and the sensors' phases of timing.hpp are no part of files.
///
/// @param remark  put in front as comments, line by line
[[nodiscard]] std::string scenario_text(const Scenario& scenario, const std::string& remark = "");

}  // namespace jink::sim
