// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/reach/intruder.hpp"

// The intruders that are looked at in one frame: when there are too many, those that come first.

namespace jink::reach {

/// Intruders at once. Each costs 48 bytes here and 8 for each cell in a table of `fill_meetings`: 45 KiB of 16 for 350
/// cells. When full, the one that comes into the grid last gives way (of two at the same time, the one of the greater
/// id), and IntruderTable::overflow() counts it: the caller is to take that as an emergency.
inline constexpr std::size_t kMaxReachIntruders = 16;
static_assert(kMaxReachIntruders >= 1 && kMaxReachIntruders <= 256);

/// When an intruder may come into a grid's range, wherever in it, deviating within its spread: 0 for one inside,
/// infinite for one that does not come. Never later than the truth. O(1).
[[nodiscard]] float entry_time(const Grid<float>& grid, const Intruder& intruder) noexcept;

struct TableIntruder {
    std::uint32_t id = 0;
    float entry = 0.0F;  ///< [s]
    Intruder intruder;
};

/// Memory: kMaxReachIntruders entries.
class IntruderTable {
public:
    void clear() noexcept;
    /// False when it, or another one in its place, has no room. O(kMaxReachIntruders).
    bool add(const Grid<float>& grid, std::uint32_t id, const Intruder& intruder) noexcept;

    [[nodiscard]] std::span<const TableIntruder> intruders() const noexcept { return {kept_.data(), kept_.size()}; }
    /// That were left out since clear().
    [[nodiscard]] std::size_t overflow() const noexcept { return overflow_; }

private:
    StaticVector<TableIntruder, kMaxReachIntruders> kept_;
    std::size_t overflow_ = 0;
};

}  // namespace jink::reach
