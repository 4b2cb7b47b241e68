// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/built_up.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "toolchain/sim/encounter.hpp"
#include "toolchain/sim/encounter_summary.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/judge.hpp"
#include "toolchain/sim/lidar.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/scenario_writer.hpp"

namespace jink::sim {
namespace {

constexpr double kLegLength = 160.0;
constexpr double kClearance = 5.0;

Vec on_leg(const Scenario& s, double along, double beside = 0.0)
{
    const Vec forward = (s.mission[1] - s.mission[0]) / kLegLength;
    return s.mission[0] + along * forward + beside * Vec(-forward.y(), forward.x(), 0.0);
}

double nearest_box(const Scenario& s, const Vec& point)
{
    double least = 1e9;
    for (const Threat& box : s.threats) {
        least = std::min(least, surface_distance(box, box.position, point));
    }
    return least;
}

/// A search over cells of 1 m in the level plane, within 60 m of the leg.
bool has_path(const Scenario& s)
{
    constexpr int kAside = 60;
    constexpr int kEnd = 160;
    constexpr int kColumns = kEnd + 2 * kAside + 1;
    std::vector<bool> checked(static_cast<std::size_t>(kColumns) * (2 * kAside + 1), false);
    std::vector<std::array<int, 2>> open{{0, 0}};
    while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        if (std::hypot(x - std::clamp(x, 0, kEnd), y) > kAside) {
            continue;
        }
        const auto cell = static_cast<std::size_t>((y + kAside) * kColumns + x + kAside);
        if (checked[cell] || nearest_box(s, on_leg(s, x, y)) <= kClearance) {
            continue;
        }
        if (x == kEnd && y == 0) {
            return true;
        }
        checked[cell] = true;
        // Onwards first: the last one is taken up next.
        open.insert(open.end(), {{x - 1, y}, {x, y + 1}, {x, y - 1}, {x + 1, y}});
    }
    return false;
}

TEST(BuiltUpArea, IsWhatItsHeaderSays)
{
    std::map<std::size_t, unsigned> counts;
    std::set<double> heights;
    std::set<int> quadrants;
    unsigned with_px4 = 0;
    Vec narrowest = Vec::Constant(1e9);
    Vec widest = Vec::Zero();
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const Scenario s = built_up_area(seed);
        ASSERT_EQ(s.mission.size(), 2U);
        EXPECT_NEAR((s.mission[1] - s.mission[0]).norm(), kLegLength, 1e-9);
        EXPECT_EQ(s.mission[0].z(), s.mission[1].z());
        EXPECT_EQ(s.start_position, s.mission[0]);
        EXPECT_NEAR(s.start_velocity.norm(), TruthLimits{}.cruise, 1e-9);
        EXPECT_TRUE(s.to_goal && s.ground && s.lidar);
        ++counts[s.threats.size()];
        heights.insert(s.mission[0].z());
        quadrants.insert((s.mission[1].x() > 0.0 ? 1 : 0) + (s.mission[1].y() > 0.0 ? 2 : 0));
        with_px4 += s.stack == Stack::px4 ? 1U : 0U;
        bool across = false;
        for (double along = 0.0; along <= kLegLength; along += 0.05) {
            across = across || surface_distance(s.threats[0], s.threats[0].position, on_leg(s, along)) < 0.01;
        }
        EXPECT_TRUE(across) << seed;
        EXPECT_GT(nearest_box(s, s.mission[0]), 13.0) << seed;
        EXPECT_GT(nearest_box(s, s.mission[1]), 13.0) << seed;
        for (const Threat& box : s.threats) {
            EXPECT_TRUE(box.at_rest() && box.form == Form::box && box.sensed_by == SensedBy::lidar);
            EXPECT_NEAR(box.position.z(), box.half_extents.z(), 1e-12) << "stands on the ground";
            const Vec above(box.half_extents.x(), box.half_extents.y(), 2.0 * box.half_extents.z() - s.mission[0].z());
            narrowest = narrowest.cwiseMin(above);
            widest = widest.cwiseMax(above);
        }
    }
    EXPECT_EQ(heights, (std::set<double>{12.0, 15.0, 20.0}));
    EXPECT_EQ(quadrants.size(), 4U);
    EXPECT_NEAR(with_px4, 250.0, 4.0 * std::sqrt(500.0 * 0.25));
    ASSERT_EQ(counts.size(), 5U);
    for (const auto& [boxes, count] : counts) {
        EXPECT_TRUE(boxes >= 2 && boxes <= 6);
        EXPECT_NEAR(count, 100.0, 4.0 * std::sqrt(500.0 * 0.2 * 0.8)) << boxes;
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(narrowest[axis], 2.0 - 1e-9);
        EXPECT_LT(narrowest[axis], 2.2);
        EXPECT_LE(widest[axis], (axis < 2 ? 12.0 : 20.0) + 1e-9);
        EXPECT_GT(widest[axis], axis < 2 ? 11.8 : 19.6);
    }
}

TEST(BuiltUpArea, HasAPathPastItsBoxes)
{
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        EXPECT_TRUE(has_path(built_up_area(seed))) << seed;
    }
    // The search finds no path where there is none: a wall 120 m wide.
    Scenario closed = built_up_area(1);
    closed.mission = {Vec(0, 0, 12), Vec(kLegLength, 0, 12)};
    closed.threats.resize(1);
    closed.threats[0].position = Vec(80, 0, 12);
    closed.threats[0].half_extents = Vec(2, 60, 12);
    EXPECT_FALSE(has_path(closed));
    closed.threats[0].half_extents.y() = 50.0;
    EXPECT_TRUE(has_path(closed));
}

TEST(BuiltUpArea, IsTheSameForTheSameSeed)
{
    std::set<std::string> all;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::string text = scenario_text(encounter_of(EncounterKind::built_up, seed), "");
        EXPECT_EQ(text, scenario_text(built_up_area(seed), ""));
        all.insert(text.substr(text.find("mission")));
    }
    EXPECT_EQ(all.size(), 200U) << "different scenes for different seeds";
}

/// Its file flies the same flight.
TEST(BuiltUpArea, ReadsBackFromItsFile)
{
    const Scenario s = built_up_area(7);
    const Scenario read = parse_scenario(scenario_text(s, ""), s.name + ".yaml");
    const Record flown = fly_in_process(s);
    const Record again = fly_in_process(read);
    EXPECT_EQ(again.closest.surface, flown.closest.surface);
    EXPECT_EQ(again.goal_at, flown.goal_at);
    EXPECT_EQ(again.outcome, flown.outcome);
}

// Regression: with the units spent, a command that was not checked counted as better than braking, and in a box that
// reached nearer than the wall any depth counted as the same. The vehicle went on into the wall, to 0.66 m.
TEST(BuiltUpArea, TheVehicleDoesNotGoOnIntoAWall)
{
    const Scenario s = encounter_of(EncounterKind::built_up, 285);
    EXPECT_GE(fly_in_process(s).closest.surface, s.promise);
}

/// The judge takes a box as reported from the start on, and its conflict begins up to 12 s before the leg comes too
/// near: at the cruise speed that is the LiDAR's range and the promise more, which is flown in 0.14 s. The box is seen
/// then.
TEST(BuiltUpArea, IsJudgedFromASightingOn)
{
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Scenario s = built_up_area(seed);
        const Verdict verdict = judge(s, 12.0, Trials::until_kept);
        ASSERT_TRUE(verdict.conflict) << seed;
        EXPECT_TRUE(verdict.avoidable) << seed << ": a stop keeps the promise";
        World world(s);
        while (world.seconds() < verdict.detected + 0.2) {
            world.step(s.start_velocity);
        }
        std::vector<bool> hit(s.threats.size(), false);
        static_cast<void>(true_ranges(world, *s.lidar, rays_of(*s.lidar), &hit));
        std::size_t first = 0;
        for (double along = 0.0; along <= kLegLength && nearest_box(s, on_leg(s, along)) >= s.promise; along += 0.05) {
            for (std::size_t i = 0; i < s.threats.size(); ++i) {
                const auto distance = [&](std::size_t k) {
                    return surface_distance(s.threats[k], s.threats[k].position, on_leg(s, along + 0.05));
                };
                first = distance(i) < distance(first) ? i : first;
            }
        }
        EXPECT_TRUE(hit[first]) << seed << ": " << s.threats[first].name;
    }
}

/// A box is reported by the first scan with a return from it. A flight into a box is therefore no late report.
TEST(BuiltUpArea, ABrokenPromiseTowardsABoxIsAvoidable)
{
    Scenario s = built_up_area(3);
    s.threats.resize(1);
    Record record = fly_in_process(s);
    for (std::size_t i = 0; i < s.threats.size(); ++i) {
        const double range = surface_distance(s.threats[i], s.threats[i].position, s.start_position);
        EXPECT_TRUE(record.reported[i] < 0.0 || record.reported[i] >= s.lidar->latency) << i;
        if (record.reported[i] == s.lidar->latency) {
            EXPECT_LE(range, s.lidar->range);
        }
    }
    EXPECT_GE(record.reported[0], 0.0) << "the box across the leg is seen";
    // The same flight straight on.
    const Record alone = fly_alone(s);
    record.samples = alone.samples;
    record.closest = alone.closest;
    record.outcome = Outcome::collision;
    const EncounterResult result = result_of(s, record);
    EXPECT_FALSE(result.reported_too_late);
    EXPECT_TRUE(result.failed_avoidable);
    EXPECT_GT(result.last_keep, 0U);
    // Without a return from it the box was unknown.
    record.reported.assign(s.threats.size(), -1.0);
    EXPECT_TRUE(result_of(s, record).reported_too_late);
}

TEST(BuiltUpArea, ASummaryCountsMissedGoals)
{
    std::vector<EncounterResult> results(4);
    for (EncounterResult& r : results) {
        r.intruders = 2;
        r.outcome = Outcome::braked;
        r.goal_at = 40.0;
    }
    results[1].goal_at = -1.0;
    results[2].goal_at = -1.0;
    results[2].outcome = Outcome::avoided;
    FolderSetup setup;
    setup.seeds_text = "from 1";
    EXPECT_EQ(summary_text(setup, results).find("goal"), std::string::npos) << "others have no goal";
    setup.variant.kind = EncounterKind::built_up;
    const std::string text = summary_text(setup, results);
    const auto counted = [&](const std::string& what) {
        const std::size_t at = text.find(what);
        return at == std::string::npos ? std::string() : text.substr(at + 58, 8 + 1);
    };
    EXPECT_EQ(counted("goal not reached"), "        2") << text;
    EXPECT_EQ(counted("... at the end of a flight that braked"), "        1") << text;
}

}  // namespace
}  // namespace jink::sim
