// SPDX-License-Identifier: BSD-3-Clause
// Pieces of a path along a route: lengths of chords, segments behind and beyond, and fixed wings.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/world/route_way.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/route_scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::RoutePieces;
using detail::WayPiece;
using path::RouteStatus;

/// Chords cover the reached part, not the whole arc: two and a half metres are one chord.
TEST_F(RoutePiecesTest, ChordsEndWithTheLookAhead)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    turn(10.0F, kPi);
    const Way w = way();
    const RoutePieces near = pieces(w, 4.5F);
    EXPECT_EQ(near.size(), 2U);
    EXPECT_GE(near.off(), sagitta(10.0F, 2.5F));
    EXPECT_LE(near.off(), 1.02F * sagitta(10.0F, 2.5F) + detail::kChordSlack);
    // 6 m are two chords of 3 m.
    EXPECT_EQ(pieces(w, 5.2F).size(), 3U);
    EXPECT_LE(pieces(w, 5.2F).off(), 1.02F * sagitta(10.0F, 3.0F) + detail::kChordSlack);
    follow_on(pieces(w, 5.2F), 5.2F);
}

/// Beside the second leg: the straight path back to the route does not extend the reach.
TEST_F(RoutePiecesTest, TheWayBackIsPartOfWhatIsReached)
{
    leg(Vec3(0, 0, 0), Vec3(40, 0, 0));
    turn(10.0F, kPi);
    scene.own.position = Vec3(28, -16, 0);
    const Way w = way();
    ASSERT_NEAR(w.ahead.straight, 20.0F, 1e-3F);  // aims at the end of the leg, 12 m ahead
    EXPECT_LE(pieces(w, 4.5F).off(), 1.02F * sagitta(10.0F, 2.5F) + detail::kChordSlack);
    EXPECT_EQ(pieces(w, 4.5F).size(), 2U);
}

/// How long the chords are depends on the turn that is flown: not on legs before it, nor on arcs behind or beyond.
TEST_F(RoutePiecesTest, ALongLegBeforeAnArcDoesNotLengthenItsChords)
{
    leg(Vec3(0, 0, 0), Vec3(200, 0, 0));
    turn(10.0F, kPi);
    scene.own.position = Vec3(195, 0, 0);
    const RoutePieces all = pieces(way(), 20.0F);
    EXPECT_LE(all.off(), 1.01F * sagitta(10.0F, 4.0F) + detail::kChordSlack + 1e-3F);
    EXPECT_EQ(all.size(), 1U + 8U + 1U) << "the leg, 3.14 rad in chords of 0.4 at most, hovering";
}

TEST_F(RoutePiecesTest, ALegBeforeAnArcThatIsFlownAllTheWayDoesNotLengthenItsChords)
{
    leg(Vec3(0, 0, 0), Vec3(60, 0, 0));
    turn(10.0F, kPi);
    const RoutePieces all = pieces(way(), 30.0F);
    EXPECT_EQ(all.size(), 1U + 8U + 1U);
    EXPECT_LE(all.off(), 1.01F * sagitta(10.0F, 4.0F) + detail::kChordSlack + 1e-3F);
}

/// Six radians ahead are ten chords, for any turns behind the vehicle.
TEST_F(RoutePiecesTest, ArcsBehindDoNotCount)
{
    ASSERT_EQ(route.add_arc(Vec3(0, 0, 0), Vec3(0, 5, 0), Vec3::UnitZ(), 1.9F * kPi), RouteStatus::ok);
    const float passed = route.length();
    const path::RoutePoint start = route.at(passed);
    leg(start.position, start.position + 30.0F * start.along);
    turn(5.0F, 3.0F);
    turn(5.0F, -3.0F);
    scene.reference.segment = 1;
    scene.own.position = route.at(passed + 10.0F).position;
    const Way w = way();
    ASSERT_NEAR(w.ahead.joined_at, passed + 30.0F, 1e-2F);
    const RoutePieces all = pieces(w, 20.0F);
    follow_on(all, 20.0F);
    EXPECT_EQ(all.size(), 1U + detail::kWayChords + 1U);
    const float chord = 5.0F * 3.0F / 5.0F;
    EXPECT_GE(all.off(), sagitta(5.0F, chord));
    EXPECT_LE(all.off(), 1.02F * sagitta(5.0F, chord) + detail::kChordSlack);
}

/// The same with turns that the time ahead does not reach.
TEST_F(RoutePiecesTest, ArcsBeyondTheLookAheadDoNotCount)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    turn(2.0F, 6.0F);  // 12 m
    const path::RoutePoint end = route.at(route.length());
    leg(end.position, end.position + 400.0F * end.along);
    turn(2.0F, 6.0F);
    const Seconds lookahead = 12.0F;  // 60 m
    const RoutePieces all = pieces(way(), lookahead);
    follow_on(all, lookahead);
    EXPECT_EQ(all.size(), 1U + detail::kWayChords + 1U);
    EXPECT_LE(all.off(), 1.02F * sagitta(2.0F, 2.0F * 0.61F) + detail::kChordSlack);
    EXPECT_GE(all.off(), sagitta(2.0F, 2.0F * 0.6F));
}

/// Where the climb is slow the time ahead is over before the length that a level flight reaches.
TEST_F(RoutePiecesTest, AnArcThatIsClimbedEndsWithTheTime)
{
    scene.limits.max_climb = scene.limits.max_descent = 1.0F;
    leg(Vec3(0, 0, 0), Vec3(10, 0, 0));
    ASSERT_EQ(route.add_arc(Vec3(10, 0, 0), Vec3(10, 0, 20), -Vec3::UnitY(), kPi), RouteStatus::ok);
    const Way w = way();
    for (const Seconds lookahead : {3.0F, 5.0F, 8.0F, 12.0F, 20.0F}) {
        const RoutePieces all = pieces(w, lookahead);
        follow_on(all, lookahead);
        for (std::size_t i = 1; i < all.size(); ++i) {
            EXPECT_LE(std::abs(all[i].own.velocity.z()), 1.001F) << i;
        }
    }
}

/// Without look-ahead the path is a place.
TEST_F(RoutePiecesTest, ALookAheadOfNothingIsThePlace)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    const RoutePieces all = pieces(way(), 0.0F);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].start, 0.0F);
    EXPECT_EQ(all[0].end, 0.0F);
}

/// Each piece by hand: 10 m to the corner, 20 m north, hovering.
TEST_F(RoutePiecesTest, ByHand)
{
    leg(Vec3(0, 0, 0), Vec3(10, 0, 0));
    leg(Vec3(10, 0, 0), Vec3(10, 20, 0));
    const Way w = way();
    const RoutePieces all = pieces(w, 8.0F);
    ASSERT_EQ(all.size(), 3U);
    const WayPiece expected[] = {{{Vec3(0, 0, 0), Vec3(5, 0, 0)}, 0.0F, 2.0F, 0.0F},
                                 {{Vec3(10, 0, 0), Vec3(0, 5, 0)}, 2.0F, 6.0F, 10.0F},
                                 {{Vec3(10, 20, 0), Vec3(0, 0, 0)}, 6.0F, 8.0F, 30.0F}};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR((all[i].own.position - expected[i].own.position).norm(), 0.0F, 1e-5F) << i;
        EXPECT_NEAR((all[i].own.velocity - expected[i].own.velocity).norm(), 0.0F, 1e-5F) << i;
        EXPECT_NEAR(all[i].start, expected[i].start, 1e-5F) << i;
        EXPECT_NEAR(all[i].end, expected[i].end, 1e-5F) << i;
        EXPECT_NEAR(all[i].way, expected[i].way, 1e-5F) << i;
    }
    for (const auto& [t, s] : {std::pair(0.0F, 0.0F), {1.0F, 5.0F}, {2.0F, 10.0F}, {3.0F, 15.0F}, {6.0F, 30.0F}}) {
        EXPECT_NEAR(all.way_at(t), s, 1e-5F);
    }
    EXPECT_NEAR(all.way_at(7.0F), 30.0F, 1e-5F);
    const RoutePieces part = pieces(w, 4.0F);
    ASSERT_EQ(part.size(), 2U);
    EXPECT_NEAR(part.way_at(100.0F), 30.0F, 1e-5F) << "the way ends";
}

/// Far from the origin a part of a millimetre more than one may have no extent in float: no place to stay at.
TEST_F(RoutePiecesTest, APartWithoutExtentIsPassed)
{
    const float x = 65536.0F;  // floats are 1 / 128 m apart from here on
    leg(Vec3(x, 0, 0), Vec3(x + 20.0F, 0, 0));
    leg(Vec3(x + 20.0F, 0, 0), Vec3(x + 20.0F + 0.015625F, 0, 0));
    leg(Vec3(x + 20.0F + 0.015625F, 0, 0), Vec3(x + 20.0F + 0.015625F, 30, 0));
    // Half a metre and more off the leg: it aims twice that ahead, 1.5 mm before the end of the second leg.
    const float ahead = 2.0F + 0.015625F - 0.0015F;
    scene.own.position = Vec3(x + 18.0F, 0.5F * ahead, 0);
    const Way w = way();
    ASSERT_NEAR(w.ahead.joined_at, 20.0F + 0.015625F - 0.0015F, 1e-4F);
    const RoutePieces all = pieces(w, 8.0F);
    ASSERT_EQ(all.size(), 3U) << "back to the route, north, hovering";
    EXPECT_NEAR(all[1].own.velocity.y(), 5.0F, 1e-4F);
    EXPECT_NEAR(all[1].end - all[1].start, 6.0F, 1e-3F);
    EXPECT_NEAR(all[2].own.position.y(), 30.0F, 1e-4F);
}

/// A part too short for a piece does not move the vehicle to the route's end: it flies until the end of the time.
TEST_F(RoutePiecesTest, WhatIsTooShortForAPieceIsNotSpentAtTheRoutesEnd)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    leg(Vec3(20, 0, 0), Vec3(20, 300, 0));
    // 0.9 mm short of the corner it joins the route, in sight of it from the side.
    scene.reference.speed = 1.0F;
    scene.own.position = Vec3(8.0F - 0.0009F, 4, 0);
    const Way w = way();
    ASSERT_NEAR(w.ahead.joined_at, 20.0F - 0.0009F, 1e-5F);
    const RoutePieces all = pieces(w, 60.0F);
    ASSERT_EQ(all.size(), 2U);
    follow_on(all, 60.0F);
    EXPECT_NEAR(all[1].own.velocity.y(), 1.0F, 1e-4F);
    scene.track(Vec3(20, 300, 0), Vec3::Zero(), 1.0F);
    Conflict found;
    WorkBudget budget(kPlenty);
    EXPECT_FALSE(main_conflict(scene.situation(), w, 60.0F, budget, found)) << "it is not there for minutes";
}

/// Exactly a millimetre from the end the path has no length, and the route's direction.
TEST_F(RoutePiecesTest, AMillimetreFromTheEndNothingIsLeft)
{
    leg(Vec3(-10, 0, 0), Vec3(0, 0, 0));
    scene.own.position = Vec3(0, 1e-3F, 0);
    EXPECT_EQ(way().length, 0.0F);
    EXPECT_EQ(way().direction, Vec3(1, 0, 0));
    scene.own.position = Vec3(0, 1.01e-3F, 0);
    EXPECT_NEAR(way().length, 1.01e-3F, 1e-6F);
    EXPECT_NEAR(way().direction.y(), -1.0F, 1e-4F);
}

/// The same without a route.
TEST(LegEnds, AMillimetreFromTheEndNothingIsLeft)
{
    Scene scene;
    scene.leg(Vec3(-10, 0, 0), Vec3(0, 0, 0), 5.0F);
    scene.own.position = Vec3(0, 1e-3F, 0);
    EXPECT_EQ(way_of(scene.situation()).length, 0.0F);
    EXPECT_EQ(way_of(scene.situation()).direction, Vec3(1, 0, 0));
    scene.own.position = Vec3(0, 1.01e-3F, 0);
    EXPECT_NEAR(way_of(scene.situation()).length, 1.01e-3F, 1e-6F);
    EXPECT_NEAR(way_of(scene.situation()).direction.y(), -1.0F, 1e-4F);
}

// --- wings ---

struct WingOnRoute : RoutePiecesTest {
    WingOnRoute()
    {
        scene.limits.kind = vehicle::VehicleKind::fixed_wing;
        scene.limits.max_climb = 3.0F;
        scene.limits.max_descent = 2.0F;
        scene.reference.speed = 15.0F;
    }
    [[nodiscard]] float ahead() const
    {
        const Vec3& own = scene.own.position;
        return way().ahead.joined_at - route.abeam_of(own, scene.reference.segment).arc_length;
    }
};

/// Four seconds of flight ahead; as far as it climbs at 3 m/s or sinks at 2 m/s, where that is farther.
TEST_F(WingOnRoute, ComesBackAsFarAheadAsItsClimbNeeds)
{
    leg(Vec3(0, 0, 100), Vec3(2000, 0, 100));
    const auto at = [&](const Vec3& position) {
        scene.own.position = position;
        return ahead();
    };
    EXPECT_NEAR(at(Vec3(50, 20, 100)), 60.0F, 1e-2F);
    EXPECT_NEAR(at(Vec3(50, 0, 70)), 150.0F, 1e-2F) << "30 m too low: 10 s";
    EXPECT_NEAR(at(Vec3(50, 0, 130)), 225.0F, 1e-2F) << "30 m too high: 15 s";
    EXPECT_NEAR(at(Vec3(50, 0, 94)), 60.0F, 1e-2F) << "6 m too low: 2 s";
    scene.reference.speed = 2.0F;
    EXPECT_NEAR(at(Vec3(50, 20, 100)), kRejoinLookahead, 1e-2F) << "no less than a multirotor";
    EXPECT_EQ(rejoin_lookahead(scene.limits, 2.0F, 0.0F), kRejoinLookahead);
    EXPECT_EQ(rejoin_lookahead(scene.limits, 15.0F, 0.0F), 60.0F);
    EXPECT_EQ(rejoin_lookahead(scene.limits, 15.0F, -30.0F), 150.0F);
    EXPECT_EQ(rejoin_lookahead(scene.limits, 15.0F, 30.0F), 225.0F);
}

/// On an arc half its radius; a multirotor the root of it.
TEST_F(WingOnRoute, OnAnArcItAimsHalfTheRadiusAhead)
{
    leg(Vec3(0, 0, 0), Vec3(100, 0, 0));
    turn(64.0F, kPi);
    scene.reference.segment = 1;
    scene.own.position = route.at(150.0F).position;
    EXPECT_NEAR(ahead(), 32.0F, 0.05F);
    scene.own.position += 3.0F * Vec3::UnitZ();
    EXPECT_NEAR(ahead(), 38.0F, 0.05F) << "and twice what it is off";
    scene.limits.kind = vehicle::VehicleKind::multirotor;
    scene.own.position = route.at(150.0F).position;
    EXPECT_NEAR(ahead(), 8.0F, 0.05F);
}

}  // namespace
}  // namespace jink::world
