// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/link/messages.hpp"

namespace jink::link::mavlink {

/// Reads the parameters that limit what a multirotor's autopilot flies in its external mode.
///
/// * ArduCopter: WPNAV_ACCEL, WPNAV_ACCEL_Z [cm/s2] and PSC_JERK_XY [m/s3]; since 4.7 WP_ACC, WP_ACC_Z [m/s2] and
///   PSC_JERK_NE or PSC_NE_JERK. Its velocity loop has the time constant acceleration / jerk, and the attitude's lag
///   comes on top (recorded: 0.6 s with 2.5 m/s2 and 5 m/s3).
/// * PX4: MPC_Z_VEL_MAX_UP, MPC_Z_VEL_MAX_DN [m/s]. In OFFBOARD it has no limit of acceleration.
///
/// One request at a time, kPeriod apart, by each name until the value is known; after kRounds in vain every kRest. A
/// value that is sent unasked counts too, so a change in flight is noticed. O(number of names).
class LimitRequests {
public:
    static constexpr Seconds kPeriod = 0.5F;
    static constexpr int kRounds = 3;
    static constexpr Seconds kRest = 30.0F;
    static constexpr Seconds kAttitudeLag = 0.1F;
    static constexpr Seconds kMaxLag = 2.0F;  ///< longer ones count as this: VEH_LAG goes no further

    enum class Outcome : std::uint8_t { not_a_limit, unchanged, changed, refused };

    /// Name to request now.
    [[nodiscard, gnu::cold]] std::optional<std::string_view> next(AutopilotStack stack, TimePoint now) noexcept;
    /// A parameter's value from the autopilot. Refused: not finite, or no value that such a limit can have.
    [[nodiscard, gnu::cold]] Outcome heard(AutopilotStack stack, std::string_view name, float value) noexcept;
    /// The autopilot has restarted: everything is requested again. What was reported holds until then.
    void restart() noexcept;

    [[nodiscard, gnu::cold]] ReportedLimits limits() const noexcept;

private:
    static constexpr std::size_t kQuantities = 5;
    std::array<float, kQuantities> reported_{};  ///< 0: not reported
    std::array<bool, kQuantities> is_new_{};     ///< reported since the autopilot's start
    std::size_t name_ = 0;                       ///< next one
    int rounds_ = 0;
    bool begun_ = false;
    TimePoint asked_;
};

}  // namespace jink::link::mavlink
