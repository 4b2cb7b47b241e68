// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/plant.hpp"

namespace jink::sim {

/// Flies a scenario with the co-processor in this process: Coprocessor and MAVLink endpoint at one end of a cable in
/// memory, the plant at the other, both on one clock that stands still until it is told. As fast as the machine allows;
/// the same scenario gives the same record, wall times aside.
[[nodiscard]] Record fly_in_process(const Scenario& scenario);

/// The same flight with nobody at the other end of the cable: what would have happened.
[[nodiscard]] Record fly_alone(const Scenario& scenario);

}  // namespace jink::sim
