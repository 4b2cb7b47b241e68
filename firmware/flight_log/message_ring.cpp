// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/flight_log/message_ring.hpp"

#include <algorithm>

#include "firmware/flight_log/ulog.hpp"
#include "firmware/link/log_part.hpp"

namespace jink::flightlog {

void MessageRing::put(std::span<const std::byte> bytes) noexcept
{
    const std::size_t from = (begin_ + size_) % kBytes;
    const std::size_t first = std::min(bytes.size(), kBytes - from);
    std::copy_n(bytes.begin(), first, bytes_.begin() + static_cast<std::ptrdiff_t>(from));
    std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(first), bytes.end(), bytes_.begin());
    size_ += bytes.size();
}

bool MessageRing::add(std::span<const std::byte> message, TimePoint now, std::size_t spare) noexcept
{
    constexpr std::size_t kDropout = ulog::kMessageHeader + 2;
    if (message.size() + spare + (is_dropping_ ? kDropout : 0U) > kBytes - size_) {
        ++dropped_;
        dropping_since_ = is_dropping_ ? dropping_since_ : now;
        is_dropping_ = true;
        return false;
    }
    if (is_dropping_) {
        std::array<std::byte, kDropout> buffer{};
        const auto ms = std::clamp<std::int64_t>((now.us - dropping_since_.us) / 1000, 0, 65535);
        put(ulog::Composer(buffer).begin(ulog::Type::dropout).put(static_cast<std::uint16_t>(ms)).end());
        is_dropping_ = false;
    }
    put(message);
    ++messages_;
    peak_ = std::max(peak_, static_cast<std::uint32_t>(size_));
    return true;
}

std::span<const std::byte> MessageRing::peek(std::span<std::byte> into) const noexcept
{
    const std::size_t n = std::min(into.size(), size_);
    const std::size_t first = std::min(n, kBytes - begin_);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), first, into.begin());
    std::copy_n(bytes_.begin(), n - first, into.begin() + static_cast<std::ptrdiff_t>(first));
    return into.first(n);
}

std::uint8_t MessageRing::first_message(std::size_t n) const noexcept
{
    const bool begins = to_message_ < std::min(n, size_) && to_message_ < link::kNoMessageBegins;
    return begins ? static_cast<std::uint8_t>(to_message_) : link::kNoMessageBegins;
}

void MessageRing::remove(std::size_t n) noexcept
{
    while (to_message_ < n) {
        to_message_ += ulog::kMessageHeader + (static_cast<std::size_t>(at(to_message_)) |
                                               static_cast<std::size_t>(at(to_message_ + 1)) << 8U);
    }
    to_message_ -= n;
    begin_ = (begin_ + n) % kBytes;
    size_ -= n;
}

void MessageRing::clear() noexcept
{
    begin_ = size_ = to_message_ = 0;
    is_dropping_ = false;
}

}  // namespace jink::flightlog
