// SPDX-License-Identifier: BSD-3-Clause
// jink log: what a flight log of jinkd says, as text or tables, and the flight again from the log, bit for bit.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "firmware/linux/flight_log/replay.hpp"
#include "firmware/linux/map_file.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/log_summary.hpp"

namespace jink::host {
namespace {

struct LogCommand {
    std::vector<std::string> files;
    std::string csv;
    bool replay = false;
    bool any_version = false;
    std::string key_file;
    std::string map_file;
};

[[noreturn]] void stop(int status, const std::string& why)
{
    std::cerr << "jink: " << why << "\n";
    throw CLI::RuntimeError(status);
}

std::ifstream opened(const std::string& path)
{
    // Opening a FIFO would wait for a writer.
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(path, error);
    std::ifstream file;
    if (is_file) {
        file.open(path, std::ios::binary);
    }
    if (!is_file || !file) {
        stop(kExitBadInput, path + " cannot be read");
    }
    return file;
}

bool is_whole(ulog::End end) { return end == ulog::End::complete; }

/// Damage that leaves nothing to read.
bool is_useless(ulog::End end) { return end == ulog::End::not_ulog || end == ulog::End::refused; }

void print_damage(const std::string& path, const ulog::Reader& log)
{
    if (!is_whole(log.end())) {
        std::cerr << "jink: " << path << ": " << ulog::to_string(log.end()) << " at byte " << log.offset()
                  << "; read until there\n";
    }
}

void summarise(const LogCommand& command)
{
    bool useless = false;
    for (const std::string& path : command.files) {
        std::ifstream file = opened(path);
        const LogSummary summary = summarise_log(file);
        if (is_useless(summary.end)) {
            std::cerr << "jink: " << path << ": " << ulog::to_string(summary.end) << "\n";
            useless = true;
            continue;
        }
        print_log_summary(path, summary, std::cout);
    }
    if (useless) {
        throw CLI::RuntimeError(kExitBadInput);
    }
}

void write_tables(const LogCommand& command)
{
    if (command.files.size() != 1) {
        stop(kExitBadInput, "--csv takes one log");
    }
    const std::string& path = command.files.front();
    std::ifstream file = opened(path);
    ulog::Reader log(file);
    if (is_useless(log.end())) {
        stop(kExitBadInput, path + ": " + std::string(ulog::to_string(log.end())));
    }
    std::filesystem::create_directories(command.csv);
    const std::uint64_t lines = write_log_csv(log, command.csv);
    print_damage(path, log);
    std::cout << lines << " lines in " << command.csv << "\n";
}

void print_result(const flightlog::ReplayResult& r)
{
    if (!r.refused.empty()) {
        stop(kExitBadInput, r.refused);
    }
    std::cout << r.steps << " steps replayed, " << r.reports << " reports of steps and " << r.bytes
              << " bytes of output compared\n";
    if (!r.difference.empty()) {
        std::cout << "first difference in step " << r.difference_step << ": " << r.difference << "\n";
    }
    if (!r.incomplete.empty()) {
        std::cout << "not exact from step " << r.steps << " on: " << r.incomplete << "\n";
    }
    if (r.steps == 0 && r.difference.empty()) {
        stop(kExitBadInput, "nothing to replay: the log holds no step");
    }
    if (!r.is_identical()) {
        throw CLI::RuntimeError(kExitStop);
    }
    std::cout << "bit-identical" << (r.was_shut_down ? "" : ", as far as the log goes") << "\n";
}

void replay(const LogCommand& command)
{
    files::Complaints complaints;
    flightlog::ReplayOptions options;
    options.any_version = command.any_version;
    if (!command.key_file.empty()) {
        options.key = files::read_key_file(command.key_file, complaints);
    }
    std::optional<files::MapTables> map;
    geometry::MeshMap view;
    if (!command.map_file.empty()) {
        map = files::read_map_file(command.map_file, complaints);
        view = map ? map->view() : view;
        options.map = map ? &view : nullptr;
    }
    for (const files::Complaint& complaint : complaints) {
        std::cerr << "jink: " << files::to_string(complaint) << "\n";
    }
    if ((!command.key_file.empty() && !options.key) || (!command.map_file.empty() && !map)) {
        throw CLI::RuntimeError(kExitBadInput);
    }
    const auto flight = std::make_unique<flightlog::FlightReplay>(options);
    bool goes_on = true;
    for (std::size_t i = 0; i < command.files.size() && goes_on; ++i) {
        std::ifstream file = opened(command.files[i]);
        ulog::Reader log(file);
        if (is_useless(log.end())) {
            stop(kExitBadInput, command.files[i] + ": " + std::string(ulog::to_string(log.end())));
        }
        goes_on = flight->play(log);
        if (options.map != nullptr && log.info("jink_map") == "none") {
            stop(kExitBadInput, command.files[i] + ": the flight had no map: --map is of another one");
        }
        if (goes_on) {
            print_damage(command.files[i], log);
        }
        // A cut end is where the run was ended; other damage hides what follows.
        if (goes_on && !is_whole(log.end()) && log.end() != ulog::End::cut) {
            flight->note_damage(std::string(ulog::to_string(log.end())));
            goes_on = false;
        }
    }
    print_result(flight->result());
}

}  // namespace

void add_log(CLI::App& jink)
{
    auto command = std::make_shared<LogCommand>();
    CLI::App* log = jink.add_subcommand(
        "log",
        "flight logs of jinkd (ULog): a summary, tables, or a replay; exit status of a replay: 0: bit for bit the "
        "same, 1: different, 2: it cannot begin");
    log->add_option("files", command->files, "logs; of a replay the files of one run in their order")->required();
    CLI::Option* const csv = log->add_option("--csv", command->csv, "write one table (CSV) per topic to this folder");
    CLI::Option* const replay_flag =
        log->add_flag("--replay", command->replay,
                      "run the co-processor over the recorded input and compare its output")
            ->excludes(csv);
    log->add_option("--signing-key", command->key_file, "key file of a flight whose frames were signed")
        ->needs(replay_flag);
    log->add_option("--map", command->map_file, "map of a flight that used one")->needs(replay_flag);
    log->add_flag("--any-version", command->any_version, "replay logs of other versions too")->needs(replay_flag);
    log->callback([command] {
        if (command->replay) {
            replay(*command);
        } else if (!command->csv.empty()) {
            write_tables(*command);
        } else {
            summarise(*command);
        }
    });
}

}  // namespace jink::host
