// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/world/world.hpp"

// Ids of tracks. A vehicle with several names has a track for each: two tracks at one place are safe. The ranges:
//
//   0x00000001..0x00FFFFFF  24-bit addresses of aircraft (ADS-B)
//   0x05000001..0x050000FF  system ids of the link: those of the other systems, and our own
//   0x40000000..0x7FFFFFFF  names in traffic management, 30 bits of a hash
//   0x80000000..0xFFFFFFFF  values in place of an address with more than 24 bits; the uppermost bit is lost
//
// 0x01000000 to 0x04FFFFFF are ids of obstacles and closed areas in the warnings of the application.

namespace jink::link {

inline constexpr world::TrackId kSystemIds = 0x05000000;
inline constexpr world::TrackId kUtmIds = 0x40000000;
inline constexpr world::TrackId kWideAddressIds = 0x80000000;

[[nodiscard]] constexpr world::TrackId track_of_system(std::uint8_t system) noexcept { return kSystemIds + system; }
[[nodiscard]] constexpr bool is_of_system(world::TrackId id) noexcept
{
    return id > kSystemIds && id <= kSystemIds + 255;
}

/// Traffic is never refused for an invalid address.
[[nodiscard]] constexpr world::TrackId track_of_address(std::uint32_t address) noexcept
{
    constexpr std::uint32_t kLargestAddress = 0xFFFFFF;
    return address <= kLargestAddress ? address : kWideAddressIds | address;
}

/// FNV-1a (Fowler, Noll, Vo), folded to 30 bits. Of 64 names two have the same hash with a chance of 2 in a million;
/// they then share a track that jumps from one to the other. O(bytes).
[[nodiscard]] constexpr world::TrackId track_of_name(std::span<const std::uint8_t> name) noexcept
{
    constexpr std::uint32_t kBasis = 2166136261U;
    constexpr std::uint32_t kPrime = 16777619U;
    constexpr unsigned kBits = 30;
    constexpr std::uint32_t kMask = (1U << kBits) - 1U;
    std::uint32_t hash = kBasis;
    for (const std::uint8_t byte : name) {
        hash = (hash ^ byte) * kPrime;
    }
    return kUtmIds | ((hash >> kBits) ^ (hash & kMask));
}

}  // namespace jink::link
