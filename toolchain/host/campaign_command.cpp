// SPDX-License-Identifier: BSD-3-Clause
// jink campaign: the distribution study of the planner's source, published beside ours.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "toolchain/host/campaign.hpp"
#include "toolchain/host/commands.hpp"

namespace jink::host {
namespace {

struct Options {
    std::string csv;
    bool json = false;
};

void print_table(const CampaignResult& result, double seconds)
{
    std::printf("%zu environments (%zu skipped: main threat nearer than 2.5 R), %zu candidates, %.1f s\n",
                result.environments, result.environments_skipped, result.candidates, seconds);
    std::printf("%-32s %4s %12s %12s %9s\n", "figure", "", "published", "ours", "deviation");
    for (const CampaignFigure& f : result.figures) {
        std::printf("%-32s %4s %12.4f %12.4f %8.2f%% %s\n", f.name.c_str(), f.unit.c_str(), f.published, f.ours,
                    100.0 * f.deviation(), f.expected_to_agree ? "must agree within 0.5 %" : "");
    }
}

void print_json(const CampaignResult& result, double seconds)
{
    nlohmann::json out{{"environments", result.environments},
                       {"environments_skipped", result.environments_skipped},
                       {"candidates", result.candidates},
                       {"closeness_median", result.closeness_median},
                       {"seconds", seconds}};
    for (const CampaignFigure& f : result.figures) {
        out["figures"].push_back({{"name", f.name},
                                  {"unit", f.unit},
                                  {"published", f.published},
                                  {"ours", f.ours},
                                  {"expected_to_agree", f.expected_to_agree}});
    }
    std::printf("%s\n", out.dump(2).c_str());
}

void run(const Options& options)
{
    std::ofstream csv;
    if (!options.csv.empty()) {
        csv.open(options.csv);
        if (!csv) {
            std::fprintf(stderr, "jink campaign: %s cannot be written\n", options.csv.c_str());
            throw CLI::RuntimeError(kExitBadInput);
        }
    }
    const bool watched = isatty(STDERR_FILENO) != 0;
    const auto began = std::chrono::steady_clock::now();
    std::size_t told = 0;
    const auto progress = [&](std::size_t done, std::size_t all) {
        // On a terminal one line that grows, elsewhere a line at each tenth.
        if (watched) {
            std::fprintf(stderr, "\r%zu of %zu environments", done, all);
            std::fputs(done == all ? "\n" : "", stderr);
        } else if (done * 10 / all != told) {
            told = done * 10 / all;
            std::fprintf(stderr, "%zu of %zu environments\n", done, all);
        }
    };
    const CampaignResult result = run_campaign(progress, options.csv.empty() ? nullptr : &csv);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    (options.json ? print_json : print_table)(result, took.count());
    csv.flush();
    if (!options.csv.empty() && !csv) {
        std::fprintf(stderr, "jink campaign: %s could not be written to its end\n", options.csv.c_str());
        throw CLI::RuntimeError(kExitBadInput);
    }
    for (const CampaignFigure& f : result.figures) {
        if (f.expected_to_agree && std::abs(f.deviation()) > kCampaignTolerance) {
            throw CLI::RuntimeError(kExitStop);
        }
    }
}

}  // namespace

void add_campaign(CLI::App& jink)
{
    auto options = std::make_shared<Options>();
    CLI::App* command =
        jink.add_subcommand("campaign", "the distribution study of the planner's source: 16 200 environments; "
                                        "exit status 2 when a figure that must agree does not");
    command->add_option("--csv", options->csv, "write a row per candidate to this file");
    command->add_flag("--json", options->json, "print JSON instead of a table");
    command->callback([options] { run(*options); });
}

}  // namespace jink::host
