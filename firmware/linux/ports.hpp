// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace jink::host {

/// Splits DEV[:BAUD]; a colon that is not followed by digits alone belongs to the device's name.
[[nodiscard]] bool split_device(const std::string& text, std::string& device, std::uint32_t& baud);

/// Opens a serial device. False, with a message, if retrying cannot help.
[[nodiscard]] bool open_serial(hal::TermiosSerialPort& port, const std::string& device, std::uint32_t baud);
/// The same for a CAN interface. An interface that is down counts as open, and is waited for.
[[nodiscard]] bool open_can(hal::SocketCanPort& port, const std::string& interface);
/// Opens the watchdogs, `device` and the service manager; false, with a message, if the device cannot be used.
[[nodiscard]] bool open_watchdog(hal::LinuxWatchdog& watchdog, const std::string& device);

}  // namespace jink::host
