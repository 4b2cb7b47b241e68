// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mission/frame.hpp"

#include <algorithm>

#include "firmware/link/mavlink/checksum.hpp"

namespace jink::link::mission {
namespace {

/// A line this long without a byte is not in the middle of a frame [s].
constexpr Seconds kSilence = 0.1F;

[[nodiscard]] std::uint16_t number_at(std::span<const std::byte> bytes, std::size_t at) noexcept
{
    return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) | std::to_integer<unsigned>(bytes[at + 1])
                                                                                 << 8U);
}

void put_number(std::span<std::byte> bytes, std::size_t at, std::uint16_t value) noexcept
{
    bytes[at] = static_cast<std::byte>(value & 0xFFU);
    bytes[at + 1] = static_cast<std::byte>(value >> 8U);
}

/// Of bytes 2 .. end - 1; the start bytes are the same in every frame.
[[nodiscard]] std::uint16_t checksum_before(std::span<const std::byte> bytes, std::size_t end) noexcept
{
    mavlink::Checksum checksum;
    checksum.add(bytes.subspan(kSync.size(), end - kSync.size()));
    return checksum.value();
}

}  // namespace

std::size_t write_frame(const Frame& frame, std::span<std::byte> out) noexcept
{
    const auto type = static_cast<std::uint8_t>(frame.type);
    const std::size_t payload = payload_size(type);
    const std::size_t size = frame_size(payload);
    if (payload == 0 || out.size() < size) {
        return 0;
    }
    std::copy(kSync.begin(), kSync.end(), out.begin());
    out[2] = std::byte{kVersion};
    out[3] = std::byte{type};
    put_number(out, 4, frame.sender);
    put_number(out, 6, frame.sequence);
    out[8] = static_cast<std::byte>(payload);
    std::copy_n(frame.payload.begin(), payload, out.begin() + kHeaderSize);
    put_number(out, size - kChecksumSize, checksum_before(out, size - kChecksumSize));
    return size;
}

void Receiver::receive(std::span<const std::byte> bytes, TimePoint now, FrameSink& sink) noexcept
{
    const bool silent = bytes.empty() && now - last_byte_ > kSilence;
    last_byte_ = bytes.empty() ? last_byte_ : now;
    while (!bytes.empty()) {  // less than a frame is pending, so at least one byte is taken each time round
        if (end_ == buffer_.size()) {
            std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(), buffer_.begin());
            end_ -= begin_;
            begin_ = 0;
        }
        const std::size_t n = std::min(bytes.size(), buffer_.size() - end_);
        std::copy_n(bytes.begin(), n, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
        end_ += n;
        bytes = bytes.subspan(n);
        search(now, sink);
    }
    while (silent && pending() > 0) {  // what is incomplete will stay so
        ++diagnostics_.cut;
        pass_over(1);
        search(now, sink);
    }
}

void Receiver::pass_over(std::size_t n) noexcept
{
    begin_ += n;
    diagnostics_.noise_bytes += n;
}

/// Up to an incomplete frame or the end of what is there.
void Receiver::search(TimePoint now, FrameSink& sink) noexcept
{
    while (pending() > 0) {  // at least one byte goes each time round
        const bool may_start = buffer_[begin_] == kSync[0] && (pending() < 2 || buffer_[begin_ + 1] == kSync[1]);
        if (!may_start) {
            pass_over(1);
        } else if (!judge(now, sink)) {
            return;
        }
    }
}

/// What begins with the start bytes. False while it is incomplete.
bool Receiver::judge(TimePoint now, FrameSink& sink) noexcept
{
    if (pending() < kHeaderSize) {
        return false;
    }
    const auto bytes = std::span<const std::byte>(buffer_).subspan(begin_, pending());
    const auto type = std::to_integer<std::uint8_t>(bytes[3]);
    const std::size_t payload = payload_size(type);
    if (bytes[2] != std::byte{kVersion} || payload == 0 || std::to_integer<std::size_t>(bytes[8]) != payload) {
        ++diagnostics_.unknown;
        pass_over(1);
        return true;
    }
    const std::size_t size = frame_size(payload);
    if (bytes.size() < size) {
        return false;
    }
    if (number_at(bytes, size - kChecksumSize) != checksum_before(bytes, size - kChecksumSize)) {
        ++diagnostics_.bad_checksum;
        pass_over(1);
        return true;
    }
    Frame frame;
    frame.type = static_cast<MessageType>(type);
    frame.sender = number_at(bytes, 4);
    frame.sequence = number_at(bytes, 6);
    std::copy_n(bytes.begin() + kHeaderSize, payload, frame.payload.begin());
    ++diagnostics_.frames;
    diagnostics_.frame_bytes += size;
    begin_ += size;
    sink.take(frame, now);
    return true;
}

}  // namespace jink::link::mission
