// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::app {

/// Counts of the co-processor's parts since start; those of the tables and of the supervisor have accessors of their
/// own. Coprocessor owns the counts, and each part counts what it does.
struct Diagnostics {
    std::uint32_t steps = 0;
    std::uint32_t deadlines_missed = 0;
    std::uint32_t setpoints = 0;
    std::uint32_t setpoints_withheld = 0;  ///< ticks of the stream whose velocity was not finite
    std::uint32_t own_states = 0;
    std::uint32_t own_state_refused = 0;  ///< stamped in the future, or older than what is known
    std::uint32_t estimator_resets = 0;
    std::uint32_t autopilot_reboots = 0;
    std::uint32_t params_set = 0;
    std::uint32_t params_refused = 0;
    std::uint32_t params_unknown = 0;
    std::uint32_t commands = 0;
    std::uint32_t commands_refused = 0;
    std::uint32_t scans = 0;
    std::uint32_t readings = 0;
    std::uint32_t readings_refused = 0;  ///< not level, and wider than kWidestSteep
    std::uint32_t tracks_in = 0;
    std::uint32_t own_heard = 0;           ///< own transponder (JNK_OWN_ICAO), heard back
    std::uint32_t legs_dropped = 0;        ///< the autopilot went on to a place that is not known
    std::uint32_t faults = 0;              ///< times the state became CRITICAL
    std::uint32_t bus_states = 0;          ///< own states of the bus that were used: the autopilot's was missing or old
    std::uint32_t bus_states_beside = 0;   ///< own states of the bus beside the autopilot's
    std::uint32_t bus_states_refused = 0;  ///< stamped in the future, or older than what is known
    std::uint32_t bus_reports_dropped = 0;  ///< reports of the bus, placed before the frame changed within the step
    std::uint32_t places_disagree = 0;      ///< times the autopilot's and the bus's own place came to differ too much
    std::uint32_t frame_changes = 0;        ///< from the bus's own frame to the autopilot's: all places forgotten
    std::uint32_t origin_changes = 0;       ///< a better or another origin of the link: tracks moved by as much
    std::uint32_t tracks_not_moved = 0;     ///< and were forgotten: the origin moved by more than the map reaches
    std::uint32_t near_reported = 0;        ///< NearObjects sent
    std::uint32_t tables_checked = 0;       ///< times all tables of the reach sets were found good while flying
    std::uint32_t map_coarse =
        0;  ///< steps in which boxes stood for pieces of the map nearer than the vehicle can stop
};

}  // namespace jink::app
