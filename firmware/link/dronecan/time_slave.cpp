// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/time_slave.hpp"

namespace jink::link::dronecan {
namespace {

constexpr unsigned kTransferMask = 31;

}  // namespace

void TimeSlave::receive(std::uint8_t master, std::uint8_t transfer, std::uint64_t previous, TimePoint arrived) noexcept
{
    const std::uint8_t current = this->master(arrived);
    if (current != 0 && master > current) {
        ++diagnostics_.other_masters;
        return;
    }
    const bool known = master == current;
    if (!known) {  // after a silence the master's clock may have changed
        has_offset_ = false;
        diagnostics_.master_changes += master_ != 0 && master != master_ ? 1U : 0U;
    }
    const bool pair = known && transfer == ((transfer_ + 1U) & kTransferMask) && previous != 0;
    if (pair) {
        const std::int64_t offset = arrived_.us - static_cast<std::int64_t>(previous);
        const std::int64_t moved = offset > offset_ ? offset - offset_ : offset_ - offset;
        if (has_offset_ && moved > kJump) {
            ++diagnostics_.jumps;
        }
        offset_ = offset;
        has_offset_ = true;
        ++diagnostics_.updates;
    } else {
        ++diagnostics_.not_a_pair;
    }
    master_ = master;
    transfer_ = transfer;
    arrived_ = arrived;
}

std::uint8_t TimeSlave::master(TimePoint now) const noexcept
{
    return master_ != 0 && now - arrived_ <= kMasterTimeout ? master_ : std::uint8_t{0};
}

std::optional<TimePoint> TimeSlave::to_local(std::uint64_t stamp, TimePoint now) const noexcept
{
    if (!has_offset_ || master(now) == 0) {
        return std::nullopt;
    }
    return TimePoint{static_cast<std::int64_t>(stamp) + offset_};
}

}  // namespace jink::link::dronecan
