// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/track_table.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/link/messages.hpp"

namespace jink::app {

/// The own transponder (JNK_OWN_ICAO), heard back. O(1).
[[nodiscard]] inline bool is_own_transponder(const link::TrackReport& report, const Configuration& c) noexcept
{
    return report.source == world::TrackSource::adsb && c.own_address != 0 && report.id == c.own_address;
}

/// A report of traffic as the track table wants it: values that the report lacks come from the parameters. O(1).
[[nodiscard]] world::TrackMeasurement measurement_of(const link::TrackReport& report, const Configuration& c) noexcept;

}  // namespace jink::app
