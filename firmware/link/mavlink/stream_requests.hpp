// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/time.hpp"

namespace jink::link::mavlink {

/// A message to request.
struct StreamRequest {
    std::uint32_t message_id = 0;
    std::int32_t interval_us = 0;
};

/// Monitors the rates of the autopilot's messages, and requests those that come too seldom: ArduPilot streams little on
/// a telemetry port unless requested, PX4 by the port's profile.
///
/// Each message has a window. A window with too few messages causes one request, so at most one a second and message.
/// After kTries in vain the requests are kRest apart: an autopilot may not have the message. Enough messages stop the
/// requests. Traffic and air pressure are not requested again after a refusal: an ArduPilot without ADS-B answers each
/// request with a text of severity INFO. Pure, O(1).
class StreamRequests {
public:
    static constexpr std::size_t kMessages = 8;
    static constexpr int kTries = 5;
    static constexpr Seconds kRest = 30.0F;

    /// A message of the autopilot arrived.
    void heard(std::uint32_t message_id) noexcept;
    /// The next request, one at a time. The first call begins the windows.
    [[nodiscard]] std::optional<StreamRequest> next(TimePoint now) noexcept;
    /// The last request was refused.
    void refused() noexcept;
    /// The autopilot has restarted: all requests are discarded.
    void restart() noexcept { *this = {}; }

private:
    struct Watch {
        TimePoint began;
        TimePoint asked;
        std::uint32_t count = 0;
        int tries = 0;  ///< consecutive
        bool given_up = false;
    };
    std::size_t last_ = kMessages;  ///< last requested
    bool begun_ = false;
    std::array<Watch, kMessages> watches_{};
};

}  // namespace jink::link::mavlink
