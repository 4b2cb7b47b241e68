// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "toolchain/sim/manned.hpp"

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `manned` of jink-sim.
struct MannedOptions {
    std::vector<std::string> models;
    std::string sensor = "adsb";
    std::uint64_t from = 1;
    std::size_t count = 300;
    Board board;
    std::vector<std::string> parameters;  ///< NAME=VALUE
    unsigned threads = 0;                 ///< 0: number of cores
    bool list = false;                    ///< the seeds of near mid-air collisions too
};

CLI::App& add_manned(CLI::App& cli, MannedOptions& options);

/// Flies the encounters of each model and prints a line of ratios for each. The result does not depend on the number of
/// threads. @return EXIT_SUCCESS when no rule was broken. @throws std::runtime_error as EncounterModel::load
int run_manned(const MannedOptions& options, std::ostream& out);

}  // namespace jink::sim
