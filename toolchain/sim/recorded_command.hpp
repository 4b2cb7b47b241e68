// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `recorded` of jink-sim.
struct RecordedOptions {
    std::vector<std::string> files;
};

CLI::App& add_recorded(CLI::App& cli, RecordedOptions& options);

/// Reads each file. For each other aircraft, prints the pairing of its fixes with the own ship's and the closest
/// approach. @throws std::runtime_error, with file and line (recorded_encounter.hpp)
void run_recorded(const RecordedOptions& options, std::ostream& out);

}  // namespace jink::sim
