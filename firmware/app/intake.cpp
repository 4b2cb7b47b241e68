// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/intake.hpp"

#include <algorithm>

#include "firmware/link/geoid.hpp"

namespace jink::app {

std::uint32_t Intake::read(TimePoint now) noexcept
{
    if (bus_ != nullptr) {
        bus_->receive(now, inbox_);
        was_bus_up_ = was_bus_up_ || !bus_->is_lost();
    }
    bus_tracks_ = inbox_.tracks.size();
    const std::size_t n = port_.read(bytes_);
    link_.receive({bytes_.data(), n}, now, inbox_);
    return static_cast<std::uint32_t>(n);
}

void Intake::drop_bus_reports() noexcept
{
    counts_.bus_reports_dropped += static_cast<std::uint32_t>(bus_tracks_) + (inbox_.has_bus_state ? 1U : 0U);
    const auto first = inbox_.tracks.begin();
    std::copy(first + static_cast<std::ptrdiff_t>(bus_tracks_), inbox_.tracks.end(), first);
    inbox_.tracks.resize(inbox_.tracks.size() - bus_tracks_);
    inbox_.has_bus_state = false;
}

FrameChange Intake::settle_frame(bool has_autopilot) noexcept
{
    if (bus_ == nullptr || !(has_autopilot || inbox_.has_autopilot)) {
        return FrameChange::none;
    }
    for (std::size_t i = 0; i < bus_tracks_; ++i) {
        if (inbox_.tracks[i].height == link::HeightSource::geometric) {
            link::hold_both_readings(inbox_.tracks[i], link_.undulation());
        }
    }
    const bool rebooted = inbox_.has_autopilot && inbox_.autopilot.rebooted;
    const std::optional<link::GlobalPosition> origin = link_.origin();
    if (follows_origin_ && origin == origin_ && !rebooted) {
        return FrameChange::none;
    }
    drop_bus_reports();
    const bool begins = !follows_origin_;
    counts_.frame_changes += begins ? 1U : 0U;
    bus_->follow_origin(origin);
    follows_origin_ = true;
    origin_ = origin;
    return begins ? FrameChange::begun : FrameChange::moved;
}

}  // namespace jink::app
