// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/param_flash.hpp"
#include "tests/memory_flash.hpp"

namespace jink::app {

/// Flash with units of one size, and what its units read as after a cut.
template <std::uint32_t UnitBytes, hal::WrongCode Wrong = hal::WrongCode::unreadable>
struct FlashKind {
    static constexpr std::uint32_t kUnitBytes = UnitBytes;
    template <std::uint32_t SectorBytes>
    using Of = hal::MemoryFlash<SectorBytes, UnitBytes, Wrong>;
    /// Programs of a record.
    static constexpr std::uint64_t units(std::uint64_t words) { return (4 * words + UnitBytes - 1) / UnitBytes; }
};
/// STM32F405; STM32H743, with a torn unit that its code detects, and with one that the code misses.
using FlashKinds = testing::Types<FlashKind<4>, FlashKind<32>, FlashKind<32, hal::WrongCode::as_it_looks>>;

inline constexpr std::uint32_t kSmall = 512;

inline ParamValues own() { return Parameters().values(); }

inline ParamValues own_with(Param p, float value)
{
    ParamValues values = own();
    values[static_cast<std::size_t>(p)] = value;
    return values;
}

/// The parameters after a restart.
inline ParamValues restarted(hal::FlashRegion& flash, ParamLoad* load = nullptr)
{
    ParamFlash store(flash);
    ParamValues values = own();
    const ParamLoad found = store.load(values);
    if (load != nullptr) {
        *load = found;
    }
    return values;
}

inline bool saved(hal::FlashRegion& flash, const ParamValues& values)
{
    ParamFlash store(flash);
    ParamValues before = own();
    static_cast<void>(store.load(before));
    return store.save(own(), values);
}

/// A record, made by hand from the header's text: another checksum's code than that of the store.
inline std::vector<std::uint32_t> record_of(std::uint32_t sequence,
                                            const std::vector<std::pair<std::string, float>>& entries)
{
    std::vector<std::uint32_t> words{0x014B4E8A, sequence, static_cast<std::uint32_t>(entries.size())};
    for (const auto& [name, value] : entries) {
        std::string padded = name;
        padded.resize(16, '\0');
        for (std::size_t i = 0; i < 16; i += 4) {
            std::uint32_t word = 0;
            std::memcpy(&word, padded.data() + i, 4);
            words.push_back(word);
        }
        words.push_back(std::bit_cast<std::uint32_t>(value));
    }
    std::uint32_t crc = 0xFFFFFFFF;
    for (const std::uint32_t word : words) {
        for (int bit = 0; bit < 32; ++bit) {
            const std::uint32_t differs = (crc ^ (word >> bit)) & 1U;
            crc = (crc >> 1U) ^ (differs != 0 ? 0xEDB88320U : 0U);
        }
    }
    words.push_back(~crc);
    return words;
}

inline void put(hal::FlashRegion& flash, std::uint32_t sector, std::uint32_t offset, std::vector<std::uint32_t> words)
{
    const std::size_t in_unit = flash.unit_bytes() / 4;
    words.resize((words.size() + in_unit - 1) / in_unit * in_unit, 0xFFFFFFFF);
    for (std::size_t i = 0; i < words.size(); i += in_unit) {
        ASSERT_TRUE(
            flash.program(sector, offset + static_cast<std::uint32_t>(4 * i), std::span(words).subspan(i, in_unit)));
    }
}

}  // namespace jink::app
