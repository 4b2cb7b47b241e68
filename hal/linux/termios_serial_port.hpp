// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/serial_port.hpp"

namespace jink::hal {

/// Longest device path, terminator included. By-id links of USB adapters stay below 160.
inline constexpr std::size_t kMaxDevicePath = 256;

/// Result of opening a device; zero is success.
enum class OpenStatus : std::uint8_t {
    ok,
    bad_path,             ///< empty, or kMaxDevicePath or more characters
    bad_baud,             ///< zero
    no_device,            ///< no such node, or no device behind the node
    access_denied,        ///< permissions, or held by another program
    not_a_serial_device,  ///< exists, but is not a terminal
    settings_refused,     ///< the driver does not support 8N1 at this rate
    failed,               ///< any other error of the system
};

/// Serial device or pty of Linux: raw, 8 data bits, no parity, 1 stop bit, no flow control, any baud rate.
///
/// While open the device node is locked by flock(): a second port, and any program that asks for the lock, does not
/// open it.
///
/// A device that vanishes (unplugged, other end of a pty closed) makes the port `lost`. `service()` then tries to open
/// the same path again, first at once and then once per retry period, until it succeeds or `close()` is called. Bytes
/// that the kernel still held at that instant, in either direction, are lost and not counted.
///
/// Not thread-safe. Allocation-free; about 400 bytes.
class TermiosSerialPort final : public SerialPort {
public:
    TermiosSerialPort() noexcept = default;
    ~TermiosSerialPort();
    TermiosSerialPort(const TermiosSerialPort&) = delete;
    TermiosSerialPort& operator=(const TermiosSerialPort&) = delete;

    /// Opens a device; closes the previous one.
    ///
    /// @param path             device or symbolic link to one, resolved again at each attempt
    /// @param baud             both directions [bit/s], > 0; refused when the driver is more than 2.5 % off
    /// @param retry_period_us  between attempts to open a lost device [us], > 0
    /// @return ok or the cause. After bad_path and bad_baud the port is closed; after any other failure it is `lost`,
    ///         and
    ///         `service()` keeps trying.
    [[nodiscard]] OpenStatus open(std::string_view path, std::uint32_t baud, std::int64_t retry_period_us) noexcept;

    /// Closes for good. Unsent bytes are discarded: waiting for them could block.
    void close() noexcept;

    /// Detects a lost device, reads the driver's error counters, tries to reopen. Call once per tick.
    /// O(1) system calls; opening a device takes the driver's time (microseconds to few milliseconds).
    void service(std::int64_t now_us) noexcept;

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
    [[nodiscard]] PortHealth health() const noexcept override { return health_; }

    /// Bytes accepted by write() that the driver still holds; 0 when not open, and always on a pseudo-terminal.
    [[nodiscard]] std::size_t unsent() const noexcept;

    /// For poll() and similar calls; -1 when not open. Changes with every reconnect.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Outcome of the latest attempt to open, first or repeated.
    [[nodiscard]] OpenStatus open_status() const noexcept { return open_status_; }
    /// The driver's actual rate [bit/s]; 0 before the first success.
    [[nodiscard]] std::uint32_t actual_baud() const noexcept { return actual_baud_; }

private:
    struct LineCounts {
        std::uint32_t overruns = 0;
        std::uint32_t errors = 0;
    };

    [[nodiscard]] OpenStatus try_open() noexcept;
    [[nodiscard]] OpenStatus configure() noexcept;
    [[nodiscard]] bool line_counts(LineCounts& counts) const noexcept;
    void count_line_errors() noexcept;
    void release() noexcept;
    void lose() noexcept;

    std::array<char, kMaxDevicePath> path_{};
    std::uint32_t baud_ = 0;
    std::uint32_t actual_baud_ = 0;
    std::int64_t retry_period_us_ = 0;
    std::int64_t next_attempt_us_ = 0;
    bool attempt_at_once_ = false;
    bool has_line_counts_ = false;
    LineCounts line_counts_{};
    int descriptor_ = -1;
    OpenStatus open_status_ = OpenStatus::ok;
    PortHealth health_{};
};

}  // namespace jink::hal
