// SPDX-License-Identifier: BSD-3-Clause
// The last value that is taken and the first one that is refused, of every setting and every part of a problem; and the
// places where a status changes.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "core/geometric/planner.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;
using world::ThreatKind;

constexpr float kMin = std::numeric_limits<float>::denorm_min();

float limit_above(float x) { return std::nextafter(x, kInfinity); }
float limit_below(float x) { return std::nextafter(x, -kInfinity); }

template <class T, class Change>
void expect_settings(bool expected, Change change, std::initializer_list<T> values)
{
    for (const T value : values) {
        Settings settings;
        change(settings, value);
        EXPECT_EQ(is_valid(settings), expected) << value;
    }
}

TEST(SettingsLimits, CountsAreTakenUpToTheirLimits)
{
    const auto offsets = [](Settings& s, std::size_t n) {
        s.offsets = static_cast<std::uint16_t>(n);
        s.extra_planes = 0;
    };
    expect_settings<std::size_t>(true, offsets, {2, 64});
    expect_settings<std::size_t>(false, offsets, {0, 1, 63, 65, 66});
    const auto planes = [](Settings& s, std::size_t n) {
        s.extra_planes = static_cast<std::uint16_t>(n);
        s.offsets = 2;
    };
    expect_settings<std::size_t>(true, planes, {0, kMaxPlanes - 1});
    expect_settings<std::size_t>(false, planes, {kMaxPlanes, kMaxPlanes + 1});
    const auto waypoints = [](Settings& s, std::size_t n) { s.waypoints = static_cast<std::uint16_t>(n); };
    expect_settings<std::size_t>(true, waypoints, {8, kMaxPathPoints});
    expect_settings<std::size_t>(false, waypoints, {0, 7, kMaxPathPoints + 1});
    const auto retries = [](Settings& s, std::size_t n) { s.retries = static_cast<std::uint8_t>(n); };
    expect_settings<std::size_t>(true, retries, {0, kAttempts.size() - 1});
    expect_settings<std::size_t>(false, retries, {kAttempts.size(), 255});
}

TEST(SettingsLimits, AsManyCandidatesAsFitAndNotOneMore)
{
    const auto of = [](bool simple, bool symmetric, std::size_t offsets, std::size_t planes) {
        Settings s;
        s.simple = simple;
        s.symmetric = symmetric;
        s.offsets = static_cast<std::uint16_t>(offsets);
        s.extra_planes = static_cast<std::uint16_t>(planes - 1);
        return is_valid(s);
    };
    static_assert(kMaxCandidates == 512, "the products limit_below");
    EXPECT_TRUE(of(true, true, 16, 16));
    EXPECT_FALSE(of(true, true, 18, 16));
    EXPECT_FALSE(of(true, true, 16, 17));
    EXPECT_TRUE(of(true, false, 32, 16));
    EXPECT_TRUE(of(false, true, 32, 16));
    EXPECT_FALSE(of(true, false, 34, 16));
    EXPECT_FALSE(of(false, true, 34, 16));
    EXPECT_FALSE(of(false, false, 2, 1));
}

TEST(SettingsLimits, AmountsAreZeroOrMoreAndFinite)
{
    const auto each = [](auto change) {
        expect_settings<float>(true, change, {0.0F, 1.0F});
        expect_settings<float>(false, change, {-kMin, -1.0F, kInfinity, -kInfinity, kNan});
    };
    each([](Settings& s, float x) { s.source_drop_margin = x; });
    each([](Settings& s, float x) { s.rotation_penalty = x; });
    each([](Settings& s, float x) { s.flip_penalty = x; });
}

TEST(SettingsLimits, CostAndWeightsHaveTheirRanges)
{
    const auto cost = [](Settings& s, float x) { s.max_cost = x; };
    expect_settings<float>(true, cost, {kMin, 1.0F});
    expect_settings<float>(false, cost, {0.0F, -1.0F, limit_above(1.0F), kInfinity, kNan});
    const auto weight = [](Settings& s, float x) { s.weights.time = x; };
    expect_settings<float>(false, weight, {kNan});
    const auto passing = [](Settings& s, float x) { s.weights.passing = x; };
    expect_settings<float>(true, passing, {0.0F});
    expect_settings<float>(false, passing, {0.1F, -0.1F, kInfinity, kNan});
    const auto beyond = [](Settings& s, float x) { s.weights.beyond = x; };
    expect_settings<float>(false, beyond, {0.1F, -0.1F, kInfinity, kNan});
    const auto cap = [](Settings& s, float x) { s.caps.energy_low = x; };
    expect_settings<float>(false, cap, {kNan});
}

/// `change` sets one part of a problem; refused, or solved somehow.
template <class T, class Change>
void expect_problem(bool taken, Change change, std::initializer_list<T> values)
{
    for (const T value : values) {
        Scene scene;
        change(scene, value);
        EXPECT_EQ(scene.run() != PlanStatus::bad_input, taken) << value;
        path::TimedPath path;
        // A single path needs no threats, and refuses the same scales.
        const bool has_path = make_candidate_path(scene.problem, {Family::simple, 0.0F, 3.0F}, 25, scene.limits, path);
        EXPECT_EQ(has_path, !path.points.empty());
        EXPECT_TRUE(has_path || !taken) << value;
    }
}

TEST(ProblemLimits, ScalesArePositiveAndFinite)
{
    const auto each = [](auto change) {
        expect_problem<float>(true, change, {0.01F, 3.0F});
        expect_problem<float>(false, change, {0.0F, -1.0F, kInfinity, kNan});
    };
    each([](Scene& s, float x) { s.problem.distance = x; });
    each([](Scene& s, float x) { s.problem.main_radius = x; });
    const auto speed = [](Scene& s, float x) { s.problem.speed = x; };
    expect_problem<float>(true, speed, {0.1F, 9.0F});
    expect_problem<float>(false, speed, {0.0F, -1.0F, kInfinity, kNan});
}

TEST(ProblemLimits, MovingSolidsAreAsManyAsFitAndSolids)
{
    const auto status_with = [](std::size_t count, const MovingSolid& solid) {
        Scene scene;
        scene.solids.assign(count, solid);
        return scene.run();
    };
    MovingSolid far{geometry::make_box(Vec3(0.0F, 90.0F, 50.0F), Vec3::Ones()), Vec3::UnitX()};
    EXPECT_EQ(status_with(kMaxMovingSolids, far), PlanStatus::found);
    EXPECT_EQ(status_with(kMaxMovingSolids + 1, far), PlanStatus::bad_input);
    for (float MovingSolid::*amount :
         {&MovingSolid::uncertainty, &MovingSolid::radius_rate, &MovingSolid::radius_acceleration}) {
        for (const float bad : {-kMin, kInfinity, kNan}) {
            MovingSolid solid = far;
            solid.*amount = bad;
            EXPECT_EQ(status_with(1, solid), PlanStatus::bad_input) << bad;
        }
    }
    far.velocity.x() = kNan;
    EXPECT_EQ(status_with(1, far), PlanStatus::bad_input);
    EXPECT_EQ(status_with(1, {geometry::make_sphere(Vec3::Zero(), -1.0F), Vec3::UnitX()}), PlanStatus::bad_input);
}

TEST(ProblemLimits, AmountsAreZeroOrMoreAndFinite)
{
    const auto each = [](auto change) {
        expect_problem<float>(true, change, {0.0F, 1.0F});
        expect_problem<float>(false, change, {-kMin, -1.0F, kInfinity, kNan});
    };
    each([](Scene& s, float x) { s.uncertainty = x; });
    each([](Scene& s, float x) { s.problem.body_radius = x; });
    each([](Scene& s, float x) { s.problem.span_from = x; });
    each([](Scene& s, float x) { s.problem.span_to = x; });
    each([](Scene& s, float x) { s.threats[0].radius = x; });
    each([](Scene& s, float x) { s.threats[0].radius_rate = x; });
    each([](Scene& s, float x) { s.threats[0].radius_acceleration = x; });
}

TEST(ProblemLimits, VectorsAreFinite)
{
    const auto each = [](auto change) {
        expect_problem<float>(true, change, {0.0F});
        expect_problem<float>(false, change, {kInfinity, -kInfinity, kNan});
    };
    each([](Scene& s, float x) { s.problem.start_velocity.y() = x; });
    each([](Scene& s, float x) { s.problem.preferred_side.y() = x; });
    each([](Scene& s, float x) { s.problem.main_centre_offset.z() = x; });
    each([](Scene& s, float x) { s.problem.frame.origin.x() = x; });
    each([](Scene& s, float x) { s.problem.frame.axes(0, 1) = x; });
    each([](Scene& s, float x) { s.threats[0].motion.position.y() = x; });
    each([](Scene& s, float x) { s.threats[0].motion.velocity.z() = x; });
    const auto scale = [](Scene& s, float x) { s.problem.frame.axes *= x; };
    expect_problem<float>(false, scale, {0.0F, 0.9F, 1.1F, -2.0F});
    const auto acceleration = [](Scene& s, float x) { s.limits.max_acceleration = x; };
    expect_problem<float>(false, acceleration, {0.0F, kNan});
}

TEST(ProblemLimits, AsManyThreatsAndObstaclesAsFit)
{
    const auto threats = [](Scene& s, std::size_t n) { s.threats.resize(n, s.threats[0]); };
    expect_problem<std::size_t>(true, threats, {1, kMaxTracks});
    expect_problem<std::size_t>(false, threats, {0, kMaxTracks + 1});  // the main one is gone
    const auto obstacles = [](Scene& s, std::size_t n) {
        s.obstacles.resize(n, {1, geometry::make_sphere(Vec3(0.0F, 500.0F, 50.0F), 1.0F)});
    };
    expect_problem<std::size_t>(true, obstacles, {0, kMaxObstacles});
    expect_problem<std::size_t>(false, obstacles, {kMaxObstacles + 1});
    const auto main = [](Scene& s, std::size_t n) { s.problem.main = n; };
    expect_problem<std::size_t>(true, main, {0, kNoThreat});
    expect_problem<std::size_t>(false, main, {1, 2});
}

TEST(ProblemLimits, TheMainThreatsShapeIsLookedAtToo)
{
    const geometry::Shape good = geometry::make_box(Vec3(20.0F, 0.0F, 50.0F), Vec3::Ones());
    const geometry::Shape bad = geometry::make_box(Vec3(20.0F, 0.0F, 50.0F), Vec3(1.0F, -1.0F, 1.0F));
    Scene taken;
    taken.problem.main_shape = &good;
    EXPECT_NE(taken.run(), PlanStatus::bad_input);
    Scene second;
    second.obstacles = {{1, good}, {2, bad}};
    EXPECT_EQ(second.run(), PlanStatus::bad_input);
    Scene scene;
    scene.problem.main_shape = &bad;
    EXPECT_EQ(scene.run(), PlanStatus::bad_input);
}

TEST(ProblemLimits, AirframeAndVehicleAreLookedAtToo)
{
    const auto refused = [](auto change) {
        Scene scene;
        change(scene);
        return scene.run() == PlanStatus::bad_input;
    };
    EXPECT_TRUE(refused([](Scene& s) { s.airframe.mass = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.limits.half_extents.x() = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.settings.max_cost = 2.0F; }));
}

TEST(CandidatePathLimits, WaypointsAreTakenUpToTheirLimits)
{
    const Scene scene;
    path::TimedPath path;
    const CandidateShape shape{Family::symmetric, 0.5F, -3.0F};
    for (const std::size_t n : {std::size_t{8}, kMaxPathPoints}) {
        ASSERT_TRUE(make_candidate_path(scene.problem, shape, static_cast<std::uint16_t>(n), scene.limits, path));
        EXPECT_EQ(path.points.size(), n);
    }
    for (const std::size_t n : {std::size_t{0}, std::size_t{7}, kMaxPathPoints + 1}) {
        EXPECT_FALSE(make_candidate_path(scene.problem, shape, static_cast<std::uint16_t>(n), scene.limits, path));
    }
    vehicle::VehicleLimits still = scene.limits;
    still.max_climb = 0.0F;
    EXPECT_FALSE(make_candidate_path(scene.problem, shape, 8, still, path));
    EXPECT_FALSE(make_candidate_path(scene.problem, {Family::simple, kInfinity, 1.0F}, 8, scene.limits, path));
    EXPECT_FALSE(make_candidate_path(scene.problem, {Family::simple, 0.0F, -kInfinity}, 8, scene.limits, path));
}

TEST(StatusLimits, TwoAndAHalfRadiiAreNotTooClose)
{
    Scene scene;
    scene.problem.distance = 2.5F;
    EXPECT_NE(scene.run(), PlanStatus::too_close);
    scene.problem.distance = limit_below(2.5F);
    EXPECT_EQ(scene.run(), PlanStatus::too_close);
    // The body counts where it is known, however uncertain its place.
    scene.problem.main_radius = 4.0F;
    EXPECT_EQ(scene.run(), PlanStatus::too_close);
    scene.problem.body_radius = 0.5F;
    EXPECT_NE(scene.run(), PlanStatus::too_close);
    scene.problem.distance = limit_below(1.25F);
    EXPECT_EQ(scene.run(), PlanStatus::too_close);
}

TEST(StatusLimits, AThreatMovesWhateverAxisItMovesAlong)
{
    for (const Vec3& velocity : {Vec3(1e-3F, 0.0F, 0.0F), Vec3(0.0F, 1e-3F, 0.0F), Vec3(0.0F, 0.0F, -1e-3F)}) {
        Scene scene;
        scene.settings.check_acceleration = false;
        scene.threats.push_back({{Vec3(25.0F, 0.0F, 50.0F), velocity}, 20.0F});  // round all that can be flown
        EXPECT_EQ(scene.run(), PlanStatus::none_available);
        EXPECT_EQ(scene.count(CandidateStatus::hits_moving), scene.result.candidates.size());
        scene.threats[1].motion.velocity = Vec3::Zero();
        EXPECT_EQ(scene.run(), PlanStatus::none_available);
        EXPECT_EQ(scene.count(CandidateStatus::hits_static), scene.result.candidates.size());
    }
}

/// Of the candidates that stay level, whether all, or none, leave the airspace at `kind`.
void expect_level_candidates(Scene& scene, bool leave, ThreatKind kind)
{
    scene.settings.check_acceleration = false;
    scene.settings.verify_flight = false;
    static_cast<void>(scene.run());
    std::size_t level = 0;
    for (const Candidate& c : scene.result.candidates) {
        if (c.shape.plane == 0.0F) {
            ++level;
            EXPECT_EQ(c.hit.kind == kind, leave) << c.shape.offset;
            EXPECT_EQ(c.status == CandidateStatus::hits_airspace, leave) << c.shape.offset;
        }
    }
    EXPECT_GT(level, 0U);
}

TEST(StatusLimits, TouchingFloorOrCeilingIsNotLeavingTheAirspace)
{
    for (const bool escape : {false, true}) {
        Scene scene;
        scene.settings.escape_from_margin = escape;
        scene.airspace.has_floor = true;
        scene.airspace.floor = 49.0F;  // exactly limit_below the box
        expect_level_candidates(scene, false, ThreatKind::floor);
        if (!escape) {
            scene.airspace.floor = limit_above(49.0F);
            expect_level_candidates(scene, true, ThreatKind::floor);
        }
        scene.airspace.has_floor = false;
        scene.airspace.has_ceiling = true;
        scene.airspace.ceiling = 51.0F;
        expect_level_candidates(scene, false, ThreatKind::ceiling);
        if (!escape) {
            scene.airspace.ceiling = limit_below(51.0F);
            expect_level_candidates(scene, true, ThreatKind::ceiling);
        }
    }
}

TEST(StatusLimits, AnAirspaceSmallerThanTheVehicleIsLeftEverywhere)
{
    // A margin so wide that nothing is left within it, and less than nothing squared would hold every candidate.
    Scene scene;
    scene.settings.escape_from_margin = false;
    scene.uncertainty = 200.0F;
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(0.0F, 0.0F, 0.0F);
    scene.airspace.keep_in_radius = 100.0F;
    expect_level_candidates(scene, true, ThreatKind::keep_in);
    scene.uncertainty = 0.0F;
    expect_level_candidates(scene, false, ThreatKind::keep_in);
}

TEST(StatusLimits, BoundsThatAreNotSetBindNothing)
{
    Scene scene;
    scene.settings.escape_from_margin = false;
    scene.airspace.floor = 100.0F;
    scene.airspace.ceiling = 10.0F;
    scene.airspace.keep_in_radius = 1.0F;
    static_cast<void>(scene.run());
    EXPECT_EQ(scene.count(CandidateStatus::hits_airspace), 0U);
}

}  // namespace
}  // namespace jink::geometric
