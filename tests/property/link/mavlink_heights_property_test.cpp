// SPDX-License-Identifier: BSD-3-Clause
// Geometric altitudes of traffic, above sea level or above the ellipsoid: the report holds the true height.
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

std::uint64_t heights_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20261124;
}

/// GPS_RAW_INT before, between and after sightings: good, without a fix, without an ellipsoid height, implausible.
TEST(MavlinkHeightsProperty, AGeometricReportHoldsTheTrueHeightWhateverItsSenderMeans)
{
    std::mt19937_64 random(heights_seed());
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto millimetres = [](double metres) { return static_cast<std::int32_t>(std::lround(1e3 * metres)); };
    for (int line = 0; line < 200; ++line) {
        Wire wire;
        wire.hear(heartbeat());
        const double base = uniform(-100.0, 3000.0);
        wire.hear(origin(473977420, 85455940, millimetres(base)));
        std::optional<double> known;
        for (int i = 0; i < 20; ++i) {
            SCOPED_TRACE(testing::Message() << "JINK_SEED=" << heights_seed() << " line " << line << " sighting " << i);
            const double undulation = uniform(-119.0, 119.0);
            const bool is_good = i % 4 == 0 && uniform(0.0, 1.0) < 0.7;
            GpsRawInt m;
            m.alt = millimetres(base + uniform(0.0, 100.0));
            m.alt_ellipsoid = m.alt + millimetres(undulation);
            m.fix_type = 3;
            const double fault = is_good ? 1.0 : uniform(0.0, 1.0);
            m.fix_type = fault < 0.3 ? 2 : m.fix_type;
            m.alt_ellipsoid = fault >= 0.3 && fault < 0.6 ? 0 : m.alt_ellipsoid;
            m.alt_ellipsoid = fault >= 0.6 && !is_good ? m.alt + 130'000 : m.alt_ellipsoid;
            known = is_good && m.alt_ellipsoid != 0 ? std::optional(undulation) : known;
            wire.hear(m);

            const double height = uniform(-200.0, 500.0);  // above the origin: true
            const bool above_ellipsoid = uniform(0.0, 1.0) < 0.5;
            const double reported = height + (above_ellipsoid ? known.value_or(0.0) : 0.0);
            wire.inbox.clear();
            wire.hear(adsb(0xABC, {473977420, 85455940, millimetres(base + reported)}), kSystem, 156);
            ASSERT_EQ(wire.inbox.tracks.size(), 1U);
            const TrackReport& t = wire.inbox.tracks[0];
            const double middle = static_cast<double>(t.position.z());
            const double spread = static_cast<double>(t.height_spread);
            ASSERT_EQ(t.height, HeightSource::geometric);
            ASSERT_LE(std::abs(middle - height), spread + 0.01);
            ASSERT_NEAR(spread, 0.5 * std::abs(known.value_or(0.0)), 0.01) << "no wider than both readings";
        }
    }
}

}  // namespace
}  // namespace jink::link::mavlink
