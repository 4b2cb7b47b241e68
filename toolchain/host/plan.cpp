// SPDX-License-Identifier: BSD-3-Clause
// jink plan: one planning problem, every candidate and the choice.
#include <cstdio>
#include <limits>
#include <memory>
#include <string>

#include "core/avoid/settings.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/plan_output.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

struct PlanOptions {
    std::string file;
    std::string format = "table";
    std::string mode;
    bool source = false;
    bool points = false;
    std::uint32_t budget = avoid::WorkPerUpdate{}.all;
};

/// Replaces the file's settings by Pinheiro's; counts, weights and smoothness methods stay.
void use_source(geometric::Settings& settings)
{
    const geometric::Settings source = geometric::source_settings();
    settings.security = source.security;
    settings.offset_rule = source.offset_rule;
    settings.main_swept_to_collision_point = source.main_swept_to_collision_point;
    settings.check_acceleration = source.check_acceleration;
    settings.verify_flight = source.verify_flight;
    settings.closeness = source.closeness;
    settings.escape_from_margin = source.escape_from_margin;
    settings.retries = source.retries;
}

void run_plan(const PlanOptions& options)
{
    std::variant<ProblemFile, files::Complaints> read = read_problem(options.file);
    if (const auto* complaints = std::get_if<files::Complaints>(&read)) {
        for (const files::Complaint& complaint : *complaints) {
            std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
        }
        throw CLI::RuntimeError(kExitBadInput);
    }
    ProblemFile& problem = std::get<ProblemFile>(read);
    if (options.source) {
        use_source(problem.settings);
    }
    if (!options.mode.empty()) {
        problem.settings.security =
            options.mode == "swept" ? geometric::SecurityMode::swept : geometric::SecurityMode::time_aware;
    }
    const std::unique_ptr<PlanOutcome> outcome = solve_problem(problem, options.budget);
    if (options.format == "json") {
        std::printf("%s\n", plan_json(problem, *outcome, options.points)
                                .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                                .c_str());
    } else {
        std::fputs((options.format == "csv" ? plan_csv(problem, *outcome) : plan_table(problem, *outcome)).c_str(),
                   stdout);
    }
    if (outcome->status == world::PlanStatus::bad_input) {
        std::fprintf(stderr, "jink plan: %s: the planner refuses the problem\n", options.file.c_str());
        throw CLI::RuntimeError(kExitBadInput);
    }
    if (outcome->status != world::PlanStatus::found) {
        throw CLI::RuntimeError(kExitStop);
    }
}

}  // namespace

void add_plan(CLI::App& jink)
{
    auto options = std::make_shared<PlanOptions>();
    CLI::App* command = jink.add_subcommand(
        "plan", "solve one planning problem and show every candidate; exit status 0: found, 1: stop, 2: bad input");
    command->add_option("file", options->file, "planning problem (YAML)")->required();
    command->add_option("--format", options->format, "table, csv or json")
        ->check(CLI::IsMember({"table", "csv", "json"}))
        ->capture_default_str();
    command->add_flag("--source", options->source,
                      "plan as the source does: swept threats, its offsets, no check of feasibility");
    command->add_option("--mode", options->mode, "security, whatever the file says")
        ->check(CLI::IsMember({"time-aware", "swept"}));
    command->add_flag("--points", options->points, "with the curve of every candidate (json)");
    command->add_option("--budget", options->budget, "units of work that the plan may take")
        ->capture_default_str()
        ->check(sim::whole(1, std::numeric_limits<std::uint32_t>::max()));
    command->callback([options] { run_plan(*options); });
}

}  // namespace jink::host
