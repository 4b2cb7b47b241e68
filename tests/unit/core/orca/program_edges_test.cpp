// SPDX-License-Identifier: BSD-3-Clause
// Programs that are no programs, and the best of a few velocities where there is no time for more.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/orca/program.hpp"

namespace jink::orca {
namespace {

constexpr float kNoSpeed = std::numeric_limits<float>::quiet_NaN();

HalfSpace beyond(const Vec3& normal, float offset, Level level = Level::obstacles)
{
    HalfSpace out;
    out.normal = normal;
    out.offset = offset;
    out.level = level;
    return out;
}

/// Within 10 m/s, and half a metre per second from the reference.
struct Asked {
    std::vector<HalfSpace> planes;
    std::vector<Sphere> spheres;
    Vec3 preferred = Vec3::Zero();
    Vec3 reference = Vec3::Zero();

    explicit Asked(const Vec3& from) : spheres{{Vec3::Zero(), 10.0F}, {from, 0.5F}}, preferred(from), reference(from) {}
    [[nodiscard]] Solution solved(std::uint32_t units = 1'000'000) const
    {
        Scratch<8> scratch;
        WorkBudget budget(units);
        return solve({planes, spheres, preferred, reference}, scratch.view(), budget);
    }
};

void expect_velocity(const Solution& solution, const Vec3& wanted, float tolerance = 1e-5F)
{
    EXPECT_LE((solution.velocity - wanted).norm(), tolerance)
        << solution.velocity.x() << " " << solution.velocity.y() << " " << solution.velocity.z();
}

TEST(ProgramEdges, OneOrTwoSpheresAndNoOthers)
{
    Asked asked({1, 0, 0});
    EXPECT_EQ(asked.solved().status, 0U);
    asked.spheres.push_back({Vec3::Zero(), 20.0F});
    EXPECT_EQ(asked.solved().status, kBadInput) << "three";
    asked.spheres.clear();
    EXPECT_EQ(asked.solved().status, kBadInput);
    expect_velocity(asked.solved(), {1, 0, 0}, 0.0F);
    asked.reference.x() = kNoSpeed;
    expect_velocity(asked.solved(), Vec3::Zero(), 0.0F);
    asked = Asked({1, 0, 0});
    asked.spheres.pop_back();
    EXPECT_EQ(asked.solved().status, 0U);
}

TEST(ProgramEdges, ASphereMayBeAPointAndNoLess)
{
    Asked asked({1, 0, 0});
    asked.spheres[1].radius = 0.0F;
    asked.preferred = {3, 0, 0};
    EXPECT_EQ(asked.solved().status & kBadInput, 0U);
    expect_velocity(asked.solved(), {1, 0, 0});
    for (const float bad : {-0.1F, kNoSpeed, std::numeric_limits<float>::infinity()}) {
        asked.spheres[1].radius = bad;
        EXPECT_EQ(asked.solved().status, kBadInput) << bad;
        expect_velocity(asked.solved(), asked.reference, 0.0F);
        asked.reference.y() = kNoSpeed;
        expect_velocity(asked.solved(), Vec3::Zero(), 0.0F);
        asked.reference.y() = 0.0F;
    }
}

TEST(ProgramEdges, OneHalfSpaceThatIsNoneIsEnough)
{
    const HalfSpace good = beyond({0, 1, 0}, -5.0F);
    for (int what = 0; what < 6; ++what) {
        HalfSpace bad = good;
        switch (what) {
        case 0: bad.normal = {0, 1.01F, 0}; break;
        case 1: bad.normal = Vec3::Zero(); break;
        case 2: bad.offset = kNoSpeed; break;
        case 3: bad.yield = 0.0F; break;
        case 4: bad.yield = -1.0F; break;
        default: bad.normal.z() = kNoSpeed; break;
        }
        for (const std::vector<HalfSpace>& planes :
             {std::vector<HalfSpace>{bad, good}, {good, bad}, {good, bad, good}}) {
            Asked asked({1, 0, 0});
            asked.planes = planes;
            EXPECT_EQ(asked.solved().status, kBadInput) << what;
            EXPECT_EQ(asked.solved().level, Level::limits);
            expect_velocity(asked.solved(), {1, 0, 0}, 0.0F);
        }
    }
    Asked mixed({1, 0, 0});
    mixed.planes = {beyond({0, 1, 0}, -5.0F, Level::conflict), good};
    EXPECT_EQ(mixed.solved().status, kBadInput) << "levels that are not in order";
    Asked many({1, 0, 0});
    many.planes.assign(8, good);
    EXPECT_EQ(many.solved().status, 0U);
    many.planes.push_back(good);
    EXPECT_EQ(many.solved().status, kBadInput) << "more than there is scratch for";
}

TEST(ProgramEdges, SpeedsThatAreNoNumbersAreRefused)
{
    for (const float bad : {kNoSpeed, std::numeric_limits<float>::infinity(), 1e30F}) {
        Asked asked({1, 0, 0});
        asked.preferred.z() = bad;
        EXPECT_EQ(asked.solved().status, kBadInput);
        expect_velocity(asked.solved(), {1, 0, 0}, 0.0F);
        asked = Asked({1, 0, 0});
        asked.reference.x() = bad;
        const Solution solution = asked.solved();
        EXPECT_EQ(solution.status, kBadInput);
        EXPECT_TRUE(is_finite(solution.velocity));
        EXPECT_LE((solution.velocity - Vec3(1, 0, 0)).norm(), 0.5F) << "within the spheres all the same";
    }
}

TEST(ProgramEdges, LimitsThatContradictEachOtherLeaveTheReference)
{
    Asked asked({1, 0, 0});
    asked.preferred = {1.3F, 0, 0};
    asked.planes = {beyond({0, 1, 0}, 0.2F, Level::limits), beyond({0, -1, 0}, 0.1F, Level::limits)};
    const Solution solution = asked.solved();
    EXPECT_EQ(solution.status, kInfeasibleDynamics);
    EXPECT_EQ(solution.level, Level::limits);
    expect_velocity(solution, {1, 0, 0});
    EXPECT_NEAR(solution.broken[0], 0.2F, 1e-5F);
}

// Without any budget: the best of the reference, braking, and full acceleration away from the largest violation.

TEST(ProgramEdges, WithoutTimeItAcceleratesAwayFromTheWorstObstacle)
{
    const HalfSpace y = beyond({0, 1, 0}, 5.0F);
    const HalfSpace z = beyond({0, 0, 1}, 2.0F);
    const HalfSpace conflict = beyond({0, 0, -1}, 50.0F, Level::conflict);
    for (const std::vector<HalfSpace>& planes : {std::vector<HalfSpace>{y, z}, {z, y}, {y}, {z, y, conflict}}) {
        Asked asked({1, 0, 0});
        asked.planes = planes;
        const Solution solution = asked.solved(0);
        EXPECT_EQ(solution.status & ~std::uint32_t{kRelaxedConflict}, kWorkLimit | kRelaxedObstacle);
        EXPECT_EQ(solution.level, Level::obstacles);
        expect_velocity(solution, {1, 0.5F, 0});
        EXPECT_NEAR(solution.broken[1], 4.5F, 1e-5F);
    }
}

TEST(ProgramEdges, WithoutTimeItAcceleratesAwayFromTheWorstConflictWhereObstaclesAllowIt)
{
    Asked asked({1, 0, 0});
    asked.planes = {beyond({1, 0, 0}, -3.0F), beyond({0, 0, 1}, 2.0F, Level::conflict),
                    beyond({0, 1, 0}, 5.0F, Level::conflict), beyond({0, -1, 0}, 90.0F, Level::warning)};
    const Solution solution = asked.solved(0);
    EXPECT_EQ(solution.status, kWorkLimit | kRelaxedConflict | kRelaxedWarning);
    EXPECT_EQ(solution.level, Level::conflict);
    expect_velocity(solution, {1, 0.5F, 0});
    // It never causes contact with an obstacle: with a bound at y = 0.2 it stays or brakes.
    asked.planes[0] = beyond({0, -1, 0}, -0.2F);
    EXPECT_EQ(asked.solved(0).broken[1], 0.0F);
    EXPECT_LT(asked.solved(0).velocity.y(), 0.2F);
}

TEST(ProgramEdges, WithoutTimeItBrakesWhereThatBreaksLeast)
{
    Asked slow({0.3F, 0, 0});
    slow.planes = {beyond({-1, 0, 0}, 0.0F), beyond({1, 0, 0}, 0.0F)};
    expect_velocity(slow.solved(0), Vec3::Zero());
    EXPECT_EQ(slow.solved(0).status, kWorkLimit) << "nothing is broken";
    Asked fast({1, 1, 0});
    const float left = 1.0F - 0.5F / std::sqrt(2.0F);
    fast.planes = {beyond({-1, 0, 0}, -left), beyond({0, -1, 0}, -left)};
    expect_velocity(fast.solved(0), {left, left, 0});
    // And keeps its velocity where nothing is broken by it.
    Asked keeps({1, 0, 0});
    keeps.planes = {beyond({1, 0, 0}, 1.0F)};
    expect_velocity(keeps.solved(0), {1, 0, 0});
    EXPECT_EQ(keeps.solved(0).status, kWorkLimit);
}

TEST(ProgramEdges, IntoTheSpheresIsTheNearestPointOfThem)
{
    const std::vector<Sphere> spheres{{Vec3::Zero(), 2.0F}, {{2, 0, 0}, 1.0F}};
    EXPECT_EQ(into_spheres(spheres, {1.5F, 0.1F, 0}), Vec3(1.5F, 0.1F, 0)) << "within";
    EXPECT_LT((into_spheres(spheres, {5, 0, 0}) - Vec3(2, 0, 0)).norm(), 1e-5F);
    EXPECT_LT((into_spheres(spheres, {-5, 0, 0}) - Vec3(1, 0, 0)).norm(), 1e-5F);
    const Vec3 corner = into_spheres(spheres, {2, 9, 0});
    EXPECT_LT((corner - Vec3(1.75F, std::sqrt(4.0F - 1.75F * 1.75F), 0)).norm(), 1e-4F);
    for (const Vec3& point : {Vec3(5, 1, 2), Vec3(-3, 0, 4), Vec3(2, 9, 0), Vec3(kNoSpeed, 0, 0)}) {
        const Vec3 in = into_spheres(spheres, point);
        EXPECT_LE(in.norm(), 2.0F);
        EXPECT_LE((in - Vec3(2, 0, 0)).norm(), 1.0F);
    }
}

}  // namespace
}  // namespace jink::orca
