// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace jink::link {

/// RangeReading::sensor of MAVLink's sensors is below this, that of DroneCAN's is not.
inline constexpr std::size_t kMavlinkSensors = 32;

/// Numbers for range sensors that are kept apart by more than RangeReading::sensor holds: by who sends, its own id, and
/// where it looks. When all `N` are taken, the one that has been silent for longest is given away, and `evicted` counts
/// it. 8 bytes each and a stamp.
template <std::size_t N>
class SensorSlots {
public:
    /// 0 to N - 1. O(N).
    [[nodiscard]] std::uint8_t of(std::uint32_t key, TimePoint now) noexcept
    {
        Slot* oldest = slots_.data();
        for (Slot& slot : slots_) {
            if (slot.used && slot.key == key) {
                slot.heard = now;
                return number(slot);
            }
            const bool better = !slot.used ? oldest->used : oldest->used && slot.heard < oldest->heard;
            oldest = better ? &slot : oldest;
        }
        evicted_ += oldest->used ? 1U : 0U;
        *oldest = {true, key, now};
        return number(*oldest);
    }
    [[nodiscard]] std::uint32_t evicted() const noexcept { return evicted_; }

private:
    static_assert(N > 0 && N <= 256);
    struct Slot {
        bool used = false;
        std::uint32_t key = 0;
        TimePoint heard;
    };
    [[nodiscard]] std::uint8_t number(const Slot& slot) const noexcept
    {
        return static_cast<std::uint8_t>(&slot - slots_.data());
    }

    std::array<Slot, N> slots_{};
    std::uint32_t evicted_ = 0;
};

}  // namespace jink::link
