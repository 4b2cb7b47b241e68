// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounters_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>

#include <CLI/CLI.hpp>

#include "firmware/app/work_rate.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::sim {

std::vector<CLI::Option*> add_board(CLI::App& command, Board& board)
{
    return {command
                .add_option("--clock", board.clock,
                            "work of a step for a processor with this clock, plans going on over several steps [MHz]")
                ->check(whole(app::WorkRate::kMinMegahertz, app::WorkRate::kMaxMegahertz)),
            command.add_flag("--reduced-sets", board.reduced_sets,
                             "reach sets of fewer nodes, those of images with little memory (STM32F405)")};
}

CLI::App& add_encounters(CLI::App& cli, EncountersOptions& options, bool with_threads)
{
    CLI::App* command = cli.add_subcommand(
        "encounters", "many random encounters of one to eight intruders, flown block by block into a folder; "
                      "exit status 1 when a promise was broken that could have been kept, or a rule");
    constexpr std::uint64_t kMaxSeed = 1'000'000'000'000'000U;
    CLI::Option* const from =
        command->add_option("--from", options.from, "the first seed, default 1")->check(whole(0, kMaxSeed));
    CLI::Option* const count =
        command->add_option("--count", options.count, "how many, default 1000")->check(whole(1, 100'000'000));
    CLI::Option* const seeds = command->add_option("--seed-file", options.seed_file, "or these seeds, one to a line")
                                   ->check(CLI::ExistingFile)
                                   ->excludes(from)
                                   ->excludes(count);
    CLI::Option* const block =
        command->add_option("--block", options.block, "encounters to a block, default 100")->check(whole(1, 1'000'000));
    CLI::Option* const planner =
        command->add_option("--planner", options.planner, "the product's, or with the settings of its source")
            ->check(CLI::IsMember({"product", "source"}));
    std::vector<std::string> kinds;
    for (const EncounterKind one : kEncounterKinds) {
        kinds.emplace_back(to_string(one));
    }
    CLI::Option* const kind =
        command->add_option("--kind", options.kind, "straight encounters, or harder ones")->check(CLI::IsMember(kinds));
    CLI::Option* const vehicle = command->add_flag("--as-recorded", options.as_recorded,
                                                   "vehicles answer set-points as their autopilots in the recordings");
    CLI::Option* const set = command->add_option("--set", options.parameters,
                                                 "NAME=VALUE: a parameter of the co-processor, any number of them");
    const std::vector<CLI::Option*> board = add_board(*command, options.board);
    CLI::Option* const out =
        command->add_option("--out", options.out, "folder of the blocks; what is finished there stays as it is");
    CLI::Option* const summary =
        command->add_option("--summary", options.summary, "flies nothing: summarises the blocks of this folder anew")
            ->check(CLI::ExistingDirectory);
    for (CLI::Option* const other : {from, count, seeds, block, planner, kind, vehicle, set, out, board[0], board[1]}) {
        summary->excludes(other);
    }
    if (with_threads) {
        command->add_option("--threads", options.threads, "default: one to a core")
            ->check(whole(1, 1024))
            ->excludes(summary);
    }
    command->add_flag("--quiet", options.quiet, "the summary is written, but not printed");
    return *command;
}

EncounterSetup setup_of(const EncountersOptions& options)
{
    if (options.out.empty()) {
        throw std::runtime_error("encounters: --out FOLDER or --summary FOLDER is needed");
    }
    EncounterSetup setup =
        options.seed_file.empty() ? consecutive_setup(options.from, options.count) : listed_setup(options.seed_file);
    setup.block = options.block;
    setup.variant.kind = *std::find_if(kEncounterKinds.begin(), kEncounterKinds.end(),
                                       [&](EncounterKind one) { return to_string(one) == options.kind; });
    setup.variant.as_recorded = options.as_recorded;
    setup.variant.board = options.board;
    setup.variant.planner = options.planner == "source" ? PlannerKind::source : PlannerKind::product;
    setup.variant.parameters = parse_parameters(options.parameters);
    const std::string refusal = refusal_of(setup.variant);
    if (!refusal.empty()) {
        throw std::runtime_error("encounters: --set: " + refusal);
    }
    return setup;
}

int conclude_encounters(const BlockFolder& folder, bool quiet)
{
    const FolderSetup setup = read_setup(folder);
    const std::vector<EncounterResult> results = read_results(folder, setup);
    const std::string summary = summarise(folder, setup, results);
    if (!setup.same_sources) {
        std::cerr << "jink-sim: " << folder.path().string() << " was flown by another build: worst/ is left as it is\n";
    }
    if (!quiet) {
        std::cout << summary;
    }
    const std::size_t avoidable = count_avoidable(results);
    const auto rules = std::count_if(results.begin(), results.end(),
                                     [](const EncounterResult& r) { return r.outcome == Outcome::failed; });
    std::cout << results.size() << " encounters in " << folder.path().string() << ": " << avoidable
              << " broken promises that could have been kept, " << rules << " broken rules\n";
    return avoidable == 0 && rules == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int run_encounters(const EncountersOptions& options)
{
    if (!options.summary.empty()) {
        return conclude_encounters(BlockFolder(options.summary), options.quiet);
    }
    const EncounterSetup setup = setup_of(options);
    BlockFolder folder(options.out);
    folder.claim(setup.manifest());
    const auto began = std::chrono::steady_clock::now();
    fly_missing(folder, setup, options.threads, [](std::size_t done, std::size_t all) {
        std::cerr << "block " << done << " of " << all << " that were missing\n";
    });
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    std::cerr << "Flown in " << took.count() << " s\n";
    return conclude_encounters(folder, options.quiet);
}

}  // namespace jink::sim
