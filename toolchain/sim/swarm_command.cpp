// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/swarm_command.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "firmware/linux/param_store.hpp"
#include "toolchain/sim/encounter_campaign.hpp"
#include "toolchain/sim/encounters_command.hpp"
#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/parallel.hpp"
#include "toolchain/sim/program_file.hpp"

namespace jink::sim {
namespace {

constexpr double kNone = 1e8;  // [m]

std::string metres(double value)
{
    if (value > kNone) {
        return "-";
    }
    std::ostringstream out;
    out << std::fixed << std::setprecision(3) << value << " m";
    return out.str();
}

SwarmSetup setup_of(const SwarmOptions& options)
{
    SwarmSetup setup = options.setup;
    setup.stack = options.stack == "px4" ? Stack::px4 : Stack::ardupilot;
    setup.both_stacks = options.stack == "both";
    setup.parameters = parse_parameters(options.parameters);
    setup.others = parse_parameters(options.others);
    if (options.daemon && (!setup.others.empty() || setup.slow != 1.0)) {
        throw std::runtime_error("--daemon flies vehicles that are all alike");
    }
    for (const unsigned index : {0U, 1U}) {
        static_cast<void>(swarm_parameters(setup, index));  // refuses invalid parameters before the first flight
    }
    return setup;
}

/// Results are in the order of the seeds.
std::vector<SwarmResult> fly_all(const SwarmSetup& setup, const SwarmOptions& options)
{
    std::vector<SwarmResult> results(options.count);
    in_parallel(results.size(), options.threads,
                [&](std::size_t k) { results[k] = fly_swarm(setup, options.seed + k, options.out); });
    return results;
}

std::filesystem::path program_of(const SwarmOptions& options)
{
    if (!options.program.empty()) {
        return options.program;
    }
    return find_daemon("--program");
}

std::vector<SwarmResult> fly_daemons_one_by_one(const SwarmSetup& setup, const SwarmOptions& options)
{
    const std::filesystem::path folder = options.out.empty() ? std::filesystem::temp_directory_path() / "jink-swarm"
                                                             : std::filesystem::path(options.out);
    std::filesystem::create_directories(folder);
    std::vector<SwarmResult> results;
    for (unsigned k = 0; k < options.count; ++k) {
        results.push_back(fly_swarm_of_daemons(setup, options.seed + k, program_of(options), folder));
    }
    return results;
}

}  // namespace

CLI::App& add_swarm(CLI::App& cli, SwarmOptions& options)
{
    SwarmSetup& s = options.setup;
    CLI::App* command = cli.add_subcommand(
        "swarm", "vehicles on a circle change places, each with a co-processor of its own; exit status 1 when bodies "
                 "touched, a goal was missed or a rule of the protocol was broken");
    command->add_option("--vehicles", s.vehicles, "how many, default 20")->check(whole(2, 64));
    command->add_option("--circle", s.circle, "its radius, default 10 [m]")->check(finite(1.0, 1000.0));
    command->add_option("--tilt", s.tilt, "of its plane, 90: vertical, default 0 [deg]")->check(finite(0.0, 90.0));
    command->add_option("--sector", s.sector, "of the circle over which they start, default 360 [deg]")
        ->check(finite(1.0, 360.0));
    command->add_option("--slow", s.slow, "share of the cruise speed of every second vehicle, default 1")
        ->check(finite(0.1, 1.0));
    command->add_option("--others", options.others, "NAME=VALUE of every second co-processor, any number of them");
    command->add_option("--cruise", s.cruise, "cruise speed, default 1 [m/s]")->check(finite(0.5, 20.0));
    command->add_option("--acceleration", s.acceleration, "of the vehicles, at most, default 2 [m/s2]")
        ->check(finite(0.2, 20.0));
    command->add_flag("--as-recorded", s.as_recorded,
                      "each vehicle answers as its autopilot in the recordings; --acceleration is what jink is told");
    command->add_option("--spread", s.spread, "of the starting places, default 0.1 [m]")->check(finite(0.0, 1.0));
    command->add_flag("--back", s.back, "and back again");
    command->add_option("--obstacles", s.obstacles, "that move, default 0")->check(whole(0, 62));
    command->add_option("--body", s.body, "radius of vehicles and obstacles, default 0.25 [m]")
        ->check(finite(0.05, 5.0));
    command->add_option("--level", s.level, "separation, level, default 0.7 [m]")->check(finite(0.2, 50.0));
    command->add_option("--vertical", s.vertical, "or in height, default 0.5 [m]")->check(finite(0.2, 50.0));
    command->add_option("--rate", s.rate, "of broadcasts, default 10 [Hz]")->check(finite(1.0, 200.0));
    command->add_option("--loss", s.loss, "share of broadcasts lost, default 0")->check(finite(0.0, 1.0));
    command->add_option("--delay", s.delay, "of broadcasts, default 0 [s]")->check(finite(0.0, 1.9));
    command->add_option("--duration", s.duration, "at most, default 180 [s]")->check(finite(1.0, 3600.0));
    static_cast<void>(add_board(*command, s.board));
    command->add_option("--stack", options.stack, "of the autopilots; both: in turns")
        ->check(CLI::IsMember({"ardupilot", "px4", "both"}));
    command->add_option("--parameters", options.parameters, "NAME=VALUE of the co-processors, any number of them");
    command->add_option("--seed", options.seed, "the first, default 1")->check(any_seed());
    command->add_option("--count", options.count, "seeds, default 1")->check(whole(1, 1'000'000));
    command->add_option("--threads", options.threads, "default: one to a core")->check(whole(1, 1024));
    command->add_option("--out", options.out, "folder for results.txt, and SEED.csv of flights that went wrong");
    command->add_flag("--daemon", options.daemon, "in real time, one jinkd to a vehicle, on pseudo-terminals");
    command->add_option("--program", options.program, "the program jinkd")->transform({find_program, "FILE"});
    return *command;
}

std::string to_line(const SwarmResult& r)
{
    std::ostringstream out;
    out << "seed " << r.seed << ": distance " << metres(r.distance) << ", margin " << std::fixed << std::setprecision(3)
        << r.margin << ", obstacle " << metres(r.obstacle) << ", " << r.arrived << " of " << r.vehicles
        << " there after " << std::setprecision(2) << r.time << " s, stall " << r.stall << " s, " << r.collisions
        << " collisions, " << r.takeovers << " take-overs, " << r.jumps << " jumps, digest " << std::hex
        << std::setw(16) << std::setfill('0') << r.digest;
    for (const std::string& fault : r.faults) {
        out << "; " << fault;
    }
    return out.str();
}

std::string summarise(const std::vector<SwarmResult>& results)
{
    const auto worst = [&](const std::function<bool(const SwarmResult&, const SwarmResult&)>& worse) {
        return *std::min_element(results.begin(), results.end(), worse);
    };
    const auto count = [&](const std::function<bool(const SwarmResult&)>& is) {
        return std::count_if(results.begin(), results.end(), is);
    };
    std::vector<double> times;
    unsigned jumps = 0;
    for (const SwarmResult& r : results) {
        times.push_back(r.time);
        jumps += r.jumps;
    }
    std::sort(times.begin(), times.end());
    const SwarmResult distance = worst([](const auto& a, const auto& b) { return a.distance < b.distance; });
    const SwarmResult margin = worst([](const auto& a, const auto& b) { return a.margin < b.margin; });
    const SwarmResult obstacle = worst([](const auto& a, const auto& b) { return a.obstacle < b.obstacle; });
    const SwarmResult stall = worst([](const auto& a, const auto& b) { return a.stall > b.stall; });
    std::ostringstream out;
    out << std::fixed << std::setprecision(3) << results.size()
        << " swarms: " << count([](const auto& r) { return r.collisions > 0; }) << " with collisions, "
        << count([](const auto& r) { return r.arrived < r.vehicles; }) << " with goals missed, "
        << count([](const auto& r) { return r.margin < 1.0; }) << " nearer than the separations, "
        << count([](const auto& r) { return !r.faults.empty(); }) << " with rules broken\n"
        << "least distance " << metres(distance.distance) << " (seed " << distance.seed << "), least margin "
        << margin.margin << " (seed " << margin.seed << "), least to an obstacle " << metres(obstacle.obstacle)
        << " (seed " << obstacle.seed << ")\n"
        << std::setprecision(2) << "longest stall " << stall.stall << " s (seed " << stall.seed << "), time median "
        << times[times.size() / 2] << " s, most " << times.back() << " s, " << jumps << " jumps of the command\n";
    return out.str();
}

int run_swarm(const SwarmOptions& options)
{
    const SwarmSetup setup = setup_of(options);
    if (!options.out.empty()) {
        std::filesystem::create_directories(options.out);
    }
    const std::vector<SwarmResult> results =
        options.daemon ? fly_daemons_one_by_one(setup, options) : fly_all(setup, options);
    std::ostringstream text;
    for (const SwarmResult& result : results) {
        text << to_line(result) << "\n";
    }
    text << summarise(results);
    std::cout << text.str();
    if (!options.out.empty()) {
        const std::filesystem::path file = std::filesystem::path(options.out) / "results.txt";
        if (const std::string wrong = files::replace_file(file.string(), text.view()); !wrong.empty()) {
            throw std::runtime_error(file.string() + ": " + wrong);
        }
    }
    const bool good = std::all_of(results.begin(), results.end(), [](const SwarmResult& r) { return r.good(); });
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace jink::sim
