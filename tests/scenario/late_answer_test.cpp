// SPDX-License-Identifier: BSD-3-Clause
// Vehicles that reach a new velocity in part and stop late (TruthLimits::drag), by jink's parameters as delivered.
#include <string>

#include <gtest/gtest.h>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::sim {
namespace {

/// Across the leg, 62 m wide and higher than anybody gets in time: a stop is the only answer at first.
std::string wide_wall(double drag, int seen_from)
{
    return "title: a wide wall, seen by a level range scan\n"
           "stack: px4\n"
           "duration: 40\n"
           "mission: [[0, 0, 30], [100, 0, 30]]\n"
           "vehicle: {max_acceleration: 8, max_vertical_acceleration: 8, drag: " +
           std::to_string(drag) +
           "}\n"
           "threats:\n"
           "  - {name: wall, radius: 1.0, half_height: 60, position: [45, 0, 30], sensed_by: scan, "
           "grid: {across: 31, up: 1, step: 2.0, direction: [0, 1, 0]}}\n"
           "scan: {rate: 10, range: " +
           std::to_string(seen_from) + "}\nexpect: {outcome: [avoided, braked]}\n";
}

/// A command to stand alone would take drag x speed / 0.4 [m], 11 from 5 m/s.
TEST(LateAnswer, AWallSeenFromTenMetresIsNotTouched)
{
    for (const double drag : {0.0, 0.3, kRecordedDrag}) {
        for (const int seen_from : {10, 12, 20}) {
            const Record record = fly_in_process(parse_scenario(wide_wall(drag, seen_from), "wide_wall.yaml"));
            EXPECT_GT(record.closest.surface, record.promise) << "drag " << drag << ", seen from " << seen_from << " m";
            EXPECT_GT(record.takeovers, 0U);
        }
    }
}

}  // namespace
}  // namespace jink::sim
