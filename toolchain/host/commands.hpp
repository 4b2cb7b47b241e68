// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

// One function per subcommand of `jink`, each in a file of its own. The function adds the subcommand with a callback
// that does the work. For an exit status other than 0 the callback throws CLI::RuntimeError(status).

namespace jink::host {

/// Exit statuses of every subcommand.
inline constexpr int kExitGood = 0;
inline constexpr int kExitStop = 1;      ///< negative answer: the plan is "stop"
inline constexpr int kExitBadInput = 2;  ///< invalid file or command line

void add_campaign(CLI::App& jink);
void add_check(CLI::App& jink);
void add_log(CLI::App& jink);
void add_mesh(CLI::App& jink);
void add_parameters(CLI::App& jink);
void add_plan(CLI::App& jink);
void add_reach(CLI::App& jink);
void add_report(CLI::App& jink);
void add_scenes(CLI::App& jink);
void add_tables(CLI::App& jink);
void add_tune(CLI::App& jink);
void add_waypoints(CLI::App& jink);

}  // namespace jink::host
