// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/options.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware/app/work_rate.hpp"
#include "firmware/linux/param_store.hpp"
#include "firmware/linux/ports.hpp"

namespace jink::host {

void add_options(CLI::App& cli, Options& options)
{
    cli.set_version_flag("--version", "jinkd " JINK_VERSION);
    CLI::Option* const serial =
        cli.add_option("--serial", options.serial, "device and baud rate, DEV[:BAUD]; 921600 where none is given");
    cli.add_option("--link", options.link,
                   "line to the autopilot: udp:[ADDRESS:]PORT listens and answers whom it hears first, "
                   "udpout:ADDRESS:PORT sends there, tcp:ADDRESS:PORT connects; serial:DEV[:BAUD] is --serial. "
                   "Without ADDRESS: this machine alone")
        ->excludes(serial);
    CLI::Option* const can =
        cli.add_option("--can", options.can,
                       "CAN interface with a DroneCAN bus; without --serial and --link MAVLink goes through "
                       "it. Its bit rate and queue are set by\n"
                       "the system, not here: ip link set can0 type can bitrate 1000000 "
                       "restart-ms 100; ip link set can0 txqueuelen 128 up");
    cli.add_option("--node-id", options.node_id, "DroneCAN node id, 1 to 127; 0: asks the bus for one")
        ->check(CLI::Range(0, 127))
        ->needs(can);
    CLI::Option* const cloud = cli.add_option(
        "--cloud", options.cloud,
        "device and baud rate, DEV[:BAUD], on which a LiDAR's driver sends point clouds in compact frames");
    cli.add_option("--vehicle", options.vehicle_file, "vehicle file (YAML): limits, airframe, cost caps");
    cli.add_option("--params", options.param_file,
                   "parameter file, NAME,VALUE per line or as QGroundControl saves it; wins over the vehicle file");
    cli.add_option("--state", options.state_file,
                   "file that keeps parameters set over MAVLink or the bus; wins over the files above. Without this "
                   "option: the parameter file's name with .state, if there is one");
    cli.add_option("--airspace", options.airspace_file,
                   "airspace file (YAML): closed areas and storm cells; read anew on SIGHUP");
    cli.add_option("--map", options.map_file,
                   "map of known surroundings, made by jink mesh build; one that is not good ends jinkd with status 2");
    cli.add_option("--signing-key", options.signing.key,
                   "file with the key of MAVLink signing: 64 hexadecimal digits, or 'passphrase TEXT'. Frames are then "
                   "signed, and unsigned ones refused");
    cli.add_option("--unsigned", options.signing.unsigned_frames,
                   "unsigned frames that are taken although a key is set: none, all, or message ids, as 109,246");
    cli.add_option("--system-id", options.system_id, "MAVLink system to serve; 0: the first autopilot heard")
        ->check(CLI::Range(0, 255));
    cli.add_option("--status-period", options.status_period, "seconds between status lines; 0: none")
        ->check(CLI::Range(0.0, 3600.0));
    cli.add_option("--summary", options.summary, "write counters and step times to this file (JSON) at the end");
    CLI::Option* const log = cli.add_option(
        "--log", options.log.folder, "folder for flight logs (ULog), which jink log reads and replays bit for bit");
    cli.add_flag("--log-clouds", options.log.clouds, "log the cloud line too: up to 6 MB/s")->needs(log)->needs(cloud);
    cli.add_option("--log-size", options.log.file_megabytes, "size of one file of the log [MB]")
        ->check(CLI::Range(1, 100'000))
        ->needs(log);
    cli.add_option("--log-count", options.log.files, "files of logs that are kept; the oldest are removed")
        ->check(CLI::Range(2, 100'000))
        ->needs(log);
    CLI::Option* const page =
        cli.add_option("--page", options.page.address,
                       "live view in a browser, read only: [ADDRESS:]PORT; without ADDRESS this machine alone");
    cli.add_option("--page-file", options.page.file, "the page of --page, in place of the installed live.html")
        ->needs(page);
    cli.add_option("--watchdog", options.watchdog, "watchdog device to feed, e.g. /dev/watchdog0");
    cli.add_option("--clock", options.clock,
                   "the processor's clock [MHz]: a step does the work that fits there, and plans go on over several "
                   "steps. Without: work for 1000 MHz and more, a plan in one step")
        ->check(CLI::Range(app::WorkRate::kMinMegahertz, app::WorkRate::kMaxMegahertz))
        ->excludes(cloud);
    cli.add_option("--realtime", options.realtime, "SCHED_FIFO priority and locked memory; 0: off")
        ->check(CLI::Range(0, 99));
    cli.add_flag("--quiet", options.quiet, "errors only");
}

bool check_names(const CLI::App& cli, const Options& options)
{
    const bool has_serial = cli.count("--serial") > 0;
    const bool has_link = cli.count("--link") > 0;
    const bool has_can = cli.count("--can") > 0;
    if (!has_serial && !has_link && !has_can) {
        complain_now("--serial, --link or --can is needed");
        return false;
    }
    if (is_link(options.serial)) {
        complain_now("--serial " + options.serial + ": that is no device; --link " + options.serial);
        return false;
    }
    // A variable of a script that is not set: without its map or key jinkd must not fly.
    for (const CLI::Option* const option : cli.get_options()) {
        const std::vector<std::string>& given = option->results();
        if (std::find(given.begin(), given.end(), std::string()) != given.end()) {
            complain_now(option->get_name() + ": a value is needed, this one is empty");
            return false;
        }
    }
    if (!std::isfinite(options.status_period)) {
        complain_now("--status-period: seconds from 0 to 3600 are needed");
        return false;
    }
    return true;
}

void name_stores(Options& options)
{
    if (options.state_file.empty() && !options.param_file.empty()) {
        options.state_file = options.param_file + ".state";
    }
    if (!options.state_file.empty()) {
        options.signing.store = options.state_file + ".signing";
    } else if (!options.signing.key.empty()) {
        options.signing.store = options.signing.key + ".state";
    }
}

bool check_files(const Options& options)
{
    const std::vector<std::string> inputs{options.param_file, options.vehicle_file, options.airspace_file,
                                          options.map_file,   options.signing.key,  options.page.file};
    const std::vector<std::string> outputs{options.state_file, options.signing.store, options.summary};
    if (const auto same = files::find_overwritten(inputs, outputs)) {
        complain_now(same->output + ": cannot be written: it is the same file as " + same->other);
        return false;
    }
    std::string fault;
    const std::optional<LinkName> link = split_link(options.link, fault);
    std::string line;
    std::string cloud;
    std::uint32_t baud = 0;
    if (split_device(link && link->serial ? link->where : options.serial, line, baud) &&
        split_device(options.cloud, cloud, baud) && files::is_same_file(line, cloud)) {
        complain_now("--cloud " + options.cloud + ": this device is the autopilot's line");
        return false;
    }
    return true;
}

}  // namespace jink::host
