// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace jink::link::mavlink {

/// What a sample of the remote clock told.
enum class ClockEvent : std::uint8_t { none, relocked_forward, relocked_backward };

/// Maps the autopilot's boot clock to ours.
///
/// Two kinds of samples:
/// * A one-way sample (stamp and arrival) bounds the offset from above: a stamp cannot arrive before it was made.
/// * A TIMESYNC round trip bounds the offset from both sides; its midpoint is the estimate, the quickest one wins.
/// Both over the last 5 to 10 s, so drift of 100 ppm stays below 1 ms. While a round trip is younger than kRoundTripAge
/// the round trips alone decide; one-way samples take over when the answers end. O(1). All times in microseconds.
///
/// Contract: `arrived` and `received` are read from our clock after the bytes were read, `sent` before the request is
/// written. A line, a driver or a reader that stalls then makes bounds wider, never wrong:
/// * Restart (relocked_backward): three one-way samples in a row from below the newest stamp, or three round trips in a
///   row whose lower bound lies above the known offset by more than kJump. A stall in which the order of stamps is kept
///   does neither. A restart is recognised with the third stamp below the newest one, at the latest with the third
///   answered round trip: 4 s at one a second.
/// * relocked_forward: three round trips in a row below the known offset by more than kJump and their own doubt, or,
///   without round trips, three one-way samples from the future. A boot clock cannot leap forward by more than the
///   delay of what was heard first: over kLongestDelay it is a restart behind the wrap of 32 bits.
/// A stamp that is merely late moves nothing: mapped by the clock as known, the stamp shows its age.
class ClockSync {
public:
    static constexpr std::int64_t kJump = 200'000;
    static constexpr int kJumpsToBelieve = 3;
    static constexpr std::int64_t kBucket = 5'000'000;
    static constexpr std::int64_t kRoundTripAge = 10'000'000;
    static constexpr std::int64_t kLongestDelay = 3'600'000'000;

    ClockEvent one_way(std::int64_t remote, std::int64_t arrived) noexcept;
    /// Request sent at `sent`, answered at remote time `remote`, answer received at `received`. Refused (none) when it
    /// took over 1 s.
    ClockEvent round_trip(std::int64_t sent, std::int64_t remote, std::int64_t received) noexcept;

    /// Our time of a remote stamp; nothing until a first sample.
    [[nodiscard]] std::optional<std::int64_t> to_local(std::int64_t remote) const noexcept;

    /// Extends a 32-bit millisecond stamp to a 64-bit one, following its wrap after 49.7 days [us].
    [[nodiscard]] std::int64_t extend(std::uint32_t boot_ms) noexcept;
    /// The same for a stamp that arrived at `arrived`: once round trips have told all 64 bits of the remote clock, the
    /// value nearest to what that clock shows. An autopilot that was up for 49.7 days before us is followed too.
    [[nodiscard]] std::int64_t extend(std::uint32_t boot_ms, std::int64_t arrived) noexcept;

    void forget() noexcept;

private:
    struct Best {
        bool known = false;
        std::int64_t offset = 0;
        std::int64_t quality = 0;  ///< smaller is better
    };
    /// Best sample of the running and of the former bucket.
    struct Window {
        Best current, former;
        std::int64_t began = 0;
        void add(std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept;
        [[nodiscard]] const Best& best() const noexcept;
    };

    [[nodiscard]] std::optional<std::int64_t> offset() const noexcept;
    /// Whether round trips decide at `now`; drops them when they are old and one-way samples are there.
    [[nodiscard]] bool decide_round_trips(std::int64_t now) noexcept;
    /// Forgets all samples but this one.
    void restart(Window& window, std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept;

    Window one_way_;
    Window round_trip_;
    int ahead_ = 0;                   ///< one-way samples from the future, in a row
    int behind_ = 0;                  ///< one-way samples from before what was heard, in a row
    int disagreements_ = 0;           ///< round trips in a row: above the known offset counts up, below counts down
    std::int64_t round_trip_at_ = 0;  ///< the last one that was taken
    std::int64_t newest_ = 0;         ///< latest remote stamp that was believed
    bool extended_known_ = false;
    std::uint32_t last_ms_ = 0;
    std::int64_t extended_ms_ = 0;
};

}  // namespace jink::link::mavlink
