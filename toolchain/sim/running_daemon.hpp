// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "toolchain/sim/child.hpp"
#include "toolchain/sim/plant.hpp"

// Common parts of jinkd's real-time flights, single and several.

namespace jink::sim {

/// SCHED_FIFO priorities of the simulator's threads and of the program. The program has the higher priority, as on its
/// own computer.
inline constexpr int kOwnPriority = 10;
inline constexpr int kDaemonPriority = 20;

/// Sets real-time priority for this thread, so that other load does not delay it; false where not permitted.
bool go_first();

/// Waits for the program's first bytes: it runs and has opened the line. False when the program ends, or is silent for
/// a minute.
[[nodiscard]] bool wait_for_life(Child& child, PseudoTerminal& line, Plant& plant);

/// Sends SIGTERM. The program must announce its end on the line and exit with status 0 within half a minute; deviations
/// are added to `faults`.
void stop_daemon(Child& child, PseudoTerminal& line, Plant& plant, std::vector<std::string>& faults);

}  // namespace jink::sim
