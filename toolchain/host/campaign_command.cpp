// SPDX-License-Identifier: BSD-3-Clause
// jink campaign: Pinheiro's distribution study, published figures beside ours.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "firmware/linux/param_store.hpp"
#include "toolchain/host/campaign_command.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"

namespace jink::host {
namespace {

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

void run_campaign(const CampaignOptions& options)
{
    // Fails before the flights instead of after them.
    check_outputs("campaign", {}, {options.csv});
    const bool watched = isatty(STDERR_FILENO) != 0;
    const auto began = std::chrono::steady_clock::now();
    std::size_t reported = 0;
    const auto progress = [&](std::size_t done, std::size_t all) {
        // On a terminal one line that is rewritten, elsewhere one line per tenth.
        if (watched) {
            std::fprintf(stderr, "\r%zu of %zu environments", done, all);
            std::fputs(done == all ? "\n" : "", stderr);
        } else if (done * 10 / all != reported) {
            reported = done * 10 / all;
            std::fprintf(stderr, "%zu of %zu environments\n", done, all);
        }
    };
    const std::vector<StudyBlock> blocks = fly_study(progress, !options.csv.empty());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    const int status = conclude_campaign(options, blocks, took.count());
    if (status != kExitGood) {
        throw CLI::RuntimeError(status);
    }
}

}  // namespace

CLI::App& add_campaign_options(CLI::App& cli, CampaignOptions& options)
{
    CLI::App* command =
        cli.add_subcommand("campaign", "the distribution study of the planner's source: 16 200 environments; "
                                       "exit status 1 when a figure that must agree does not");
    command->add_option("--csv", options.csv, "write a row per candidate to this file");
    command->add_flag("--json", options.json, "print JSON instead of a table");
    return *command;
}

int conclude_campaign(const CampaignOptions& options, const std::vector<StudyBlock>& blocks, double seconds)
{
    const CampaignResult result = merge_study(blocks);
    (options.json ? print_json : print_table)(result, seconds);
    if (!options.csv.empty()) {
        std::ostringstream csv;
        write_rows(csv, blocks);
        if (const std::string wrong = files::replace_file(options.csv, csv.view()); !wrong.empty()) {
            std::fprintf(stderr, "campaign: %s: %s\n", options.csv.c_str(), wrong.c_str());
            return kExitBadInput;
        }
    }
    for (const CampaignFigure& f : result.figures) {
        if (f.expected_to_agree && std::abs(f.deviation()) > kCampaignTolerance) {
            return kExitStop;
        }
    }
    return kExitGood;
}

void add_campaign(CLI::App& jink)
{
    auto options = std::make_shared<CampaignOptions>();
    add_campaign_options(jink, *options).callback([options] { run_campaign(*options); });
}

}  // namespace jink::host
