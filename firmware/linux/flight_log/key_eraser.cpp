// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/key_eraser.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace jink::flightlog {
namespace {

constexpr std::size_t kLength = 1;     ///< of the payload
constexpr std::size_t kFlags = 2;      ///< incompatible ones: 1, signed, is the only one there is
constexpr std::size_t kMessageId = 7;  ///< three bytes
constexpr std::size_t kKey = 10;       ///< in the payload; a shorter one has none

/// @param header  ten bytes
bool is_setup_signing(const std::byte* header)
{
    return header[kMessageId] == std::byte{0} &&  // first: few other frames get further
           header[0] == link::mavlink::kStartV2 && static_cast<std::size_t>(header[kLength]) > kKey &&
           static_cast<unsigned>(header[kFlags]) <= 1U && header[kMessageId + 1] == std::byte{1} &&
           header[kMessageId + 2] == std::byte{0};
}

}  // namespace

bool KeyEraser::erase(std::span<std::byte> bytes) noexcept
{
    if (bytes.empty()) {
        return false;
    }
    bool erased = false;
    const std::size_t rest = std::exchange(secret_, 0);
    const auto wipe = [&](std::size_t from, std::size_t length) {
        const std::size_t to = std::min(from + length, bytes.size());
        if (from < to) {
            std::memset(bytes.data() + from, 0, to - from);
            erased = true;
        }
        secret_ = std::max(secret_, from + length - std::min(from + length, bytes.size()));
    };
    // Headers are searched in what was received, also in what another header makes a payload: a frame that was cut may
    // be followed by the one that the receiver takes.
    const std::size_t head = std::min(bytes.size(), kTail);
    const bool is_joined = may_go_on_ || bytes.size() < kTail;
    std::array<std::byte, 2 * kTail> joint;  // NOLINT(cppcoreguidelines-pro-type-member-init): set where it is read
    if (is_joined) {
        std::copy(tail_.begin(), tail_.end(), joint.begin());
        std::copy_n(bytes.begin(), head, joint.begin() + kTail);
        std::copy_n(joint.begin() + static_cast<std::ptrdiff_t>(head), kTail, tail_.begin());
    }
    if (bytes.size() >= kTail) {
        std::memcpy(tail_.data(), bytes.data() + bytes.size() - kTail, kTail);
    }
    may_go_on_ = bytes.size() < kTail;
    // Frames that begin in this read, the last one first: what is overwritten lies behind the headers still to be read.
    const std::byte* end = bytes.data() + bytes.size();
    while (const void* const found = ::memrchr(bytes.data(), static_cast<int>(link::mavlink::kStartV2),
                                               static_cast<std::size_t>(end - bytes.data()))) {
        end = static_cast<const std::byte*>(found);
        const auto at = static_cast<std::size_t>(end - bytes.data());
        if (bytes.size() - at < kHeader) {
            may_go_on_ = true;  // in the tail
        } else if (is_setup_signing(end)) {
            wipe(at + kHeader, static_cast<std::size_t>(end[kLength]) + link::mavlink::kChecksumSize);
        }
    }
    for (std::size_t i = 0; is_joined && i + kHeader <= kTail + head; ++i) {  // frames that began in the reads before
        if (is_setup_signing(joint.data() + i)) {
            wipe(i + kHeader - kTail, static_cast<std::size_t>(joint[i + kLength]) + link::mavlink::kChecksumSize);
        }
    }
    if (rest > 0) {
        wipe(0, rest);
    }
    return erased;
}

void KeyEraser::forget() noexcept
{
    tail_.fill(std::byte{0});
    may_go_on_ = false;
    secret_ = kUnknown;
}

}  // namespace jink::flightlog
