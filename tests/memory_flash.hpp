// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "hal/flash_region.hpp"

namespace jink::hal {

/// Flash in memory whose power can be cut within any step. Steps: a program is one, an erase one for each word of the
/// sector.
///
/// Erased at the start. Allocation-free; 2 * SectorBytes.
template <std::uint32_t SectorBytes>
class MemoryFlash final : public FlashRegion {
public:
    static_assert(SectorBytes > 0 && SectorBytes % 4 == 0);

    MemoryFlash() noexcept
    {
        for (auto& sector : words_) {
            sector.fill(kErased);
        }
    }

    [[nodiscard]] std::uint32_t sector_bytes() const noexcept override { return SectorBytes; }
    [[nodiscard]] std::uint32_t read(std::uint32_t sector, std::uint32_t offset) const noexcept override
    {
        return words_[sector][offset / 4U];
    }
    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept override
    {
        std::uint32_t& cell = words_[sector][offset / 4U];
        const bool done = change(cell, cell & word);
        return done && cell == word;
    }
    [[nodiscard]] bool erase(std::uint32_t sector) noexcept override
    {
        erases_ += is_cut() ? 0U : 1U;
        bool done = true;
        for (std::uint32_t& cell : words_[sector]) {
            done = change(cell, kErased) && done;
        }
        return done;
    }

    /// Cuts the power within the step of this number, counted from now on: of the bits changed by this step, only those
    /// in `mask` change. All later steps fail without effect, until restore().
    void cut_at(std::uint64_t step, std::uint32_t mask) noexcept
    {
        cut_ = steps_ + step;
        mask_ = mask;
    }
    void restore() noexcept { cut_ = kNever; }
    [[nodiscard]] bool is_cut() const noexcept { return steps_ > cut_; }

    [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }
    [[nodiscard]] std::uint32_t erases() const noexcept { return erases_; }
    /// Damage.
    void flip(std::uint32_t sector, std::uint32_t offset, std::uint32_t bits) noexcept
    {
        words_[sector][offset / 4U] ^= bits;
    }

private:
    static constexpr std::uint32_t kErased = 0xFFFFFFFF;
    static constexpr std::uint64_t kNever = ~std::uint64_t{0};

    bool change(std::uint32_t& cell, std::uint32_t to) noexcept
    {
        if (is_cut()) {
            return false;
        }
        cell = steps_ == cut_ ? cell ^ ((cell ^ to) & mask_) : to;
        ++steps_;
        return !is_cut();
    }

    std::array<std::array<std::uint32_t, SectorBytes / 4>, kSectors> words_;
    std::uint64_t steps_ = 0;
    std::uint64_t cut_ = kNever;
    std::uint32_t mask_ = 0;
    std::uint32_t erases_ = 0;
};

}  // namespace jink::hal
