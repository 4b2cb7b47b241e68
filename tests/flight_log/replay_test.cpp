// SPDX-License-Identifier: BSD-3-Clause
// Flights recorded through recording ports replay bit for bit, and a log that was changed does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/scenario_file.hpp"

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
        const sim::Timing timing =
            seed % 2 == 0 ? sim::Timing{} : sim::timing_of(seed, sim::Spread{}, 100'000, 500'000);
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

/// Everything that decides beside the parameters: the same flights with other set-ups.
void expect_identical(const sim::Scenario& scenario, const FlightOptions& options, const char* what)
{
    const RecordedFlight flight = fly_recorded(scenario, {}, options);
    flightlog::ReplayOptions with;
    with.key = options.key;
    const flightlog::ReplayResult result = replay(flight.log, with);
    EXPECT_TRUE(result.is_identical()) << what << ": " << result.refused << result.incomplete << result.difference
                                       << " in step " << result.difference_step;
    EXPECT_EQ(result.steps, flight.steps) << what;
    EXPECT_EQ(flight.lost, 0U) << what;
    EXPECT_GT(flight.manoeuvres, 0U) << what << ": nothing was decided";
    EXPECT_GT(result.bytes, 1'000U) << what;
}

TEST(FlightReplay, APlanInSlicesIsTheSame)
{
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        FlightOptions options;
        options.setup.clock = 168;
        expect_identical(sim::random_scenario(seed), options, "--clock 168");
    }
}

TEST(FlightReplay, AFlightThroughABusIsTheSame)
{
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        FlightOptions options;
        options.setup.on_bus = options.setup.has_bus = true;
        options.setup.node.node = sim::TunnelLine::kOurNode;
        options.setup.node.seed = 99;
        options.setup.node.unique_id = {1, 2, 3};
        expect_identical(sim::random_scenario(seed), options, "--can");
    }
}

TEST(FlightReplay, ABusBesideTheLineIsTheSame)
{
    FlightOptions options;
    options.setup.has_bus = true;
    options.setup.node.node = 0;  // asks an allocator that is not there
    options.setup.node.seed = 12345;
    expect_identical(sim::random_scenario(1), options, "--serial and --can");
}

TEST(FlightReplay, ASignedFlightIsTheSameWithItsKeyAlone)
{
    FlightOptions options;
    options.key.emplace();
    options.key->fill(std::byte{0x3C});
    options.setup.has_key = true;
    options.setup.signing_time = 1'000'000;
    expect_identical(sim::random_scenario(1), options, "--signing-key");

    const RecordedFlight flight = fly_recorded(sim::random_scenario(1), {}, options);
    EXPECT_EQ(flight.log.find(std::string(8, '\x3C')), std::string::npos) << "the key is in the log";
    EXPECT_NE(replay(flight.log).refused.find("--signing-key"), std::string::npos);
    flightlog::ReplayOptions wrong;
    wrong.key.emplace();
    EXPECT_NE(replay(flight.log, wrong).difference, "");
}

TEST(FlightReplay, OtherParametersAreTheSame)
{
    FlightOptions options;
    app::Parameters parameters;
    ASSERT_EQ(parameters.set(app::Param::own_address, 16'777'215.0F), app::ParamStatus::ok);
    ASSERT_EQ(parameters.set(app::Param::track_age, 7.3F), app::ParamStatus::ok);
    options.setup.initial = parameters.values();
    options.setup.generation = parameters.generation();
    ASSERT_EQ(parameters.set(app::Param::lookahead, 9.1F), app::ParamStatus::ok);
    options.setup.stored = parameters.values();
    options.setup.keeps_state = true;
    expect_identical(sim::random_scenario(1), options, "--params and --state");
}

TEST(FlightReplay, PointCloudsAreReplayedWhereTheyAreLogged)
{
    sim::Scenario scenario = sim::load_scenario(JINK_SCENARIOS "/forest_of_cylinders.yaml");
    scenario.duration = 8.0;
    FlightOptions options;
    options.setup.has_cloud = options.setup.logs_cloud = true;
    expect_identical(scenario, options, "--log-clouds");
    options.setup.logs_cloud = false;
    EXPECT_NE(replay(fly_recorded(scenario, {}, options).log).refused.find("--log-clouds"), std::string::npos);
}

}  // namespace
