// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/capacity.hpp"

namespace jink::link::mavlink {

/// What is remembered of the other systems of a link: their boot clocks, and whether they are armed.
///
/// A radio network queues. What it brings late must not be taken for new, so each system's boot clock is mapped to ours
/// by the rules that ClockSync has for one-way samples, in 24 bytes a system: the least delay of the last 5 to 10 s
/// counts as none; three stamps in a row from the future, or from before those already heard (a restart), move the
/// clock; a stamp that is merely late shows its age. What every message takes at least cannot be seen.
///
/// Memory: kMaxTracks * 24 bytes. When full, the system that was not heard for longest gives way and evicted() counts
/// it: its next stamp counts as new.
class Neighbours {
public:
    /// A stamp of `system`, just arrived. @return our time of it, never after `now`. O(kMaxTracks).
    [[nodiscard]] TimePoint stamp(std::uint8_t system, std::uint32_t boot_ms, TimePoint now) noexcept;

    /// Its heartbeat.
    void note_armed(std::uint8_t system, bool armed, TimePoint now) noexcept;
    /// It has said so, and nothing else since. O(kMaxTracks).
    [[nodiscard]] bool is_disarmed(std::uint8_t system) const noexcept;

    [[nodiscard]] std::uint32_t evicted() const noexcept { return evicted_; }

private:
    /// All clocks in milliseconds modulo 2^32: differences follow the wrap of the wire's own.
    struct System {
        std::uint32_t heard = 0;
        std::uint32_t least = 0;   ///< our clock less its, the least of the running bucket
        std::uint32_t former = 0;  ///< and of the one before
        std::uint32_t began = 0;   ///< the running bucket
        std::uint32_t newest = 0;  ///< of its stamps that were believed
        std::uint8_t id = 0;
        std::int8_t ahead = 0;   ///< stamps from the future, in a row
        std::int8_t behind = 0;  ///< from before what was heard, in a row
        bool has_clock : 1 = false;
        bool has_former : 1 = false;
        bool disarmed : 1 = false;

        [[nodiscard]] std::uint32_t best() const noexcept;
    };
    static_assert(sizeof(System) == 24);

    [[nodiscard]] System& of(std::uint8_t id, std::uint32_t now) noexcept;
    static void start_clock(System& system, std::uint32_t boot, std::uint32_t now) noexcept;
    static void add(System& system, std::uint32_t sample, std::uint32_t now) noexcept;

    StaticVector<System, kMaxTracks> systems_;
    std::uint32_t evicted_ = 0;
};

}  // namespace jink::link::mavlink
