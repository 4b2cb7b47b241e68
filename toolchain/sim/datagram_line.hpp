// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace jink::sim {

/// An emulated UART's line through datagrams on this machine. qemu takes bytes from a pseudo-terminal or a socket one
/// at a time, a system call and a turn of its main loop each: too slow for a full line at 921600 baud. Datagrams it
/// takes whole, and its multiplexer hands their bytes on as the UART reads them.
///
/// Datagrams have no back pressure: `may_send` looks at what waits at the emulator, and what the system dropped is
/// told, so that a loss of the host's is not taken for one of the board's.
class DatagramLine {
public:
    /// @throws std::runtime_error
    DatagramLine();
    ~DatagramLine();
    DatagramLine(const DatagramLine&) = delete;
    DatagramLine& operator=(const DatagramLine&) = delete;

    /// qemu's options for it: a character device of the name `line`.
    [[nodiscard]] std::vector<std::string> options() const;

    /// False while the emulator is behind by more than a few datagrams: a burst that it would hand on at once is what
    /// no line does, and the board's ring need not hold.
    [[nodiscard]] bool may_send() const;
    void send(std::span<const std::byte> bytes);
    /// What has arrived since the last call.
    [[nodiscard]] std::vector<std::byte> take();

    /// Datagrams that the system dropped, both ways.
    [[nodiscard]] std::uint64_t dropped() const;

private:
    struct State {
        std::uint64_t waiting = 0;  ///< memory held [B], some 768 for a small datagram
        std::uint64_t dropped = 0;
    };
    [[nodiscard]] State state_of(std::uint16_t port) const;
    void listen();

    int socket_ = -1;
    int table_ = -1;  ///< /proc/net/udp
    std::uint16_t own_port_ = 0;
    std::uint16_t other_port_ = 0;
    std::uint64_t refused_ = 0;
    std::atomic<bool> over_{false};
    std::mutex mutex_;
    std::vector<std::byte> heard_;
    std::thread listener_;
};

}  // namespace jink::sim
