// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"

namespace jink::flightlog {

/// Whole ULog messages that wait to be sent, in fixed memory. They are taken out in parts of any size, each of which
/// says where its first message begins. A message that does not fit is dropped whole and counted; the next one that
/// fits follows a dropout message.
class MessageRing {
public:
    static constexpr std::size_t kBytes = 2048;

    /// Adds all of `message` if `spare` bytes stay free behind it. @return false: dropped. O(message).
    [[gnu::cold]] bool add(std::span<const std::byte> message, TimePoint now, std::size_t spare = 0) noexcept;
    /// Oldest bytes, without taking them out. @return as many as `into` has, if there are as many
    [[nodiscard, gnu::cold]] std::span<const std::byte> peek(std::span<std::byte> into) const noexcept;
    /// Where the first message begins among the oldest `n` bytes; link::kNoMessageBegins: nowhere.
    [[nodiscard, gnu::cold]] std::uint8_t first_message(std::size_t n) const noexcept;
    /// Takes the oldest `n` bytes out, n <= size(). O(messages in them).
    [[gnu::cold]] void remove(std::size_t n) noexcept;
    /// Empty, with the counters as they are.
    void clear() noexcept;

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] std::uint32_t messages() const noexcept { return messages_; }
    [[nodiscard]] std::uint32_t dropped() const noexcept { return dropped_; }
    [[nodiscard]] std::uint32_t peak() const noexcept { return peak_; }

private:
    [[gnu::cold, gnu::noinline]] void put(std::span<const std::byte> bytes) noexcept;
    [[nodiscard]] std::byte at(std::size_t i) const noexcept { return bytes_[(begin_ + i) % kBytes]; }

    std::array<std::byte, kBytes> bytes_{};
    std::size_t begin_ = 0;
    std::size_t size_ = 0;
    std::size_t to_message_ = 0;  ///< bytes before the first whole message
    std::uint32_t messages_ = 0;  ///< accepted
    std::uint32_t dropped_ = 0;
    std::uint32_t peak_ = 0;  ///< most bytes that waited
    bool is_dropping_ = false;
    TimePoint dropping_since_;
};

}  // namespace jink::flightlog
