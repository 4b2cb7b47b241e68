// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/watchdog.hpp"

namespace jink::hal {

/// Result of opening a watchdog; zero is success.
enum class WatchdogStatus : std::uint8_t {
    ok,
    bad_path,         ///< empty, too long, or (notify) neither a path nor an abstract name
    no_device,        ///< no such node, or no device behind the node
    busy,             ///< held by another program
    timeout_refused,  ///< the driver refuses the timeout; it has been disarmed again
    failed,           ///< any other error of the system
};

/// Watchdogs fed on Linux: the kernel's watchdog device, the service manager, both or neither.
///
/// The device resets the machine. The service manager restarts the program: the protocol is one datagram "WATCHDOG=1"
/// to the socket named in $NOTIFY_SOCKET (sd_notify(3)), in a unit with Type=notify and WatchdogSec.
class LinuxWatchdog final : public Watchdog {
public:
    struct Counters {
        std::uint64_t feeds = 0;
        std::uint64_t device_errors = 0;  ///< feeds that the device refused
        std::uint64_t notify_errors = 0;  ///< datagrams that could not be sent
    };

    LinuxWatchdog() noexcept = default;
    ~LinuxWatchdog();
    LinuxWatchdog(const LinuxWatchdog&) = delete;
    LinuxWatchdog& operator=(const LinuxWatchdog&) = delete;

    /// Opens and thereby arms a device such as /dev/watchdog0.
    /// @param timeout_s  time until it acts [s], > 0; the driver may round the time, see `device_timeout_s()`
    [[nodiscard]] WatchdogStatus open_device(std::string_view path, int timeout_s) noexcept;

    /// @param address  value of $NOTIFY_SOCKET: a path, or '@' and an abstract name
    [[nodiscard]] WatchdogStatus open_notify(std::string_view address) noexcept;

    /// Reports the end of start-up to the service manager. False if that failed.
    [[nodiscard]] bool notify_ready() noexcept { return notify("READY=1"); }

    void feed() noexcept override;

    /// Orderly end: disarms the device (if the kernel permits it) and closes both outlets.
    void close() noexcept;

    [[nodiscard]] Counters counters() const noexcept { return counters_; }
    [[nodiscard]] int device_timeout_s() const noexcept { return device_timeout_s_; }

private:
    static constexpr std::size_t kMaxPath = 108;  // sockaddr_un::sun_path

    [[nodiscard]] bool notify(std::string_view message) noexcept;
    void close_device() noexcept;
    void close_notify() noexcept;

    int device_ = -1;
    int device_timeout_s_ = 0;
    int notify_socket_ = -1;
    std::array<char, kMaxPath> notify_address_{};
    std::size_t notify_address_size_ = 0;
    Counters counters_{};
};

}  // namespace jink::hal
