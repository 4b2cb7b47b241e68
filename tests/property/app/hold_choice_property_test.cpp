// SPDX-License-Identifier: BSD-3-Clause
// Whether stopping helps, against a flight in double with steps of 2 ms. JINK_CASES and JINK_SEED.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/base/random.hpp"
#include "firmware/app/hold_choice.hpp"

namespace jink::app {
namespace {

/// The stop in double: a first-order loop whose change is limited, flown in steps of kFine.
struct Stop {
    static constexpr double kFine = 0.002;
    std::array<std::array<double, 2>, 4000> at{};  ///< position after each step
    std::size_t steps = 0;                         ///< until slower than a standstill

    Stop(double vx, double vy, const vehicle::VehicleLimits& limits)
    {
        const double lag = static_cast<double>(limits.velocity_lag);
        const double most = static_cast<double>(limits.max_acceleration);
        double x = 0.0, y = 0.0;
        while (std::hypot(vx, vy) > static_cast<double>(vehicle::kStandstillSpeed) && steps + 1 < at.size()) {
            const double share = std::min(1.0 / lag, most / std::hypot(vx, vy)) * kFine;
            x += vx * kFine * (1.0 - 0.5 * share);
            y += vy * kFine * (1.0 - 0.5 * share);
            vx -= vx * share;
            vy -= vy * share;
            at[++steps] = {x, y};
        }
    }
    [[nodiscard]] double time() const { return static_cast<double>(steps) * kFine; }

    /// Least distance of a straight flight from the vehicle until it has stopped for `ahead`.
    [[nodiscard]] double closest(const std::array<double, 3>& p, const std::array<double, 3>& v, double ahead) const
    {
        double least = 1e9;
        const std::size_t end = steps + static_cast<std::size_t>(ahead / kFine);
        for (std::size_t i = 0; i <= end; ++i) {
            const double t = static_cast<double>(i) * kFine;
            const std::array<double, 2>& own = at[std::min(i, steps)];
            const double x = p[0] + v[0] * t - own[0], y = p[1] + v[1] * t - own[1], z = p[2] + v[2] * t;
            least = std::min(least, x * x + y * y + z * z);
        }
        return std::sqrt(least);
    }
};

std::uint64_t hold_number_of(const char* name, std::uint64_t normal)
{
    const char* text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 0) : normal;
}

TEST(HoldChoiceLaw, StopsExactlyWhereItKeepsTheVehicleFartherAway)
{
    const std::uint64_t cases = hold_number_of("JINK_CASES", 2000);
    const std::uint64_t seed = hold_number_of("JINK_SEED", 20260811);
    std::uint64_t stops = 0, flies = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        vehicle::VehicleLimits limits;
        limits.max_acceleration = random.uniform(2.0F, 6.0F);
        limits.velocity_lag = random.uniform(0.1F, 0.5F);
        vehicle::VehicleState own;
        const float course = random.uniform(-3.14F, 3.14F), speed = random.uniform(0.2F, 15.0F);
        own.velocity = Vec3(speed * std::cos(course), speed * std::sin(course), 0.0F);
        const Stop stop(static_cast<double>(own.velocity.x()), static_cast<double>(own.velocity.y()), limits);

        // Past, while braking, soon after, late, about the end of the look-ahead.
        const double standing = static_cast<double>(kHoldAhead);
        const double due[] = {-1.0, stop.time() * static_cast<double>(random.uniform()),
                              stop.time() + static_cast<double>(random.uniform(0.0F, 3.0F)),
                              stop.time() + standing * static_cast<double>(random.uniform(0.0F, 2.0F)),
                              stop.time() + standing + static_cast<double>(random.uniform(-1.0F, 1.0F))};
        const double when = due[random.below(5)];
        const float heading = random.uniform(-3.14F, 3.14F), pace = random.uniform(0.6F, 20.0F);
        const std::array<double, 3> v{static_cast<double>(pace * std::cos(heading)),
                                      static_cast<double>(pace * std::sin(heading)),
                                      static_cast<double>(random.uniform(-1.0F, 1.0F))};
        const auto step = static_cast<std::size_t>(std::max(when, 0.0) / Stop::kFine);
        const std::array<double, 2>& met = stop.at[std::min(step, stop.steps)];
        const std::array<double, 3> p{met[0] + static_cast<double>(3.0F * random.normal()) - v[0] * when,
                                      met[1] + static_cast<double>(3.0F * random.normal()) - v[1] * when,
                                      static_cast<double>(2.0F * random.normal()) - v[2] * when};
        world::Track track;
        track.position = Vec3(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
        track.velocity = Vec3(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
        world::Conflict conflict;
        conflict.miss_distance = random.uniform(0.0F, 6.0F);

        // Tolerance: 0.1 m of the chords, 10 ms of the standstill's time, and the contribution of a creep of 0.05 m/s.
        const double wanted = static_cast<double>(conflict.miss_distance + kHoldBetter);
        const double longer = stop.closest(p, v, standing + 0.01), shorter = stop.closest(p, v, standing - 0.01);
        const bool safe = longer > wanted + 0.13, unsafe = shorter < wanted - 0.13;
        if (!safe && !unsafe) {
            continue;
        }
        ASSERT_EQ(is_stopping_safer(own, limits, conflict, &track), safe)
            << "closest " << shorter << " m, wanted " << wanted << " m; JINK_CASES=1 JINK_SEED=" << seed + i;
        stops += safe ? 1U : 0U;
        flies += safe ? 0U : 1U;
    }
    if (cases >= 1000) {
        EXPECT_GT(stops, cases / 5);
        EXPECT_GT(flies, cases / 5);
    }
}

}  // namespace
}  // namespace jink::app
