// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// A scenario as text of a scenario file (tests/scenario/README.md). parse_scenario restores the scenario bit by bit,
/// noise seeds included: numbers are in the shortest decimal form that reads back to the same bits. Not in the text:
/// the name, which the file carries, and the sensors' phases of timing.hpp.
///
/// @param remark  prepended as comments, line by line
[[nodiscard]] std::string scenario_text(const Scenario& scenario, const std::string& remark = "");

}  // namespace jink::sim
