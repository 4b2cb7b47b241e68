// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "firmware/app/coprocessor.hpp"
#include "firmware/linux/complaint.hpp"
#include "firmware/linux/flight_log/recording_ports.hpp"
#include "firmware/linux/map_file.hpp"
#include "hal/linux/system_clock.hpp"

// Files that jinkd reads before its first step, with what it says of them.

namespace jink::host {

/// Says what is wrong, a line each.
void complain(const files::Complaints& complaints);

/// Closes what the file says. False, and said why, where the file is not good.
/// @param recorder  of what the co-processor is given; may be nullptr
[[nodiscard]] bool load_airspace(const std::string& file, hal::SystemClock& clock, app::Coprocessor& coprocessor,
                                 flightlog::HalRecorder* recorder);

/// The map of a file, or nothing, and said why.
[[nodiscard]] std::optional<files::MapTables> load_map(const std::string& file);

/// Parameters that were set over a link before the last stop. What is wrong there is left out, and said.
void load_state(const std::string& file, app::Parameters& parameters);

}  // namespace jink::host
