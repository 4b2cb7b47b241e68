// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/sim/record.hpp"
#include "toolchain/sim/timing.hpp"

namespace jink::sim {

/// Flies the same scenario `count` times in process, with timings of the seeds from `first` on (timing.hpp).
[[nodiscard]] std::vector<Record> fly_phases(const Scenario& scenario, std::uint64_t first, unsigned count,
                                             const Spread& spread);

}  // namespace jink::sim
