// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "toolchain/sim/child.hpp"
#include "toolchain/sim/plant.hpp"

// What flights of jinkd in real time have in common, one or many.

namespace jink::sim {

/// SCHED_FIFO priorities of the simulator's threads and, above them, of the program: its turn comes first, as on its
/// own machine.
inline constexpr int kOwnPriority = 10;
inline constexpr int kDaemonPriority = 20;

/// Real-time priority for this thread, so that other work on the machine does not delay it; false where that is not
/// permitted.
bool go_first();

/// Until its first bytes: it runs and has opened the line. False when it ends, or says nothing for a minute.
[[nodiscard]] bool wait_for_life(Child& child, PseudoTerminal& line, Plant& plant);

/// SIGTERM; it has to end with exit status 0 within half a minute, and to say so on the line before. What it does
/// otherwise is added to `faults`.
void stop_daemon(Child& child, PseudoTerminal& line, Plant& plant, std::vector<std::string>& faults);

}  // namespace jink::sim
