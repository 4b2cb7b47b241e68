// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/flight_log/ulog.hpp"

namespace jink::flightlog {

/// Queue of whole messages from one writer, the control loop, to one reader, the thread that writes files. Neither side
/// waits. Messages that do not fit together are dropped; before the next one that fits a ULog dropout message is put,
/// whose duration is the time without messages. Memory: `capacity`, once.
class Queue {
public:
    /// @param capacity  a power of two [bytes]
    explicit Queue(std::size_t capacity) : bytes_(capacity) {}

    /// Writer. @param messages  whole ones, `count` of them. O(bytes).
    bool add(std::span<const std::byte> messages, std::int64_t now_us, std::uint32_t count) noexcept;
    void lose(std::int64_t now_us, std::uint32_t count) noexcept;
    [[nodiscard]] std::uint32_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint32_t messages() const noexcept { return messages_; }
    [[nodiscard]] std::uint32_t peak() const noexcept { return peak_; }

    /// Reader. Takes bytes, oldest first; the last message may be in parts. @return their number
    [[nodiscard]] std::size_t take(std::span<std::byte> into) noexcept;
    /// For either side.
    [[nodiscard]] std::size_t size() const noexcept
    {
        return static_cast<std::size_t>(head_.load(std::memory_order_acquire) - tail_.load(std::memory_order_acquire));
    }

private:
    void copy_in(std::uint64_t at, std::span<const std::byte> bytes) noexcept;
    [[gnu::noinline]] std::uint64_t end_dropping(std::uint64_t at, std::int64_t now_us) noexcept;

    static constexpr std::size_t kDropout = ulog::kMessageHeader + 2;  ///< size of a dropout message

    std::vector<std::byte> bytes_;
    alignas(64) std::atomic<std::uint64_t> head_{0};  ///< the writer's
    alignas(64) std::atomic<std::uint64_t> tail_{0};  ///< the reader's
    // The writer's own.
    std::atomic<std::uint32_t> dropped_{0};
    std::uint32_t messages_ = 0;
    std::uint32_t peak_ = 0;
    bool is_dropping_ = false;
    std::int64_t dropping_since_ = 0;
};

}  // namespace jink::flightlog
