// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

/// Two sectors of NOR flash of one size. Programming a word takes bits from 1 to 0 only; erasing a sector sets all of
/// its bits. A power cut leaves the word that is programmed, and the sector that is erased, with any of the bits
/// changed that were to change; nothing else.
///
/// Both operations may stop the processor until they end. Sectors are 0 and 1; offsets [bytes] are multiples of 4 below
/// sector_bytes(). For one thread.
class FlashRegion {
public:
    static constexpr std::uint32_t kSectors = 2;

    /// A multiple of 4.
    [[nodiscard]] virtual std::uint32_t sector_bytes() const noexcept = 0;
    [[nodiscard]] virtual std::uint32_t read(std::uint32_t sector, std::uint32_t offset) const noexcept = 0;
    /// Takes 0.1 ms at most. True: the word reads as `word` from now on. False: it may have any of its bits cleared.
    [[nodiscard]] virtual bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept = 0;
    /// Takes seconds. False: the sector may be as it was, erased, or anything between.
    [[nodiscard]] virtual bool erase(std::uint32_t sector) noexcept = 0;

protected:
    ~FlashRegion() = default;
};

}  // namespace jink::hal
