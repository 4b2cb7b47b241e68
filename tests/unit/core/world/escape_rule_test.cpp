// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/separation.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Margins that a flight may start inside.
struct Margin {
    const char* name;
    void (*place)(Scene&);
    Vec3 out;        ///< direction outwards
    float leave;     ///< pace that must do [m/s]
    float too_slow;  ///< pace that must not

    friend void PrintTo(const Margin& m, std::ostream* out) { *out << m.name; }
};

const std::vector<Point3>& block()
{
    static const std::vector<Point3> vertices{{-2, -2, -2}, {-2, -2, 2}, {-2, 2, -2}, {-2, 2, 2},
                                              {2, -2, -2},  {2, -2, 2},  {2, 2, -2},  {2, 2, 2}};
    return vertices;
}

// The flight starts at the origin, where a margin of about half a metre is lacking.
const Margin kMargins[] = {
    {"track", [](Scene& s) { s.track(Vec3(3.5F, 0, 0), Vec3::Zero(), 3.0F); }, Vec3(-1, 0, 0), 0.55F, 0.4F},
    {"growing track", [](Scene& s) { s.track(Vec3(3.5F, 0, 0), Vec3::Zero(), 2.9F).sigma_velocity = 0.05F; },
     Vec3(-1, 0, 0), 0.75F, 0.4F},
    {"moving track", [](Scene& s) { s.track(Vec3(3.5F, 0, 0), Vec3(-2, 0, 0), 3.0F); }, Vec3(-1, 0, 0), 2.55F, 2.4F},
    {"sphere", [](Scene& s) { s.obstacle(geometry::make_sphere(Vec3(3.5F, 0, 0), 3.0F)); }, Vec3(-1, 0, 0), 0.55F,
     0.4F},
    {"upright capsule", [](Scene& s) { s.obstacle(geometry::make_capsule(Vec3(3.5F, 0, -5), Vec3(3.5F, 0, 5), 3.0F)); },
     Vec3(-1, 0, 0), 0.55F, 0.4F},
    {"box", [](Scene& s) { s.obstacle(geometry::make_box(Vec3(2.5F, 0, 0), Vec3(2, 2, 2))); }, Vec3(-1, 0, 0), 0.6F,
     0.3F},
    {"hull", [](Scene& s) { s.obstacle(geometry::make_hull(block(), Vec3(2.5F, 0, 0))); }, Vec3(-1, 0, 0), 0.6F, 0.3F},
    {"wall's clearance",
     [](Scene& s) { s.own.sigma_position = 0.3F, s.obstacle(geometry::make_box(Vec3(3.4F, 0, 0), Vec3(2, 20, 20))); },
     Vec3(-1, 0, 0), 0.6F, 0.2F},
    {"floor", [](Scene& s) { s.airspace.has_floor = true, s.airspace.floor = -0.5F; }, Vec3(0, 0, 1), 0.55F, 0.4F},
    {"ceiling", [](Scene& s) { s.airspace.has_ceiling = true, s.airspace.ceiling = 0.5F; }, Vec3(0, 0, -1), 0.55F,
     0.4F},
    {"keep-in",
     [](Scene& s) {
         s.airspace.has_keep_in = true, s.airspace.home = Vec3(-10, 0, 0), s.airspace.keep_in_radius = 10.9F;
     },
     Vec3(-1, 0, 0), 0.55F, 0.4F},
};

/// Points `step` seconds apart along `direction` at `pace`.
path::TimedPath straight(const Vec3& direction, float pace, Seconds step, int steps)
{
    std::vector<Vec3> positions;
    for (int i = 0; i <= steps; ++i) {
        positions.push_back(direction * (pace * step * static_cast<float>(i)));
    }
    return flight(positions, step);
}

struct EscapeRules : testing::TestWithParam<Margin> {
    void SetUp() override { GetParam().place(scene); }
    Scene scene;
};

TEST_P(EscapeRules, StartsInside)
{
    WorkBudget budget(kPlenty);
    EXPECT_LT(separation_at(scene.situation(), Vec3::Zero(), 0.0F, budget).margin, -0.3F);
}

/// For any length of the pieces: leaving fast enough is clear.
TEST_P(EscapeRules, LeavingIsClear)
{
    for (const Seconds step : {0.02F, 0.1F, 0.2F, 0.5F, 4.0F}) {
        const int steps = std::min(60, static_cast<int>(4.0F / step));
        EXPECT_GE(separation(scene, straight(GetParam().out, GetParam().leave, step, steps)).margin, 0.0F)
            << "steps of " << step;
        EXPECT_GE(separation(scene, straight(GetParam().out, GetParam().leave + 3.0F, step, steps)).margin, 0.0F)
            << "steps of " << step;
    }
}

TEST_P(EscapeRules, LeavingTooSlowlyIsNot)
{
    for (const Seconds step : {0.1F, 0.5F, 6.0F}) {
        const int steps = static_cast<int>(6.0F / step);
        EXPECT_LT(separation(scene, straight(GetParam().out, GetParam().too_slow, step, steps)).margin, 0.0F)
            << "steps of " << step;
    }
}

TEST_P(EscapeRules, StayingIsNot)
{
    for (const Seconds step : {0.05F, 0.2F, 1.0F, 5.0F}) {
        EXPECT_LT(
            separation(scene, straight(Vec3::Zero(), 0.0F, step, std::max(1, static_cast<int>(2.0F / step)))).margin,
            0.0F)
            << "steps of " << step;
    }
}

TEST_P(EscapeRules, GoingDeeperIsNot)
{
    for (const Seconds step : {0.1F, 1.0F}) {
        EXPECT_LT(separation(scene, straight(-GetParam().out, 1.0F, step, 8)).margin, 0.0F) << "steps of " << step;
    }
}

TEST_P(EscapeRules, LeavingAndComingBackIsNot)
{
    std::vector<Vec3> positions;
    for (const float at : {0.0F, 2.0F, 4.0F, 6.0F, 4.0F, 2.0F, 0.0F}) {
        positions.push_back(GetParam().out * at);
    }
    const Vec3 threat = scene.tracks.empty() ? Vec3(Vec3::Zero()) : scene.tracks[0].velocity;
    std::size_t i = 0;
    for (Vec3& p : positions) {
        p += threat * static_cast<float>(i++);  // beside one that moves, coming back is relative to it
    }
    const Separation found = separation(scene, flight(positions, 1.0F));
    EXPECT_LT(found.margin, 0.0F);
    EXPECT_GT(found.when, 3.0F) << "on the way back";
}

INSTANTIATE_TEST_SUITE_P(Of, EscapeRules, testing::ValuesIn(kMargins), [](const auto& info) {
    std::string name = info.param.name;
    std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
    return name;
});

/// One threat's margin is no licence against another.
TEST(EscapeRule, HoldsForEachThreatByItself)
{
    Scene scene;
    scene.track(Vec3(3.5F, 0, 0), Vec3::Zero(), 3.0F);
    scene.track(Vec3(-9, 0, 0), Vec3::Zero(), 1.0F);
    const Separation found = separation(scene, straight(Vec3(-1, 0, 0), 2.0F, 0.5F, 10));
    EXPECT_LT(found.margin, 0.0F);
    EXPECT_EQ(found.against.index, 1U);
}

TEST(EscapeRule, AFlightThatStartsOutsideGetsNoCredit)
{
    Scene scene;
    scene.track(Vec3(4.001F, 0, 0), Vec3::Zero(), 3.0F);
    EXPECT_GE(separation(scene, straight(Vec3(-1, 0, 0), 0.0F, 1.0F, 3)).margin, 0.0F);
    EXPECT_LT(separation(scene, straight(Vec3(1, 0, 0), 0.01F, 1.0F, 1)).margin, 0.0F);
}

/// A mast 400 m tall whose top leans 8 cm towards the flight. Its thicker, upright bound must not count as a start
/// inside: the flight starts 1 mm clear, and has no credit to go 4 cm inside.
TEST(EscapeRule, AStartThatIsClearOfALeaningMastGetsNoCredit)
{
    Scene scene;
    const Vec3 axis(-4e-4F, 0, 1.0F);
    scene.obstacle(geometry::make_capsule(-200.0F * axis, 200.0F * axis, 0.5F));
    const Vec3 start(-(1.0F + 0.5F + 4e-4F * 196.0F + 1e-3F), 0, 195.0F);
    scene.limits.half_extents = Vec3::Ones();
    EXPECT_GE(separation(scene, flight({start, start}, 1.0F)).margin, 0.0F);
    EXPECT_LE(separation(scene, flight({start, start + Vec3(0.04F, 0, 0), start}, 0.02F)).margin, -0.03F);
}

/// Distances from solids have the resolution kObstacleResolution; the side on which a flight starts is exact.
TEST(EscapeRule, AStartThatIsBarelyClearOfASolidsClearanceGetsNoCredit)
{
    Scene scene;
    scene.limits.half_extents = Vec3(0.5F, 0.7F, 0.3F);
    scene.own.sigma_position = 0.3F;
    const float clearance = scene.rules.k_sigma * scene.own.sigma_position;
    for (int i = 0; i < 400; ++i) {
        const float turn = 0.37F * static_cast<float>(i);
        const Mat3 axes = (Eigen::AngleAxisf(turn, Vec3::UnitZ()) * Eigen::AngleAxisf(0.61F * turn, Vec3::UnitX()) *
                           Eigen::AngleAxisf(1.3F * turn, Vec3::UnitY()))
                              .toRotationMatrix();
        const Vec3 normal = axes.col(0);
        const Vec3& half = scene.limits.half_extents;
        const Vec3 corner(std::copysign(half.x(), -normal.x()), std::copysign(half.y(), -normal.y()),
                          std::copysign(half.z(), -normal.z()));
        const Vec3 foot = corner - (clearance + 2.0F + 5e-3F) * normal;  // 5 mm from a tower's side
        scene.obstacles.clear();
        scene.obstacle(geometry::make_cylinder(foot - 5.0F * axes.col(2), foot + 5.0F * axes.col(2), 2.0F));
        ASSERT_GE(separation(scene, flight({Vec3::Zero(), 1e-3F * normal}, 1.0F)).margin, 0.0F) << i;
        const Vec3 in = -0.03F * normal;
        ASSERT_LE(separation(scene, flight({Vec3::Zero(), in, Vec3::Zero()}, 0.03F)).margin, -0.025F + 1e-3F) << i;
    }
}

// --- obstacle_margin
// -----------------------------------------------------------------------------------------------------------

}  // namespace
}  // namespace jink::world
