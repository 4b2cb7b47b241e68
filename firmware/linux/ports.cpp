// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/ports.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include <arpa/inet.h>

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

const char* text_of(hal::NetworkStatus status)
{
    switch (status) {
    case hal::NetworkStatus::ok: return "open";
    case hal::NetworkStatus::bad_address: return "neither an IPv4 nor an IPv6 address";
    case hal::NetworkStatus::in_use: return "another program uses this address";
    case hal::NetworkStatus::not_here: return "no interface has this address, or no way leads to it";
    case hal::NetworkStatus::nobody: return "nobody listens there";
    case hal::NetworkStatus::access_denied: return "no permission";
    case hal::NetworkStatus::failed: break;
    }
    return "cannot be opened";
}

struct Scheme {
    std::string_view name;
    hal::NetworkKind kind;
    bool serial;
};
constexpr std::array<Scheme, 4> kSchemes{{{"udp:", hal::NetworkKind::udp_listen, false},
                                          {"udpout:", hal::NetworkKind::udp_send, false},
                                          {"tcp:", hal::NetworkKind::tcp, false},
                                          {"serial:", hal::NetworkKind::udp_listen, true}}};
constexpr const char* kForms =
    "expected udp:[ADDRESS:]PORT, udpout:ADDRESS:PORT, tcp:ADDRESS:PORT or serial:DEV[:BAUD]";

const Scheme* scheme_of(std::string_view text)
{
    const auto* found =
        std::find_if(kSchemes.begin(), kSchemes.end(), [&](const Scheme& s) { return text.starts_with(s.name); });
    return found != kSchemes.end() ? &*found : nullptr;
}

/// Splits [ADDRESS:]PORT into `link`, whose kind is set. False, and the reason in `fault`, where it is none.
bool split_address(std::string_view text, LinkName& link, std::string& fault)
{
    const std::size_t colon = text.rfind(':');
    const std::string_view number = colon == std::string_view::npos ? text : text.substr(colon + 1);
    std::string_view address = colon == std::string_view::npos ? "" : text.substr(0, colon);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), link.port);
    if (error != std::errc() || end != number.data() + number.size() || link.port == 0) {
        fault = "the port has to be a number from 1 to 65535";
        return false;
    }
    if (address.starts_with('[') && address.ends_with(']')) {
        address = address.substr(1, address.size() - 2);
    } else if (address.find(':') != std::string_view::npos) {
        fault = "an IPv6 address has to stand in brackets";
        return false;
    }
    if (address.empty() && (colon != std::string_view::npos || link.kind != hal::NetworkKind::udp_listen)) {
        fault = "an address is missing";
        return false;
    }
    link.where = address.empty() || address == "localhost" ? "127.0.0.1" : std::string(address);
    return true;
}

/// False where the text is no address of numbers.
bool to_address(const LinkName& link, hal::NetworkAddress& out)
{
    sockaddr_in v4{};
    sockaddr_in6 v6{};
    if (::inet_pton(AF_INET, link.where.c_str(), &v4.sin_addr) == 1) {
        v4.sin_family = AF_INET;
        v4.sin_port = htons(link.port);
        std::memcpy(&out.storage, &v4, sizeof v4);
        out.length = sizeof v4;
        return true;
    }
    if (::inet_pton(AF_INET6, link.where.c_str(), &v6.sin6_addr) == 1) {
        v6.sin6_family = AF_INET6;
        v6.sin6_port = htons(link.port);
        std::memcpy(&out.storage, &v6, sizeof v6);
        out.length = sizeof v6;
        return true;
    }
    return false;
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

bool is_link(std::string_view text) { return scheme_of(text) != nullptr; }

std::optional<LinkName> split_link(std::string_view text, std::string& fault)
{
    const Scheme* const scheme = scheme_of(text);
    if (scheme == nullptr) {
        fault = kForms;
        return std::nullopt;
    }
    text.remove_prefix(scheme->name.size());
    LinkName link{scheme->serial, scheme->kind, std::string(text), 0};
    if (!link.serial && !split_address(text, link, fault)) {
        fault += "; " + std::string(kForms);
        return std::nullopt;
    }
    return link;
}

std::optional<hal::NetworkAddress> listening_address(std::string_view text, std::string& fault)
{
    constexpr const char* kForm = "; expected [ADDRESS:]PORT";
    LinkName link{false, hal::NetworkKind::udp_listen, {}, 0};
    hal::NetworkAddress address;
    if (!split_address(text, link, fault)) {
        fault += kForm;
        return std::nullopt;
    }
    if (!to_address(link, address)) {
        fault = link.where + " is no address of numbers, as 127.0.0.1 or [::1]" + kForm;
        return std::nullopt;
    }
    return address;
}

bool AutopilotLine::open_device(const std::string& text)
{
    std::string device;
    std::uint32_t baud = 0;
    if (!split_device(text, device, baud)) {
        complain_now("--serial " + text + ": expected DEV[:BAUD]");
        return false;
    }
    return open_serial(serial_, device, baud);
}

bool AutopilotLine::open_link(const std::string& text)
{
    std::string fault;
    const std::optional<LinkName> link = split_link(text, fault);
    if (!link) {
        complain_now("--link " + text + ": " + fault);
        return false;
    }
    if (link->serial) {
        return open_device(link->where);
    }
    hal::NetworkAddress address;
    if (!to_address(*link, address)) {
        complain_now("--link " + text + ": " + link->where + " is no address of numbers, as 127.0.0.1 or [::1]");
        return false;
    }
    on_network_ = true;
    const hal::NetworkStatus opened = network_.open(link->kind, address, kReconnectPeriod);
    if (opened != hal::NetworkStatus::ok) {
        complain_now(text + ": " + text_of(opened) + "; going on trying");
    }
    return true;
}

void AutopilotLine::close() noexcept
{
    serial_.close();
    network_.close();
}

void AutopilotLine::service(std::int64_t now_us) noexcept
{
    if (on_network_) {
        network_.service(now_us);
    } else {
        serial_.service(now_us);
    }
}

hal::SerialPort& AutopilotLine::port() noexcept
{
    return on_network_ ? static_cast<hal::SerialPort&>(network_) : serial_;
}

std::size_t AutopilotLine::unsent() const noexcept { return on_network_ ? network_.unsent() : serial_.unsent(); }

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
        static_cast<void>(watchdog.open_notify(address));  // notify_ready says it
    }
    return true;
}

void notify_ready(hal::LinuxWatchdog& watchdog)
{
    if (std::getenv("NOTIFY_SOCKET") != nullptr && !watchdog.notify_ready()) {
        complain_now("the service manager's socket cannot be used");
    }
}

}  // namespace jink::host
