// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/clock_sync.hpp"

#include <algorithm>

namespace jink::link::mavlink {

void ClockSync::Window::add(std::int64_t offset, std::int64_t quality, std::int64_t now) noexcept
{
    if (!current.known || now - began >= kBucket) {
        former = current;
        current = {true, offset, quality};
        began = now;
    } else if (quality <= current.quality) {
        current = {true, offset, quality};
    }
}

const ClockSync::Best& ClockSync::Window::best() const noexcept
{
    return former.known && former.quality < current.quality ? former : current;
}

std::optional<std::int64_t> ClockSync::offset() const noexcept
{
    if (round_trip_.current.known) {
        return round_trip_.best().offset;
    }
    if (one_way_.current.known) {
        return one_way_.best().offset;
    }
    return std::nullopt;
}

void ClockSync::restart(Window& window, std::int64_t sample, std::int64_t quality, std::int64_t now) noexcept
{
    one_way_ = round_trip_ = {};
    ahead_ = behind_ = disagreements_ = 0;
    window.add(sample, quality, now);
}

bool ClockSync::decide_round_trips(std::int64_t now) noexcept
{
    if (round_trip_.current.known && now - round_trip_at_ > kRoundTripAge && one_way_.current.known) {
        round_trip_ = {};
        disagreements_ = 0;
    }
    return round_trip_.current.known;
}

ClockEvent ClockSync::one_way(std::int64_t remote, std::int64_t arrived) noexcept
{
    const std::int64_t sample = arrived - remote;
    const bool by_round_trips = decide_round_trips(arrived);
    const std::optional<std::int64_t> known = offset();
    if (!known) {
        newest_ = remote;
        one_way_.add(sample, sample, arrived);
        return ClockEvent::none;
    }
    const bool from_future = sample < *known - kJump;
    const bool late = sample > *known + kJump;
    const bool from_past = late && remote < newest_ - kJump;
    ahead_ = from_future && !by_round_trips ? ahead_ + 1 : 0;
    behind_ = from_past ? behind_ + 1 : 0;
    if (ahead_ >= kJumpsToBelieve || behind_ >= kJumpsToBelieve) {
        const bool restarted = from_past || *known - sample > kLongestDelay;
        newest_ = remote;
        restart(one_way_, sample, sample, arrived);
        return restarted ? ClockEvent::relocked_backward : ClockEvent::relocked_forward;
    }
    if (from_future || from_past) {
        return ClockEvent::none;
    }
    newest_ = remote > newest_ ? remote : newest_;
    if (!late) {
        one_way_.add(sample, sample, arrived);
    }
    return ClockEvent::none;
}

ClockEvent ClockSync::round_trip(std::int64_t sent, std::int64_t remote, std::int64_t received) noexcept
{
    constexpr std::int64_t kSlowest = 1'000'000;
    const std::int64_t took = received - sent;
    if (took < 0 || took > kSlowest) {
        return ClockEvent::none;
    }
    const std::int64_t sample = sent + took / 2 - remote;
    static_cast<void>(decide_round_trips(received));
    const std::optional<std::int64_t> known = offset();
    // The midpoint's error is at most half the duration of the round trip, both of the known round trip and of this
    // one.
    const std::int64_t doubt = kJump + took / 2 + (round_trip_.current.known ? round_trip_.best().quality / 2 : 0);
    const bool above = known && sample - *known > doubt;
    const bool below = known && *known - sample > doubt;
    if (above || below) {
        disagreements_ = above ? std::max(disagreements_, 0) + 1 : std::min(disagreements_, 0) - 1;
        if (disagreements_ < kJumpsToBelieve && disagreements_ > -kJumpsToBelieve) {
            return ClockEvent::none;
        }
        newest_ = remote;
        restart(round_trip_, sample, took, received);
        round_trip_at_ = received;
        // A greater offset means that the remote clock shows less than before: it was set back.
        return above ? ClockEvent::relocked_backward : ClockEvent::relocked_forward;
    }
    disagreements_ = 0;
    if (!known) {
        newest_ = remote;
    }
    round_trip_.add(sample, took, received);
    round_trip_at_ = received;
    return ClockEvent::none;
}

std::optional<std::int64_t> ClockSync::to_local(std::int64_t remote) const noexcept
{
    const std::optional<std::int64_t> known = offset();
    return known ? std::optional<std::int64_t>(remote + *known) : std::nullopt;
}

std::int64_t ClockSync::extend(std::uint32_t boot_ms) noexcept
{
    if (!extended_known_) {
        extended_known_ = true;
        extended_ms_ = boot_ms;
    } else {
        extended_ms_ += static_cast<std::int32_t>(boot_ms - last_ms_);
    }
    last_ms_ = boot_ms;
    return extended_ms_ * 1000;
}

std::int64_t ClockSync::extend(std::uint32_t boot_ms, std::int64_t arrived) noexcept
{
    if (round_trip_.current.known) {
        const std::int64_t shows = (arrived - round_trip_.best().offset) / 1000;
        extended_ms_ = shows + static_cast<std::int32_t>(boot_ms - static_cast<std::uint32_t>(shows));
        extended_known_ = true;
        last_ms_ = boot_ms;
        return extended_ms_ * 1000;
    }
    return extend(boot_ms);
}

void ClockSync::forget() noexcept { *this = {}; }

}  // namespace jink::link::mavlink
