// SPDX-License-Identifier: BSD-3-Clause
// The filter's tick with any budget, and with non-finite values. JINK_CASES and JINK_SEED are used.
#include "core/orca/velocity_filter.hpp"

#include <gtest/gtest.h>

#include "tests/property/core/orca/random_tick.hpp"

namespace jink::orca {
namespace {

using namespace random_tick;
using geometry::oracle::case_count;
using geometry::oracle::seed_of;

/// Budgets of any size: the command is flyable, the budget is kept up to the documented excess, and every violation is
/// reported.
TEST(VelocityFilterFaultLaws, NoBudgetBreaksTheContract)
{
    Random random(seed_of(7));
    const std::size_t count = case_count(20'000);
    std::size_t limited = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 24);
        const auto units = static_cast<std::uint32_t>(random.below(random.below(2) == 0 ? 60 : 1500));
        const Decision decision = decide(tick, units);
        ASSERT_TRUE(is_flyable(decision, tick.settings.limits, tick.input.own.velocity)) << "case " << i;
        ASSERT_LE(decision.work, units) << "case " << i;
        const bool out_of_work = (decision.status & kWorkLimit) != 0;
        limited += out_of_work ? 1U : 0U;
        if (units == 0) {
            ASSERT_TRUE(out_of_work);
        }
        // Unchecked obstacles are capped or reported; checked ones have their half-space.
        const std::uint32_t unlooked = kObstaclesTruncated | kNeighboursTruncated;
        if ((decision.status & unlooked) != 0 || out_of_work) {
            continue;
        }
        const float unsaid = 4e-6F * scale_of(tick);
        for (const HalfSpace& plane : planes_of(tick)) {
            const auto level = static_cast<std::size_t>(plane.level);
            const bool said = (decision.status & kSaid[level]) != 0;
            ASSERT_LE(plane.violation(decision.command), said ? decision.broken[level] + 2.1e-4F : unsaid)
                << "case " << i << ", level " << level;
        }
    }
    std::printf("[ measured ] %zu of %zu out of work\n", limited, count);
    EXPECT_GE(limited, count / 10);
}

/// One value of a tick is non-finite or huge: reported or without effect, and the command is flyable.
TEST(VelocityFilterFaultLaws, NumbersThatAreNoneDoNotGetThrough)
{
    Random random(seed_of(8));
    const std::size_t count = case_count(20'000);
    const std::array<float, 7> bad{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                   -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::max(),
                                   -std::numeric_limits<float>::max(),      1e30F,
                                   std::numeric_limits<float>::denorm_min()};
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 6);
        const Vec3 before = tick.input.own.velocity;
        std::vector<float*> places{&tick.input.own_age};
        for (Vec3* v : {&tick.input.own.position, &tick.input.preferred}) {
            places.insert(places.end(), {&v->x(), &v->y(), &v->z()});
        }
        for (Neighbour& n : tick.neighbours) {
            places.insert(places.end(), {&n.position.x(), &n.position.z(), &n.velocity.y(), &n.velocity.z(),
                                         &n.half_width, &n.half_height, &n.max_speed, &n.acceleration, &n.age});
        }
        for (Bound& bound : tick.bounds) {
            places.insert(places.end(), {&bound.outward.x(), &bound.gap, &bound.speed});
        }
        const float value = bad[random.below(bad.size())];
        *places[random.below(places.size())] = value;
        VelocityFilter filter(tick.settings);
        const Decision decision = decide(filter, tick);
        ASSERT_TRUE(is_flyable(decision, tick.settings.limits, before)) << "case " << i << ", " << value;
        if (!std::isfinite(value)) {
            const std::uint32_t reported = std::uint32_t{kBadInput} | kNeighbourRefused | kOwnStale;
            ASSERT_NE(decision.status & reported, 0U) << "case " << i << ", " << value;
        }
    }
}

}  // namespace
}  // namespace jink::orca
