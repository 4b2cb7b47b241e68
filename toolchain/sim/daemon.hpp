// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// What flies at the far end of the line.
struct Computer {
    std::filesystem::path program;  ///< jinkd; or the image for `machine`
    std::string machine;            ///< qemu-system-arm's name of the board; empty: the program runs on this machine

    [[nodiscard]] bool emulated() const noexcept { return !machine.empty(); }
};

/// Why neither jinkd nor an image can fly the scenario; empty where both can.
[[nodiscard]] std::string no_input_for(const Scenario& scenario);

/// Flies a scenario against the real program. jinkd, in real time: starts `jinkd --serial PTY` on a pseudo-terminal,
/// plays the autopilot at its master end, stops jinkd with SIGTERM and wants a clean exit; takes as long as the flight;
/// one thread, mostly asleep; both run with real-time priority where that is permitted. An image: in a board under
/// emulation, by the board's clock (board_flight.hpp).
///
/// A flight during which the machine stood still for 0.1 s is thrown away and flown again, at most three times; so is
/// one that did not end as expected while the machine held a step up by more than 15 ms. What the machine did is
/// measured at the simulator's own steps and by how long the system had the program wait for a processor: a program
/// that is late by itself is not excused by it.
///
/// @param folder  for what it prints (NAME.log) and jinkd's summary (NAME.json); must exist
/// A program that does not start, dies, or does not stop cleanly makes the outcome `failed` and is named in
/// Record::faults.
[[nodiscard]] Record fly_daemon(const Scenario& scenario, const Computer& computer,
                                const std::filesystem::path& folder);

/// Several at once, `at_once` of them, in the order of the scenarios.
/// @throws std::runtime_error before any flight where no_input_for() one of them has a reason
[[nodiscard]] std::vector<Record> fly_daemons(const std::vector<Scenario>& scenarios, const Computer& computer,
                                              const std::filesystem::path& folder, unsigned at_once);

}  // namespace jink::sim
