// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace jink::link::mavlink {

/// Result of a sample of the remote clock.
enum class ClockEvent : std::uint8_t { none, relocked_forward, relocked_backward };

/// Maps the autopilot's boot clock to ours.
///
/// Two kinds of samples:
/// * A one-way sample (stamp and arrival) bounds the offset from above: a stamp cannot arrive before it was made.
/// * A TIMESYNC round trip bounds the offset from both sides; its midpoint is the estimate. The fastest round trip
///   wins.
/// Both use the samples of the last 5 to 10 s, so drift of 100 ppm stays below 1 ms. While a round trip is younger than
/// kRoundTripAge the round trips alone decide; one-way samples take over when the answers end. O(1). All times in
/// microseconds.
///
/// Contract: `arrived` and `received` are read from our clock after the bytes were read, `sent` before the request is
/// written. So a line, a driver or a reader that stalls makes bounds wider, never wrong:
/// * Restart (relocked_backward): three consecutive one-way samples below the newest stamp, or three consecutive round
///   trips whose lower bound lies above the known offset by more than kJump. A stall that keeps the order of stamps
///   causes neither. A restart is detected with the third stamp below the newest one, at the latest with the third
///   answered round trip: 4 s at one a second.
/// * relocked_forward: three consecutive round trips below the known offset by more than kJump and their own
///   uncertainty, or, without round trips, three one-way samples from the future. A boot clock cannot jump forward by
///   more than the delay of the first samples: a jump over kLongestDelay is a restart after the wrap of 32 bits.
/// A stamp that is merely late changes nothing: mapped by the known clock, the stamp shows its age.
class ClockSync {
public:
    static constexpr std::int64_t kJump = 200'000;
    static constexpr int kJumpsToBelieve = 3;
    static constexpr std::int64_t kBucket = 5'000'000;
    static constexpr std::int64_t kRoundTripAge = 10'000'000;
    static constexpr std::int64_t kLongestDelay = 3'600'000'000;
    /// Without round trips a restart after such a silence may look like a late stamp for good, if the remote clock
    /// shows more than when it was heard last. Users of one-way samples alone forget() the clock then; no report is
    /// kept for longer.
    static constexpr std::int64_t kUnheard = 10'000'000;

    ClockEvent one_way(std::int64_t remote, std::int64_t arrived) noexcept;
    /// Request sent at `sent`, answered at remote time `remote`, answer received at `received`. Rejected (none) if it
    /// took over 1 s.
    ClockEvent round_trip(std::int64_t sent, std::int64_t remote, std::int64_t received) noexcept;

    /// Local time of a remote stamp; nothing before the first sample.
    [[nodiscard]] std::optional<std::int64_t> to_local(std::int64_t remote) const noexcept;

    /// Extends a 32-bit millisecond stamp to a 64-bit one, following its wrap after 49.7 days [us].
    [[nodiscard]] std::int64_t extend(std::uint32_t boot_ms) noexcept;
    /// The same for a stamp that arrived at `arrived`. Once round trips have given all 64 bits of the remote clock, the
    /// result is the value nearest to that clock. This covers an autopilot that was up for 49.7 days before us.
    [[nodiscard]] std::int64_t extend(std::uint32_t boot_ms, std::int64_t arrived) noexcept;

    void forget() noexcept;

private:
    struct Best {
        bool known = false;
        std::int64_t offset = 0;
        std::int64_t quality = 0;  ///< smaller is better
    };
    /// Best sample of the current bucket and of the previous one.
    struct Window {
        Best current, former;
        std::int64_t began = 0;
        void add(std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept;
        [[nodiscard]] const Best& best() const noexcept;
    };

    [[nodiscard]] std::optional<std::int64_t> offset() const noexcept;
    /// Whether round trips decide at `now`; drops them if they are old and one-way samples exist.
    [[nodiscard]] bool decide_round_trips(std::int64_t now) noexcept;
    /// Discards all samples but this one.
    void restart(Window& window, std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept;

    Window one_way_;
    Window round_trip_;
    int ahead_ = 0;                   ///< consecutive one-way samples from the future
    int behind_ = 0;                  ///< consecutive one-way samples from before the newest stamp
    int disagreements_ = 0;           ///< consecutive round trips: above the known offset counts up, below counts down
    std::int64_t round_trip_at_ = 0;  ///< the last round trip that was accepted
    std::int64_t newest_ = 0;         ///< latest remote stamp that was accepted
    bool extended_known_ = false;
    std::uint32_t last_ms_ = 0;
    std::int64_t extended_ms_ = 0;
};

}  // namespace jink::link::mavlink
