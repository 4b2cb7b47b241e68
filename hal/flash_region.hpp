// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace jink::hal {

/// Two sectors of NOR flash of one size, programmed by units of unit_bytes(). Programming a unit changes bits from 1 to
/// 0 only; erasing a sector sets all of its bits. A power cut leaves any subset of the intended bit changes in the unit
/// being programmed or in the sector being erased; all other memory is unchanged.
///
/// Flash with an error-correcting code keeps one code per unit. Its units are programmed once after an erase, as a
/// second program would leave a wrong code. A unit with a wrong code, as after a power cut, may be unreadable.
///
/// Program and erase may stop the processor until they end. Sectors are 0 and 1; offsets [bytes] are below
/// sector_bytes(). Not thread-safe.
class FlashRegion {
public:
    static constexpr std::uint32_t kSectors = 2;
    static constexpr std::uint32_t kMaxUnitBytes = 32;

    /// A multiple of unit_bytes().
    [[nodiscard]] virtual std::uint32_t sector_bytes() const noexcept = 0;
    /// 4, 8, 16 or 32.
    [[nodiscard]] virtual std::uint32_t unit_bytes() const noexcept = 0;
    /// `offset` is a multiple of 4. Nothing: the unit is unreadable.
    [[nodiscard]] virtual std::optional<std::uint32_t> read(std::uint32_t sector, std::uint32_t offset) noexcept = 0;
    /// Takes 0.2 ms at most. `offset` is a multiple of unit_bytes(), `unit` has as many. True: the unit now reads as
    /// `unit`. False: any of its bits may have been cleared, or it may be unreadable.
    [[nodiscard]] virtual bool program(std::uint32_t sector, std::uint32_t offset,
                                       std::span<const std::uint32_t> unit) noexcept = 0;
    /// Takes seconds. False: the sector may be unchanged, erased, unreadable, or anything between.
    [[nodiscard]] virtual bool erase(std::uint32_t sector) noexcept = 0;

protected:
    ~FlashRegion() = default;
};

}  // namespace jink::hal
