// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "firmware/link/messages.hpp"

namespace jink::link {

/// Keeps both possible heights of a report: senders differ in whether a geometric height is above sea level or above
/// the ellipsoid. Afterwards the height as reported and that height less the undulation both lie within `height_spread`
/// of `position`.
///
/// @param report      `position` with the height as reported; its `height_spread` is overwritten
/// @param undulation  of sea level above the ellipsoid [mm]; nothing: unknown, and the report stays unchanged
inline void hold_both_readings(TrackReport& report, const std::optional<std::int32_t>& undulation) noexcept
{
    const float half = 0.5e-3F * static_cast<float>(undulation.value_or(0));
    report.position.z() -= half;
    report.height_spread = std::abs(half);
}

}  // namespace jink::link
