// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "hal/flash_region.hpp"

namespace jink::hal {

/// What a unit reads as whose code is wrong: cut within its change, or programmed twice.
enum class WrongCode : std::uint8_t {
    unreadable,   ///< the code detects it
    as_it_looks,  ///< the code misses it, or there is none
};

/// Flash in memory whose power can be cut within any step. Steps: a program is one, an erase one for each unit of the
/// sector. Units of more than 4 bytes have a code; of 4 bytes none.
///
/// Erased at the start. Allocation-free; 2 * SectorBytes, and a byte per unit.
template <std::uint32_t SectorBytes, std::uint32_t UnitBytes = 4, WrongCode Wrong = WrongCode::unreadable>
class MemoryFlash final : public FlashRegion {
public:
    static_assert(SectorBytes > 0 && SectorBytes % UnitBytes == 0 && UnitBytes % 4 == 0 && UnitBytes <= kMaxUnitBytes);
    static constexpr bool kHasCode = UnitBytes > 4;
    static constexpr std::uint32_t kUnits = SectorBytes / UnitBytes;

    MemoryFlash() noexcept
    {
        for (auto& sector : units_) {
            sector.fill(kErased);
        }
    }

    [[nodiscard]] std::uint32_t sector_bytes() const noexcept override { return SectorBytes; }
    [[nodiscard]] std::uint32_t unit_bytes() const noexcept override { return UnitBytes; }
    [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t sector, std::uint32_t offset) noexcept override
    {
        const Unit& unit = units_[sector][offset / UnitBytes];
        return unit.unreadable ? std::nullopt : std::optional(unit.words[offset % UnitBytes / 4U]);
    }
    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset,
                               std::span<const std::uint32_t> words) noexcept override
    {
        Unit& unit = units_[sector][offset / UnitBytes];
        const bool twice = kHasCode && (unit.unreadable || unit.words != kErased.words);
        Unit to = unit;
        for (std::size_t i = 0; i < kUnitWords; ++i) {
            to.words[i] &= words[i];
        }
        to.unreadable = unit.unreadable || (twice && Wrong == WrongCode::unreadable);
        const bool done = change(unit, to);
        return done && !unit.unreadable && std::equal(words.begin(), words.end(), unit.words.begin(), unit.words.end());
    }
    /// Of a single word, at the start of a unit; the rest of the unit stays erased.
    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept
    {
        std::array<std::uint32_t, kUnitWords> words = kErased.words;
        words[0] = word;
        return program(sector, offset, words);
    }
    [[nodiscard]] bool erase(std::uint32_t sector) noexcept override
    {
        erases_ += is_cut() ? 0U : 1U;
        bool done = true;
        for (Unit& unit : units_[sector]) {
            done = change(unit, kErased) && done;
        }
        return done;
    }

    /// Cuts the power within the step of this number, counted from now on: of the bits changed by this step, only those
    /// in `mask` change, which is turned from word to word of a unit. All later steps fail without effect, until
    /// restore().
    void cut_at(std::uint64_t step, std::uint32_t mask) noexcept
    {
        cut_ = steps_ + step;
        mask_ = mask;
    }
    void restore() noexcept { cut_ = kNever; }
    [[nodiscard]] bool is_cut() const noexcept { return steps_ > cut_; }

    [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }
    [[nodiscard]] std::uint32_t erases() const noexcept { return erases_; }
    /// Damage that no code detects.
    void flip(std::uint32_t sector, std::uint32_t offset, std::uint32_t bits) noexcept
    {
        units_[sector][offset / UnitBytes].words[offset % UnitBytes / 4U] ^= bits;
    }
    /// Damage that the code detects.
    void make_unreadable(std::uint32_t sector, std::uint32_t offset) noexcept
    {
        units_[sector][offset / UnitBytes].unreadable = true;
    }

private:
    static constexpr std::size_t kUnitWords = UnitBytes / 4U;
    static constexpr std::uint64_t kNever = ~std::uint64_t{0};

    struct Unit {
        std::array<std::uint32_t, kUnitWords> words{};
        bool unreadable = false;
    };
    static constexpr Unit kErased = [] {
        Unit unit;
        unit.words.fill(0xFFFFFFFF);
        return unit;
    }();

    bool change(Unit& unit, const Unit& to) noexcept
    {
        if (is_cut()) {
            return false;
        }
        if (steps_ == cut_) {
            const Unit before = unit;
            for (std::size_t i = 0; i < kUnitWords; ++i) {
                unit.words[i] ^= (unit.words[i] ^ to.words[i]) & std::rotl(mask_, static_cast<int>(7 * i));
            }
            if (unit.words == to.words) {
                unit.unreadable = to.unreadable;
            } else if (kHasCode && Wrong == WrongCode::unreadable && unit.words != before.words) {
                unit.unreadable = true;
            }
        } else {
            unit = to;
        }
        ++steps_;
        return !is_cut();
    }

    std::array<std::array<Unit, kUnits>, kSectors> units_;
    std::uint64_t steps_ = 0;
    std::uint64_t cut_ = kNever;
    std::uint32_t mask_ = 0;
    std::uint32_t erases_ = 0;
};

}  // namespace jink::hal
