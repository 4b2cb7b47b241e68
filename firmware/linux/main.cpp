// SPDX-License-Identifier: BSD-3-Clause
// jinkd: the co-processor on Linux. One 50 Hz loop; Coprocessor::step() makes all decisions. One thread of lower
// priority does all blocking work (status lines, messages, files): background.hpp.
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware/app/can_bus.hpp"
#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/app/plan_memory.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/background.hpp"
#include "firmware/linux/housekeeping.hpp"
#include "firmware/linux/loading.hpp"
#include "firmware/linux/node_identity.hpp"
#include "firmware/linux/param_file.hpp"
#include "firmware/linux/param_store.hpp"
#include "firmware/linux/ports.hpp"
#include "firmware/linux/read_ahead.hpp"
#include "firmware/linux/status.hpp"
#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "hal/linux/system_clock.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace {

using namespace jink;
using host::complain_now;

constexpr std::int64_t kTickMicroseconds = 20'000;
/// Exit status for a command line, a file or a device that cannot be used.
constexpr int kRefused = 2;

volatile std::sig_atomic_t stop_requested = 0;

volatile std::sig_atomic_t reload_requested = 0;

extern "C" void request_stop(int /*signal*/) { stop_requested = 1; }
extern "C" void request_reload(int /*signal*/) { reload_requested = 1; }

struct Options {
    std::string serial;
    std::string link;
    std::string can;
    std::string cloud;
    std::string vehicle_file;
    std::string param_file;
    std::string state_file;
    std::string airspace_file;
    std::string map_file;
    host::SigningFiles signing;
    std::string watchdog;
    std::string summary;
    double status_period = 1.0;
    unsigned clock = 0;  ///< of the processor [MHz]; 0: not said
    int system_id = 0;
    int node_id = 0;
    int realtime = 0;
    bool quiet = false;
};

void go_realtime(int priority)
{
    sched_param param{};
    param.sched_priority = priority;
    if (sched_setscheduler(0, SCHED_FIFO, &param) != 0 || mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        complain_now(std::string("no real-time priority: ") + std::strerror(errno));
    }
}

void sleep_until(std::int64_t us)
{
    timespec t{};
    t.tv_sec = us / 1'000'000;
    t.tv_nsec = us % 1'000'000 * 1000;
    // A signal ends the sleep. Only the signal that ends the loop may do so: other signals must not make steps early.
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR && stop_requested == 0) {
    }
}

/// Sleeps until `us`. Meanwhile a cloud line is read a thousand times a second: its driver's buffer is small.
void wait_until(std::int64_t us, hal::SystemClock& clock, host::ReadAhead* cloud)
{
    constexpr std::int64_t kPumpPeriod = 1'000;
    while (cloud != nullptr && stop_requested == 0) {
        cloud->pump();
        const std::int64_t next = clock.now_us() + kPumpPeriod;
        if (next >= us) {
            break;
        }
        sleep_until(next);
    }
    sleep_until(us);
}

/// Waits until the driver has sent its bytes: closing discards them, and the last words matter most.
void let_go_out(const host::AutopilotLine& port, hal::SystemClock& clock)
{
    constexpr std::int64_t kMin = 100'000;  // a pseudo-terminal gives no count, and its reader needs a little time
    constexpr std::int64_t kMax = 1'000'000;
    const std::int64_t began = clock.now_us();
    for (std::int64_t now = began; now - began < kMin || (port.unsent() > 0 && now - began < kMax);
         now = clock.now_us()) {
        sleep_until(now + kTickMicroseconds);
    }
}

/// A closed pipe or a full quota is an error of a write, not a reason to die.
void ignore_what_outputs_raise()
{
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

void catch_signals()
{
    struct sigaction action {};
    action.sa_handler = request_stop;
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
    action.sa_handler = request_reload;  // a terminal that hangs up does not stop the program either
    sigaction(SIGHUP, &action, nullptr);
}

link::dronecan::NodeOptions node_options(const Options& options)
{
    link::dronecan::NodeOptions node;
    node.node = static_cast<std::uint8_t>(options.node_id);
    const host::NodeIdentity identity = host::node_identity("/etc/machine-id", options.can);
    node.unique_id = identity.unique_id;
    node.seed = identity.seed;
    node.software.major = JINK_VERSION_MAJOR;
    node.software.minor = JINK_VERSION_MINOR;
    if (!identity.lasting) {
        complain_now("no /etc/machine-id: the node's unique id is another at each start");
    }
    return node;
}

/// @param initial  parameters of the files that people write
/// @param stored   values in force: these, and over them what was set over a link before
/// @param map      null: none
int run(const Options& options, const app::Parameters& initial, const files::ParamValues& stored,
        const geometry::MeshMap* map)
{
    hal::SystemClock clock;
    host::AutopilotLine autopilot;
    hal::SocketCanPort can;
    host::CanReadAhead frames(can, app::CanBus::kMaxFramesPerStep);
    std::optional<app::CanBus> bus;
    hal::LinuxWatchdog watchdog;
    if ((!options.serial.empty() && !autopilot.open_device(options.serial)) ||
        (!options.link.empty() && !autopilot.open_link(options.link))) {
        return kRefused;
    }
    if (!options.can.empty()) {
        if (!host::open_can(can, options.can)) {
            return kRefused;
        }
        bus.emplace(frames, node_options(options));
    }
    host::ReadAhead line(autopilot.port(), app::Coprocessor::kMaxBytesPerStep);
    hal::SerialPort& port = options.serial.empty() && options.link.empty() ? bus->serial() : line;
    if (!host::open_watchdog(watchdog, options.watchdog)) {
        return kRefused;
    }

    hal::TermiosSerialPort cloud_port;
    std::optional<host::ReadAhead> cloud_line;
    if (!options.cloud.empty()) {
        std::string cloud_device;
        std::uint32_t cloud_baud = 0;
        if (!host::split_device(options.cloud, cloud_device, cloud_baud)) {
            complain_now("--cloud " + options.cloud + ": expected DEV[:BAUD]");
            return kRefused;
        }
        if (!host::open_serial(cloud_port, cloud_device, cloud_baud)) {
            return kRefused;
        }
        cloud_line.emplace(cloud_port, host::ReadAhead::kCloudRoom);
    }
    // Single points of the link are used without a cloud port too.
    const auto clouds = std::make_unique<app::CloudInput>(cloud_line ? &*cloud_line : nullptr);

    link::mavlink::EndpointOptions link_options;
    link_options.system_id = static_cast<std::uint8_t>(options.system_id);
    link::mavlink::Signing signing;
    files::SigningState signing_state;
    if (!host::set_up_signing(options.signing, signing_state, signing)) {
        return kRefused;
    }
    link::mavlink::Endpoint endpoint(link_options, &signing);
    const auto coprocessor =
        std::make_unique<app::Coprocessor>(endpoint, port, watchdog, initial, bus ? &*bus : nullptr);
    static_cast<void>(coprocessor->restore_parameters(stored));  // validated together when they were read
    if (!options.state_file.empty()) {
        coprocessor->note_stored(coprocessor->parameters().generation());
    }
    const std::unique_ptr<app::PlanMemory> plans = options.clock != 0 ? std::make_unique<app::PlanMemory>() : nullptr;
    if (plans && !coprocessor->plan_in_slices(plans->plan, app::WorkRate::of_megahertz(options.clock).work())) {
        complain_now("--clock: a step at this clock has no time for a plan");
        return kRefused;
    }
    coprocessor->use_clouds(*clouds);
    if (map != nullptr) {
        coprocessor->use_map(*map);
    }
    const auto picture = std::make_unique<app::ReachPicture>(app::reach_sets());
    if (cloud_line) {
        coprocessor->let_reach_sets_see(*picture);
    }
    if (app::kHasReach && reach::check(app::reach_sets()) != reach::SetStatus::good) {
        complain_now("the reach sets are damaged and left out");
        coprocessor->leave_out_reach_sets();
    }
    if (!options.airspace_file.empty() && !host::load_airspace(options.airspace_file, clock, *coprocessor)) {
        return kRefused;
    }
    host::StatusLog log(options.quiet ? 0.0 : options.status_period);
    const host::Watched watched{*coprocessor, endpoint, port, bus ? &*bus : nullptr, *clouds};
    host::BackgroundCounts counts;
    {
        host::Background background(
            {options.airspace_file, options.state_file, options.signing.store, initial.values()});
        host::Housekeeping housekeeping(background, *coprocessor, endpoint, signing, signing_state.given);
        housekeeping.has_airspace(!options.airspace_file.empty());
        if (options.realtime > 0) {
            go_realtime(options.realtime);  // this thread alone
        }
        std::int64_t next = clock.now_us();
        while (stop_requested == 0) {
            autopilot.service(clock.now_us());
            can.service(clock.now_us());
            cloud_port.service(clock.now_us());
            line.pump();
            frames.pump();
            const std::int64_t began = clock.now_us();  // read after the bytes, so that no byte is newer
            if (reload_requested != 0) {
                reload_requested = 0;
                housekeeping.reload();
            }
            housekeeping.work({began});
            const app::StepReport report = coprocessor->step({began});
            if (const auto text = log.note(report, watched, began, clock.now_us() - began)) {
                background.print(host::Stream::out, *text);
            }
            next += kTickMicroseconds;
            next = std::max(next, clock.now_us());  // after a late step: no burst of steps to catch up
            wait_until(next, clock, cloud_line ? &*cloud_line : nullptr);
        }
        coprocessor->shut_down({clock.now_us()});
        housekeeping.store_all();
        let_go_out(autopilot, clock);
        watchdog.close();
        autopilot.close();
        if (!options.quiet) {
            background.print(host::Stream::error, "jinkd: stopped");
        }
        counts = background.counts();
    }
    if (!options.summary.empty() && !log.write_summary(options.summary, watched, counts)) {
        complain_now(options.summary + " cannot be written");
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App cli{
        "jinkd: collision avoidance beside a PX4 or ArduPilot autopilot, over MAVLink on a serial line, with\n"
        "sensors and traffic on a DroneCAN bus, or over MAVLink through that bus. Runs until SIGTERM or SIGINT."};
    cli.set_version_flag("--version", "jinkd " JINK_VERSION);
    CLI::Option* const serial =
        cli.add_option("--serial", options.serial, "device and baud rate, DEV[:BAUD]; 921600 where none is given");
    CLI::Option* const link =
        cli.add_option("--link", options.link,
                       "line to the autopilot: udp:[ADDRESS:]PORT listens and answers whom it hears first, "
                       "udpout:ADDRESS:PORT sends there, tcp:ADDRESS:PORT connects; serial:DEV[:BAUD] is --serial. "
                       "Without ADDRESS: this machine alone")
            ->excludes(serial);
    CLI::Option* const can =
        cli.add_option("--can", options.can,
                       "CAN interface with a DroneCAN bus; without --serial and --link MAVLink goes "
                       "through "
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
    cli.add_option("--params", options.param_file, "parameter file, NAME,VALUE per line; wins over the vehicle file");
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
    cli.add_option("--watchdog", options.watchdog, "watchdog device to feed, e.g. /dev/watchdog0");
    cli.add_option("--clock", options.clock,
                   "the processor's clock [MHz]: a step does the work that fits there, and plans go on over several "
                   "steps. Without: work for 1000 MHz and more, a plan in one step")
        ->check(CLI::Range(app::WorkRate::kMinMegahertz, app::WorkRate::kMaxMegahertz))
        ->excludes(cloud);
    cli.add_option("--realtime", options.realtime, "SCHED_FIFO priority and locked memory; 0: off")
        ->check(CLI::Range(0, 99));
    cli.add_flag("--quiet", options.quiet, "errors only");
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error) == 0 ? EXIT_SUCCESS : kRefused;
    }

    ignore_what_outputs_raise();
    catch_signals();
    if (serial->empty() && link->empty() && can->empty()) {
        complain_now("--serial, --link or --can is needed");
        return kRefused;
    }
    if (host::is_link(options.serial)) {
        complain_now("--serial " + options.serial + ": that is no device; --link " + options.serial);
        return kRefused;
    }
    if (!can->empty() && options.can.empty()) {
        complain_now("--can: the name of an interface is needed");
        return kRefused;
    }
    if ((!serial->empty() && options.serial.empty()) || (!link->empty() && options.link.empty())) {
        complain_now("--serial, --link: the name of a line is needed");
        return kRefused;
    }
    files::Complaints complaints;
    auto parameters = files::load_parameters(options.vehicle_file, options.param_file, complaints);
    host::complain(complaints);
    if (!parameters) {
        return kRefused;
    }
    const app::Parameters initial = *parameters;
    if (options.state_file.empty() && !options.param_file.empty()) {
        options.state_file = options.param_file + ".state";
    }
    if (!options.state_file.empty()) {
        options.signing.store = options.state_file + ".signing";
    } else if (!options.signing.key.empty()) {
        options.signing.store = options.signing.key + ".state";
    }
    std::optional<files::MapTables> map;
    if (!options.map_file.empty()) {
        map = host::load_map(options.map_file);
        if (!map) {
            return kRefused;
        }
    }
    host::load_state(options.state_file, *parameters);
    const geometry::MeshMap view = map ? map->view() : geometry::MeshMap{};
    return run(options, initial, parameters->values(), map ? &view : nullptr);
}
