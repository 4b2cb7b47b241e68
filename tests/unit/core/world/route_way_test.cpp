// SPDX-License-Identifier: BSD-3-Clause
// Paths along a route: their aims, their pieces, and conflicts on them computed by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/route_way.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::RoutePieces;
using path::RouteStatus;

constexpr float kQuarter = 0.5F * kPi;

/// 30 m east, a corner, 20 m north, a quarter circle of 10 m to the west, 25 m west. The vehicle is on the first leg,
/// 10 m from its start, and flies 5 m/s.
struct OnRoute : testing::Test {
    OnRoute()
    {
        EXPECT_EQ(route.add_leg(Vec3(0, 0, 0), Vec3(30, 0, 0)), RouteStatus::ok);
        EXPECT_EQ(route.add_leg(Vec3(30, 0, 0), Vec3(30, 20, 0)), RouteStatus::ok);
        EXPECT_EQ(route.add_arc(Vec3(30, 20, 0), Vec3(20, 20, 0), Vec3::UnitZ(), kQuarter), RouteStatus::ok);
        EXPECT_EQ(route.add_leg(Vec3(20, 30, 0), Vec3(-5, 30, 0)), RouteStatus::ok);
        fly(route);
        scene.own.position = Vec3(10, 0, 0);
    }
    void fly(const path::Route& r)
    {
        scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
        scene.reference = world::Reference(r, scene.reference.speed);
    }
    Way at(const Vec3& position, std::size_t segment = 0)
    {
        scene.own.position = position;
        scene.reference.segment = segment;
        return way_of(scene.situation());
    }
    bool meets(Conflict& out, Seconds lookahead = 12.0F, std::uint32_t units = kPlenty)
    {
        WorkBudget budget(units);
        const Situation s = scene.situation();
        const bool found = main_conflict(s, way_of(s), lookahead, budget, out);
        spent = budget.spent();
        return found;
    }

    path::Route route;
    Scene scene;
    Conflict found;
    std::uint32_t spent = 0;
};

constexpr float kLength = 30.0F + 20.0F + 10.0F * kQuarter + 25.0F;

// --- where it aims ---

TEST_F(OnRoute, OnALegItAimsAtTheLegsEnd)
{
    const Way way = at(Vec3(10, 0, 0));
    EXPECT_EQ(way.direction, Vec3(1, 0, 0));
    EXPECT_NEAR(way.ahead.straight, 20.0F, 1e-4F);
    EXPECT_NEAR(way.ahead.joined_at, 30.0F, 1e-4F);
    EXPECT_NEAR(way.length, kLength - 10.0F, 1e-3F);
    EXPECT_EQ(way.speed, 5.0F);
    EXPECT_NEAR(at(Vec3(10, 0.25F, 0)).ahead.joined_at, 30.0F, 1e-4F) << "a quarter of a metre is on it";
    EXPECT_NEAR(at(Vec3(10, 0.26F, 0)).ahead.joined_at, 22.0F, 1e-4F);
}

TEST_F(OnRoute, OffALegItAimsAheadButNotFarPastItsEnd)
{
    EXPECT_NEAR(at(Vec3(10, -4, 0)).ahead.joined_at, 22.0F, 1e-4F);
    EXPECT_NEAR(at(Vec3(10, -4, 0)).ahead.straight, std::hypot(12.0F, 4.0F), 1e-4F);
    EXPECT_NEAR(at(Vec3(10, -4, 0)).length, std::hypot(12.0F, 4.0F) + kLength - 22.0F, 1e-3F);
    EXPECT_NEAR(at(Vec3(20, -2, 0)).ahead.joined_at, 30.0F, 1e-4F) << "the leg's end is nearer than 12 m";
    EXPECT_NEAR(at(Vec3(25, -4, 0)).ahead.joined_at, 33.0F, 1e-4F) << "8 m ahead at least";
    EXPECT_NEAR(at(Vec3(25, -10, 0)).ahead.joined_at, 37.0F, 1e-4F) << "but 12 m at most";
    EXPECT_NEAR(at(Vec3(29.5F, 0, 0)).ahead.joined_at, 30.5F, 1e-4F) << "and 1 m at least";
    EXPECT_NEAR(at(Vec3(29.5F, -0.4F, 0)).ahead.joined_at, 30.5F, 1e-4F);
}

TEST_F(OnRoute, OnAnArcItAimsByItsRadiusAndHowFarItIsOff)
{
    const auto ahead = [&](float radius, float angle) {
        const Vec3 position(20.0F + radius * std::cos(angle), 20.0F + radius * std::sin(angle), 0);
        return at(position, 2).ahead.joined_at - (50.0F + 10.0F * angle);
    };
    EXPECT_NEAR(ahead(10.0F, 0.3F), std::sqrt(10.0F), 1e-2F);
    EXPECT_NEAR(ahead(12.0F, 0.3F), std::sqrt(10.0F) + 4.0F, 1e-2F);
    EXPECT_NEAR(ahead(7.0F, 0.2F), std::sqrt(10.0F) + 6.0F, 1e-2F);
    EXPECT_NEAR(ahead(15.0F, 0.2F), 12.0F, 1e-2F) << "12 m at most";
    EXPECT_NEAR(ahead(10.0F, kQuarter - 0.2F), 2.0F, 1e-2F) << "to its end";
    EXPECT_NEAR(ahead(10.0F, kQuarter - 0.05F), 1.0F, 1e-2F) << "but 1 m at least";
}

TEST_F(OnRoute, AtItsEndNothingIsLeft)
{
    const Way way = at(Vec3(-5, 30, 0), 3);
    EXPECT_EQ(way.length, 0.0F);
    EXPECT_NEAR((way.direction - Vec3(-1, 0, 0)).norm(), 0.0F, 1e-4F);
    EXPECT_NEAR(at(Vec3(-4.9F, 30, 0), 3).length, 0.1F, 1e-3F);
}

/// Back beside its own line: the point a metre ahead, round the turn, may be less than 1 mm from the vehicle.
TEST(FoldedRoute, GoesOnWhereTheAimIsTheOwnPlace)
{
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 0), Vec3(100, 0, 0)), RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(100, 0, 0), Vec3(0, 0.15F, 0)), RouteStatus::ok);
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.own.position = Vec3(99.5F, 0, 0);
    const Way way = way_of(scene.situation());
    EXPECT_NEAR(way.ahead.joined_at, 100.5F, 1e-4F);
    EXPECT_NEAR(way.length, 99.5F, 1e-3F);
    EXPECT_NEAR((way.direction - Vec3(-1, 0, 0)).norm(), 0.0F, 2e-3F);
    const RoutePieces pieces(scene.situation(), way, 10.0F);
    EXPECT_NEAR(pieces[0].own.velocity.x(), -5.0F, 1e-4F);
}

// --- its pieces ---

TEST_F(OnRoute, PiecesEndWithTheTimeThatIsLookedAhead)
{
    const Way way = at(Vec3(10, 0, 0));
    const auto count = [&](Seconds lookahead) {
        const RoutePieces pieces(scene.situation(), way, lookahead);
        EXPECT_EQ(pieces[pieces.size() - 1].end, lookahead);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            EXPECT_EQ(pieces[i].start, i == 0 ? 0.0F : pieces[i - 1].end);
            EXPECT_GT(pieces[i].end, pieces[i].start);
        }
        return pieces.size();
    };
    EXPECT_EQ(count(3.0F), 1U);
    EXPECT_EQ(count(4.0F), 1U) << "just to the corner";
    EXPECT_EQ(count(4.00005F), 1U) << "what is shorter than a tenth of a millisecond is no piece";
    EXPECT_EQ(count(4.1F), 2U);
    EXPECT_EQ(count(6.0F), 2U);
    EXPECT_EQ(count(8.5F), 3U) << "a chord of the arc";
    EXPECT_EQ(count(12.0F), 2U + 4U + 1U) << "1.57 rad in chords of 0.4 at most";
    EXPECT_EQ(count(30.0F), 2U + 4U + 1U + 1U) << "and hovering";
}

TEST_F(OnRoute, PiecesLieOffTheArcAsTheySay)
{
    const Way way = at(Vec3(10, 0, 0));
    const auto off = [&](Seconds lookahead) { return RoutePieces(scene.situation(), way, lookahead).off(); };
    EXPECT_EQ(off(7.9F), 0.0F) << "legs are what they are";
    const float chord = 10.0F * kQuarter / 4.0F;
    const float sagitta = 10.0F * (1.0F - std::cos(0.5F * chord / 10.0F));
    EXPECT_GE(off(12.0F), sagitta);
    EXPECT_LE(off(12.0F), 1.02F * sagitta + detail::kChordSlack);
    EXPECT_LE(off(12.0F), 0.02F * 10.0F) << "2 % of the radius";
}

TEST_F(OnRoute, PiecesAreTheWayInTime)
{
    for (const Vec3& from : {Vec3(10, 0, 0), Vec3(12, -5, 3), Vec3(28, 9, 0)}) {
        const Way way = at(from, from.x() > 20.0F ? 1 : 0);
        const RoutePieces pieces(scene.situation(), way, 30.0F);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const detail::WayPiece& piece = pieces[i];
            for (const float share : {0.0F, 0.3F, 0.9F}) {
                const Seconds t = piece.start + share * (piece.end - piece.start);
                const float s = pieces.way_at(t);
                const Vec3 there = path::point_of(way.ahead, way.origin, way.direction, s).position;
                const Vec3 own = piece.own.position + piece.own.velocity * (t - piece.start);
                ASSERT_LE((there - own).norm(), pieces.off() + 2e-3F) << i << ' ' << share;
                ASSERT_GE(s, piece.way - 1e-3F);
                ASSERT_LE(s, way.length + 1e-3F);
            }
        }
        EXPECT_NEAR(pieces.way_at(30.0F), way.length, 1e-3F);
        EXPECT_NEAR(pieces.way_at(1.0F), pieces[0].own.velocity.norm(), 2e-3F);
        const detail::WayPiece& last = pieces[pieces.size() - 1];
        EXPECT_EQ(last.own.velocity, Vec3(0, 0, 0));
        EXPECT_NEAR((last.own.position - Vec3(-5, 30, 0)).norm(), 0.0F, 1e-3F);
        EXPECT_NEAR(last.way, way.length, 1e-3F);
    }
}

TEST_F(OnRoute, AtItsEndItHovers)
{
    const Way way = at(Vec3(-5, 30, 0), 3);
    const RoutePieces pieces(scene.situation(), way, 8.0F);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_EQ(pieces[0].own.velocity, Vec3(0, 0, 0));
    EXPECT_EQ(pieces[0].own.position, Vec3(-5, 30, 0));
    EXPECT_EQ(pieces[0].start, 0.0F);
    EXPECT_EQ(pieces[0].end, 8.0F);
    EXPECT_NEAR(pieces.way_at(5.0F), 0.0F, 1e-4F);
}

/// Two full turns within the look-ahead: longer chords, so that ten are enough.
TEST(WindingRoute, HasTenChordsAtMost)
{
    path::Route route;
    ASSERT_EQ(route.add_arc(Vec3(3, 0, 0), Vec3(0, 0, 0), Vec3::UnitZ(), 1.99F * kPi), RouteStatus::ok);
    const Vec3 joint = route.at(route.length()).position;
    ASSERT_EQ(route.add_arc(joint, Vec3(2.0F * joint.x(), 2.0F * joint.y(), 0), Vec3::UnitZ(), -1.99F * kPi),
              RouteStatus::ok);
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.own.position = Vec3(3, 0, 0);
    const Way way = way_of(scene.situation());
    const Seconds all = way.length / 5.0F;
    const RoutePieces pieces(scene.situation(), way, all + 1.0F);
    EXPECT_LE(pieces.size(), 1U + detail::kWayChords + 2U);
    EXPECT_GE(pieces.size(), 10U);
    EXPECT_GT(pieces.off(), 0.3F);
    const RoutePieces start(scene.situation(), way, 1.0F);
    EXPECT_LE(start.off(), 0.02F * 3.0F + 1e-3F) << "short of 4 rad the chords are short";
}

TEST(ClimbingRoute, FliesEachPieceAsFastAsTheLimitsLet)
{
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 0), Vec3(40, 0, 0)), RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(40, 0, 0), Vec3(40, 0, 30)), RouteStatus::ok);
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    const RoutePieces pieces(scene.situation(), way_of(scene.situation()), 30.0F);
    ASSERT_EQ(pieces.size(), 3U);
    EXPECT_NEAR(pieces[0].end, 8.0F, 1e-4F);
    EXPECT_NEAR(pieces[1].own.velocity.z(), 3.0F, 1e-4F);
    EXPECT_NEAR(pieces[1].end, 18.0F, 1e-3F);
    EXPECT_NEAR(pieces.way_at(11.0F), 49.0F, 1e-2F);
}

// --- conflicts along it ---

/// Behind the corner: times of the first contact with its surface, and of the centre's closest approach.
TEST_F(OnRoute, AnObstacleBehindTheCorner)
{
    scene.obstacle(geometry::make_sphere(Vec3(33, 6, 0), 3.2F));
    ASSERT_TRUE(meets(found, 7.5F));
    const float touch = 6.0F - std::sqrt(3.2F * 3.2F - 4.0F) - 1.0F;
    EXPECT_NEAR(found.time_to_loss, (20.0F + touch) / 5.0F, 1e-3F);
    EXPECT_NEAR(found.time_to_closest, 26.0F / 5.0F, 1e-3F);
    EXPECT_NEAR(found.way_at_closest, 26.0F, 1e-2F);
    EXPECT_NEAR((found.own_at_closest - Vec3(30, 6, 0)).norm(), 0.0F, 1e-2F);
    EXPECT_NEAR(found.miss_distance, 3.0F, 1e-2F);
    EXPECT_EQ(found.threat_at_closest, Vec3(33, 6, 0));
}

/// Contact before the corner, closest approach after it.
TEST_F(OnRoute, AnObstacleAtTheCornerIsNearestWhereItIs)
{
    scene.obstacle(geometry::make_sphere(Vec3(32, 1, 0), 1.5F));
    ASSERT_TRUE(meets(found, 7.5F));
    EXPECT_NEAR(found.time_to_loss, 19.5F / 5.0F, 1e-3F);
    EXPECT_NEAR(found.time_to_closest, 21.0F / 5.0F, 1e-3F);
    EXPECT_NEAR((found.own_at_closest - Vec3(30, 1, 0)).norm(), 0.0F, 1e-2F);
    EXPECT_NEAR(found.miss_distance, 2.0F, 1e-2F);
    scene.obstacles.clear();
    scene.obstacle(geometry::make_sphere(Vec3(28, -2, 0), 1.5F));
    ASSERT_TRUE(meets(found, 7.5F));
    EXPECT_NEAR(found.time_to_closest, 18.0F / 5.0F, 1e-3F) << "before the corner";
    EXPECT_NEAR(found.way_at_closest, 18.0F, 1e-2F);
    EXPECT_NEAR(found.miss_distance, 2.0F, 1e-2F);
    EXPECT_LT(found.time_to_loss, found.time_to_closest);
}

/// No nearer than the loss: one that reaches far has its centre behind.
TEST_F(OnRoute, AnApproachIsNoSoonerThanTheLoss)
{
    scene.own.position = Vec3(20, 0, 0);
    scene.obstacle(geometry::make_box(Vec3(10, 21.5F, 0), Vec3(30, 1, 1)));  // across the second leg
    ASSERT_TRUE(meets(found, 7.5F));
    EXPECT_NEAR(found.time_to_loss, (10.0F + 19.5F) / 5.0F, 0.05F);
    EXPECT_GE(found.time_to_closest, found.time_to_loss);
    EXPECT_GE(found.way_at_closest, 29.0F);
}

TEST_F(OnRoute, OfSeveralTheFirstOneIsTheMainThreat)
{
    scene.obstacle(geometry::make_sphere(Vec3(30, 14, 0), 1.0F));
    scene.obstacle(geometry::make_sphere(Vec3(30, 8, 0), 1.0F));
    scene.obstacle(geometry::make_sphere(Vec3(30, 11, 0), 1.0F));
    scene.obstacle(geometry::make_sphere(Vec3(300, 11, 0), 1.0F));
    ASSERT_TRUE(meets(found, 7.5F));
    EXPECT_EQ(found.threat.index, 1U);
    EXPECT_NEAR(found.time_to_loss, 26.0F / 5.0F, 1e-3F);
    scene.track(Vec3(30, 4, 0), Vec3::Zero(), 1.0F);
    ASSERT_TRUE(meets(found, 7.5F));
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::track, 0}));
    EXPECT_NEAR(found.time_to_loss, 22.0F / 5.0F, 1e-2F);
    EXPECT_NEAR(found.way_at_closest, 24.0F, 0.1F);
    scene.tracks[0].position = Vec3(18, 30, 0);
    ASSERT_TRUE(meets(found));
    EXPECT_EQ(found.threat.kind, ThreatKind::obstacle) << "a later one behind the arc";
}

TEST_F(OnRoute, WhereTheBudgetRunsOutThereIsAConflictNow)
{
    scene.track(Vec3(400, 4, 0), Vec3::Zero(), 1.0F);
    scene.cylinder(Vec2(500, 0), 3.0F);
    scene.obstacle(geometry::make_sphere(Vec3(300, 8, 0), 1.0F));
    scene.obstacle(geometry::make_box(Vec3(30, 12, 0), Vec3::Ones()));
    ASSERT_TRUE(meets(found));
    ASSERT_EQ(found.threat, (ThreatRef{ThreatKind::obstacle, 1}));
    const std::uint32_t all = spent;
    for (std::uint32_t n = 0; n < all; n += 3) {
        Conflict now;
        ASSERT_TRUE(meets(now, 12.0F, n)) << n;
        ASSERT_EQ(now.time_to_loss, 0.0F) << n;
        ASSERT_EQ(now.margin, -kSeparationCap) << n;
    }
}

TEST_F(OnRoute, NothingOnItIsNoConflict)
{
    scene.track(Vec3(10, 30, 0), Vec3::Zero(), 1.0F);  // more than 50 m along the path
    EXPECT_FALSE(meets(found, 8.0F));
    EXPECT_TRUE(meets(found, 16.0F));
}

}  // namespace
}  // namespace jink::world
