// SPDX-License-Identifier: BSD-3-Clause
// The guided points that ArduPlane is sent lie on the commanded course from where it is, for random commands, places
// and origins. JINK_CASES and JINK_SEED.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/base/random.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

std::uint64_t plane_number(const char* name, std::uint64_t normal)
{
    const char* text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 0) : normal;
}

struct Bearing {
    double angle, distance;
};

/// Great circle from one place to another, haversine in double: clockwise from north [rad], [m].
Bearing bearing(double lat1, double lon1, double lat2, double lon2)
{
    const double dlon = lon2 - lon1;
    const double y = std::sin(dlon) * std::cos(lat2);
    const double x = std::cos(lat1) * std::sin(lat2) - std::sin(lat1) * std::cos(lat2) * std::cos(dlon);
    const double h = std::pow(std::sin(0.5 * (lat2 - lat1)), 2) +
                     std::cos(lat1) * std::cos(lat2) * std::pow(std::sin(0.5 * dlon), 2);
    return {std::atan2(y, x), 2.0 * 6378137.0 * std::asin(std::sqrt(h))};
}

class MavlinkPlaneLaw : public test::EndpointTest {};

TEST_F(MavlinkPlaneLaw, ThePointLiesOnTheCommandedCourse)
{
    const std::uint64_t cases = plane_number("JINK_CASES", 1500);
    const std::uint64_t seed = plane_number("JINK_SEED", 20260801);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        endpoint = std::make_unique<Endpoint>();
        heartbeat(3, 15, true, 1);
        // Up to 60 degrees: there one local place is good to 5 cm of great circle (kMapError).
        const auto lat = static_cast<std::int32_t>(random.uniform(-6.0e8F, 6.0e8F));
        const auto lon = static_cast<std::int32_t>(random.uniform(-1.8e9F, 1.8e9F));
        origin(lat, lon, 500000);
        const Vec3 ned(random.uniform(-3000.0F, 3000.0F), random.uniform(-3000.0F, 3000.0F),
                       random.uniform(-500.0F, -50.0F));
        const float course = random.uniform(-3.14159F, 3.14159F);
        local_position(ned, {18.0F, 0.0F, 0.0F});
        static_cast<void>(sent());
        const float speed = random.uniform(10.0F, 40.0F);
        const float climb = random.uniform(-5.0F, 5.0F);
        endpoint->send_velocity({speed * std::sin(course), speed * std::cos(course), climb}, now);
        const CommandInt m = sent_one<CommandInt>();
        // Where the plane is: offset from the origin by great circle, solved in double.
        const double lat0 = lat * 1e-7 * kDegree, lon0 = lon * 1e-7 * kDegree;
        const double north = static_cast<double>(ned.x()), east = static_cast<double>(ned.y());
        const double away = std::hypot(north, east) / 6378137.0, to = std::atan2(east, north);
        const double own_lat =
            std::asin(std::sin(lat0) * std::cos(away) + std::cos(lat0) * std::sin(away) * std::cos(to));
        const double own_lon = lon0 + std::atan2(std::sin(to) * std::sin(away) * std::cos(lat0),
                                                 std::cos(away) - std::sin(lat0) * std::sin(own_lat));
        const Bearing b = bearing(own_lat, own_lon, m.x * 1e-7 * kDegree, m.y * 1e-7 * kDegree);
        const double ahead = std::max(25.0 * static_cast<double>(speed), 400.0);
        EXPECT_NEAR(b.distance, ahead, 0.3) << "JINK_SEED=" << seed + i;
        // Meridians converge: 3 km east of the origin at 60 degrees the map's north is 0.05 degrees off.
        EXPECT_NEAR(std::remainder(b.angle - static_cast<double>(course), 360.0 * kDegree), 0.0, 0.0015)
            << "JINK_SEED=" << seed + i;
        const double rise = std::max(-14.0, std::min(14.0, 4.0 * static_cast<double>(climb)));
        EXPECT_NEAR(static_cast<double>(m.z), 500.0 - static_cast<double>(ned.z()) + rise, 0.01)
            << "JINK_SEED=" << seed + i;
        EXPECT_TRUE(climb == 0.0F || (climb > 0.0F) == (m.z > 500.0F - ned.z())) << "JINK_SEED=" << seed + i;
        if (HasFailure()) {
            return;
        }
    }
}

}  // namespace
}  // namespace jink::link::mavlink
