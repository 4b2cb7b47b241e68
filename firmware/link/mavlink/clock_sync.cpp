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

ClockEvent ClockSync::accept(Window& window, std::int64_t sample, std::int64_t quality, std::int64_t now) noexcept
{
    const std::optional<std::int64_t> known = offset();
    if (known && (sample - *known > kJump || *known - sample > kJump)) {
        if (++jumps_ < kJumpsToBelieve) {
            return ClockEvent::none;
        }
        // A greater offset means that the remote clock shows less than before: it went back.
        const ClockEvent event = sample > *known ? ClockEvent::relocked_backward : ClockEvent::relocked_forward;
        one_way_ = round_trip_ = {};
        jumps_ = 0;
        window.add(sample, quality, now);
        return event;
    }
    jumps_ = 0;
    window.add(sample, quality, now);
    return ClockEvent::none;
}

ClockEvent ClockSync::one_way(std::int64_t remote, std::int64_t arrived) noexcept
{
    return accept(one_way_, arrived - remote, arrived - remote, arrived);
}

ClockEvent ClockSync::round_trip(std::int64_t sent, std::int64_t remote, std::int64_t received) noexcept
{
    constexpr std::int64_t kSlowest = 1'000'000;
    const std::int64_t took = received - sent;
    if (took < 0 || took > kSlowest) {
        return ClockEvent::none;
    }
    return accept(round_trip_, sent + took / 2 - remote, took, received);
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
