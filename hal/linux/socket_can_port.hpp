// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/can_port.hpp"

namespace jink::hal {

/// Longest name of a network interface, terminator included (the kernel's IFNAMSIZ).
inline constexpr std::size_t kMaxInterfaceName = 16;
/// Filters of one port; further ones are refused.
inline constexpr std::size_t kMaxCanFilters = 16;

/// A frame passes if `(frame.id ^ id) & mask` is zero and its id has the length given by `extended`.
struct CanFilter {
    std::uint32_t id = 0;
    std::uint32_t mask = 0;
    bool extended = true;
};

/// Result of opening an interface; zero is success.
enum class CanOpenStatus : std::uint8_t {
    ok,
    bad_name,          ///< empty, or kMaxInterfaceName or more characters
    too_many_filters,  ///< more than kMaxCanFilters
    no_can,            ///< this kernel has no SocketCAN
    no_interface,      ///< no interface of that name
    not_can,           ///< not a CAN controller
    no_fd,             ///< FD was requested, but the interface does not support it
    access_denied,
    failed,  ///< any other error of the system
};

struct SocketCanOptions {
    bool fd = false;                       ///< FD frames too; the interface must be configured for them (its MTU is 72)
    std::span<const CanFilter> filters{};  ///< none: all frames pass
    int receive_buffer = 0;                ///< bytes, in the kernel's count; 0: the system's default
};

/// CAN controller of Linux (SocketCAN, raw protocol). The system sets bit rate and restart time.
///
/// An interface that goes down keeps its socket and works again when it is up. An interface that is deleted is reopened
/// by service() when one of the same name appears. Frames dropped by the kernel for lack of space are counted exactly
/// (SO_RXQ_OVFL). Error frames of the controller become counters and the state, never frames.
///
/// Not thread-safe. Allocation-free; about 400 bytes.
class SocketCanPort final : public CanPort {
public:
    SocketCanPort() noexcept = default;
    ~SocketCanPort();
    SocketCanPort(const SocketCanPort&) = delete;
    SocketCanPort& operator=(const SocketCanPort&) = delete;

    /// Opens an interface by name; closes the previous one. After bad_name, too_many_filters, no_can, not_can and no_fd
    /// the port is closed; after any other failure it is `down`, and service() keeps trying.
    [[nodiscard]] CanOpenStatus open(std::string_view interface, const SocketCanOptions& options,
                                     std::int64_t retry_period_us) noexcept;
    void close() noexcept;

    /// Detects interfaces that appear or disappear. Call once per tick. O(1) system calls.
    void service(std::int64_t now_us) noexcept;

    /// Processes at most kErrorFramesPerCall error frames before the next data frame.
    [[nodiscard]] bool receive(CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const CanFrame& frame) noexcept override;
    [[nodiscard]] CanHealth health() const noexcept override { return health_; }

    /// For poll() and similar calls; -1 when not open. Changes whenever the port is reopened.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    [[nodiscard]] CanOpenStatus open_status() const noexcept { return open_status_; }

    static constexpr int kErrorFramesPerCall = 64;

private:
    enum class Read : std::uint8_t { nothing, data, error };

    [[nodiscard]] CanOpenStatus try_open() noexcept;
    [[nodiscard]] CanOpenStatus configure(int index) noexcept;
    [[nodiscard]] Read read_one(CanFrame& frame) noexcept;
    void note_error_frame(std::uint32_t id, const std::uint8_t* data) noexcept;
    void note_error(int error) noexcept;
    void become(CanState state) noexcept;
    void release() noexcept;

    std::array<char, kMaxInterfaceName> name_{};
    std::array<CanFilter, kMaxCanFilters> filters_{};
    std::size_t filter_count_ = 0;
    bool fd_ = false;
    int receive_buffer_ = 0;
    std::int64_t retry_period_us_ = 0;
    std::int64_t next_attempt_us_ = 0;
    std::uint32_t dropped_ = 0;  ///< the kernel's last count
    int descriptor_ = -1;
    CanOpenStatus open_status_ = CanOpenStatus::ok;
    CanHealth health_{};
};

}  // namespace jink::hal
