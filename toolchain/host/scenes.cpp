// SPDX-License-Identifier: BSD-3-Clause
// jink scenes: scenario files flown straight, by each avoidance method and by all, as a table and as plan-view
// pictures.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/scenes_study.hpp"
#include "toolchain/host/script.hpp"
#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScenes = "scenes";

struct ScenesOptions {
    std::vector<std::string> files;
    unsigned seeds = 0;
    std::string out;
    std::string python = "/usr/bin/python3";
};

sim::Scenario load(const std::string& file, std::optional<std::uint64_t> seed)
{
    try {
        return sim::load_scenario(file, seed);
    } catch (const sim::BadScenario& error) {
        refuse(kScenes, error.what());
    }
}

void run_scenes(const ScenesOptions& options)
{
    std::error_code error;
    if (!options.out.empty() && !fs::create_directories(options.out, error) && error) {
        refuse(kScenes, options.out + " cannot be made: " + error.message());
    }
    const std::vector<FlownBy> ways = ways_to_fly();
    std::vector<Scene> drawn;
    for (const std::string& file : options.files) {
        std::vector<Scene> scenes;
        if (options.seeds == 0) {
            scenes.push_back(fly_scene(load(file, std::nullopt), ways));
            std::fputs(table_of(scenes.front()).c_str(), stdout);
        }
        for (unsigned seed = 1; seed <= options.seeds; ++seed) {
            scenes.push_back(fly_scene(load(file, seed), ways));
        }
        std::fputs(options.seeds > 0 ? summary_of(scenes).c_str() : "", stdout);
        std::fflush(stdout);
        drawn.push_back(std::move(scenes.front()));
    }
    if (!options.out.empty()) {
        become_report_script(kScenes, options.python, "reach_flights.py", drawing_of(drawn), options.out);
    }
}

}  // namespace

void add_scenes(CLI::App& jink)
{
    auto options = std::make_shared<ScenesOptions>();
    CLI::App* command =
        jink.add_subcommand("scenes", "fly scenario files straight, with each avoidance method and with all of them");
    command->add_option("files", options->files, "scenario files (tests/scenario/README.md)")
        ->required()
        ->check(CLI::ExistingFile);
    command
        ->add_option("--seeds", options->seeds, "instead of the files' own seeds 1 to so many, and a summary of them")
        ->check(sim::whole(0, 100000));
    command->add_option("--out", options->out, "draw each file's scene into this folder");
    command->add_option("--python", options->python, "a Python 3 with matplotlib")->capture_default_str();
    command->callback([options] { run_scenes(*options); });
}

}  // namespace jink::host
