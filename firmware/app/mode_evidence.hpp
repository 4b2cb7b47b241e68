// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "core/base/time.hpp"

namespace jink::app {

/// How much the newest HEARTBEAT proves of the autopilot's present mode, and when to ask for another one.
///
/// A HEARTBEAT proves nothing before it is newer than our last request of a mode, and than the accepted answer to it.
/// It proves enough to ask for a mode while it is no older than kFresh. Where a HEARTBEAT that was asked for does not
/// come within kAnswer, one no older than kPeriods of its own periods is good enough. Its period is the median of the
/// last three gaps between HEARTBEATs that nobody asked for, kShortestPeriod to kLongestPeriod.
///
/// Use: note_*() as they happen, is_clear_to_ask() in each tick in which a request of a mode is due, is_due() once at
/// the end of a tick. Pure, O(1).
class ModeEvidence {
public:
    /// A HEARTBEAT arrived.
    void note_heartbeat(TimePoint now) noexcept;
    /// Nothing is known of the present mode until another HEARTBEAT arrives.
    void discard() noexcept { is_void_ = true; }
    /// A mode is asked for.
    void note_request(TimePoint now) noexcept;
    /// The last request was accepted; a HEARTBEAT of the same tick may have come after the answer.
    void note_accepted(TimePoint now) noexcept;

    [[nodiscard]] bool is_newer_than_requests() const noexcept
    {
        return has_heard_ && !is_void_ && (!has_asked_ || heard_ > barrier_);
    }
    [[nodiscard]] bool is_fresh(TimePoint now) const noexcept
    {
        return has_heard_ && !is_void_ && now - heard_ <= kPeriods * period_;
    }
    /// No HEARTBEAT for longer than `time`; false before the first one.
    [[nodiscard]] bool was_silent(Seconds time, TimePoint now) const noexcept
    {
        return has_heard_ && now - heard_ > time;
    }
    /// A request of a mode is due: true when it may be made. A HEARTBEAT is asked for otherwise.
    [[nodiscard]] bool is_clear_to_ask(TimePoint now) noexcept;
    /// Nothing is asked for yet, but the mode has to be known.
    void need_heartbeat() noexcept { needed_ = true; }

    /// At the end of a tick: whether to ask for a HEARTBEAT.
    ///
    /// @param kept_fresh one may be due at any time, or the effect of one is to be seen soon: asked for from an age of
    ///                   half kFresh on, as for a mode that has to be known
    [[nodiscard]] bool is_due(bool kept_fresh, TimePoint now) noexcept;

    /// A HEARTBEAT this young is evidence by itself [s]: about what a line and a pilot's hand take.
    static constexpr Seconds kFresh = 0.1F;
    /// An answer comes within this, or is not waited for [s].
    static constexpr Seconds kAnswer = 0.25F;
    /// Asked again after this long while a request waits [s].
    static constexpr Seconds kPoll = 0.1F;
    /// Both autopilots send one a second or more; longer gaps are losses [s].
    static constexpr Seconds kLongestPeriod = 1.0F;
    static constexpr Seconds kShortestPeriod = 0.2F;
    static constexpr float kPeriods = 1.5F;

private:
    bool has_heard_ = false;
    bool is_void_ = false;        ///< the newest is no evidence
    bool heard_unasked_ = false;  ///< one was heard, and the newest came by itself
    TimePoint heard_;             ///< the newest
    bool has_asked_ = false;      ///< for any mode
    TimePoint barrier_;           ///< that request, or its accepted answer; counts once has_asked_
    Seconds period_ = kLongestPeriod;
    std::array<Seconds, 3> gaps_{kLongestPeriod, kLongestPeriod, kLongestPeriod};
    std::size_t next_gap_ = 0;
    bool needed_ = false;  ///< in this tick
    bool waits_ = false;   ///< a request waits for evidence
    TimePoint waits_since_;
    bool has_polled_ = false;  ///< since the newest HEARTBEAT
    TimePoint polled_;
};

}  // namespace jink::app
