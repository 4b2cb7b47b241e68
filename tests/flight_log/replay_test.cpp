// SPDX-License-Identifier: BSD-3-Clause
// Flights recorded through recording ports replay bit for bit, and a log that was changed does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using namespace jink::test;

/// Random encounters, half of them on a machine that delays steps. JINK_LOG_SEED: the first seed.
TEST(FlightReplay, AHundredRandomFlightsAreTheSameBitForBit)
{
    const char* const given = std::getenv("JINK_LOG_SEED");
    const std::uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 0) : 1;
    std::uint64_t steps = 0;
    std::uint32_t manoeuvres = 0;
    for (std::uint64_t seed = first; seed < first + 100; ++seed) {
        const sim::Scenario scenario = sim::random_scenario(seed);
        const sim::Timing timing = seed % 2 == 0 ? sim::Timing{} : sim::timing_of(seed, sim::Spread{}, 100'000, 500'000);
        const RecordedFlight flight = fly_recorded(scenario, timing);
        const flightlog::ReplayResult result = replay(flight.log);
        ASSERT_TRUE(result.is_identical()) << "JINK_LOG_SEED=" << seed << ": " << result.refused << result.incomplete
                                           << result.difference << " in step " << result.difference_step;
        ASSERT_EQ(result.steps, flight.steps) << seed;
        ASSERT_EQ(result.reports, flight.steps) << seed;
        ASSERT_TRUE(result.was_shut_down) << seed;
        ASSERT_EQ(flight.lost, 0U) << seed;
        steps += flight.steps;
        manoeuvres += flight.manoeuvres;
    }
    EXPECT_GT(steps, 50'000U);
    EXPECT_GT(manoeuvres, 100U) << "the flights are to have something to decide";
}

}  // namespace
