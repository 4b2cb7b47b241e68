// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/node.hpp"

namespace jink::link::dronecan {

struct TunnelOptions {
    /// Node at the other end; kAnonymous: the first that tunnels MAVLink to us, until it is silent for
    /// Tunnel::kPeerSilence and another one does.
    std::uint8_t peer = kAnonymous;
    std::int8_t serial = -1;  ///< its serial port, 0 .. 15; -1: with an unknown peer that which it names, else 0
    std::uint8_t protocol = static_cast<std::uint8_t>(TunnelProtocol::mavlink2);
};

struct TunnelDiagnostics {
    std::uint32_t transfers_in = 0;
    std::uint32_t transfers_out = 0;
    std::uint32_t bytes_overwritten = 0;  ///< received and not read in time: the oldest go
    std::uint32_t not_ours = 0;           ///< for another node, from another peer, port or protocol
    std::uint32_t peers_changed = 0;      ///< a peer that had fallen silent made room for another
};

/// A stream of bytes to another node over uavcan.tunnel.Targetted: what a MAVLink endpoint speaks through where there
/// is a CAN bus instead of a serial line. Used as a serial port is: bytes are read and written, never waited for.
///
/// Written bytes go out as they come, up to 120 in a transfer. Of a lost transfer all bytes are missing; MAVLink's own
/// framing finds that. What has been written cannot be taken back: a Link, which takes back set-points that are out of
/// date, should be asked for bytes only while no frame waits (`Node::outgoing().front()` is nullptr), so that on a bus
/// that takes nothing they wait in the Link. Memory: 1.1 KiB.
class Tunnel {
public:
    /// Bytes received and not read yet: what 1 Mbit/s of CAN brings in one step of 20 ms, less its framing.
    static constexpr std::size_t kReceiveBytes = 1024;
    /// Frames of the transmit queue that the tunnel leaves to others: a status, an answer, a text.
    static constexpr std::size_t kLeftToOthers = 32;
    /// A peer that was not given to us and is silent this long gives way to another node: five HEARTBEATs. An autopilot
    /// that comes back with another node id is found again [s].
    static constexpr Seconds kPeerSilence = 5.0F;

    explicit Tunnel(const TunnelOptions& options = {}) noexcept
        : options_(options), wanted_peer_(options.peer), wanted_serial_(options.serial)
    {
    }

    /// A TunnelTargetted transfer; others are none of its business. O(bytes).
    void receive(Node& node, const Transfer& transfer) noexcept;
    /// Takes out what has arrived, oldest first. @return bytes
    std::size_t read(std::span<std::byte> out) noexcept;
    /// Queues as many bytes as there is room for; none while there is no peer or no node id. @return bytes taken
    std::size_t write(Node& node, std::span<const std::byte> bytes) noexcept;

    /// kAnonymous until one is known.
    [[nodiscard]] std::uint8_t peer() const noexcept { return options_.peer; }
    [[nodiscard]] const TunnelDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    TunnelOptions options_;  ///< as they are now: with the peer and port that were learned
    std::uint8_t wanted_peer_;
    std::int8_t wanted_serial_;
    TimePoint heard_;  ///< the peer
    std::array<std::byte, kReceiveBytes> ring_{};
    std::size_t first_ = 0;
    std::size_t size_ = 0;
    TunnelDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
