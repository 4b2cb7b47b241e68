// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/ports.hpp"

#include <cstdlib>

#include "firmware/linux/background.hpp"

namespace jink::host {
namespace {

constexpr std::int64_t kReconnectPeriod = 500'000;
constexpr std::uint32_t kDefaultBaud = 921600;

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

}  // namespace

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

bool open_serial(hal::TermiosSerialPort& port, const std::string& device, std::uint32_t baud)
{
    const hal::OpenStatus opened = port.open(device, baud, kReconnectPeriod);
    const bool is_final = opened == hal::OpenStatus::bad_path || opened == hal::OpenStatus::bad_baud ||
                          opened == hal::OpenStatus::not_a_serial_device || opened == hal::OpenStatus::settings_refused;
    if (opened != hal::OpenStatus::ok) {
        complain_now(device + ": " + text_of(opened) + (is_final ? "" : "; going on trying"));
    }
    return !is_final;
}

bool open_can(hal::SocketCanPort& port, const std::string& interface)
{
    const hal::CanOpenStatus opened = port.open(interface, {}, kReconnectPeriod);
    const bool is_final = opened != hal::CanOpenStatus::ok && port.health().state == hal::CanState::closed;
    if (opened != hal::CanOpenStatus::ok) {
        complain_now(interface + ": " + text_of(opened) + (is_final ? "" : "; going on trying"));
    } else if (port.health().state == hal::CanState::down) {
        complain_now(interface + ": down; waiting until it is set up");
    }
    return !is_final;
}

bool open_watchdog(hal::LinuxWatchdog& watchdog, const std::string& device)
{
    constexpr int kWatchdogSeconds = 5;
    if (!device.empty() && watchdog.open_device(device, kWatchdogSeconds) != hal::WatchdogStatus::ok) {
        complain_now("watchdog " + device + " cannot be used");
        return false;
    }
    if (const char* address = std::getenv("NOTIFY_SOCKET"); address != nullptr) {
        if (watchdog.open_notify(address) != hal::WatchdogStatus::ok || !watchdog.notify_ready()) {
            complain_now("the service manager's socket cannot be used");
        }
    }
    return true;
}

}  // namespace jink::host
