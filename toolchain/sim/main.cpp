// SPDX-License-Identifier: BSD-3-Clause
// jink-sim: flies scenarios against the co-processor, in this process or as the real program.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>

#include "firmware/app/work_rate.hpp"
#include "firmware/linux/param_store.hpp"
#include "toolchain/sim/command_end.hpp"
#include "toolchain/sim/daemon.hpp"
#include "toolchain/sim/encounter_campaign.hpp"
#include "toolchain/sim/encounters_command.hpp"
#include "toolchain/sim/envelope.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/manned_command.hpp"
#include "toolchain/sim/matrix_command.hpp"
#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/parallel.hpp"
#include "toolchain/sim/phases_command.hpp"
#include "toolchain/sim/program_file.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/recorded_command.hpp"
#include "toolchain/sim/replay_command.hpp"
#include "toolchain/sim/report.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/swarm_command.hpp"

namespace {

using namespace jink::sim;
namespace fs = std::filesystem;

struct Options {
    std::vector<std::string> files;
    std::string daemon;
    std::string image;
    std::string machine;
    std::string out;
    std::string link = "serial";
    std::string steps;
    std::string scenarios = JINK_SCENARIOS;
    unsigned count = 50;
    std::uint64_t seed = 1;
    unsigned at_once = 24;
    std::vector<std::string> parameters;  ///< NAME=VALUE
    Board board;
    bool quiet = false;
    bool judge = false;
    bool within_phases = false;
};

std::vector<Scenario> load_all(const std::vector<std::string>& files, bool real_time, const Board& board)
{
    std::vector<Scenario> scenarios;
    for (const std::string& file : files) {
        scenarios.push_back(load_scenario(file));
        scenarios.back().board = board;
        scenarios.back().timed = true;
        if (const std::string reason = no_input_for(scenarios.back()); real_time && !reason.empty()) {
            std::cout << scenarios.back().name << ": left out, " << reason << "\n";
            scenarios.pop_back();
        }
    }
    if (scenarios.empty()) {
        throw std::runtime_error("no scenario is left to be flown");
    }
    return scenarios;
}

/// Flies in process; with a folder, writes NAME.steps there.
Record fly_recorded(const Scenario& scenario, const std::string& folder)
{
    if (folder.empty()) {
        return fly_in_process(scenario);
    }
    if (scenario.lidar) {
        throw std::runtime_error(scenario.name + ": the steps of a flight with a LiDAR cannot be recorded");
    }
    fs::create_directories(folder);
    const fs::path file = fs::path(folder) / (scenario.name + ".steps");
    std::ostringstream steps;
    Record record = fly_in_process(scenario, &steps);
    if (const std::string wrong = jink::files::replace_file(file.string(), steps.view()); !wrong.empty()) {
        throw std::runtime_error(file.string() + ": " + wrong);
    }
    return record;
}

/// Random flights in process, two at once, in the order of their seeds.
std::vector<ReportedFlight> fly_random(std::uint64_t first, unsigned count)
{
    std::vector<ReportedFlight> flights(count);
    in_parallel(flights.size(), 2, [&](std::size_t k) {
        Scenario scenario = random_scenario(first + k);
        scenario.timed = true;
        flights[k] = report_on(scenario, fly_in_process(scenario), true);
    });
    return flights;
}

/// Judged flights count as bad only if the judge has a manoeuvre that keeps the promise; other flights by their
/// expectation.
bool is_bad(const ReportedFlight& flight)
{
    return flight.judged ? flight.failed_avoidable || flight.record.outcome == Outcome::failed : !flight.unmet.empty();
}

int finish(const Options& options, const std::vector<ReportedFlight>& flights)
{
    const auto bad = std::count_if(flights.begin(), flights.end(), is_bad);
    if (!options.quiet) {
        print_table(std::cout, flights);
    }
    const auto count = [&](Outcome outcome) {
        return std::count_if(flights.begin(), flights.end(),
                             [&](const ReportedFlight& f) { return f.record.outcome == outcome; });
    };
    std::cout << flights.size() << " flights: ";
    for (const Outcome outcome :
         {Outcome::clear, Outcome::avoided, Outcome::braked, Outcome::breach, Outcome::collision, Outcome::failed}) {
        std::cout << count(outcome) << " " << to_string(outcome) << (outcome == Outcome::failed ? "" : ", ");
    }
    std::cout << "; " << bad << " not as expected\n";
    for (const ReportedFlight& f : flights) {
        if (f.judged && f.record.closest.surface < f.record.promise) {
            std::cout << f.record.name << ": " << f.record.closest.surface << " m from " << f.record.closest_threat
                      << " at " << f.record.closest.time << " s; ";
            if (f.reported_too_late) {
                std::cout << "nobody was told of it before\n";
            } else {
                std::cout << f.last_chance.keep << " of " << f.last_chance.tried << " manoeuvres from "
                          << f.last_chance.detected << " s on kept the promise\n";
            }
        }
    }
    if (!options.out.empty()) {
        const fs::path file = fs::path(options.out) / "run.json";
        write_run(file, flights);
        std::cout << "Written: " << file.string() << "\n";
    }
    return bad == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

void make_folder(const Options& options)
{
    if (!options.out.empty()) {
        fs::create_directories(options.out);
    }
}

fs::path log_folder(const Options& options)
{
    const fs::path folder =
        options.out.empty() ? fs::temp_directory_path() / "jink-sim" : fs::path(options.out) / "jinkd";
    fs::create_directories(folder);
    return folder;
}

Computer computer_of(const Options& options)
{
    if (!options.image.empty()) {
        return {options.image, options.machine};
    }
    return {options.daemon.empty() ? find_daemon("--daemon") : fs::path(options.daemon), ""};
}

int fly(const Options& options)
{
    std::vector<ReportedFlight> flights;
    const bool in_process = options.daemon.empty() && options.image.empty();
    const std::vector<Scenario> scenarios = load_all(options.files, !in_process, options.board);
    const bool tunnel = options.link == "tunnel";
    if (in_process) {
        for (const Scenario& scenario : scenarios) {
            Record record = tunnel ? fly_through_tunnel(scenario) : fly_recorded(scenario, options.steps);
            flights.push_back(report_on(scenario, std::move(record), options.judge));
        }
    } else {
        std::vector<Record> records =
            fly_daemons(scenarios, computer_of(options), log_folder(options), options.at_once);
        for (std::size_t i = 0; i < scenarios.size(); ++i) {
            const std::vector<std::string> differs =
                options.within_phases ? outside_phases(scenarios[i], records[i]) : std::vector<std::string>();
            flights.push_back(report_on(scenarios[i], std::move(records[i]), options.judge));
            std::vector<std::string>& missing = flights.back().unmet;
            missing.insert(missing.end(), differs.begin(), differs.end());
        }
    }
    return finish(options, flights);
}

int demo(const Options& options)
{
    const auto began = std::chrono::steady_clock::now();
    const Computer computer = computer_of(options);
    std::vector<std::string> files;
    for (const fs::path& file : scenario_files(options.scenarios)) {
        files.push_back(file.string());
    }
    const std::vector<Scenario> scenarios = load_all(files, true, {});
    std::cout << scenarios.size() << " scenarios in real time against " << computer.program.filename().string() << ", "
              << options.at_once << " at once ..." << std::endl;
    std::vector<Record> records = fly_daemons(scenarios, computer, log_folder(options), options.at_once);
    std::vector<ReportedFlight> flights;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        ReportedFlight flight = report_on(scenarios[i], std::move(records[i]), false);
        // Candidates and work units are only available in process.
        Record inside = fly_in_process(scenarios[i]);
        if (flight.record.inside && inside.inside) {
            flight.record.inside->decisions = std::move(inside.inside->decisions);
            flight.record.inside->work = std::move(inside.inside->work);
            flight.record.inside->first_candidate = inside.inside->first_candidate;
        }
        flights.push_back(std::move(flight));
    }
    std::cout << options.count << " random encounters in process ..." << std::endl;
    for (ReportedFlight& flight : fly_random(options.seed, options.count)) {
        flights.push_back(std::move(flight));
    }
    const int result = finish(options, flights);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    std::cout << "Flown in " << took.count() << " s\n";
    return result;
}

int random(const Options& options) { return finish(options, fly_random(options.seed, options.count)); }

/// Of each clock [MHz]: instructions of a tick, work units of a step, and of those of its slice.
int rates(const std::vector<unsigned>& clocks)
{
    for (const unsigned clock : clocks) {
        const jink::app::WorkRate rate = jink::app::WorkRate::of_megahertz(clock);
        std::cout << clock << ' ' << rate.instructions() << ' ' << rate.work().all << ' ' << rate.work().slice << '\n';
    }
    return EXIT_SUCCESS;
}

int crowd(const Options& options)
{
    Variant variant;
    variant.parameters = parse_parameters(options.parameters);
    if (const std::string refusal = refusal_of(variant); !refusal.empty()) {
        throw std::runtime_error("crowd: --set: " + refusal);
    }
    std::vector<ReportedFlight> flights;
    for (unsigned i = 0; i < options.count; ++i) {
        Scenario scenario = crowded_scenario(options.seed + i);
        scenario.board = options.board;
        scenario.timed = true;
        scenario.parameters = variant.parameters;
        flights.push_back(report_on(scenario, fly_recorded(scenario, options.steps), false));
    }
    return finish(options, flights);
}

int run(int argc, char** argv)
{
    Options options;
    CLI::App cli{"jink-sim: flies encounters against the co-processor. The exit status is not 0 when one does not end "
                 "as expected."};
    cli.set_version_flag("--version", "jink-sim " JINK_VERSION);
    cli.require_subcommand(1);
    CLI::App* fly_command = cli.add_subcommand("fly", "fly scenario files in process, or in real time against jinkd");
    fly_command->add_option("files", options.files, "scenario files (tests/scenario/README.md)")
        ->required()
        ->check(CLI::ExistingFile);
    fly_command->add_flag("--judge", options.judge, "search for a manoeuvre that keeps the promise, and go by that");
    PhasesOptions phases;
    const CLI::App& phases_command = add_phases(cli, phases);
    CLI::App* demo_command =
        cli.add_subcommand("demo", "all scenarios against jinkd, then random encounters in process");
    demo_command->add_option("--scenarios", options.scenarios, "folder of scenario files")
        ->check(CLI::ExistingDirectory);
    CLI::App* random_command =
        cli.add_subcommand("random", "random encounters in process, each judged for avoidability");
    CLI::App* crowd_command = cli.add_subcommand(
        "crowd", "32 intruders at once in a ring of pillars, in process: the fullest world, not the fairest");
    crowd_command->add_option("--set", options.parameters,
                              "NAME=VALUE: a parameter of the co-processor, any number of them");
    for (CLI::App* command : {fly_command, crowd_command}) {
        command->add_option("--record-steps", options.steps,
                            "in process: folder for NAME.steps, what each step read and wrote");
        static_cast<void>(add_board(*command, options.board));
    }
    for (CLI::App* command : {fly_command, demo_command}) {
        CLI::Option* const daemon =
            command->add_option("--daemon", options.daemon, "the program jinkd")->transform({find_program, "FILE"});
        CLI::Option* const image =
            command->add_option("--image", options.image, "a bare-metal image, flown under qemu-system-arm")
                ->check({check_image, "FILE"})
                ->excludes(daemon);
        CLI::Option* const machine =
            command->add_option("--machine", options.machine, "qemu's board for the image: mps2-an500, netduinoplus2");
        image->needs(machine);
        machine->needs(image);
        if (command == fly_command) {
            command
                ->add_flag("--within-phases", options.within_phases,
                           "real time: has to lie within the envelope of flights in process in many phases")
                ->excludes("--judge");
            command
                ->add_option("--link", options.link,
                             "in process: MAVLink over a serial cable, or through the tunnel of a DroneCAN bus")
                ->check(CLI::IsMember({"serial", "tunnel"}))
                ->excludes(daemon)
                ->excludes(image);
        }
        command->add_option("--at-once", options.at_once, "flights in real time at once")->check(whole(1, 64));
    }
    for (CLI::App* command : {random_command, demo_command, crowd_command}) {
        command->add_option("--count", options.count, "random encounters")->check(whole(0, 1000000));
        command->add_option("--seed", options.seed, "of the first one")->check(any_seed());
    }
    for (CLI::App* command : {fly_command, demo_command, random_command, crowd_command}) {
        command->add_option("--out", options.out, "folder for run.json and the daemon's logs");
        command->add_flag("--quiet", options.quiet, "no table");
    }
    std::vector<unsigned> clocks;
    CLI::App* const rates_command = cli.add_subcommand(
        "rates", "the work of a step for processors with these clocks: each clock [MHz], instructions "
                 "of a tick, work units of a step, and of those of its slice");
    rates_command->add_option("clocks", clocks)
        ->required()
        ->check(whole(jink::app::WorkRate::kMinMegahertz, jink::app::WorkRate::kMaxMegahertz));
    EncountersOptions encounters;
    const CLI::App& encounters_command = add_encounters(cli, encounters, true);
    SwarmOptions swarm;
    const CLI::App& swarm_command = add_swarm(cli, swarm);
    ReplayOptions recording;
    const CLI::App& replay_command = add_replay(cli, recording);
    MatrixOptions matrix;
    const CLI::App& matrix_command = add_matrix(cli, matrix);
    MannedOptions manned;
    const CLI::App& manned_command = add_manned(cli, manned);
    RecordedOptions recorded;
    const CLI::App& recorded_command = add_recorded(cli, recorded);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return end_of_parse(cli, "jink-sim", e);
    }
    try {
        make_folder(options);
        if (encounters_command.parsed()) {
            return run_encounters(encounters);
        }
        if (swarm_command.parsed()) {
            return run_swarm(swarm);
        }
        if (rates_command->parsed()) {
            return rates(clocks);
        }
        if (replay_command.parsed()) {
            return run_replay(recording, std::cout, std::cerr);
        }
        if (matrix_command.parsed()) {
            return run_matrix(matrix, std::cout);
        }
        if (manned_command.parsed()) {
            return run_manned(manned, std::cout);
        }
        if (recorded_command.parsed()) {
            run_recorded(recorded, std::cout);
            return EXIT_SUCCESS;
        }
        if (fly_command->parsed()) {
            const bool plain = options.daemon.empty() && options.image.empty() && options.link == "serial";
            if (!options.steps.empty() && !plain) {
                throw std::runtime_error("--record-steps is for flights in process, over the serial cable");
            }
            return fly(options);
        }
        if (phases_command.parsed()) {
            return run_phases(phases, std::cout);
        }
        return demo_command->parsed() ? demo(options) : crowd_command->parsed() ? crowd(options) : random(options);
    } catch (const std::exception& e) {
        std::cerr << "jink-sim: " << e.what() << "\n";
        return kRefused;
    }
}

}  // namespace

int main(int argc, char** argv) { return with_output("jink-sim", run(argc, argv)); }
