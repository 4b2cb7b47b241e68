// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/capacity.hpp"

namespace jink::link::mavlink {

/// State kept of the other systems of a link: their boot clocks, and whether they are armed.
///
/// A radio network queues, and late frames must not count as new. So each system's boot clock is mapped to ours by
/// ClockSync's rules for one-way samples, in 24 bytes a system. The least delay of the last 5 to 10 s counts as zero.
/// Three consecutive stamps from the future, or from before those already received (a restart), move the clock. A stamp
/// that is merely late shows its age. The least delay of a message is not observable. After 10 s without a stamp the
/// next one counts as new: the system may have restarted meanwhile, or its clock have drifted.
///
/// Memory: kMaxTracks * 24 bytes. When full, the system without a stamp for longest is dropped and evicted() counts it:
/// its next stamp counts as new.
class Neighbours {
public:
    /// A stamp of `system`, just arrived. @return local time of the stamp, never after `now`. O(kMaxTracks).
    [[nodiscard]] TimePoint stamp(std::uint8_t system, std::uint32_t boot_ms, TimePoint now) noexcept;

    /// Records the armed state of a heartbeat.
    void note_armed(std::uint8_t system, bool armed, TimePoint now) noexcept;
    /// Whether the last heartbeat of `system` was disarmed. O(kMaxTracks).
    [[nodiscard]] bool is_disarmed(std::uint8_t system) const noexcept;

    [[nodiscard]] std::uint32_t evicted() const noexcept { return evicted_; }

private:
    /// All clocks in milliseconds modulo 2^32: differences follow the wrap of the wire's clock.
    struct System {
        std::uint32_t heard = 0;   ///< the last stamp; before the first one, the first heartbeat
        std::uint32_t least = 0;   ///< our clock less its clock, the least of the current bucket
        std::uint32_t former = 0;  ///< and of the previous one
        std::uint32_t began = 0;   ///< start of the current bucket
        std::uint32_t newest = 0;  ///< newest accepted stamp
        std::uint8_t id = 0;
        std::int8_t ahead = 0;   ///< consecutive stamps from the future
        std::int8_t behind = 0;  ///< consecutive stamps from before the newest one
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
