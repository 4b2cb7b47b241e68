// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/phases_command.hpp"

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <map>
#include <ostream>

#include <CLI/CLI.hpp>

#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/phases.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {

CLI::App& add_phases(CLI::App& cli, PhasesOptions& options)
{
    CLI::App* command = cli.add_subcommand(
        "phases", "fly scenario files in process, each of them in many phases of ticks, line and sensors");
    command->add_option("files", options.files, "scenario files")->required()->check(CLI::ExistingFile);
    command->add_flag("--sensors,!--sensors-fixed", options.spread.sensors, "vary their phases, or not");
    command->add_option("--held-up", options.spread.held_up_share, "share of ticks held up by 20 ms and more")
        ->check(finite(0.0, 1.0));
    command->add_option("--held-up-most", options.spread.held_up_most, "and by at most this [us]")
        ->check(whole(20'000, 1'000'000));
    command->add_option("--count", options.count, "phases")->check(whole(0, 1000000));
    command->add_option("--seed", options.seed, "of the first one")->check(any_seed());
    return *command;
}

int run_phases(const PhasesOptions& options, std::ostream& out)
{
    unsigned unexpected = 0;
    std::vector<Scenario> scenarios;
    for (const std::string& file : options.files) {
        scenarios.push_back(load_scenario(file));
    }
    for (const Scenario& scenario : scenarios) {
        const std::vector<Record> flights = fly_phases(scenario, options.seed, options.count, options.spread);
        std::map<std::string, unsigned> ends;
        std::vector<double> least;
        for (std::size_t i = 0; i < flights.size(); ++i) {
            const Record& flight = flights[i];
            std::string end(to_string(flight.outcome));
            end.append(flight.given_back ? ", given back" : "").append(", ").append(to_string(flight.final_mode));
            ++ends[end];
            least.push_back(flight.closest.surface);
            const std::vector<std::string> missing = unmet(scenario, flight);
            unexpected += missing.empty() ? 0U : 1U;
            for (const std::string& what : missing) {
                out << scenario.name << ", seed " << options.seed + i << ": " << what << "\n";
            }
        }
        std::sort(least.begin(), least.end());
        out << std::left << std::setw(24) << scenario.name << std::right << std::fixed << std::setprecision(2);
        if (!least.empty()) {
            out << " least " << std::setw(6) << least.front() << " median " << std::setw(6) << least[least.size() / 2]
                << " most " << std::setw(6) << least.back() << " m:";
        }
        for (const auto& [end, n] : ends) {
            out << "  " << n << " x " << end << ";";
        }
        out << std::endl;
    }
    out << unexpected << " not as expected\n";
    return unexpected == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace jink::sim
