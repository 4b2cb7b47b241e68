// SPDX-License-Identifier: BSD-3-Clause
// One curve against static and moving threats: the queried parts, spheres as small as a point, growing solids,
// bounds with zero margin, and the cost of each check.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/curve_bench.hpp"

namespace jink::geometric {
namespace {

using detail::Clearance;
using world::ThreatKind;
using Part = Clearance::Part;

/// 10 m along x in 10 s, a point each second.
std::vector<CurvePoint> straight_way()
{
    std::vector<CurvePoint> points;
    for (int i = 0; i <= 10; ++i) {
        points.push_back({static_cast<float>(i) * Vec3::UnitX(), static_cast<float>(i)});
    }
    return points;
}

/// A sphere that stays about `place` and counts as moving.
/// So slow that a solid stays where it is, and counts as moving.
const Vec3 kHardly(0.0F, 0.0F, 1e-4F);

Sphere hovering(const Vec3& place) { return {{place, kHardly}, 0.5F}; }

const Vec3 kOnTheWay(5.0F, 0.0F, 0.0F);
const Vec3 kBeside(5.0F, 0.0F, 4.0F);

TEST(ClearanceBorder, ThreatsThatAreDeferredAreAskedAfterByThemselves)
{
    CurveBench bench(straight_way());
    bench.deferred[1] = true;
    const auto statuses = [&](const Vec3& near, const Vec3& deferred) {
        bench.threats = {hovering(near), hovering(deferred)};
        return std::array{bench.check(Part::all, {kBeside}).status, bench.check(Part::near, {kBeside}).status,
                          bench.check(Part::deferred, {kBeside}).status};
    };
    constexpr auto kFree = CandidateStatus::available;
    constexpr auto kHit = CandidateStatus::hits_moving;
    EXPECT_EQ(statuses(kBeside, kBeside), (std::array{kFree, kFree, kFree}));
    EXPECT_EQ(statuses(kOnTheWay, kBeside), (std::array{kHit, kHit, kFree}));
    EXPECT_EQ(statuses(kBeside, kOnTheWay), (std::array{kHit, kFree, kHit}));
}

TEST(ClearanceBorder, TheAirspaceIsNoneOfWhatIsDeferred)
{
    CurveBench bench(straight_way());
    bench.airspace.has_ceiling = true;
    bench.airspace.ceiling = 0.25F;
    EXPECT_EQ(bench.check(Part::all).status, CandidateStatus::hits_airspace);
    EXPECT_EQ(bench.check(Part::near).status, CandidateStatus::hits_airspace);
    EXPECT_EQ(bench.check(Part::deferred).status, CandidateStatus::available);
}

TEST(ClearanceBorder, SolidsAreWhatNoClosedFormKnowsAtRestOrMoving)
{
    CurveBench bench(straight_way());
    const auto count = [&](const std::vector<geometry::Shape>& still, std::size_t moving) {
        bench.obstacles.clear();
        for (const geometry::Shape& shape : still) {
            bench.obstacles.push_back({1, shape});
        }
        bench.solids.assign(moving, {geometry::make_sphere(kOnTheWay, 0.5F), Vec3::Zero()});
        static_cast<void>(bench.check());
        return bench.counted_solids;
    };
    const Vec3 up(0.0F, 0.0F, 1.0F);
    const geometry::Shape sphere = geometry::make_sphere(kOnTheWay, 0.5F);
    const geometry::Shape mast = geometry::make_capsule(kOnTheWay - up, kOnTheWay + up, 0.5F);
    const geometry::Shape box = geometry::make_box(kOnTheWay, Vec3::Ones());
    const geometry::Shape drum = geometry::make_cylinder(kOnTheWay - up, kOnTheWay + up, 0.5F);
    EXPECT_EQ(count({}, 0), 0U);
    EXPECT_EQ(count({sphere, mast}, 0), 0U);
    EXPECT_EQ(count({sphere, box, drum}, 0), 2U);
    EXPECT_EQ(count({}, 2), 2U);
    EXPECT_EQ(count({box, mast}, 1), 2U);
    EXPECT_EQ(count({geometry::make_box(Vec3(5.0F, 9.0F, 0.0F), Vec3::Ones())}, 0), 0U) << "and within reach";
}

TEST(ClearanceBorder, AnObstacleThatIsASphereCostsWhatAThreatAtRestCosts)
{
    for (const Vec3& place : {kOnTheWay, Vec3(9.0F, 1.2F, 0.0F), kBeside}) {
        CurveBench bench(straight_way());
        bench.threats = {Scene::still(place, 0.5F)};
        const CandidateStatus status = bench.check(Part::all, {kBeside}).status;
        const std::uint32_t spent = bench.spent;
        bench.threats.clear();
        bench.obstacles = {{1, geometry::make_sphere(place, 0.5F)}};
        EXPECT_EQ(bench.check(Part::all, {kBeside}).status, status);
        EXPECT_EQ(bench.spent, spent);
    }
}

TEST(ClearanceBorder, AMovingSolidIsReportedOfBehindTheObstacles)
{
    CurveBench bench(straight_way());
    const geometry::Shape box = geometry::make_box(kOnTheWay, Vec3::Constant(0.5F));
    bench.obstacles.assign(3, {1, geometry::make_box(kBeside, Vec3::Constant(0.5F))});
    bench.solids = {{geometry::make_box(kBeside, Vec3::Constant(0.5F)), kHardly}, {box, kHardly}};
    const detail::Verdict verdict = bench.check(Part::all, {kBeside});
    EXPECT_EQ(verdict.status, CandidateStatus::hits_moving);
    EXPECT_EQ(verdict.hit.kind, ThreatKind::obstacle);
    EXPECT_EQ(verdict.hit.index, 4U);
}

TEST(ClearanceBorder, AMovingSolidIsInTheWayHoweverManySpheresAreNot)
{
    for (std::size_t spheres = 0; spheres <= 8; ++spheres) {
        CurveBench bench(straight_way());
        bench.threats.assign(spheres, Scene::still(kBeside, 0.5F));
        bench.solids = {{geometry::make_box(kOnTheWay, Vec3::Constant(0.5F)), kHardly}};
        EXPECT_EQ(bench.check(Part::all, {kBeside}).status, CandidateStatus::hits_moving) << spheres;
    }
}

TEST(ClearanceBorder, AMovingSolidReachesAsFarAsItsUncertainty)
{
    for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
        CurveBench bench(straight_way());
        bench.settings.security = security;
        bench.solids = {{geometry::make_sphere(Vec3(5.0F, 4.0F, 0.0F), 0.5F), kHardly, 3.0625F}};
        EXPECT_EQ(bench.status(), CandidateStatus::hits_moving);
        bench.solids[0].uncertainty = 2.9375F;
        EXPECT_EQ(bench.status(), CandidateStatus::available);
    }
}

TEST(ClearanceBorder, SweptAMovingSolidIsInTheWayOfWhatPassesBeforeAndAfterIt)
{
    // It crosses the path a second before the path's end; the vehicle is then far away.
    CurveBench bench(straight_way());
    bench.solids = {{geometry::make_box(Vec3(2.0F, 9.0F, 0.0F), Vec3::Constant(0.5F)), Vec3(0.0F, -1.0F, 0.0F)}};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    bench.settings.security = SecurityMode::swept;
    EXPECT_EQ(bench.status(), CandidateStatus::hits_moving);
}

TEST(ClearanceBorder, AMovingSolidThatGrowsIsPassedWhileItIsSmall)
{
    // Passed at 2 m after two seconds; when it has grown to that size, the path is far away.
    for (const auto& [rate, acceleration] : {std::array{0.4F, 0.0F}, std::array{0.0F, 0.12F}}) {
        CurveBench bench(straight_way());
        bench.solids = {
            {geometry::make_box(Vec3(2.0F, 3.0F, 0.0F), Vec3::Constant(0.5F)), kHardly, 0.0F, rate, acceleration}};
        EXPECT_EQ(bench.status(), CandidateStatus::available) << rate;
        bench.solids[0].radius_rate *= 6.0F;
        bench.solids[0].radius_acceleration *= 6.0F;
        EXPECT_EQ(bench.status(), CandidateStatus::hits_moving) << rate;
    }
}

TEST(ClearanceBorder, AKeepInThatTheBoxJustFillsIsNoRoomToMoveAside)
{
    for (const float aside : {0.0F, 1e-3F}) {
        CurveBench bench({{Vec3::Zero(), 0.0F}, {Vec3(0.0F, 0.0F, 5.0F), 5.0F}, {Vec3(aside, 0.0F, 9.0F), 9.0F}});
        bench.limits.half_extents = Vec3(3.0F, 4.0F, 1.0F);  // 5 m across, exactly
        bench.airspace.has_keep_in = true;
        bench.airspace.keep_in_radius = 5.0F;
        EXPECT_EQ(bench.status(), aside > 0.0F ? CandidateStatus::hits_airspace : CandidateStatus::available);
    }
}

/// One segment.
CurveBench segment(const Vec3& to, Seconds duration) { return CurveBench({{Vec3::Zero(), 0.0F}, {to, duration}}); }

TEST(ClearanceBorder, APointIsInTheWayToo)
{
    // A segment whose middle is far from it, so that the quick reject of the middle does not decide.
    CurveBench bench = segment(Vec3(3.0F, 0.0F, 0.0F), 1.0F);
    for (const Vec3& velocity : {Vec3(0.0F, 0.0F, 0.0F), Vec3(-1.0F, 0.0F, 0.0F)}) {
        bench.threats = {{{Vec3(-0.4F, 0.0F, 0.0F), velocity}, 0.0F}};
        EXPECT_NE(bench.status(), CandidateStatus::available) << velocity.x();
        bench.threats[0].motion.position.x() = -0.6F;
        EXPECT_EQ(bench.status(), CandidateStatus::available) << velocity.x();
    }
}

TEST(ClearanceBorder, AnExactTestOfASphereIsPaidFor)
{
    CurveBench bench = segment(Vec3(3.0F, 0.0F, 0.0F), 1.0F);
    bench.threats = {Scene::still(Vec3(-0.75F, 0.0F, 0.0F), 0.5F)};
    ASSERT_EQ(bench.status(), CandidateStatus::hits_static);
    EXPECT_EQ(bench.spent, units::kItem + units::kSphereCheck + units::kSphereCheckPart + units::kSphereContact);
    bench.settings.security = SecurityMode::swept;
    bench.threats[0].motion.velocity = Vec3(0.0F, 1e-3F, 0.0F);
    ASSERT_EQ(bench.status(), CandidateStatus::hits_moving);
    EXPECT_EQ(bench.spent, units::kItem + units::kSphereCheckPart + units::kCapsuleQuery);
}

TEST(ClearanceBorder, WhoLeavesAMarginStraightAwayIsSeenToAtAQuickReject)
{
    // An eighth of a metre inside; the sphere grows back half its slack in each of 16 parts.
    CurveBench bench = segment(Vec3(2.0F, 0.0F, 0.0F), 1.0F);
    bench.settings.escape_from_margin = true;
    bench.problem.rules.escape = {0.0625F, 0.5F};
    bench.threats = {Scene::still(Vec3(-2.0F, 0.0F, 0.0F), 1.625F)};
    ASSERT_EQ(bench.status(), CandidateStatus::available);
    EXPECT_EQ(bench.spent, units::kItem + units::kSphereCheck + 16 * units::kSphereCheckPart);
}

TEST(ClearanceBorder, AMarginThatGrowsBackAsSlowlyAsNumbersAllowIsLookedAtAllTheSame)
{
    // A quarter of a metre inside: one direction leads out, the other deeper, by far more than the slack.
    for (const float speed : {0.0F, 1e-44F, 1e-20F, 0.5F}) {
        for (const bool sphere : {true, false}) {
            for (const float way : {-1.0F, 1.0F}) {
                CurveBench bench = segment(Vec3(way, 0.0F, 0.0F), 1.0F);
                bench.settings.escape_from_margin = true;
                bench.problem.rules.escape.speed = speed;
                if (sphere) {
                    bench.threats = {Scene::still(Vec3(-2.25F, 0.0F, 0.0F), 2.0F)};
                } else {
                    bench.obstacles = {{1, geometry::make_box(Vec3(-2.25F, 0.0F, 0.0F), Vec3::Constant(2.0F))}};
                }
                EXPECT_EQ(bench.status(), way > 0.0F ? CandidateStatus::available : CandidateStatus::hits_static)
                    << speed << " " << sphere;
            }
        }
    }
}

TEST(ClearanceBorder, WhereThereWasNoRoomTheNextSegmentIsLookedAtItself)
{
    // A sphere beside the start; away from it in one second, and on from there.
    CurveBench bench({{Vec3::Zero(), 0.0F},
                      {Vec3(8.0F, 0.0F, 0.0F), 1.0F},
                      {Vec3(8.0F, 1.0F, 0.0F), 2.0F},
                      {Vec3(8.0F, 2.0F, 0.0F), 3.0F}});
    bench.threats = {Scene::still(Vec3(-3.0F, 0.0F, 0.0F), 0.5F)};
    ASSERT_EQ(bench.check(Part::all, {Vec3(-3.0F, 0.0F, 0.0F)}).status, CandidateStatus::available);
    EXPECT_EQ(bench.spent, units::kItem + 2 * units::kSphereCheck) << "and room is looked for again after that";
}

TEST(ClearanceBorder, WhoStandsStillFarFromASphereIsFarUntilTheEnd)
{
    CurveBench bench({{Vec3::Zero(), 0.0F}, {Vec3::Zero(), 1.0F}, {Vec3::Zero(), 2.0F}});
    bench.threats = {Scene::still(Vec3(-3.0F, 0.0F, 0.0F), 0.5F)};
    ASSERT_EQ(bench.check(Part::all, {Vec3(-2.0F, 0.0F, 0.0F)}).status, CandidateStatus::available);
    EXPECT_EQ(bench.spent, units::kItem);
}

TEST(ClearanceBorder, AVolumeThatIsAsFarAsItsRadiusAndItsSlackIsInTheWay)
{
    // A metre beside the box all the time, in numbers that are exact; the slack is a share of 1 m and of how far out
    // the volume lies.
    constexpr float kFarOut = 8.5F;
    const float slack = detail::kExtentRounding * (1.0F + kFarOut);
    float radius = 1.0F - slack;
    while (radius + slack > 1.0F) {
        radius = std::nextafter(radius, 0.0F);
    }
    while (radius + slack < 1.0F) {
        radius = std::nextafter(radius, 1.0F);
    }
    ASSERT_EQ(radius + slack, 1.0F);
    CurveBench bench({{Vec3(0.0F, -10.0F, 0.0F), 0.0F}, {Vec3(1.0F, -10.0F, 0.0F), 1.0F}});
    bench.settings.security = SecurityMode::swept;
    bench.threats = {{{Vec3(0.0F, -kFarOut, 0.0F), Vec3(1.0F, 0.0F, 0.0F)}, radius}};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_moving);
    bench.threats[0].radius = radius - 1e-6F;
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

}  // namespace
}  // namespace jink::geometric
