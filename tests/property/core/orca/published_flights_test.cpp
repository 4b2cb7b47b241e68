// SPDX-License-Identifier: BSD-3-Clause
// Flights of Alejo 8.3 and 8.5 (E1 to E6) with half a second of delay, on a velocity loop of second order: the benefit
// of accounting for the delay. Alejo draws their plans without coordinates; speeds, walls and pillars are our choice.
// Separations are judged as by Alejo, across or in height (E of table 8.1), so the cover of the cylinder is flown.
#include <gtest/gtest.h>

#include <array>

#include "tests/property/core/geometry/oracle.hpp"
#include "tests/property/core/orca/closed_loop_report.hpp"

namespace jink::orca {
namespace {

using namespace closed_loop;
using geometry::oracle::case_count;
using geometry::oracle::seed_of;

/// Tables 8.2 (20 Hz, no filter) and 8.3 (40 Hz, the mean of ten commands); accelerations and speeds are ours.
enum class Parameters : std::uint8_t { preliminary, final_ones };

FilterSettings flight_settings(Parameters which)
{
    const bool final_ones = which == Parameters::final_ones;
    FilterSettings s;
    s.half_width = 0.6F;
    s.half_height = 0.3F;
    s.cover = kCylinderCover;
    s.pair.horizon = 10.0F;
    s.obstacles.horizontal = final_ones ? 1.1F : 0.9F;
    s.obstacles.vertical = final_ones ? 0.8F : 0.6F;
    s.obstacles.horizon = final_ones ? 2.4F : 2.0F;
    s.smoothing = final_ones ? CommandFilter::kFlown : 1;
    // The filter's 75 ms count for the gains.
    s.delay = final_ones ? 0.575F : 0.5F;
    s.pair.ramp_speed = 0.25F;
    s.pair.recovery_time = 1.6F;
    return s;
}

/// Reports of vehicles are 0.2 s late, and commands act 0.3 s later.
Scene flight(Parameters which)
{
    Scene scene;
    scene.settings = flight_settings(which);
    scene.agents = head_on(Vec3d(4, 0, 0), Vec3d(0, 0, 1.5));
    scene.plant.period = which == Parameters::final_ones ? 0.025 : 0.05;
    scene.plant.sense = 0.2;
    scene.plant.act = 0.3;
    scene.plant.natural = 6.0;
    scene.plant.noise = 0.01;
    scene.reported = Reported::commands;
    scene.until = 90.0;
    scene.e_xy = 1.2;
    scene.e_z = 0.6;
    return scene;
}

/// Sums of several noises.
struct Activity {
    double rate = 0.0;  ///< mean of the commands' rms rate [m/s2]
    double turns = 0.0;
    std::uint64_t hard = 0;
    std::uint64_t soft = 0;
    double cylinder = 1e9;
    double obstacle = 1e9;
    double across = 1e9;
    double slowest = 0.0;
    double stall = 0.0;
    bool all_arrive = true;
};

Activity activity_of(const char* name, Scene scene, std::size_t runs)
{
    Activity out;
    for (std::size_t i = 0; i < runs; ++i) {
        scene.plant.seed = seed_of(1) + i;
        World world(scene);
        EXPECT_TRUE(world.configured()) << name;
        const Outcome o = world.fly();
        EXPECT_EQ(o.outside + o.other, 0U) << name << ", noise " << i;
        out.rate += o.command_rate / double(runs);
        out.turns += double(o.turns) / double(runs);
        out.hard += o.conflict + o.obstacle_relaxed;
        out.soft += o.warning;
        out.cylinder = std::min(out.cylinder, o.cylinder);
        out.obstacle = std::min(out.obstacle, o.obstacle);
        out.across = std::min(out.across, o.least_across);
        out.slowest = std::max(out.slowest, o.time);
        out.stall = std::max(out.stall, longest_wait(o));
        out.all_arrive = out.all_arrive && o.time > 0.0;
    }
    std::printf(
        "[ measured ] %s, %zu noises: command rate %.3f m/s2, %.0f turns, relaxed %llu hard %llu soft, cylinder %.3f, "
        "across %.2f m, obstacles %.3f, slowest %.1f s, longest stall %.1f s\n",
        name, runs, out.rate, out.turns, static_cast<unsigned long long>(out.hard),
        static_cast<unsigned long long>(out.soft), out.cylinder, out.across, out.obstacle, out.slowest, out.stall);
    EXPECT_TRUE(out.all_arrive) << name;
    return out;
}

std::size_t noises(std::size_t most) { return std::clamp<std::size_t>(case_count(most), 2, 1000); }

struct Comparison {
    Activity free, off, on;
};

/// Without any delay, with it, and with it reckoned with.
Comparison compare(const std::string& name, Scene scene, std::size_t runs)
{
    Comparison out;
    out.on = activity_of((name + ", compensated").c_str(), scene, runs);
    scene.knows_delay = false;
    out.off = activity_of((name + ", not compensated").c_str(), scene, runs);
    scene.knows_delay = true;
    scene.plant.sense = scene.plant.act = 0.0;
    out.free = activity_of((name + ", without delay").c_str(), scene, runs);
    // No separation is lost where the delay is reckoned with: noise takes 3 % of it at most.
    EXPECT_GE(out.on.cylinder, 0.97) << name;
    EXPECT_GE(out.on.obstacle, 1.0) << name;
    EXPECT_LE(out.on.hard, runs / 50) << name;
    EXPECT_GT(out.off.hard, 0U) << name;
    EXPECT_GT(out.off.turns, 1.5 * out.on.turns) << name;
    return out;
}

/// 19.4 DERIVED, a point mass in E1: a rate of 0.70 m/s2 and hard relaxations without compensation, 0.54 and none with
/// it, 0.545 without delay. Reproduced in kind: speed and place are not published, and ours differ.
TEST(PublishedFlight, E1PointMass)
{
    Scene scene = flight(Parameters::preliminary);
    scene.plant.natural = 0.0;
    for (const double cruise : {0.6, 1.0}) {
        scene.cruise = cruise;
        const Comparison c = compare("E1 point mass, " + std::to_string(cruise) + " m/s", scene, noises(10));
        EXPECT_GT(c.off.rate, 1.3 * c.on.rate);
        EXPECT_LT(c.on.rate, 1.4 * c.free.rate);
        EXPECT_GT(c.off.turns, 5.0 * c.on.turns);
    }
}

/// E1 REFERENCE: minima are never both broken; oscillation and aggressive commands, which the compensation takes away.
TEST(PublishedFlight, E1)
{
    const Comparison c = compare("E1", flight(Parameters::preliminary), noises(10));
    EXPECT_GT(c.off.rate, 1.4 * c.on.rate);
    EXPECT_LT(c.on.rate, 1.1 * c.free.rate);
    EXPECT_GE(c.off.cylinder, 0.97);
}

/// E2 REFERENCE: past each other in height between walls. That it did not oscillate there is not reproduced.
TEST(PublishedFlight, E2)
{
    Scene scene = flight(Parameters::preliminary);
    scene.bodies = corridor();
    const Comparison c = compare("E2", scene, noises(10));
    EXPECT_LT(c.on.across, scene.e_xy);
    EXPECT_LT(c.off.across, scene.e_xy);
    EXPECT_GE(c.off.cylinder, 0.95);
    EXPECT_GT(c.off.rate, 1.4 * c.on.rate);
}

/// Four that change places among two pillars, the last one 15 s later.
Scene crossing_of_four(Parameters which)
{
    Scene scene = flight(which);
    scene.agents = on_a_circle(4, 4.0, 1.5);
    scene.agents[3].wait = 15.0;
    scene.bodies = {{Vec3d(1.2, 1.6, 1.5), Vec3d(0, 0, 1.5), 0.2}, {Vec3d(-1.6, -1.2, 1.5), Vec3d(0, 0, 1.5), 0.2}};
    return scene;
}

/// E3 REFERENCE: oscillation as in E1, deadlocks of about 10 s, small violations. The first; 9 s of standstill for one
/// of 200 noise seeds (JINK_CASES=200 JINK_SEED=5000); violations stay within the cover.
TEST(PublishedFlight, E3)
{
    const Comparison c = compare("E3", crossing_of_four(Parameters::preliminary), noises(10));
    EXPECT_GT(c.off.rate, 1.4 * c.on.rate);
    EXPECT_LT(c.on.rate, 1.2 * c.free.rate);
    EXPECT_GT(c.off.stall, c.on.stall);
}

/// E4 REFERENCE: out and back, oscillation much reduced, both passes alike but not the same. Not reproduced: it passed
/// sideways, with more than 2 m most of the time; ours takes the shorter path in height.
TEST(PublishedFlight, E4)
{
    Scene scene = flight(Parameters::final_ones);
    scene.there_and_back = true;
    const Comparison c = compare("E4", scene, noises(10));
    EXPECT_GT(c.off.turns, 5.0 * c.on.turns);
    EXPECT_LT(c.on.rate, 1.2 * c.free.rate);
    const Comparison once = compare("E4, out alone", flight(Parameters::final_ones), noises(3));
    EXPECT_GT(c.on.slowest, 1.9 * once.on.slowest);
    EXPECT_LT(c.on.slowest, 2.3 * once.on.slowest);
}

/// E5 REFERENCE: three pass a pillar, the third one between the others, and back; no violation.
TEST(PublishedFlight, E5)
{
    Scene scene = flight(Parameters::final_ones);
    scene.bodies = {{Vec3d(0, 0, 1.5), Vec3d(0, 0, 1.5), 0.2}};
    scene.agents = {{Vec3d(-4, 1.6, 1.5), Vec3d(4, 1.6, 1.5)},
                    {Vec3d(-4, -1.6, 1.5), Vec3d(4, -1.6, 1.5)},
                    {Vec3d(4, 0.3, 1.5), Vec3d(-4, 0.3, 1.5)}};
    scene.there_and_back = true;
    // Whenever the third one passes another, on which side.
    std::array<Vec3, 3> at{};
    std::array<bool, 2> behind{};
    std::size_t between = 0;
    std::size_t outside = 0;
    scene.watch = [&](const Watched& tick) {
        at[tick.vehicle] = tick.input.own.position;
        for (std::size_t i = 0; i < behind.size() && tick.vehicle == 2; ++i) {
            const bool now = at[2].x() < at[i].x();
            if (now != behind[i] && tick.now > 1.0) {
                const bool inside = i == 0 ? at[2].y() < at[0].y() : at[2].y() > at[1].y();
                ++(inside ? between : outside);
            }
            behind[i] = now;
        }
    };
    const Comparison c = compare("E5", scene, noises(4));
    std::printf("[ measured ] E5: the third one passes %zu times between the others, %zu times outside\n", between,
                outside);
    EXPECT_EQ(outside, 0U);
    EXPECT_GE(between, 3U * 4U * noises(4));  // three kinds of flight, each past both, out and back
    EXPECT_LT(c.on.rate, 1.2 * c.free.rate);
}

/// E6 REFERENCE: E3's scene with the final parameters: no violation, no dance; past each other in height at times.
TEST(PublishedFlight, E6)
{
    const Comparison c = compare("E6", crossing_of_four(Parameters::final_ones), noises(4));
    EXPECT_LT(c.on.across, 1.2);
    EXPECT_GT(c.off.rate, 1.15 * c.on.rate);
    EXPECT_LT(c.on.rate, 1.2 * c.free.rate);
    EXPECT_LT(c.on.stall, 3.0);
}

}  // namespace
}  // namespace jink::orca
