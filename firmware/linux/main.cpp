// SPDX-License-Identifier: BSD-3-Clause
// jinkd: the co-processor on Linux. One 50 Hz loop; Coprocessor::step() makes all decisions. One thread of lower
// priority does all blocking work (status lines, messages, files): background.hpp.
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

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

#include "firmware/app/coprocessor.hpp"
#include "firmware/linux/background.hpp"
#include "firmware/linux/flight_log/assembly.hpp"
#include "firmware/linux/housekeeping.hpp"
#include "firmware/linux/live_page/live_page.hpp"
#include "firmware/linux/loading.hpp"
#include "firmware/linux/logging.hpp"
#include "firmware/linux/node_identity.hpp"
#include "firmware/linux/options.hpp"
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
using host::Options;

constexpr std::int64_t kTickMicroseconds = 20'000;
/// Exit status for a command line, a file or a device that cannot be used.
constexpr int kRefused = 2;

volatile std::sig_atomic_t stop_requested = 0;

volatile std::sig_atomic_t reload_requested = 0;

extern "C" void request_stop(int /*signal*/) { stop_requested = 1; }
extern "C" void request_reload(int /*signal*/) { reload_requested = 1; }

void go_realtime(int priority)
{
    sched_param param{};
    param.sched_priority = priority;
    if (sched_setscheduler(0, SCHED_FIFO, &param) != 0) {
        complain_now(std::string("no real-time priority: ") + std::strerror(errno));
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        complain_now(std::string("memory is not locked: ") + std::strerror(errno));
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

/// A standard stream that is closed becomes /dev/null: otherwise a device gets its descriptor, and what is printed
/// there. False: there is no /dev/null for it.
bool open_standard_streams()
{
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
        if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) != stream) {
            return false;
        }
    }
    return true;
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

/// What decides beside the ports; the key stays in `signing`.
/// @param initial  parameters of the files that people write
/// @param stored   values in force: these, and over them what was set over a link before
/// @param map      null: none
flightlog::Setup set_up(const Options& options, const app::Parameters& initial, const files::ParamValues& stored,
                        const geometry::MeshMap* map, const link::mavlink::Signing& signing)
{
    flightlog::Setup setup;
    setup.system_id = static_cast<std::uint8_t>(options.system_id);
    setup.clock = options.clock;
    setup.on_bus = options.serial.empty() && options.link.empty();
    setup.has_bus = !options.can.empty();
    if (setup.has_bus) {
        setup.node = node_options(options);
    }
    setup.has_cloud = !options.cloud.empty();
    setup.logs_cloud = setup.has_cloud && options.log.clouds;
    setup.keeps_state = !options.state_file.empty();
    setup.map = map != nullptr ? std::optional(map->checksum) : std::nullopt;
    setup.reach_sets = flightlog::reach_sets_checksum();
    setup.has_key = signing.has_key();
    setup.keys_can_be_set = signing.keys_can_be_set();
    setup.signing_time = signing.time();
    setup.unsigned_frames = options.signing.unsigned_frames;
    setup.initial = initial.values();
    setup.stored = stored;
    setup.generation = initial.generation();
    setup.version = flightlog::build_version();
    setup.digest = flightlog::build_digest();
    return setup;
}

/// The devices of jinkd, and what was read ahead of them.
struct Devices {
    host::AutopilotLine autopilot;
    hal::SocketCanPort can;
    hal::TermiosSerialPort cloud_port;
    hal::LinuxWatchdog watchdog;
    std::optional<host::ReadAhead> line;  ///< from open() on
    host::CanReadAhead frames{can, app::CanBus::kMaxFramesPerStep};
    std::optional<host::ReadAhead> cloud;

    /// False, and said why, where jinkd must not start.
    [[nodiscard]] bool open(const Options& options);
    void read(hal::SystemClock& clock)
    {
        autopilot.service(clock.now_us());
        can.service(clock.now_us());
        cloud_port.service(clock.now_us());
        line->pump();
        frames.pump();
    }
    [[nodiscard]] host::ReadAhead* cloud_line() { return cloud ? &*cloud : nullptr; }
};

bool Devices::open(const Options& options)
{
    if ((!options.serial.empty() && !autopilot.open_device(options.serial)) ||
        (!options.link.empty() && !autopilot.open_link(options.link)) ||
        (!options.can.empty() && !host::open_can(can, options.can)) ||
        !host::open_watchdog(watchdog, options.watchdog)) {
        return false;
    }
    line.emplace(autopilot.port(), app::Coprocessor::kMaxBytesPerStep);
    if (options.cloud.empty()) {
        return true;
    }
    std::string cloud_device;
    std::uint32_t cloud_baud = 0;
    if (!host::split_device(options.cloud, cloud_device, cloud_baud)) {
        complain_now("--cloud " + options.cloud + ": expected DEV[:BAUD]");
        return false;
    }
    cloud.emplace(cloud_port, host::ReadAhead::kCloudRoom);
    return host::open_serial(cloud_port, cloud_device, cloud_baud);
}

/// What the loop works with.
struct Loop {
    const Options& options;
    hal::SystemClock& clock;
    Devices& devices;
    flightlog::Assembly& assembly;
    host::Logging& flight_log;
    host::Housekeeping& housekeeping;
    host::Background& background;
    host::StatusLog& status;
    const host::Watched& watched;

    void step()
    {
        devices.read(clock);
        const std::int64_t began = clock.now_us();  // read after the bytes, so that no byte is newer
        if (reload_requested != 0) {
            reload_requested = 0;
            housekeeping.reload();
        }
        housekeeping.work({began});
        flight_log.begin({began});
        const app::StepReport report = assembly.coprocessor().step({began});
        const std::int64_t took = clock.now_us() - began;
        flight_log.end(report, assembly.coprocessor(), {began}, took, background);
        if (const auto text = status.note(report, watched, began, took)) {
            background.print(host::Stream::out, *text);
        }
    }
    void run()
    {
        std::int64_t next = clock.now_us();
        while (stop_requested == 0) {
            step();
            next += kTickMicroseconds;
            next = std::max(next, clock.now_us());  // after a late step: no burst of steps to catch up
            wait_until(next, clock, devices.cloud_line());
        }
    }
    void stop()
    {
        const TimePoint end{clock.now_us()};
        flight_log.begin_shut_down(end);
        assembly.coprocessor().shut_down(end);
        housekeeping.store_all();
        let_go_out(devices.autopilot, clock);
        devices.watchdog.close();
        devices.autopilot.close();
        flight_log.end_shut_down(end);
        if (!options.quiet) {
            background.print(host::Stream::error, "jinkd: stopped");
        }
    }
};

int run(const Options& options, const app::Parameters& initial, const files::ParamValues& stored,
        const geometry::MeshMap* map)
{
    hal::SystemClock clock;
    std::unique_ptr<livepage::LivePage> page;
    if (!options.page.address.empty()) {
        page = livepage::LivePage::open(options.page, stored);
        if (!page) {
            return kRefused;
        }
    }
    Devices devices;
    link::mavlink::Signing signing;
    files::SigningState signing_state;
    if (!devices.open(options) || !host::set_up_signing(options.signing, signing_state, signing)) {
        return kRefused;
    }
    const flightlog::Setup setup = set_up(options, initial, stored, map, signing);
    host::Logging flight_log(options.log, setup, page.get());
    const flightlog::AssemblyPorts ports{setup.on_bus ? nullptr : &flight_log.line(*devices.line),
                                         setup.has_bus ? &flight_log.can(devices.frames) : nullptr,
                                         devices.cloud ? &flight_log.cloud(*devices.cloud) : nullptr};
    flightlog::Assembly assembly(setup, initial, ports, devices.watchdog, signing, map);
    if (!assembly.has_time_for_plans()) {
        complain_now("--clock: a step at this clock has no time for a plan");
        return kRefused;
    }
    if (assembly.are_reach_sets_damaged()) {
        complain_now("the reach sets are damaged and left out");
    }
    app::Coprocessor& coprocessor = assembly.coprocessor();
    if (!options.airspace_file.empty() &&
        !host::load_airspace(options.airspace_file, clock, coprocessor, flight_log.recorder())) {
        return kRefused;
    }
    host::StatusLog status(options.quiet ? 0.0 : options.status_period);
    const hal::SerialPort& mavlink = setup.on_bus ? assembly.bus()->serial() : *devices.line;
    const host::Watched watched{coprocessor,    assembly.endpoint(), mavlink,
                                assembly.bus(), assembly.clouds(),   flight_log.output()};
    host::BackgroundCounts counts;
    {
        host::Background background(
            {options.airspace_file, options.state_file, options.signing.store, initial.values()});
        host::Housekeeping housekeeping(background, coprocessor, assembly.endpoint(), signing, signing_state.given);
        housekeeping.has_airspace(!options.airspace_file.empty());
        housekeeping.record_to(flight_log.recorder());
        if (options.realtime > 0) {
            go_realtime(options.realtime);  // this thread alone
        }
        Loop loop{options, clock, devices, assembly, flight_log, housekeeping, background, status, watched};
        host::notify_ready(devices.watchdog);
        loop.run();
        loop.stop();
        counts = background.counts();
    }
    if (!options.summary.empty() && !status.write_summary(options.summary, watched, counts)) {
        complain_now(options.summary + " cannot be written");
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
    if (!open_standard_streams()) {
        return kRefused;
    }
    host::Options options;
    CLI::App cli{host::kAbout};
    host::add_options(cli, options);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error) == 0 ? EXIT_SUCCESS : kRefused;
    }

    ignore_what_outputs_raise();
    catch_signals();
    host::name_stores(options);
    if (!host::check_names(cli, options) || !host::check_files(options)) {
        return kRefused;
    }
    files::Complaints complaints;
    auto parameters = files::load_parameters(options.vehicle_file, options.param_file, complaints);
    host::complain(complaints);
    if (!parameters) {
        return kRefused;
    }
    const app::Parameters initial = *parameters;
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
