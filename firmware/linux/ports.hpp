// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "hal/linux/linux_watchdog.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "hal/linux/termios_serial_port.hpp"

namespace jink::host {

/// DEV[:BAUD]; a colon that is not followed by digits alone belongs to the device's name.
[[nodiscard]] bool split_device(const std::string& text, std::string& device, std::uint32_t& baud);

/// False, and said why, where time cannot mend it.
[[nodiscard]] bool open_serial(hal::TermiosSerialPort& port, const std::string& device, std::uint32_t baud);
/// The same for a CAN interface. One that is down is open, and waited for.
[[nodiscard]] bool open_can(hal::SocketCanPort& port, const std::string& interface);
/// Opens what is to be fed, `device` and the service manager; false, and said why, where the device cannot be used.
[[nodiscard]] bool open_watchdog(hal::LinuxWatchdog& watchdog, const std::string& device);

}  // namespace jink::host
