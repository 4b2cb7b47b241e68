// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `replay` of jink-sim.
struct ReplayOptions {
    std::string file;
    std::string vehicle;  ///< vehicle file; empty: the default one
    std::string params;   ///< parameter file; empty: none
    bool json = false;
};

CLI::App& add_replay(CLI::App& cli, ReplayOptions& options);

/// Prints a line for every second of the recording; text output includes the recorded jinkd's messages to the pilot.
/// @return 0; 1, with the reason on `errors`, when the file is damaged (records before the damage are replayed) or a
/// vehicle or parameter file is wrong
/// @throws std::runtime_error when the file cannot be read
int run_replay(const ReplayOptions& options, std::ostream& out, std::ostream& errors);

}  // namespace jink::sim
