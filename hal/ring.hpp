// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace jink::hal {

/// Queue from one writer to one reader that may interrupt each other: an interrupt handler and the main program.
///
/// Neither side waits. `head_` belongs to the writer and `tail_` to the reader; both only grow (and wrap with the
/// word), so that full and empty differ. N is a power of two. N * sizeof(T) + 8 bytes.
template <class T, std::size_t N>
class Ring {
    static_assert(N >= 2 && (N & (N - 1)) == 0);
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// Writer. Adds an item; false (and the item is lost) when full. O(1).
    bool push(const T& item) noexcept
    {
        const std::uint32_t head = head_.load(std::memory_order_relaxed);
        if (head - tail_.load(std::memory_order_acquire) == N) {
            return false;
        }
        items_[head % N] = item;
        head_.store(head + 1, std::memory_order_release);
        return true;
    }

    /// Writer. Adds as many items from the start of `from` as fit; returns their number. O(from.size()).
    std::size_t push(std::span<const T> from) noexcept
    {
        std::uint32_t head = head_.load(std::memory_order_relaxed);
        const std::size_t room = N - (head - tail_.load(std::memory_order_acquire));
        const std::size_t n = std::min(room, from.size());
        for (std::size_t i = 0; i < n; ++i) {
            items_[head++ % N] = from[i];
        }
        head_.store(head, std::memory_order_release);
        return n;
    }

    /// Reader. Removes the oldest item; false when empty. O(1).
    bool pop(T& item) noexcept
    {
        const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
        if (head_.load(std::memory_order_acquire) == tail) {
            return false;
        }
        item = items_[tail % N];
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }

    /// Reader. Fills `into` from its start; returns the number of items. O(into.size()).
    std::size_t pop(std::span<T> into) noexcept
    {
        std::uint32_t tail = tail_.load(std::memory_order_relaxed);
        const std::size_t n = std::min<std::size_t>(head_.load(std::memory_order_acquire) - tail, into.size());
        for (std::size_t i = 0; i < n; ++i) {
            into[i] = items_[tail++ % N];
        }
        tail_.store(tail, std::memory_order_release);
        return n;
    }

    /// For either side; the other side may change it at once.
    [[nodiscard]] std::size_t size() const noexcept
    {
        return head_.load(std::memory_order_acquire) - tail_.load(std::memory_order_acquire);
    }
    [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }

private:
    std::atomic<std::uint32_t> head_{0};
    std::atomic<std::uint32_t> tail_{0};
    std::array<T, N> items_{};
};

template <std::size_t N>
using ByteRing = Ring<std::byte, N>;

}  // namespace jink::hal
