// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_command.hpp"

#include <iomanip>

#include <CLI/CLI.hpp>

#include "toolchain/sim/recorded_encounter.hpp"

namespace jink::sim {

CLI::App& add_recorded(CLI::App& cli, RecordedOptions& options)
{
    CLI::App* command = cli.add_subcommand(
        "recorded",
        "reads recorded encounters as DAIDALUS writes them (*.daa): fixes paired by time, closest approach");
    command->add_option("files", options.files, "files, each with the own ship first")
        ->required()
        ->check(CLI::ExistingFile);
    return *command;
}

void run_recorded(const RecordedOptions& options, std::ostream& out)
{
    out << std::fixed << std::setprecision(1);
    for (const std::string& file : options.files) {
        const RecordedEncounter encounter = read_encounter(std::filesystem::path(file));
        const Aircraft& own = encounter.aircraft.front();
        out << std::filesystem::path(file).filename().string() << ": " << own.name << ", " << own.fixes.size()
            << " fixes from " << own.fixes.front().time << " s to " << own.fixes.back().time << " s; "
            << encounter.reordered << " rows put in order\n";
        for (std::size_t i = 1; i < encounter.aircraft.size(); ++i) {
            const Aircraft& other = encounter.aircraft[i];
            const Paired paired = pair_by_time(own, other);
            out << "  " << other.name << ": " << paired.fixes.size() << " paired (" << paired.interpolated
                << " interpolated), " << paired.unmatched << " unmatched";
            const Paired::Both* closest = nullptr;
            for (const Paired::Both& both : paired.fixes) {
                const auto distance = [](const Paired::Both& b) { return (b.own.position - b.other.position).norm(); };
                closest = closest == nullptr || distance(both) < distance(*closest) ? &both : closest;
            }
            if (closest != nullptr) {
                const Vec off = closest->other.position - closest->own.position;
                out << "; closest at " << closest->own.time << " s: " << off.head<2>().norm() << " m level, " << off.z()
                    << " m up";
            }
            out << "\n";
        }
    }
}

}  // namespace jink::sim
