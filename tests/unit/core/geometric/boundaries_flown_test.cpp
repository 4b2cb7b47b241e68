// SPDX-License-Identifier: BSD-3-Clause
// A candidate as it is flown, at the border: the cost of its flight to the last work unit, the duration of swept
// volumes, and the permitted speed relative to its path.
#include <gtest/gtest.h>

#include <vector>

#include "core/base/work_units.hpp"
#include "core/geometric/flown.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

/// A straight path of `length` at 5 m/s along the leg, about its start, without threats.
struct FlightBench : Scene {
    path::TimedPath path;

    explicit FlightBench(float length, const Vec3& direction = Vec3::UnitX())
    {
        threats.clear();
        problem.main = kNoThreat;
        problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), direction);
        const Vec3 along = problem.frame.axes.col(0);
        problem.start_velocity = 5.0F * along;
        settings.escape_from_margin = false;
        constexpr int kPoints = 25;
        for (int i = 0; i < kPoints; ++i) {
            const float way = length * static_cast<float>(i) / static_cast<float>(kPoints - 1);
            path.points.unchecked_push_back({way * along, 5.0F * along, way / 5.0F});
        }
    }
    detail::Verdict judge(Seconds swept_until, WorkBudget& units)
    {
        put_into(problem);
        detail::Flown flown(problem, settings, limits);
        return flown.judge(path, swept_until, units);
    }
    CandidateStatus status(Seconds swept_until = 0.0F)
    {
        WorkBudget units(1'000'000);
        return judge(swept_until, units).status;
    }
};

TEST(FlownBorder, WhatAFlightNeedsIsWhatItSpends)
{
    std::uint32_t needs[2] = {};
    for (const vehicle::VehicleKind kind : {vehicle::VehicleKind::fixed_wing, vehicle::VehicleKind::multirotor}) {
        FlightBench bench(30.0F);
        bench.limits.kind = kind;
        WorkBudget plenty(1'000'000);
        ASSERT_EQ(bench.judge(0.0F, plenty).status, CandidateStatus::available);
        WorkBudget enough(plenty.spent());
        EXPECT_EQ(bench.judge(0.0F, enough).status, CandidateStatus::available);
        EXPECT_FALSE(enough.exhausted());
        WorkBudget less(plenty.spent() - 1);
        EXPECT_EQ(bench.judge(0.0F, less).status, CandidateStatus::not_evaluated);
        EXPECT_TRUE(less.exhausted());
        EXPECT_EQ(less.left(), 0U) << "what is not flown to its end takes all the same";
        needs[kind == vehicle::VehicleKind::multirotor] = plenty.spent();
    }
    EXPECT_GE(needs[1], needs[0] + 5 * units::kCandidatePart) << "braking comes on top";
}

/// Units that the threats of a bench add to its flight.
std::uint32_t added_units(FlightBench& bench)
{
    const std::vector<Sphere> threats = bench.threats;
    bench.threats.clear();
    WorkBudget without(1'000'000);
    EXPECT_EQ(bench.judge(0.0F, without).status, CandidateStatus::available);
    bench.threats = threats;
    WorkBudget with(1'000'000);
    static_cast<void>(bench.judge(0.0F, with));
    return with.spent() - without.spent();
}

TEST(FlownBorder, WhatIsInTheWayAtAQuickRejectIsNotLookedAtCloser)
{
    FlightBench bench(30.0F);
    bench.threats = {Scene::still(Vec3(1.0F, 0.0F, 50.0F), 0.5F)};
    ASSERT_EQ(bench.status(), CandidateStatus::hits_static);
    EXPECT_EQ(added_units(bench), units::kCollected + units::kItem + units::kSphereCheck);
}

TEST(FlownBorder, WhatIsPassedAtAQuickRejectIsNotLookedAtCloser)
{
    // As large as the leg is long, a tenth of a metre beside all of it: each segment is checked once.
    FlightBench bench(60.0F, Vec3(1.0F, 1.0F, 0.0F));
    const Mat3& axes = bench.problem.frame.axes;
    bench.threats = {Scene::still(Vec3(0.0F, 0.0F, 50.0F) + axes * Vec3(30.0F, 202.5F, 0.0F), 200.0F)};
    ASSERT_EQ(bench.status(), CandidateStatus::available);
    const std::uint32_t added = added_units(bench);
    EXPECT_GT(added, units::kCollected + units::kItem + units::kSphereCheck * 3 * kMaxPathPoints / 4) << "almost all";
    EXPECT_LT(added, units::kCollected + units::kItem + units::kSphereCheck * kMaxPathPoints);
}

TEST(FlownBorder, VolumesLastAsLongAsTheFlight)
{
    FlightBench bench(30.0F);
    bench.settings.security = SecurityMode::swept;
    bench.threats = {{{Vec3(15.0F, -24.0F, 50.0F), Vec3(0.0F, 6.0F, 0.0F)}, 0.5F}};  // on the leg after 4 s
    EXPECT_EQ(bench.status(), CandidateStatus::hits_moving);
    bench.settings.security = SecurityMode::time_aware;
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

TEST(FlownBorder, VolumesLastAsLongAsTheLongestCandidate)
{
    // Beside a slanted leg, within the extent of its flight: it comes there long after the flight.
    FlightBench bench(20.0F, Vec3(1.0F, 1.0F, 0.0F));
    bench.settings.security = SecurityMode::swept;
    bench.threats = {{{Vec3(13.0F, 1.0F, 50.0F), Vec3(-0.3F, 0.3F, 0.0F)}, 0.5F}};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    EXPECT_EQ(bench.status(40.0F), CandidateStatus::hits_moving);
}

TEST(FlownBorder, AFlightMayBeginFasterThanItsPath)
{
    FlightBench bench(30.0F);
    for (path::PathPoint& point : bench.path.points) {
        point.velocity *= 0.2F;
        point.time *= 5.0F;
    }
    bench.problem.speed = 1.0F;
    bench.limits.max_acceleration = 2.0F;
    bench.problem.start_velocity = Vec3(18.0F, 0.0F, 0.0F);
    ASSERT_EQ(bench.status(), CandidateStatus::available);
    // Passed within the first second; by the path's speed it would be checked after that.
    bench.threats = {Scene::still(Vec3(12.0F, 1.0F, 50.0F), 0.3F)};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static);
}

/// A nearly static track sweeps a negligible volume, and still blocks the path.
TEST(FlownBorder, ATrackAsSlowAsNumbersAllowIsInTheWay)
{
    for (const float speed : {1e-6F, 1e-20F, 1e-25F, 1e-38F}) {
        for (const bool to_collision_point : {false, true}) {
            FlightBench bench(30.0F);
            bench.settings.security = SecurityMode::swept;
            bench.settings.main_swept_to_collision_point = to_collision_point;
            bench.problem.main = 0;
            bench.threats = {{{Vec3(15.0F, 0.0F, 50.0F), Vec3(0.0F, speed, 0.0F)}, 0.5F}};
            EXPECT_EQ(bench.status(), CandidateStatus::hits_moving) << speed;
        }
    }
}

TEST(FlownBorder, WhatTouchesAtTheStartIsNoMarginToEscapeFrom)
{
    FlightBench bench(30.0F);
    bench.settings.escape_from_margin = true;
    // The box extends 1 m; 1e-3 m inside, the escape rule shrinks the sphere; in exact contact it does not.
    bench.threats = {Scene::still(Vec3(-3.0F, 0.0F, 50.0F), 2.001F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    bench.threats[0].radius = 2.0F;
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static);
    bench.threats[0].radius = 1.999F;
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

TEST(FlownBorder, WhereThereIsNoPathLeftBrakingIsAllThatIsFlown)
{
    // From 5 m/s, through a lag of a quarter of a second: 1.25 m, and 2.5 m at most at 5 m/s2. The box reaches 1 m.
    FlightBench bench(0.0F);
    ASSERT_EQ(bench.path.duration(), 0.0F);
    bench.threats = {Scene::still(Vec3(3.0F, 0.0F, 50.0F), 0.25F)};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static);
    bench.threats = {Scene::still(Vec3(6.0F, 0.0F, 50.0F), 0.25F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    bench.threats = {Scene::still(Vec3(-1.5F, 0.0F, 50.0F), 0.25F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

TEST(FlownBorder, WhatStandsAtItsEndIsWatchedForAStepMore)
{
    FlightBench bench(0.0F);
    bench.problem.start_velocity = Vec3::Zero();
    for (std::size_t i = 0; i < bench.path.points.size(); ++i) {
        bench.path.points[i].velocity = Vec3::Zero();
        bench.path.points[i].time = static_cast<float>(i) / static_cast<float>(bench.path.points.size() - 1);
    }
    ASSERT_EQ(bench.path.duration(), 1.0F);
    // It comes down at 20 m/s, and is there a tenth of a second after the path's end, or much later.
    const Vec3 velocity(0.0F, 0.0F, -20.0F);
    const auto coming = [&](Seconds then) {
        bench.threats = {{{Vec3(0.0F, 0.0F, 51.5F) - then * velocity, velocity}, 0.5F}};
        return bench.status();
    };
    EXPECT_EQ(coming(0.9F), CandidateStatus::hits_moving);
    EXPECT_EQ(coming(1.1F), CandidateStatus::hits_moving);
    EXPECT_EQ(coming(1.5F), CandidateStatus::available);
}

}  // namespace
}  // namespace jink::geometric
