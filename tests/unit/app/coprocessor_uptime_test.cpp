// SPDX-License-Identifier: BSD-3-Clause
// Invariance to uptime: a flight with an avoidance is the same, tick by tick, for any values of jink's and the
// autopilot's clocks, and across each value at which a narrower counter would wrap.
#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>

#include "tests/unit/app/flight.hpp"

namespace jink::app {
namespace {

using namespace test;

constexpr std::int64_t kMillisecondWrap = (1LL << 32) * 1000;  // 49.7 days [us]

struct UptimeTrace {
    std::vector<float> requested;
    int setpoints = 0;
    std::uint32_t conflicts = 0;
    Vec3 end = Vec3::Zero();
    std::uint32_t relocks = 0;
    std::uint32_t stale = 0;
    std::int64_t longest_silence = 0;  ///< between HEARTBEATs [us]
    std::uint32_t late = 0;
    bool operator==(const UptimeTrace&) const = default;
};

/// Flies with an obstacle on the leg; jink's clock and the autopilot's start at these values [us].
UptimeTrace fly_from(std::int64_t ours, std::int64_t theirs, int ticks)
{
    const auto flight = std::make_unique<Flight>();
    flight->now.us = ours;
    flight->boot_us = theirs;
    flight->obstacles = {Vec3(0.0F, 60.0F, 50.0F)};
    UptimeTrace trace;
    std::int64_t last_heartbeat = ours;
    for (int i = 0; i < ticks; ++i) {
        flight->fly(1);
        if (!flight->said_of<Heartbeat>().empty()) {
            trace.longest_silence = std::max(trace.longest_silence, flight->now.us - last_heartbeat);
            last_heartbeat = flight->now.us;
        }
    }
    trace.requested = flight->requested;
    trace.setpoints = flight->setpoints;
    trace.conflicts = flight->coprocessor.supervisor_diagnostics().conflicts;
    trace.end = flight->position;
    trace.relocks = flight->endpoint.diagnostics().clock_relocks;
    trace.stale = flight->endpoint.diagnostics().stale_stamp;
    trace.late = flight->coprocessor.diagnostics().deadlines_missed;
    return trace;
}

TEST(CoprocessorUptime, AnAvoidanceAcrossEveryWrapIsTheSameAvoidance)
{
    constexpr int kTicks = 1200;  // 24 s; the avoidance is from 5 s to 20 s
    constexpr std::int64_t kStart = 10'000'000;
    const UptimeTrace young = fly_from(kStart, 3 * kStart, kTicks);
    ASSERT_GE(young.requested.size(), 2U) << "taken and given back, or the test shows nothing";
    ASSERT_GT(young.setpoints, 100);
    ASSERT_LE(young.longest_silence, 1'500'000);
    EXPECT_EQ(young.stale, 0U);
    constexpr std::array<std::int64_t, 7> kWraps{
        1LL << 31, 1LL << 32, kMillisecondWrap / 2, kMillisecondWrap, 4 * kMillisecondWrap, 1LL << 52, 1LL << 53};
    constexpr std::array<std::int64_t, 3> kBefore{2'000'000, 9'000'000, 14'000'000};
    for (const std::int64_t wrap : kWraps) {
        for (const std::int64_t before : kBefore) {
            const UptimeTrace ours = fly_from(wrap - before, 3 * kStart, kTicks);
            EXPECT_EQ(ours, young) << "our clock wraps at " << wrap << " us after " << before
                                   << " us: " << ours.setpoints << " set-points";
            const UptimeTrace theirs = fly_from(kStart, wrap - before, kTicks);
            EXPECT_EQ(theirs, young) << "theirs at " << wrap << " us after " << before << " us";
            const UptimeTrace both = fly_from(wrap - before, wrap - before, kTicks);
            EXPECT_EQ(both, young) << "both at " << wrap << " us after " << before << " us";
        }
    }
}

TEST(CoprocessorUptime, HoursAcrossTheWrapOfMillisecondsLoseNoHeartbeat)
{
    // Long form: JINK_UPTIME_HOURS=24.
    const char* const given = std::getenv("JINK_UPTIME_HOURS");
    const double hours = given != nullptr ? std::strtod(given, nullptr) : 0.05;
    const auto half = static_cast<std::int64_t>(hours * 1.8e9);
    const auto flight = std::make_unique<Flight>();
    flight->now.us = kMillisecondWrap - half;
    flight->boot_us = kMillisecondWrap - half + 7'000'000;
    flight->hovers = true;
    flight->velocity = Vec3::Zero();
    std::int64_t last_heartbeat = flight->now.us;
    std::int64_t longest = 0;
    const std::int64_t end = kMillisecondWrap + half;
    int unready = 0;
    for (int i = 0; flight->now.us < end; ++i) {
        const StepReport report = flight->tick();
        if (!flight->said_of<Heartbeat>().empty()) {
            longest = std::max(longest, flight->now.us - last_heartbeat);
            last_heartbeat = flight->now.us;
        }
        unready += i > 100 && report.faults != 0 ? 1 : 0;
    }
    EXPECT_LE(longest, 1'500'000);
    EXPECT_EQ(unready, 0);
    EXPECT_EQ(flight->endpoint.diagnostics().clock_relocks, 0U);
    EXPECT_EQ(flight->endpoint.diagnostics().stale_stamp, 0U);
    EXPECT_EQ(flight->coprocessor.diagnostics().deadlines_missed, 0U);
    EXPECT_FALSE(flight->lost_input);
}

}  // namespace
}  // namespace jink::app
