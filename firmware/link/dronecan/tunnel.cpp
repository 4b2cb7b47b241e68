// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/tunnel.hpp"

#include <algorithm>

namespace jink::link::dronecan {
namespace {

/// Frames of the longest transfer of a tunnel.
constexpr std::size_t kFramesOfTransfer = (TunnelTargetted::kType.max_length + 2 + 6) / 7;

[[nodiscard]] constexpr bool is_mavlink(std::uint8_t protocol) noexcept
{
    return protocol <= static_cast<std::uint8_t>(TunnelProtocol::mavlink2);
}

}  // namespace

void Tunnel::receive(Node& node, const Transfer& transfer) noexcept
{
    TunnelTargetted message;
    if (transfer.type.id != TunnelTargetted::kType.id || !node.decode(transfer, message)) {
        return;
    }
    const bool is_silent = wanted_peer_ == kAnonymous && options_.peer != kAnonymous &&
                           transfer.stamp - heard_ > kPeerSilence && transfer.source != options_.peer;
    const bool known = options_.peer != kAnonymous && !is_silent;
    const std::int8_t serial = is_silent ? wanted_serial_ : options_.serial;
    const bool port = serial < 0 || message.serial == serial;
    if (node.id() == kAnonymous || message.target != node.id() || !is_mavlink(message.protocol) || !port ||
        message.serial < 0 || transfer.source == kAnonymous || (known && transfer.source != options_.peer)) {
        ++diagnostics_.not_ours;
        return;
    }
    if (is_silent) {
        ++diagnostics_.peers_changed;
        size_ = 0;  // drops the partial frame of the former peer
    }
    heard_ = transfer.stamp;
    if (!known) {
        options_.peer = transfer.source;
        options_.serial = message.serial;
    }
    ++diagnostics_.transfers_in;
    for (const std::uint8_t byte : message.bytes) {
        if (size_ == kReceiveBytes) {
            first_ = (first_ + 1) % kReceiveBytes;
            --size_;
            ++diagnostics_.bytes_overwritten;
        }
        ring_[(first_ + size_) % kReceiveBytes] = std::byte{byte};
        ++size_;
    }
}

std::size_t Tunnel::read(std::span<std::byte> out) noexcept
{
    const std::size_t n = std::min(out.size(), size_);
    for (std::size_t i = 0; i < n; ++i) {
        out[i] = ring_[(first_ + i) % kReceiveBytes];
    }
    first_ = (first_ + n) % kReceiveBytes;
    size_ -= n;
    return n;
}

std::size_t Tunnel::write(Node& node, std::span<const std::byte> bytes) noexcept
{
    std::size_t taken = 0;
    while (taken < bytes.size() && options_.peer != kAnonymous && node.id() != kAnonymous &&
           node.outgoing().size() + kFramesOfTransfer + kLeftToOthers <= kTransmitFrames) {
        TunnelTargetted message;
        message.protocol = options_.protocol;
        message.target = options_.peer;
        message.serial = std::max<std::int8_t>(options_.serial, 0);
        for (const std::byte byte :
             bytes.subspan(taken).first(std::min(bytes.size() - taken, TunnelTargetted::kBytes))) {
            message.bytes.unchecked_push_back(std::to_integer<std::uint8_t>(byte));
        }
        if (!node.send(message, Priority::medium)) {
            break;
        }
        taken += message.bytes.size();
        ++diagnostics_.transfers_out;
    }
    return taken;
}

}  // namespace jink::link::dronecan
