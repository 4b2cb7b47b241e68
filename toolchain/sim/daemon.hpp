// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// The co-processor at the far end of the line.
struct Computer {
    std::filesystem::path program;  ///< jinkd, or the image for `machine`
    std::string machine;            ///< qemu-system-arm's name of the board; empty: the program runs on this machine

    [[nodiscard]] bool emulated() const noexcept { return !machine.empty(); }
};

/// Why jinkd and images cannot fly the scenario; empty where they can.
[[nodiscard]] std::string no_input_for(const Scenario& scenario);

/// Flies a scenario against the real program. jinkd, in real time: starts `jinkd --serial PTY` on a pseudo-terminal,
/// plays the autopilot at the master end, stops jinkd with SIGTERM and requires a clean exit. Takes as long as the
/// flight; one thread, mostly asleep; both run with real-time priority where permitted. An image: on an emulated board,
/// paced by the board's clock (board_flight.hpp).
///
/// A flight is discarded and repeated, at most three times, in two cases: the host stalled for 0.1 s, or the flight
/// ended unexpectedly and the host delayed a step by more than 15 ms. Host delays are measured at the simulator's own
/// steps and by the program's waiting time for a processor. A program's own lateness is not excused.
///
/// If the program does not start, dies, or does not stop cleanly, the outcome is `failed` and Record::faults says why.
///
/// @param folder  for the output (NAME.log) and jinkd's summary (NAME.json); must exist
[[nodiscard]] Record fly_daemon(const Scenario& scenario, const Computer& computer,
                                const std::filesystem::path& folder);

/// Several flights, `at_once` in parallel, the longest first. Records are in the order of the scenarios.
/// @throws std::runtime_error before any flight when no_input_for() a scenario is not empty
[[nodiscard]] std::vector<Record> fly_daemons(const std::vector<Scenario>& scenarios, const Computer& computer,
                                              const std::filesystem::path& folder, unsigned at_once);

}  // namespace jink::sim
