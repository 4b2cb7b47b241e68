// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/clock_sync.hpp"

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

ClockEvent ClockSync::one_way(std::int64_t remote, std::int64_t arrived) noexcept
{
    const std::int64_t sample = arrived - remote;
    const std::optional<std::int64_t> known = offset();
    if (!known) {
        newest_ = remote;
        one_way_.add(sample, sample, arrived);
        return ClockEvent::none;
    }
    const bool from_future = sample < *known - kJump;
    const bool late = sample > *known + kJump;
    const bool from_past = late && remote < newest_ - kJump;
    ahead_ = from_future ? ahead_ + 1 : 0;
    behind_ = from_past ? behind_ + 1 : 0;
    if (ahead_ >= kJumpsToBelieve || behind_ >= kJumpsToBelieve) {
        newest_ = remote;
        restart(one_way_, sample, sample, arrived);
        return from_past ? ClockEvent::relocked_backward : ClockEvent::relocked_forward;
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
    const std::optional<std::int64_t> known = offset();
    const std::int64_t slack = kJump + took / 2;
    if (known && (sample - *known > slack || *known - sample > slack)) {
        if (++disagreements_ < kJumpsToBelieve) {
            return ClockEvent::none;
        }
        newest_ = remote;
        restart(round_trip_, sample, took, received);
        // A greater offset means that the remote clock shows less than before: it went back.
        return sample > *known ? ClockEvent::relocked_backward : ClockEvent::relocked_forward;
    }
    disagreements_ = 0;
    if (!known) {
        newest_ = remote;
    }
    round_trip_.add(sample, took, received);
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

void ClockSync::forget() noexcept { *this = {}; }

}  // namespace jink::link::mavlink
