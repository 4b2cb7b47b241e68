// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "toolchain/sim/encounter_campaign.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace jink::sim {

/// The command `encounters` of jink-sim and jink-sim-mpi.
struct EncountersOptions {
    std::uint64_t from = 1;
    std::size_t count = 1000;
    std::size_t block = 100;
    std::string seed_file;
    std::string planner = "product";
    std::string kind = "open";
    bool as_recorded = false;
    Board board;
    std::vector<std::string> parameters;  ///< NAME=VALUE
    std::string out;
    std::string summary;   ///< folder to summarise; nothing is flown
    unsigned threads = 0;  ///< 0: number of cores
    bool quiet = false;
};

/// Adds a command's options of the board, --clock and --reduced-sets.
std::vector<CLI::Option*> add_board(CLI::App& command, Board& board);

/// Adds the command's options. @param with_threads  false where processes share the work
CLI::App& add_encounters(CLI::App& cli, EncountersOptions& options, bool with_threads);

/// @throws std::runtime_error when options contradict each other or the seed file is invalid
[[nodiscard]] EncounterSetup setup_of(const EncountersOptions& options);

/// Reads the folder, writes and prints its summary. @return exit status: 1 when an avoidable broken promise or a broken
/// rule occurred, else 0. @throws BadFolder
int conclude_encounters(const BlockFolder& folder, bool quiet);

/// The whole command in one process; exit status as above. @throws BadFolder, std::runtime_error
int run_encounters(const EncountersOptions& options);

}  // namespace jink::sim
