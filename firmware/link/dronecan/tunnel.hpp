// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/node.hpp"

namespace jink::link::dronecan {

struct TunnelOptions {
    /// Node at the other end. kAnonymous: the first node that tunnels MAVLink to us. It is replaced when it has been
    /// silent for Tunnel::kPeerSilence and another node tunnels MAVLink.
    std::uint8_t peer = kAnonymous;
    std::int8_t serial = -1;  ///< its serial port, 0 .. 15; -1: with an unknown peer the port that it names, else 0
    std::uint8_t protocol = static_cast<std::uint8_t>(TunnelProtocol::mavlink2);
};

struct TunnelDiagnostics {
    std::uint32_t transfers_in = 0;
    std::uint32_t transfers_out = 0;
    std::uint32_t bytes_overwritten = 0;  ///< received and not read in time: the oldest are lost
    std::uint32_t not_ours = 0;           ///< for another node, from another peer, port or protocol
    std::uint32_t peers_changed = 0;      ///< a silent peer was replaced by another one
};

/// A stream of bytes to another node over uavcan.tunnel.Targetted: the transport of a MAVLink endpoint where there is a
/// CAN bus in place of a serial line. Used like a serial port: non-blocking reads and writes.
///
/// Written bytes are sent at once, up to 120 in a transfer. If a transfer is lost, all its bytes are missing; MAVLink's
/// own framing detects that. Written bytes cannot be withdrawn, but a Link withdraws outdated set-points. So ask a Link
/// for bytes only while no frame waits (`Node::outgoing().front()` is nullptr): on a bus that accepts nothing, its
/// bytes then wait in the Link. Memory: 1.1 KiB.
class Tunnel {
public:
    /// Bytes received and not yet read: the amount that 1 Mbit/s of CAN brings in one step of 20 ms, less its framing.
    static constexpr std::size_t kReceiveBytes = 1024;
    /// Frames of the transmit queue that the tunnel leaves free for others: a status, an answer, a text.
    static constexpr std::size_t kLeftToOthers = 32;
    /// A peer that was not configured and is silent this long is replaced by another node: five HEARTBEATs. So an
    /// autopilot that returns with another node id is found again [s].
    static constexpr Seconds kPeerSilence = 5.0F;

    explicit Tunnel(const TunnelOptions& options = {}) noexcept
        : options_(options), wanted_peer_(options.peer), wanted_serial_(options.serial)
    {
    }

    /// Processes a TunnelTargetted transfer; ignores other types. O(bytes).
    void receive(Node& node, const Transfer& transfer) noexcept;
    /// Reads bytes that have arrived, oldest first. @return bytes read
    std::size_t read(std::span<std::byte> out) noexcept;
    /// Queues as many bytes as fit; none while there is no peer or no node id. @return bytes accepted
    std::size_t write(Node& node, std::span<const std::byte> bytes) noexcept;

    /// kAnonymous until the peer is known.
    [[nodiscard]] std::uint8_t peer() const noexcept { return options_.peer; }
    [[nodiscard]] const TunnelDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    TunnelOptions options_;  ///< the current options: with the learned peer and port
    std::uint8_t wanted_peer_;
    std::int8_t wanted_serial_;
    TimePoint heard_;  ///< last transfer of the peer
    std::array<std::byte, kReceiveBytes> ring_{};
    std::size_t first_ = 0;
    std::size_t size_ = 0;
    TunnelDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
