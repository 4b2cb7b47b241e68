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
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/complaint.hpp"
#include "firmware/linux/param_file.hpp"
#include "firmware/linux/status.hpp"
#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/system_clock.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace {

using namespace jink;

constexpr std::int64_t kTickMicroseconds = 20'000;
constexpr std::int64_t kReconnectPeriod = 500'000;
constexpr std::uint32_t kDefaultBaud = 921600;

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int /*signal*/) { stop_requested = 1; }

struct Options {
    std::string serial;
    std::string vehicle_file;
    std::string param_file;
    std::string watchdog;
    std::string summary;
    double status_period = 1.0;
    int system_id = 0;
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

int run(const Options& options, const app::Parameters& parameters, const std::string& device, std::uint32_t baud)
{
    hal::SystemClock clock;
    hal::TermiosSerialPort port;
    hal::LinuxWatchdog watchdog;
    const hal::OpenStatus opened = port.open(device, baud, kReconnectPeriod);
    if (opened == hal::OpenStatus::bad_path || opened == hal::OpenStatus::bad_baud ||
        opened == hal::OpenStatus::not_a_serial_device || opened == hal::OpenStatus::settings_refused) {
        std::fprintf(stderr, "jinkd: %s: %s\n", device.c_str(), text_of(opened));
        return EXIT_FAILURE;
    }
    if (opened != hal::OpenStatus::ok) {
        std::fprintf(stderr, "jinkd: %s: %s; going on trying\n", device.c_str(), text_of(opened));
    }
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

    link::mavlink::EndpointOptions link_options;
    link_options.system_id = static_cast<std::uint8_t>(options.system_id);
    link::mavlink::Endpoint endpoint(link_options);
    const auto coprocessor = std::make_unique<app::Coprocessor>(endpoint, port, watchdog, parameters);
    host::StatusLog log(options.quiet ? 0.0 : options.status_period);

    std::int64_t next = clock.now_us();
    while (stop_requested == 0) {
        const std::int64_t began = clock.now_us();
        port.service(began);
        const app::StepReport report = coprocessor->step({began});
        log.note(report, *coprocessor, endpoint, port.health(), began, clock.now_us() - began);
        next += kTickMicroseconds;
        const std::int64_t now = clock.now_us();
        if (next < now) {
            next = now;  // late: do not try to catch up by a burst of steps
        }
        sleep_until(next);
    }
    coprocessor->shut_down({clock.now_us()});
    let_go_out(port, clock);
    watchdog.close();
    port.close();
    if (!options.quiet) {
        std::fprintf(stderr, "jinkd: stopped\n");
    }
    if (!options.summary.empty() && !log.write_summary(options.summary, *coprocessor, endpoint, port.health())) {
        std::fprintf(stderr, "jinkd: %s cannot be written\n", options.summary.c_str());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App cli{"jinkd: collision avoidance beside a PX4 or ArduPilot autopilot, over MAVLink on a serial line.\n"
                 "Runs until SIGTERM or SIGINT."};
    cli.add_option("--serial", options.serial, "device and baud rate, DEV[:BAUD]; 921600 where none is given")
        ->required();
    cli.add_option("--vehicle", options.vehicle_file, "vehicle file (YAML): limits, airframe, cost caps");
    cli.add_option("--params", options.param_file, "parameter file, NAME,VALUE per line; wins over the vehicle file");
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

    std::string device;
    std::uint32_t baud = 0;
    if (!split_device(options.serial, device, baud)) {
        std::fprintf(stderr, "jinkd: --serial %s: expected DEV[:BAUD]\n", options.serial.c_str());
        return EXIT_FAILURE;
    }
    files::Complaints complaints;
    const auto parameters = files::load_parameters(options.vehicle_file, options.param_file, complaints);
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "jinkd: %s\n", files::to_string(complaint).c_str());
    }
    if (!parameters) {
        return EXIT_FAILURE;
    }
    struct sigaction action {};
    action.sa_handler = request_stop;
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
    if (options.realtime > 0) {
        go_realtime(options.realtime);
    }
    return run(options, *parameters, device, baud);
}
