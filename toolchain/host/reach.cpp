// SPDX-License-Identifier: BSD-3-Clause
// jink reach: a vehicle's reach sets, as tables for flash, measured and drawn.
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/reach_sets_text.hpp"
#include "toolchain/host/reach_study.hpp"
#include "toolchain/host/script.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

namespace fs = std::filesystem;
namespace rb = reach::build;

struct ReachOptions {
    std::string file;
    std::string profile = "full";
    rb::Recipe recipe;
    std::string out;
    bool source = false;
    std::string figures;
    std::string python = "/usr/bin/python3";
};

constexpr const char* kBuildReach = "reach build";
constexpr const char* kMeasureReach = "reach measure";

rb::BuiltVehicle build_from(const char* command, const ReachOptions& options)
{
    const files::Vehicle vehicle = read_named_vehicle(command, options.file);
    rb::Recipe recipe = options.recipe;
    recipe.profile = options.profile == "reduced" ? rb::Profile::reduced : rb::Profile::full;
    try {
        return rb::build_vehicle(vehicle.name, vehicle.limits, recipe);
    } catch (const rb::CannotBuild& error) {
        refuse(command, options.file + ": " + error.what());
    }
}

void build_reach(const ReachOptions& options)
{
    check_outputs(kBuildReach, {options.file}, {options.out});
    const rb::BuiltVehicle built = build_from(kBuildReach, options);
    const char* const of = built.recipe.profile == rb::Profile::reduced ? "planes" : "chaotic";
    std::printf("%s: %zu bytes in %zu sets, profile %s: %s with spread %zu, up to %zu ways out at each side cell\n",
                built.vehicle.c_str(), built.bytes(), built.sets.size(), options.profile.c_str(), of,
                built.density.spread, built.density.most_lateral);
    for (const rb::BuiltSet& set : built.sets) {
        const reach::ReachSet view = set.stored.view();
        std::printf("  %-40s %5zu nodes %6zu bytes  checksum %08X\n", std::string(view.name).c_str(), view.nodes(),
                    rb::bytes_of(view), static_cast<unsigned>(view.checksum));
    }
    if (!options.out.empty()) {
        write_whole(kBuildReach, options.out, reach_sets_header(built));
    }
}

void measure_reach(const ReachOptions& options)
{
    if (options.source != options.file.empty()) {
        refuse(kMeasureReach, "give either a vehicle file, or --source");
    }
    std::error_code error;
    if (!options.figures.empty() && !fs::create_directories(options.figures, error) && error) {
        refuse(kMeasureReach, options.figures + " cannot be made: " + error.message());
    }
    const std::vector<NamedSet> sets = options.source ? sets_of_source() : sets_of(build_from(kMeasureReach, options));
    std::fputs(table_of(sets, measure_all(sets)).c_str(), stdout);
    if (!options.figures.empty()) {
        become_report_script(kMeasureReach, options.python, "reach_sets.py", drawing_of(sets), options.figures);
    }
}

void add_recipe(CLI::App& command, ReachOptions& options)
{
    command.add_option("--profile", options.profile, "full, or reduced for a co-processor with little flash")
        ->capture_default_str()
        ->check(CLI::IsMember({"full", "reduced"}));
    command.add_option("--period", options.recipe.period, "duration of one movement [s]")->capture_default_str();
    command
        .add_option("--speeds", options.recipe.speeds, "lower ends of the speed segments, shares of the cruise speed")
        ->capture_default_str()
        ->delimiter(',');
    command.add_option("--most-speed", options.recipe.most_speed, "upper end of the last speed segment")
        ->capture_default_str();
    command
        .add_option("--most-bytes", options.recipe.most_bytes,
                    "bytes that all tables may take, default 262144 (full) or 98304 (reduced)")
        ->check(sim::whole(1, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace

void add_reach(CLI::App& jink)
{
    CLI::App* command = jink.add_subcommand("reach", "make a vehicle's reach sets, measure and draw them");
    command->require_subcommand(1);
    auto options = std::make_shared<ReachOptions>();
    CLI::App* build_command = command->add_subcommand("build", "make the sets of all segments of a vehicle's states");
    build_command->add_option("vehicle", options->file, "vehicle file (YAML)")->required();
    build_command->add_option("--out", options->out, "write the tables to this C++ header");
    add_recipe(*build_command, *options);
    build_command->callback([options] { build_reach(*options); });
    CLI::App* measure_command =
        command->add_subcommand("measure", "what the sets cover, how smooth they are and how large");
    measure_command->add_option("vehicle", options->file, "vehicle file (YAML)");
    measure_command->add_flag("--source", options->source, "the generators on the source's unit vehicle instead");
    measure_command->add_option("--figures", options->figures, "draw each set into this folder");
    measure_command->add_option("--python", options->python, "a Python 3 with matplotlib")->capture_default_str();
    add_recipe(*measure_command, *options);
    measure_command->callback([options] { measure_reach(*options); });
}

}  // namespace jink::host
