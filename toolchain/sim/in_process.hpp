// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/timing.hpp"

namespace jink::sim {

/// Flies a scenario with the co-processor in this process. Coprocessor and MAVLink endpoint are at one end of a line in
/// memory, the plant at the other, both on one simulated clock. Runs as fast as the host allows. The same scenario
/// gives the same record, except for step times (processor time of the thread).
///
/// @param steps  where given, receives the line's traffic of each step (step_record.hpp)
[[nodiscard]] Record fly_in_process(const Scenario& scenario, std::ostream* steps = nullptr);

/// The same with another timing.
[[nodiscard]] Record fly_in_process(const Scenario& scenario, const Timing& timing, std::ostream* steps = nullptr);

/// The same with MAVLink through the tunnel of a DroneCAN bus of 1 Mbit/s in memory (tunnel_line.hpp).
[[nodiscard]] Record fly_through_tunnel(const Scenario& scenario);

/// The same flight without a co-processor.
[[nodiscard]] Record fly_alone(const Scenario& scenario);

}  // namespace jink::sim
