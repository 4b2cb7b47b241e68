// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstring>

#include "hal/interrupt_serial_port.hpp"

namespace jink::hal {

/// What is to be said when the processor faults: composed beforehand, while everything still works, and sent by a fault
/// handler that trusts nothing but the check sum.
///
/// Two places, written in turn: a fault amid the writing leaves the older words. Without a constructor, so that it can
/// lie in memory that a reset leaves alone: clear() it before use. 500 bytes.
class LastWords {
public:
    /// Four signed MAVLink frames take 226.
    static constexpr std::size_t kMost = 240;

    void clear() noexcept
    {
        places_[0].size = places_[1].size = 0;
        places_[0].check = places_[1].check = 0;
        newest_ = 0;
    }

    /// Where the next words go. They count from publish() on.
    [[nodiscard]] std::span<std::byte> draft() noexcept { return places_[1U - (newest_ & 1U)].bytes; }

    /// @param size  of the words in draft(), at most kMost; 0: nothing to say
    /// O(size): a check sum over the words of 4 bytes.
    void publish(std::size_t size) noexcept
    {
        Place& place = places_[1U - (newest_ & 1U)];
        place.size = size <= kMost ? static_cast<std::uint32_t>(size) : 0;
        place.check = check_of(place);
        std::atomic_signal_fence(std::memory_order_release);  // whole before it counts
        newest_ = 1U - (newest_ & 1U);
    }

    /// The newest words whose check sum holds; empty where there are none. O(kMost).
    [[nodiscard]] std::span<const std::byte> valid() const noexcept
    {
        for (const std::uint32_t i : {newest_ & 1U, 1U - (newest_ & 1U)}) {
            const Place& place = places_[i];
            if (place.size > 0 && place.size <= kMost && place.check == check_of(place)) {
                return {place.bytes.data(), place.size};
            }
        }
        return {};
    }

private:
    struct Place {
        std::uint32_t size;
        std::uint32_t check;
        std::array<std::byte, kMost> bytes;
    };
    static_assert(kMost % sizeof(std::uint32_t) == 0);

    /// Each word is turned by its place and multiplied by an odd number: no change of one word goes unnoticed.
    [[nodiscard]] static std::uint32_t check_of(const Place& place) noexcept
    {
        constexpr std::uint32_t kStart = 0x4A4C5731;
        constexpr std::uint32_t kOdd = 0x9E3779B1;
        std::uint32_t sum = kStart ^ place.size;
        for (std::size_t i = 0; i < place.size; i += sizeof(std::uint32_t)) {
            std::uint32_t word = 0;
            std::memcpy(&word, place.bytes.data() + i, sizeof word);
            sum = ((sum << 5U | sum >> 27U) ^ word) * kOdd;
        }
        return sum;
    }

    std::array<Place, 2> places_;
    std::uint32_t newest_;
};

/// Says last words over a UART by looking for room, with interrupts off. First goes what waits in the driver's ring: it
/// finishes what is begun on the wire, and nothing older than the last words comes behind them. Then `filler` zeros:
/// where a message was cut all the same, its reader takes them for the rest and is in step again.
///
/// @param registers  of the UART, made anew: what the driver holds may be damaged
/// @param waiting    the driver's ring; passed over where its indices cannot be right
/// @param filler     bytes of the longest message
/// @param patience   looks for room per byte; a line that takes nothing within them ends it
/// False where the line took nothing. O((ring + filler + words) * patience) at worst.
template <class Uart, RegisterBlock Registers, std::size_t N>
bool say_last_words(Registers registers, ByteRing<N>& waiting, std::span<const std::byte> words, std::size_t filler,
                    std::uint32_t patience) noexcept
{
    constexpr std::byte kZero{0};
    constexpr std::array<std::byte, 4> kBehind{};  // they push the last word out of the UART's own buffers
    const auto say = [&](std::span<const std::byte> bytes) { return send_waiting<Uart>(registers, bytes, patience); };
    std::byte byte{};
    for (std::size_t i = 0; i < N && waiting.size() <= N && waiting.pop(byte); ++i) {
        if (!say({&byte, 1})) {
            return false;
        }
    }
    for (std::size_t i = 0; i < filler; ++i) {
        if (!say({&kZero, 1})) {
            return false;
        }
    }
    return say(words) && say(kBehind);
}

}  // namespace jink::hal
