// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "toolchain/sim/swarm.hpp"

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `swarm` of jink-sim.
struct SwarmOptions {
    SwarmSetup setup;
    std::uint64_t seed = 1;
    unsigned count = 1;
    unsigned threads = 0;  ///< 0: number of cores
    std::string stack = "ardupilot";
    std::vector<std::string> parameters;  ///< NAME=VALUE
    std::vector<std::string> others;      ///< NAME=VALUE of every second vehicle
    std::string out;
    bool daemon = false;
    std::string program;  ///< jinkd; empty: beside this program
};

CLI::App& add_swarm(CLI::App& cli, SwarmOptions& options);

/// One line of text, without its end.
[[nodiscard]] std::string to_line(const SwarmResult& result);
/// Summary of all results, each worst value with its seed.
[[nodiscard]] std::string summarise(const std::vector<SwarmResult>& results);

/// Flies and prints. @return exit status: 1 when bodies were in contact, a goal was missed or a rule of the protocol
/// was broken, else 0
/// @throws std::runtime_error when options are invalid
int run_swarm(const SwarmOptions& options);

}  // namespace jink::sim
