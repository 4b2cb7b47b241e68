// SPDX-License-Identifier: BSD-3-Clause
// Vehicles that stop later than jink's parameters as delivered say: with drag, which nobody tells, or as ArduCopter
// does, which tells it.
#include <string>

#include <gtest/gtest.h>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::sim {
namespace {

/// Across the leg, 62 m wide and higher than anybody gets in time: a stop is the only answer at first.
std::string wide_wall(int seen_from)
{
    return "title: a wide wall, seen by a level range scan\n"
           "duration: 40\n"
           "mission: [[0, 0, 30], [100, 0, 30]]\n"
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
            Scenario s = parse_scenario(wide_wall(seen_from), "wide_wall.yaml");
            s.stack = Stack::px4;
            answer_as_px4(s.vehicle);
            s.vehicle.drag = drag;
            const Record record = fly_in_process(s);
            EXPECT_GT(record.closest.surface, record.promise) << "drag " << drag << ", seen from " << seen_from << " m";
            EXPECT_GT(record.takeovers, 0U);
        }
    }
}

/// By the parameters as delivered it was come nearer to than 0.7 m from 10 m, at 2.5 m/s2 in place of 5.
TEST(LateAnswer, ArduCopterStopsBeforeAWallBecauseItsLimitsAreRead)
{
    for (const int seen_from : {8, 10, 12, 20}) {
        Scenario s = parse_scenario(wide_wall(seen_from), "wide_wall.yaml");
        s.stack = Stack::ardupilot;
        answer_as_arducopter(s.vehicle);
        const Record record = fly_in_process(s);
        EXPECT_GT(record.closest.surface, record.promise) << "seen from " << seen_from << " m";
        EXPECT_GT(record.takeovers, 0U);
    }
}

}  // namespace
}  // namespace jink::sim
