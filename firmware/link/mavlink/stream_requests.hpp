// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/time.hpp"

namespace jink::link::mavlink {

/// A message that is to be asked for.
struct StreamRequest {
    std::uint32_t message_id = 0;
    std::int32_t interval_us = 0;
};

/// Watches how often the autopilot says what we need, and asks for what comes too seldom: ArduPilot streams little on a
/// telemetry port unless told to, PX4 by the port's profile.
///
/// Each message has a window; one that brought too few asks once, so at most once a second and message. After kTries in
/// vain it rests for kRest between further ones: an autopilot may not have it. Enough of it stops the asking. Traffic
/// and air pressure are not asked for again after a refusal: an ArduPilot without ADS-B answers each request with a
/// text of severity INFO. Pure, O(1).
class StreamRequests {
public:
    static constexpr std::size_t kMessages = 8;
    static constexpr int kTries = 5;
    static constexpr Seconds kRest = 30.0F;

    /// A message of the autopilot arrived.
    void heard(std::uint32_t message_id) noexcept;
    /// What to ask for now, one at a time. The first call begins the windows.
    [[nodiscard]] std::optional<StreamRequest> next(TimePoint now) noexcept;
    /// The request of last was refused.
    void refused() noexcept;
    /// The autopilot has restarted: what it was asked for is forgotten.
    void restart() noexcept { *this = {}; }

private:
    struct Watch {
        TimePoint began;
        TimePoint asked;
        std::uint32_t count = 0;
        int tries = 0;  ///< in a row
        bool given_up = false;
    };
    std::size_t last_ = kMessages;  ///< asked for
    bool begun_ = false;
    std::array<Watch, kMessages> watches_{};
};

}  // namespace jink::link::mavlink
