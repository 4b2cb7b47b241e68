// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

// One function per subcommand of `jink`, each in a file of its own. It adds the subcommand with a callback that does
// the work; the callback ends the program with another exit status than 0 by `throw CLI::RuntimeError(status)`.

namespace jink::host {

/// Exit statuses of every subcommand.
inline constexpr int kExitGood = 0;
inline constexpr int kExitBadInput = 1;  ///< a file or a command line that is wrong
inline constexpr int kExitStop = 2;      ///< the answer is "no": the plan says stop

void add_campaign(CLI::App& jink);
void add_check(CLI::App& jink);
void add_mesh(CLI::App& jink);
void add_plan(CLI::App& jink);
void add_reach(CLI::App& jink);
void add_report(CLI::App& jink);
void add_scenes(CLI::App& jink);
void add_tables(CLI::App& jink);
void add_tune(CLI::App& jink);
void add_waypoints(CLI::App& jink);

}  // namespace jink::host
