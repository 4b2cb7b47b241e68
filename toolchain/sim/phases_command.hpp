// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "toolchain/sim/timing.hpp"

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `phases` of jink-sim.
struct PhasesOptions {
    std::vector<std::string> files;
    unsigned count = 50;
    std::uint64_t seed = 1;
    Spread spread;
};

CLI::App& add_phases(CLI::App& cli, PhasesOptions& options);

/// Flies every scenario with many timings and prints the frequency of each ending and the least separations.
/// @return EXIT_SUCCESS when every flight ended as its file expects
/// @throws std::runtime_error when a file is not a scenario
int run_phases(const PhasesOptions& options, std::ostream& out);

}  // namespace jink::sim
