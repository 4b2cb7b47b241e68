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
    unsigned threads = 0;  ///< 0: as many as the machine has cores
    std::string stack = "ardupilot";
    std::vector<std::string> parameters;  ///< NAME=VALUE
    std::string out;
    bool daemon = false;
    std::string program;  ///< jinkd; empty: beside this program
};

CLI::App& add_swarm(CLI::App& cli, SwarmOptions& options);

/// One line of text, without its end.
[[nodiscard]] std::string to_line(const SwarmResult& result);
/// Of all results, in their order, each worst with its seed.
[[nodiscard]] std::string summarise(const std::vector<SwarmResult>& results);

/// Flies, prints, and says how it ended: 0; 1 when bodies touched, a goal was missed or a rule of the protocol broken.
/// @throws std::runtime_error when options are of no use
int run_swarm(const SwarmOptions& options);

}  // namespace jink::sim
