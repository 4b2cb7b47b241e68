// SPDX-License-Identifier: BSD-3-Clause
// jinkd: the co-processor on Linux. One thread, one 50 Hz loop; everything that decides is Coprocessor::step().
#include <sched.h>
#include <sys/mman.h>

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
#include "firmware/app/reach_picture.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/airspace_file.hpp"
#include "firmware/linux/cloud_line.hpp"
#include "firmware/linux/complaint.hpp"
#include "firmware/linux/node_identity.hpp"
#include "firmware/linux/param_file.hpp"
#include "firmware/linux/status.hpp"
#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "hal/linux/system_clock.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace {

using namespace jink;

constexpr std::int64_t kTickMicroseconds = 20'000;
constexpr std::int64_t kReconnectPeriod = 500'000;
constexpr std::uint32_t kDefaultBaud = 921600;

volatile std::sig_atomic_t stop_requested = 0;

volatile std::sig_atomic_t reload_requested = 0;

extern "C" void request_stop(int /*signal*/) { stop_requested = 1; }
extern "C" void request_reload(int /*signal*/) { reload_requested = 1; }

struct Options {
    std::string serial;
    std::string can;
    std::string cloud;
    std::string vehicle_file;
    std::string param_file;
    std::string airspace_file;
    std::string watchdog;
    std::string summary;
    double status_period = 1.0;
    int system_id = 0;
    int node_id = 0;
    int realtime = 0;
    bool quiet = false;
};

/// DEV[:BAUD]; a colon that is not followed by digits alone belongs to the device's name.
bool split_device(const std::string& text, std::string& device, std::uint32_t& baud)
{
    const std::size_t colon = text.rfind(':');
    const bool has_baud = colon != std::string::npos && colon + 1 < text.size() &&
                          text.find_first_not_of("0123456789", colon + 1) == std::string::npos;
    device = has_baud ? text.substr(0, colon) : text;
    baud = kDefaultBaud;
    if (has_baud) {
        const unsigned long value = std::strtoul(text.c_str() + colon + 1, nullptr, 10);
        if (value == 0 || value > 20'000'000UL) {
            return false;
        }
        baud = static_cast<std::uint32_t>(value);
    }
    return !device.empty();
}

void go_realtime(int priority)
{
    sched_param param{};
    param.sched_priority = priority;
    if (sched_setscheduler(0, SCHED_FIFO, &param) != 0 || mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        std::fprintf(stderr, "jinkd: no real-time priority: %s\n", std::strerror(errno));
    }
}

void sleep_until(std::int64_t us)
{
    timespec t{};
    t.tv_sec = us / 1'000'000;
    t.tv_nsec = us % 1'000'000 * 1000;
    // Woken early by a signal: the loop looks at the stop flag.
    static_cast<void>(clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr));
}

/// Sleeps until `us`; a cloud line is emptied a thousand times a second meanwhile: its driver holds little.
void wait_until(std::int64_t us, hal::SystemClock& clock, host::CloudLine* cloud)
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

/// Closing throws away what the driver has not sent yet, and the last words are the ones that matter.
void let_go_out(const hal::TermiosSerialPort& port, hal::SystemClock& clock)
{
    constexpr std::int64_t kLeast = 100'000;  // a pseudo-terminal does not tell, its reader needs a moment
    constexpr std::int64_t kMost = 1'000'000;
    const std::int64_t began = clock.now_us();
    for (std::int64_t now = began; now - began < kLeast || (port.unsent() > 0 && now - began < kMost);
         now = clock.now_us()) {
        sleep_until(now + kTickMicroseconds);
    }
}

const char* text_of(hal::OpenStatus status)
{
    switch (status) {
    case hal::OpenStatus::ok: return "open";
    case hal::OpenStatus::bad_path: return "not a usable path";
    case hal::OpenStatus::bad_baud: return "baud rate must be above zero";
    case hal::OpenStatus::no_device: return "no such device";
    case hal::OpenStatus::access_denied: return "no permission, or held by another program";
    case hal::OpenStatus::not_a_serial_device: return "not a serial device";
    case hal::OpenStatus::settings_refused: return "the driver does not take this baud rate";
    case hal::OpenStatus::failed: break;
    }
    return "cannot be opened";
}

const char* text_of(hal::CanOpenStatus status)
{
    switch (status) {
    case hal::CanOpenStatus::ok: return "open";
    case hal::CanOpenStatus::bad_name: return "not a name that an interface can have";
    case hal::CanOpenStatus::no_can: return "this kernel has no SocketCAN (AF_CAN); the modules are can and can-raw";
    case hal::CanOpenStatus::no_interface: return "no such interface";
    case hal::CanOpenStatus::not_can: return "not a CAN interface";
    case hal::CanOpenStatus::access_denied: return "no permission";
    case hal::CanOpenStatus::too_many_filters:
    case hal::CanOpenStatus::no_fd:
    case hal::CanOpenStatus::failed: break;
    }
    return "cannot be opened";
}

/// False, and said why, where time cannot mend it.
bool open_serial(hal::TermiosSerialPort& port, const std::string& device, std::uint32_t baud)
{
    const hal::OpenStatus opened = port.open(device, baud, kReconnectPeriod);
    const bool is_final = opened == hal::OpenStatus::bad_path || opened == hal::OpenStatus::bad_baud ||
                          opened == hal::OpenStatus::not_a_serial_device || opened == hal::OpenStatus::settings_refused;
    if (opened != hal::OpenStatus::ok) {
        std::fprintf(stderr, "jinkd: %s: %s%s\n", device.c_str(), text_of(opened), is_final ? "" : "; going on trying");
    }
    return !is_final;
}

/// The same for a CAN interface. One that is down is open, and waited for.
bool open_can(hal::SocketCanPort& port, const std::string& interface)
{
    const hal::CanOpenStatus opened = port.open(interface, {}, kReconnectPeriod);
    const bool is_final = opened != hal::CanOpenStatus::ok && port.health().state == hal::CanState::closed;
    if (opened != hal::CanOpenStatus::ok) {
        std::fprintf(stderr, "jinkd: %s: %s%s\n", interface.c_str(), text_of(opened),
                     is_final ? "" : "; going on trying");
    } else if (port.health().state == hal::CanState::down) {
        std::fprintf(stderr, "jinkd: %s: down; waiting until it is set up\n", interface.c_str());
    }
    return !is_final;
}

void complain(const files::Complaints& complaints)
{
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "jinkd: %s\n", files::to_string(complaint).c_str());
    }
}

/// False, and said why, where the file is not good: what was closed before stays so.
bool load_airspace(const std::string& file, hal::SystemClock& clock, app::Coprocessor& coprocessor)
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    const TimePoint now{clock.now_us()};
    const double unix_seconds = static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
    files::Complaints complaints;
    const auto constraints = files::read_airspace_file(file, {unix_seconds, now}, complaints);
    complain(complaints);
    if (constraints) {
        coprocessor.set_constraints(*constraints, now);
        std::fprintf(stderr, "jinkd: %s: %zu areas are closed\n", file.c_str(), constraints->size());
    }
    return constraints.has_value();
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
        std::fprintf(stderr, "jinkd: no /etc/machine-id: the node's unique id is another at each start\n");
    }
    return node;
}

int run(const Options& options, const app::Parameters& parameters, const std::string& device, std::uint32_t baud)
{
    hal::SystemClock clock;
    hal::TermiosSerialPort serial;
    hal::SocketCanPort can;
    std::optional<app::CanBus> bus;
    hal::LinuxWatchdog watchdog;
    if (!device.empty() && !open_serial(serial, device, baud)) {
        return EXIT_FAILURE;
    }
    if (!options.can.empty()) {
        if (!open_can(can, options.can)) {
            return EXIT_FAILURE;
        }
        bus.emplace(can, node_options(options));
    }
    hal::SerialPort& port = device.empty() ? bus->serial() : serial;
    constexpr int kWatchdogSeconds = 5;
    if (!options.watchdog.empty() &&
        watchdog.open_device(options.watchdog, kWatchdogSeconds) != hal::WatchdogStatus::ok) {
        std::fprintf(stderr, "jinkd: watchdog %s cannot be used\n", options.watchdog.c_str());
        return EXIT_FAILURE;
    }
    if (const char* address = std::getenv("NOTIFY_SOCKET"); address != nullptr) {
        if (watchdog.open_notify(address) != hal::WatchdogStatus::ok || !watchdog.notify_ready()) {
            std::fprintf(stderr, "jinkd: the service manager's socket cannot be used\n");
        }
    }

    hal::TermiosSerialPort cloud_port;
    std::optional<host::CloudLine> cloud_line;
    if (!options.cloud.empty()) {
        std::string cloud_device;
        std::uint32_t cloud_baud = 0;
        if (!split_device(options.cloud, cloud_device, cloud_baud)) {
            std::fprintf(stderr, "jinkd: --cloud %s: expected DEV[:BAUD]\n", options.cloud.c_str());
            return EXIT_FAILURE;
        }
        if (!open_serial(cloud_port, cloud_device, cloud_baud)) {
            return EXIT_FAILURE;
        }
        cloud_line.emplace(cloud_port);
    }
    // Single points of the link count without a port too.
    const auto clouds = std::make_unique<app::CloudInput>(cloud_line ? &*cloud_line : nullptr);

    link::mavlink::EndpointOptions link_options;
    link_options.system_id = static_cast<std::uint8_t>(options.system_id);
    link::mavlink::Endpoint endpoint(link_options);
    const auto coprocessor =
        std::make_unique<app::Coprocessor>(endpoint, port, watchdog, parameters, bus ? &*bus : nullptr);
    coprocessor->use_clouds(*clouds);
    const auto picture = std::make_unique<app::ReachPicture>(app::reach_sets());
    if (cloud_line) {
        coprocessor->let_reach_sets_see(*picture);
    }
    if (reach::check(app::reach_sets()) != reach::SetStatus::good) {
        std::fprintf(stderr, "jinkd: the reach sets are damaged and left out\n");
        coprocessor->leave_out_reach_sets();
    }
    if (!options.airspace_file.empty() && !load_airspace(options.airspace_file, clock, *coprocessor)) {
        return EXIT_FAILURE;
    }
    host::StatusLog log(options.quiet ? 0.0 : options.status_period);
    const host::Watched watched{*coprocessor, endpoint, port, bus ? &*bus : nullptr, *clouds};

    std::int64_t next = clock.now_us();
    while (stop_requested == 0) {
        const std::int64_t began = clock.now_us();
        serial.service(began);
        can.service(began);
        cloud_port.service(began);
        if (reload_requested != 0) {
            reload_requested = 0;
            static_cast<void>(load_airspace(options.airspace_file, clock, *coprocessor));
        }
        const app::StepReport report = coprocessor->step({began});
        log.note(report, watched, began, clock.now_us() - began);
        next += kTickMicroseconds;
        const std::int64_t now = clock.now_us();
        if (next < now) {
            next = now;  // late: do not try to catch up by a burst of steps
        }
        wait_until(next, clock, cloud_line ? &*cloud_line : nullptr);
    }
    coprocessor->shut_down({clock.now_us()});
    let_go_out(serial, clock);
    watchdog.close();
    serial.close();
    if (!options.quiet) {
        std::fprintf(stderr, "jinkd: stopped\n");
    }
    if (!options.summary.empty() && !log.write_summary(options.summary, watched)) {
        std::fprintf(stderr, "jinkd: %s cannot be written\n", options.summary.c_str());
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
    CLI::Option* const serial =
        cli.add_option("--serial", options.serial, "device and baud rate, DEV[:BAUD]; 921600 where none is given");
    CLI::Option* const can = cli.add_option("--can", options.can,
                                            "CAN interface with a DroneCAN bus; without --serial MAVLink goes through "
                                            "it. Its bit rate and queue are set by\n"
                                            "the system, not here: ip link set can0 type can bitrate 1000000 "
                                            "restart-ms 100; ip link set can0 txqueuelen 128 up");
    cli.add_option("--node-id", options.node_id, "DroneCAN node id, 1 to 127; 0: asks the bus for one")
        ->check(CLI::Range(0, 127))
        ->needs(can);
    cli.add_option("--cloud", options.cloud,
                   "device and baud rate, DEV[:BAUD], on which a LiDAR's driver sends point clouds in compact frames");
    cli.add_option("--vehicle", options.vehicle_file, "vehicle file (YAML): limits, airframe, cost caps");
    cli.add_option("--params", options.param_file, "parameter file, NAME,VALUE per line; wins over the vehicle file");
    cli.add_option("--airspace", options.airspace_file,
                   "airspace file (YAML): closed areas and storm cells; read anew on SIGHUP");
    cli.add_option("--system-id", options.system_id, "MAVLink system to serve; 0: the first autopilot heard")
        ->check(CLI::Range(0, 255));
    cli.add_option("--status-period", options.status_period, "seconds between status lines; 0: none")
        ->check(CLI::Range(0.0, 3600.0));
    cli.add_option("--summary", options.summary, "write counters and step times to this file (JSON) at the end");
    cli.add_option("--watchdog", options.watchdog, "watchdog device to feed, e.g. /dev/watchdog0");
    cli.add_option("--realtime", options.realtime, "SCHED_FIFO priority and locked memory; 0: off")
        ->check(CLI::Range(0, 99));
    cli.add_flag("--quiet", options.quiet, "errors only");
    CLI11_PARSE(cli, argc, argv);

    if (serial->empty() && can->empty()) {
        std::fprintf(stderr, "jinkd: --serial or --can is needed\n");
        return EXIT_FAILURE;
    }
    std::string device;
    std::uint32_t baud = 0;
    if (!can->empty() && options.can.empty()) {
        std::fprintf(stderr, "jinkd: --can: the name of an interface is needed\n");
        return EXIT_FAILURE;
    }
    if (!serial->empty() && !split_device(options.serial, device, baud)) {
        std::fprintf(stderr, "jinkd: --serial %s: expected DEV[:BAUD]\n", options.serial.c_str());
        return EXIT_FAILURE;
    }
    files::Complaints complaints;
    const auto parameters = files::load_parameters(options.vehicle_file, options.param_file, complaints);
    complain(complaints);
    if (!parameters) {
        return EXIT_FAILURE;
    }
    struct sigaction action {};
    action.sa_handler = request_stop;
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
    if (!options.airspace_file.empty()) {
        action.sa_handler = request_reload;
        sigaction(SIGHUP, &action, nullptr);
    }
    if (options.realtime > 0) {
        go_realtime(options.realtime);
    }
    return run(options, *parameters, device, baud);
}
