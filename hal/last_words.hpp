// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstring>

#include "hal/interrupt_serial_port.hpp"

namespace jink::hal {

/// The bytes to send if the processor faults: composed beforehand, while everything still works, and sent by a fault
/// handler that relies on nothing but the checksum.
///
/// Two places, written in turn: a fault during writing leaves the older words. No constructor, so that it can lie in
/// memory that a reset does not clear: clear() it before use. 500 bytes.
class LastWords {
public:
    /// Four signed MAVLink frames take 226.
    static constexpr std::size_t kMax = 240;

    void clear() noexcept
    {
        places_[0].size = places_[1].size = 0;
        places_[0].check = places_[1].check = 0;
        newest_ = 0;
    }

    /// Buffer for the next words. They are valid from publish() on.
    [[nodiscard]] std::span<std::byte> draft() noexcept { return places_[1U - (newest_ & 1U)].bytes; }

    /// @param size  of the words in draft(), at most kMax; 0: nothing to send
    /// O(size): a checksum over 4-byte words.
    void publish(std::size_t size) noexcept
    {
        Place& place = places_[1U - (newest_ & 1U)];
        place.size = size <= kMax ? static_cast<std::uint32_t>(size) : 0;
        place.check = check_of(place);
        std::atomic_signal_fence(std::memory_order_release);  // complete before it is valid
        newest_ = 1U - (newest_ & 1U);
    }

    /// The newest words with a correct checksum; empty if there are none. O(kMax).
    [[nodiscard]] std::span<const std::byte> valid() const noexcept
    {
        for (const std::uint32_t i : {newest_ & 1U, 1U - (newest_ & 1U)}) {
            const Place& place = places_[i];
            if (place.size > 0 && place.size <= kMax && place.check == check_of(place)) {
                return {place.bytes.data(), place.size};
            }
        }
        return {};
    }

private:
    struct Place {
        std::uint32_t size;
        std::uint32_t check;
        std::array<std::byte, kMax> bytes;
    };
    static_assert(kMax % sizeof(std::uint32_t) == 0);

    /// For each word the sum is rotated and multiplied by an odd number: any change of one word is detected.
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

/// Sends last words over a UART by polling for space, with interrupts off. First the bytes that wait in the driver's
/// ring are sent: they complete the message on the wire, and nothing older follows the last words. Then `filler` zeros:
/// if a message was cut nevertheless, its reader takes the zeros for the rest and is in step again.
///
/// @param registers  of the UART, constructed again: the driver's may be damaged
/// @param waiting    the driver's ring; ignored if its indices are invalid
/// @param filler     bytes of the longest message
/// @param patience   polls per byte; a line that accepts nothing within them ends the sending
/// False if the line accepted nothing. O((ring + filler + words) * patience) at worst.
template <class Uart, RegisterBlock Registers, std::size_t N>
bool say_last_words(Registers registers, ByteRing<N>& waiting, std::span<const std::byte> words, std::size_t filler,
                    std::uint32_t patience) noexcept
{
    constexpr std::byte kZero{0};
    constexpr std::array<std::byte, Uart::kHardwareBytes + 2> kBehind{};  // they push the last word onto the line
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
