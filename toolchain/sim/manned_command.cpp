// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/manned_command.hpp"

#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <ostream>

#include <CLI/CLI.hpp>

#include "toolchain/sim/encounter_campaign.hpp"
#include "toolchain/sim/encounters_command.hpp"
#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/parallel.hpp"

namespace jink::sim {
namespace {

std::vector<MannedResult> fly_all(const EncounterModel& model, const MannedOptions& options,
                                  const std::map<std::string, double>& parameters)
{
    const MannedSensor sensor = options.sensor == "adsb" ? MannedSensor::adsb : MannedSensor::range;
    std::vector<MannedResult> results(options.count);
    in_parallel(results.size(), options.threads, [&](std::size_t i) {
        results[i] = fly_manned(model, sensor, options.from + i, parameters, options.board);
    });
    return results;
}

void print(std::ostream& out, const Ratio& ratio)
{
    out << std::fixed << std::setprecision(3) << ratio.value << " (" << ratio.low << " to " << ratio.high << ")";
}

}  // namespace

CLI::App& add_manned(CLI::App& cli, MannedOptions& options)
{
    CLI::App* command = cli.add_subcommand(
        "manned", "encounters with tracks sampled from models of manned aircraft, in process: ratios of near mid-air "
                  "collisions and of losses of well clear, with and without the co-processor");
    command->add_option("models", options.models, "parameter files of encounter models")
        ->required()
        ->check(CLI::ExistingFile);
    command->add_option("--sensor", options.sensor, "a transponder, or a sensor with a range of 2 km")
        ->check(CLI::IsMember({"adsb", "range"}));
    constexpr std::uint64_t kMaxSeed = 1'000'000'000'000'000U;
    command->add_option("--from", options.from, "the first seed")->check(whole(0, kMaxSeed));
    command->add_option("--count", options.count, "encounters of each model")->check(whole(1, 10'000'000));
    command->add_option("--set", options.parameters, "NAME=VALUE: a parameter of the co-processor, any number of them");
    static_cast<void>(add_board(*command, options.board));
    command->add_option("--threads", options.threads, "default: one to a core")->check(whole(1, 1024));
    command->add_flag("--list", options.list, "the seeds of all near mid-air collisions too");
    return *command;
}

int run_manned(const MannedOptions& options, std::ostream& out)
{
    Variant variant;
    variant.parameters = parse_parameters(options.parameters);
    if (const std::string refusal = refusal_of(variant); !refusal.empty()) {
        throw std::runtime_error("manned: --set: " + refusal);
    }
    std::size_t broken = 0;
    for (const std::string& file : options.models) {
        const std::vector<MannedResult> results = fly_all(EncounterModel::load(file), options, variant.parameters);
        const MannedSummary sum = summary_of(results);
        out << std::filesystem::path(file).stem().string() << ", " << options.sensor << ": " << sum.flown
            << " encounters; near mid-air ratio ";
        print(out, sum.near_mid_air);
        out << ", well clear ratio ";
        print(out, sum.well_clear);
        out << ", unavoidable ";
        print(out, sum.unavoidable);
        out << "; counts: near mid-air " << sum.near_alone << " alone, " << sum.near << " with, "
            << sum.unavoidable_count << " unavoidable; well clear lost " << sum.lost_alone << " alone, " << sum.lost
            << " with; took over " << sum.took_over << "; broken rules " << sum.broken_rules << std::endl;
        for (const MannedResult& r : results) {
            if (options.list && r.near) {
                out << "  seed " << r.seed << (r.unavoidable ? ", unavoidable" : "")
                    << (r.near_alone ? "" : ", not near without") << "\n";
            }
        }
        broken += sum.broken_rules;
    }
    return broken == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace jink::sim
