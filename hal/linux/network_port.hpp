// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <sys/socket.h>

#include "hal/serial_port.hpp"

namespace jink::hal {

/// An address and port of IPv4 or IPv6, as the system has them.
struct NetworkAddress {
    sockaddr_storage storage{};
    socklen_t length = 0;
};

[[nodiscard]] bool operator==(const NetworkAddress& a, const NetworkAddress& b) noexcept;

enum class NetworkKind : std::uint8_t {
    udp_listen,  ///< UDP: waits at an own address for the other side's first datagram, and answers there
    udp_send,    ///< UDP: sends to an address, and hears it alone
    tcp,         ///< TCP: connects to an address
};

/// Result of opening; zero is success.
enum class NetworkStatus : std::uint8_t {
    ok,             ///< for TCP: open or connecting
    bad_address,    ///< neither IPv4 nor IPv6
    in_use,         ///< another program listens at this address
    not_here,       ///< no interface of this machine has the address, or no way leads to it
    nobody,         ///< nobody listens there
    access_denied,  ///< permissions
    failed,         ///< any other error of the system
};

/// A stream of bytes over UDP or TCP, in place of a serial line.
///
/// UDP to listen: the port is `lost` until a datagram comes; its sender is the other side from then on. Datagrams of
/// anyone else are dropped and counted as line errors, until nothing was heard of the other side for kPeerSilence: then
/// the next sender is the other side (a reconnect). What is sent goes in datagrams of kSentAtOnce bytes at most,
/// without regard to frames; what no one receives is lost, as on a wire. TCP: a connection that ends, or whose data
/// nobody acknowledges for kPeerSilence, is made anew each retry period.
///
/// Nothing here blocks. Not thread-safe. Allocation-free; about 64 KiB, the largest datagram.
class NetworkPort final : public SerialPort {
public:
    static constexpr std::int64_t kPeerSilence = 5'000'000;  ///< [us]
    static constexpr std::size_t kSentAtOnce = 1400;         ///< below the payload of an Ethernet frame [bytes]
    /// Datagrams that one read() or service() takes from the system, dropped ones included.
    static constexpr int kDatagramsPerCall = 256;

    NetworkPort() noexcept = default;
    ~NetworkPort();
    NetworkPort(const NetworkPort&) = delete;
    NetworkPort& operator=(const NetworkPort&) = delete;

    /// Opens; closes what was open before.
    ///
    /// @param retry_period_us  between attempts to open again [us], > 0
    /// @return ok or the cause. After bad_address the port is closed; after any other failure it is `lost`, and
    ///         `service()` keeps trying.
    [[nodiscard]] NetworkStatus open(NetworkKind kind, const NetworkAddress& address,
                                     std::int64_t retry_period_us) noexcept;
    void close() noexcept;

    /// Takes note of the time, completes and repeats connections, hears who is there. Call once per tick. O(1) system
    /// calls but for datagrams of others.
    void service(std::int64_t now_us) noexcept;

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
    [[nodiscard]] PortHealth health() const noexcept override { return health_; }

    /// Bytes accepted by write() that the system still holds; 0 when not open.
    [[nodiscard]] std::size_t unsent() const noexcept;
    /// For poll() and similar calls; -1 when there is none. Changes with every attempt.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Where it listens or sends from; a length of 0 when not open.
    [[nodiscard]] NetworkAddress local_address() const noexcept;

private:
    static constexpr std::size_t kMaxDatagram = 65536;
    static constexpr std::int64_t kNotYet = -1;

    [[nodiscard]] NetworkStatus try_open() noexcept;
    void complete_connection() noexcept;
    void take_datagram() noexcept;
    [[nodiscard]] bool is_from_other_side(const NetworkAddress& sender) noexcept;
    [[nodiscard]] std::size_t read_stream(std::span<std::byte> into) noexcept;
    [[nodiscard]] std::size_t read_datagrams(std::span<std::byte> into) noexcept;
    [[nodiscard]] bool send_part(std::span<const std::byte> part, std::size_t& sent) noexcept;
    void become_open() noexcept;
    void release() noexcept;
    void lose() noexcept;

    NetworkKind kind_ = NetworkKind::udp_listen;
    NetworkAddress address_;
    NetworkAddress peer_;  ///< of udp_listen; a length of 0: nobody yet
    std::int64_t retry_period_us_ = 0;
    std::int64_t next_attempt_us_ = 0;
    std::int64_t now_us_ = 0;
    std::int64_t heard_us_ = 0;        ///< the other side, last
    std::int64_t began_us_ = kNotYet;  ///< to connect
    int descriptor_ = -1;
    bool attempt_at_once_ = false;
    bool connecting_ = false;
    bool was_open_ = false;
    PortHealth health_{};
    std::size_t begin_ = 0;  ///< of what is left of the datagram
    std::size_t end_ = 0;
    std::array<std::byte, kMaxDatagram> datagram_{};
};

}  // namespace jink::hal
