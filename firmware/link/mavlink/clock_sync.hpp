// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace jink::link::mavlink {

/// What a sample of the remote clock told.
enum class ClockEvent : std::uint8_t { none, relocked_forward, relocked_backward };

/// Maps the autopilot's boot clock to ours.
///
/// Two sources: one-way samples (arrival less stamp: the true offset plus the line's delay, so the least one is kept)
/// and TIMESYNC round trips (midpoint; the quickest one is kept, and wins). Both over the last 5 to 10 s, so drift of
/// 100 ppm stays below 1 ms. O(1). All times in microseconds.
///
/// A clock that jumped is told from a line that stalled: a stall can only make stamps late, in their order. So the
/// clock is moved when three samples in a row come from the future (by more than kJump), or from before stamps already
/// heard (a restart), or when three round trips in a row disagree by more than kJump and half their duration. A stamp
/// that is merely late moves nothing: mapped by the clock as known, it shows its age.
class ClockSync {
public:
    static constexpr std::int64_t kJump = 200'000;
    static constexpr int kJumpsToBelieve = 3;
    static constexpr std::int64_t kBucket = 5'000'000;

    ClockEvent one_way(std::int64_t remote, std::int64_t arrived) noexcept;
    /// Request sent at `sent`, answered at remote time `remote`, answer received at `received`. Refused (none) when it
    /// took over 1 s.
    ClockEvent round_trip(std::int64_t sent, std::int64_t remote, std::int64_t received) noexcept;

    /// Our time of a remote stamp; nothing until a first sample.
    [[nodiscard]] std::optional<std::int64_t> to_local(std::int64_t remote) const noexcept;

    /// Extends a 32-bit millisecond stamp to a 64-bit one, following its wrap after 49.7 days [us].
    [[nodiscard]] std::int64_t extend(std::uint32_t boot_ms) noexcept;

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
    /// Forgets all samples but this one.
    void restart(Window& window, std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept;

    Window one_way_;
    Window round_trip_;
    int ahead_ = 0;            ///< one-way samples from the future, in a row
    int behind_ = 0;           ///< one-way samples from before what was heard, in a row
    int disagreements_ = 0;    ///< round trips, in a row
    std::int64_t newest_ = 0;  ///< latest remote stamp that was believed
    bool extended_known_ = false;
    std::uint32_t last_ms_ = 0;
    std::int64_t extended_ms_ = 0;
};

}  // namespace jink::link::mavlink
