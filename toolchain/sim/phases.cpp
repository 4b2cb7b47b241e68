// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/phases.hpp"

#include "toolchain/sim/in_process.hpp"

namespace jink::sim {

std::vector<Record> fly_phases(const Scenario& scenario, std::uint64_t first, unsigned count, const Spread& spread)
{
    std::vector<Record> records;
    for (unsigned i = 0; i < count; ++i) {
        const Timing timing =
            timing_of(first + i, spread, to_micros(1.0 / scenario.scan.rate), to_micros(1.0 / scenario.traffic.rate));
        records.push_back(fly_in_process(scenario, timing));
    }
    return records;
}

}  // namespace jink::sim
