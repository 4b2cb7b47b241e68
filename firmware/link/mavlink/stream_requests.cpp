// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/stream_requests.hpp"

#include <algorithm>

#include "firmware/link/mavlink/messages.hpp"

namespace jink::link::mavlink {
namespace {

/// One kind of data: the message that is requested and others with the same data (0: none).
struct Need {
    std::array<std::uint32_t, 3> messages;
    std::int32_t interval_us;
    Seconds window;
    std::uint32_t least;  ///< in a window
    bool optional = false;
};

constexpr std::array<Need, StreamRequests::kMessages> kNeeds{{
    // OWN_AGE is 0.5 s, and half a second at 5 m/s exceeds the own box: 10 Hz at least, 50 Hz wanted.
    {{LocalPositionNed::kInfo.id, Odometry::kInfo.id, 0}, 20'000, 1.0F, 10},
    // A heading can place ranges for a second.
    {{AttitudeQuaternion::kInfo.id, Attitude::kInfo.id, Odometry::kInfo.id}, 100'000, 1.0F, 4},
    {{MissionCurrent::kInfo.id, 0, 0}, 500'000, 3.0F, 1},
    {{ExtendedSysState::kInfo.id, 0, 0}, 1'000'000, 4.0F, 1},
    {{GpsGlobalOrigin::kInfo.id, 0, 0}, 5'000'000, 12.0F, 1},
    {{HomePosition::kInfo.id, 0, 0}, 5'000'000, 12.0F, 1},
    // ArduPilot sends one aircraft at a time, and each at most once a second.
    {{AdsbVehicle::kInfo.id, 0, 0}, 50'000, 6.0F, 1, true},
    // For the height of traffic with a barometer alone.
    {{ScaledPressure::kInfo.id, 0, 0}, 1'000'000, 6.0F, 1, true},
}};

}  // namespace

void StreamRequests::heard(std::uint32_t message_id) noexcept
{
    for (std::size_t i = 0; i < kMessages; ++i) {
        const auto& messages = kNeeds[i].messages;
        const bool brings =
            message_id != 0 && std::find(messages.begin(), messages.end(), message_id) != messages.end();
        watches_[i].count += brings ? 1U : 0U;
    }
}

void StreamRequests::refused() noexcept
{
    if (last_ < kMessages && kNeeds[last_].optional) {
        watches_[last_].given_up = true;
    }
}

std::optional<StreamRequest> StreamRequests::next(TimePoint now) noexcept
{
    if (!begun_) {
        begun_ = true;
        for (Watch& watch : watches_) {
            watch.began = now;
        }
    }
    for (std::size_t i = 0; i < kMessages; ++i) {
        Watch& watch = watches_[i];
        const Need& need = kNeeds[i];
        if (watch.given_up || now - watch.began < need.window) {
            continue;
        }
        const bool enough = watch.count >= need.least;
        watch.began = now;
        watch.count = 0;
        if (enough) {
            watch.tries = 0;
        } else if (watch.tries < kTries || now - watch.asked >= kRest) {
            watch.tries = std::min(watch.tries + 1, kTries);
            watch.asked = now;
            last_ = i;
            return StreamRequest{need.messages[0], need.interval_us};
        }
    }
    return std::nullopt;
}

}  // namespace jink::link::mavlink
