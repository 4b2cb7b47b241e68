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

/// An emulated UART's line through local datagrams. qemu takes bytes from a pseudo-terminal or a socket singly, with a
/// system call and a main-loop iteration each: too slow for a full line at 921600 baud. qemu takes datagrams whole, and
/// its multiplexer hands on their bytes as the UART reads.
///
/// Datagrams have no back pressure: `may_send` checks the emulator's receive queue, and `dropped` reports the system's
/// losses, so that host losses are not attributed to the board.
class DatagramLine {
public:
    /// @throws std::runtime_error
    DatagramLine();
    ~DatagramLine();
    DatagramLine(const DatagramLine&) = delete;
    DatagramLine& operator=(const DatagramLine&) = delete;

    /// qemu's options for the line: a character device named `line`.
    [[nodiscard]] std::vector<std::string> options() const;

    /// False while more than a few datagrams wait at the emulator. The emulator would hand them on as a burst that a
    /// real line cannot produce and that the board's ring need not hold.
    [[nodiscard]] bool may_send() const;
    void send(std::span<const std::byte> bytes);
    /// Bytes received since the last call.
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
