// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/queue.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace jink::flightlog {

inline void Queue::copy_in(std::uint64_t at, std::span<const std::byte> bytes) noexcept
{
    const auto from = static_cast<std::size_t>(at & (bytes_.size() - 1));
    const std::size_t first = std::min(bytes.size(), bytes_.size() - from);
    std::memcpy(bytes_.data() + from, bytes.data(), first);
    if (first < bytes.size()) {
        std::memcpy(bytes_.data(), bytes.data() + first, bytes.size() - first);
    }
}

void Queue::lose(std::int64_t now_us, std::uint32_t count) noexcept
{
    dropped_.store(dropped_.load(std::memory_order_relaxed) + count, std::memory_order_relaxed);
    dropping_since_ = is_dropping_ ? dropping_since_ : now_us;
    is_dropping_ = true;
}

/// Puts the dropout message. @return behind it
std::uint64_t Queue::end_dropping(std::uint64_t at, std::int64_t now_us) noexcept
{
    std::array<std::byte, kDropout> buffer{};
    const auto ms = std::clamp<std::int64_t>((now_us - dropping_since_) / 1000, 0, 65535);
    copy_in(at, ulog::Composer(buffer).begin(ulog::Type::dropout).put(static_cast<std::uint16_t>(ms)).end());
    is_dropping_ = false;
    return at + kDropout;
}

bool Queue::add(std::span<const std::byte> messages, std::int64_t now_us, std::uint32_t count) noexcept
{
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    const auto used = static_cast<std::size_t>(head - tail_.load(std::memory_order_acquire));
    const std::size_t wanted = messages.size() + (is_dropping_ ? kDropout : 0U);
    if (wanted > bytes_.size() - used) [[unlikely]] {
        lose(now_us, count);
        return false;
    }
    const std::uint64_t at = is_dropping_ ? end_dropping(head, now_us) : head;
    copy_in(at, messages);
    head_.store(at + messages.size(), std::memory_order_release);
    messages_ += count;
    peak_ = std::max(peak_, static_cast<std::uint32_t>(used + wanted));
    return true;
}

std::size_t Queue::take(std::span<std::byte> into) noexcept
{
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t n = std::min(into.size(), static_cast<std::size_t>(head_.load(std::memory_order_acquire) - tail));
    const auto from = static_cast<std::size_t>(tail & (bytes_.size() - 1));
    const std::size_t first = std::min(n, bytes_.size() - from);
    std::memcpy(into.data(), bytes_.data() + from, first);
    std::memcpy(into.data() + first, bytes_.data(), n - first);
    tail_.store(tail + n, std::memory_order_release);
    return n;
}

}  // namespace jink::flightlog
