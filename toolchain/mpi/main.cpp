// SPDX-License-Identifier: BSD-3-Clause
// jink-sim-mpi: the campaigns of jink-sim and jink, shared by the processes of an MPI run. Blocks go to the next free
// process; the results are byte-identical to those of a single process.
#include <chrono>
#include <cstdlib>
#include <iostream>

#include <CLI/CLI.hpp>

#include "toolchain/host/campaign.hpp"
#include "toolchain/host/campaign_command.hpp"
#include "toolchain/mpi/crew.hpp"
#include "toolchain/sim/encounters_command.hpp"

namespace {

using jink::mpi::Crew;
namespace host = jink::host;
namespace sim = jink::sim;

constexpr int kRefused = 2;

/// Work that the leader does before the other processes begin. An error ends the run of all processes and is reported
/// once.
template <class Work>
bool lead(const Crew& crew, Work&& work)
{
    std::string refusal;
    if (crew.leads()) {
        try {
            work();
        } catch (const std::exception& e) {
            refusal = e.what();
            std::cerr << "jink-sim-mpi: " << refusal << "\n";
        }
    }
    crew.share(refusal);
    return refusal.empty();
}

int encounters(Crew& crew, const sim::EncountersOptions& options)
{
    int status = EXIT_SUCCESS;
    if (!options.summary.empty()) {
        const bool good =
            lead(crew, [&] { status = sim::conclude_encounters(sim::BlockFolder(options.summary), options.quiet); });
        return good ? status : kRefused;
    }
    sim::EncounterSetup setup;
    sim::BlockFolder folder(options.out);
    std::vector<std::uint64_t> missing;
    if (!lead(crew, [&] {
            setup = sim::setup_of(options);
            folder.claim(setup.manifest());
            const std::vector<std::size_t> blocks = folder.missing(setup.blocks());
            missing.assign(blocks.begin(), blocks.end());
        })) {
        return kRefused;
    }
    setup = sim::setup_of(options);
    crew.share(missing);
    crew.begin_count();
    const auto next = [&]() -> std::optional<std::size_t> {
        const std::uint64_t at = crew.next();
        return at < missing.size() ? std::optional<std::size_t>(missing[at]) : std::nullopt;
    };
    sim::fly_blocks(folder, setup, next, [&] { crew.attend(); });
    crew.meet();
    return lead(crew, [&] { status = sim::conclude_encounters(folder, options.quiet); }) ? status : kRefused;
}

int campaign(Crew& crew, const host::CampaignOptions& options)
{
    const auto began = std::chrono::steady_clock::now();
    crew.begin_count();
    std::vector<std::string> pieces;
    for (std::uint64_t i = crew.next(); i < host::kStudyBlocks; i = crew.next()) {
        pieces.push_back(host::packed(i, host::fly_study_block(i, !options.csv.empty())));
        crew.attend();
    }
    std::vector<host::StudyBlock> blocks(crew.leads() ? host::kStudyBlocks : 0);
    for (const std::string& piece : crew.gather(pieces)) {
        host::unpack(piece, blocks);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    return crew.leads() ? host::conclude_campaign(options, blocks, took.count()) : EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
    Crew crew(argc, argv);
    CLI::App cli{
        "jink-sim-mpi: campaigns shared by the processes of an MPI run (mpirun -n PROCESSES jink-sim-mpi ...), "
        "with the results of one process alone."};
    cli.require_subcommand(1);
    sim::EncountersOptions encounters_options;
    host::CampaignOptions campaign_options;
    const CLI::App& encounters_command = sim::add_encounters(cli, encounters_options, false);
    host::add_campaign_options(cli, campaign_options);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        const bool asked = e.get_exit_code() == 0;
        if (crew.leads()) {
            cli.exit(e);
        }
        return asked ? EXIT_SUCCESS : kRefused;
    }
    try {
        return encounters_command.parsed() ? encounters(crew, encounters_options) : campaign(crew, campaign_options);
    } catch (const std::exception& e) {
        std::cerr << "jink-sim-mpi: " << e.what() << "\n";
        crew.abandon(kRefused);
    }
}
