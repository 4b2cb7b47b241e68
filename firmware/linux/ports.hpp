// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/network_port.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace jink::host {

/// Splits DEV[:BAUD]; a colon that is not followed by digits alone belongs to the device's name.
[[nodiscard]] bool split_device(const std::string& text, std::string& device, std::uint32_t& baud);

/// A link of the command line: udp:[ADDRESS:]PORT, udpout:ADDRESS:PORT, tcp:ADDRESS:PORT or serial:DEV[:BAUD]. ADDRESS
/// is localhost, an IPv4 address or an IPv6 address in brackets; without one localhost. No other names: looking them up
/// may take long, and what the line leads to would hang on it.
struct LinkName {
    bool serial = false;
    hal::NetworkKind kind = hal::NetworkKind::udp_listen;
    std::string where;  ///< address, or DEV[:BAUD]
    std::uint16_t port = 0;
};
/// The link that a text names; empty, and the reason in `fault`, where it names none.
[[nodiscard]] std::optional<LinkName> split_link(std::string_view text, std::string& fault);
/// Whether a text is a link's and no device's: it begins with a scheme of split_link.
[[nodiscard]] bool is_link(std::string_view text);

/// The address that [ADDRESS:]PORT names, with addresses as in LinkName; empty, and the reason in `fault`, where it
/// names none.
[[nodiscard]] std::optional<hal::NetworkAddress> listening_address(std::string_view text, std::string& fault);

/// The line to the autopilot: a serial device, or a network.
class AutopilotLine {
public:
    /// Opens DEV[:BAUD]. False, with a message, if retrying cannot help.
    [[nodiscard]] bool open_device(const std::string& text);
    /// Opens a link of split_link. False, with a message, if retrying cannot help.
    [[nodiscard]] bool open_link(const std::string& text);
    void close() noexcept;
    /// Once per tick.
    void service(std::int64_t now_us) noexcept;
    [[nodiscard]] hal::SerialPort& port() noexcept;
    [[nodiscard]] std::size_t unsent() const noexcept;

private:
    bool on_network_ = false;
    hal::TermiosSerialPort serial_;
    hal::NetworkPort network_;
};

/// Opens a serial device. False, with a message, if retrying cannot help.
[[nodiscard]] bool open_serial(hal::TermiosSerialPort& port, const std::string& device, std::uint32_t baud);
/// The same for a CAN interface. An interface that is down counts as open, and is waited for.
[[nodiscard]] bool open_can(hal::SocketCanPort& port, const std::string& interface);
/// Opens the watchdogs, `device` and the service manager; false, with a message, if the device cannot be used.
[[nodiscard]] bool open_watchdog(hal::LinuxWatchdog& watchdog, const std::string& device);
/// Tells the service manager, if there is one, that nothing can refuse any more; says so if that fails.
void notify_ready(hal::LinuxWatchdog& watchdog);

}  // namespace jink::host
