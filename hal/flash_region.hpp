// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

/// Two sectors of NOR flash of one size. Programming a word changes bits from 1 to 0 only; erasing a sector sets all of
/// its bits. A power cut leaves any subset of the intended bit changes in the word being programmed or the sector being
/// erased; all other memory is unchanged.
///
/// Both operations may stop the processor until they end. Sectors are 0 and 1; offsets [bytes] are multiples of 4 below
/// sector_bytes(). Not thread-safe.
class FlashRegion {
public:
    static constexpr std::uint32_t kSectors = 2;

    /// A multiple of 4.
    [[nodiscard]] virtual std::uint32_t sector_bytes() const noexcept = 0;
    [[nodiscard]] virtual std::uint32_t read(std::uint32_t sector, std::uint32_t offset) const noexcept = 0;
    /// Takes 0.1 ms at most. True: the word now reads as `word`. False: any of its bits may have been cleared.
    [[nodiscard]] virtual bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept = 0;
    /// Takes seconds. False: the sector may be unchanged, erased, or anything between.
    [[nodiscard]] virtual bool erase(std::uint32_t sector) noexcept = 0;

protected:
    ~FlashRegion() = default;
};

}  // namespace jink::hal
