// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/transmit_queue.hpp"

#include <algorithm>
#include <cassert>

#include "firmware/link/dronecan/checksum.hpp"

namespace jink::link::dronecan {
namespace {

constexpr std::size_t kPayloadOfFrame = Frame::kBytes - 1;

[[nodiscard]] std::uint32_t id_of(const TransferHead& head, std::span<const std::byte> payload) noexcept
{
    FrameId id{
        head.type.kind, static_cast<std::uint8_t>(head.priority), head.type.id, head.source, head.destination, 0};
    if (head.source == kAnonymous) {
        // Two senders that pick the same identifier at once must send the same data.
        Checksum checksum;
        checksum.add(payload);
        id.discriminator = checksum.value() & 0x3FFFU;
    }
    return pack(id);
}

}  // namespace

bool TransmitQueue::push(const TransferHead& head, std::span<const std::byte> payload) noexcept
{
    const bool single = payload.size() <= kPayloadOfFrame;
    const bool anonymous = head.source == kAnonymous;
    if (payload.size() > kMaxPayload || (anonymous && (!single || head.type.kind != TransferKind::message))) {
        ++diagnostics_.transfers_refused;
        return false;
    }
    Checksum checksum(head.type.crc_seed);
    checksum.add(payload);
    const std::array<std::byte, kCrcBytes> crc{static_cast<std::byte>(checksum.value() & 0xFFU),
                                               static_cast<std::byte>(checksum.value() >> 8U)};
    const std::size_t prefix = single ? 0 : kCrcBytes;
    const std::size_t total = prefix + payload.size();
    const std::size_t count = std::max<std::size_t>(1, (total + kPayloadOfFrame - 1) / kPayloadOfFrame);
    while (kTransmitFrames - size_ < count) {
        drop_oldest();
    }
    Frame frame;
    frame.id = id_of(head, payload);
    for (std::size_t f = 0; f < count; ++f) {
        const std::size_t begin = f * kPayloadOfFrame;
        const std::size_t n = std::min(kPayloadOfFrame, total - begin);
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t at = begin + i;
            frame.data[i] = at < prefix ? crc[at] : payload[at - prefix];
        }
        frame.data[n] = pack(Tail{f == 0, f + 1 == count, f % 2 != 0, head.transfer});
        std::fill(frame.data.begin() + static_cast<std::ptrdiff_t>(n) + 1, frame.data.end(), std::byte{0});
        frame.length = static_cast<std::uint8_t>(n + 1);
        append(frame);
    }
    ++diagnostics_.transfers;
    return true;
}

void TransmitQueue::append(const Frame& frame) noexcept
{
    assert(size_ < kTransmitFrames);
    frames_[(first_ + size_) % kTransmitFrames] = frame;
    ++size_;
}

void TransmitQueue::pop() noexcept
{
    if (size_ > 0) {
        first_ = (first_ + 1) % kTransmitFrames;
        --size_;
        ++diagnostics_.frames;
    }
}

void TransmitQueue::drop_oldest() noexcept
{
    bool whole = false;
    while (size_ > 0 && !whole) {
        const Frame& frame = frames_[first_];
        whole = unpack(frame.data[frame.length - 1U]).end;
        first_ = (first_ + 1) % kTransmitFrames;
        --size_;
    }
    ++diagnostics_.transfers_dropped;
}

void TransmitQueue::clear() noexcept
{
    while (size_ > 0) {
        drop_oldest();
    }
}

}  // namespace jink::link::dronecan
