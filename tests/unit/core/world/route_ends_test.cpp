// SPDX-License-Identifier: BSD-3-Clause
// Pieces of a path along a route at exact ends of the time, a segment or the path, and paths shorter than a piece.
#include <cmath>

#include <gtest/gtest.h>

#include "core/world/route_way.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/route_scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::RoutePieces;

struct RouteEnds : RoutePiecesTest {
    /// Straight east for `straight` metres, then along the route from `joined` on.
    [[nodiscard]] Way joining(float straight, float joined) const
    {
        Way w;
        w.length = straight + route.length() - joined;
        w.speed = scene.reference.speed;
        w.ahead = {route, straight, joined};
        return w;
    }
};

/// The time ends where an arc begins: nothing of the arc is flown, so that nothing lies off it.
TEST_F(RouteEnds, AnArcThatBeginsWithTheEndOfTheTimeDoesNotCount)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    turn(10.0F, kPi);
    EXPECT_EQ(pieces(way(), 4.0F).size(), 1U);
    EXPECT_EQ(pieces(way(), 4.0F).off(), 0.0F);
    EXPECT_GT(pieces(way(), 4.01F).off(), 0.0F);
}

/// A part too short for a piece leaves time over; segments beyond the reach are not flown in it.
TEST_F(RouteEnds, AnArcBeyondWhatIsReachedIsNotOffTheWay)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    leg(Vec3(20, 0, 0), Vec3(20, 300, 0));
    turn(10.0F, kPi);
    scene.reference.speed = 1.0F;
    const RoutePieces all = pieces(joining(20.0F - 0.0009F, 20.0F - 0.0009F), 60.0F);
    ASSERT_EQ(all.size(), 2U);
    EXPECT_LE(all.off(), detail::kChordSlack);
    follow_on(all, 60.0F);
}

/// Of several arcs the one with the largest chord deviation counts, anywhere on the path.
TEST_F(RouteEnds, OfSeveralArcsTheLargestCounts)
{
    leg(Vec3(0, 0, 0), Vec3(5, 0, 0));
    turn(20.0F, 0.38F);
    turn(2.0F, -0.38F);
    const float most = sagitta(20.0F, 20.0F * 0.38F);
    for (const Seconds lookahead : {2.6F, 3.5F}) {
        const RoutePieces all = pieces(way(), lookahead);
        EXPECT_GE(all.off(), most) << lookahead;
        EXPECT_LE(all.off(), 1.02F * most + detail::kChordSlack) << lookahead;
    }
}

/// A millimetre exactly is no piece, a little more is one.
TEST_F(RouteEnds, AMillimetreIsNoPiece)
{
    leg(Vec3(0, 0, 0), Vec3(0, 50, 0));
    EXPECT_EQ(pieces(joining(1e-3F, 0.0F), 8.0F).size(), 1U);
    EXPECT_EQ(pieces(joining(std::nextafter(1e-3F, 1.0F), 0.0F), 8.0F).size(), 2U);
}

/// Remaining time after a piece: exactly a tenth of a millisecond counts as none, slightly more counts.
TEST_F(RouteEnds, ATenthOfAMillisecondIsNoTime)
{
    leg(Vec3(0, 0, 0), Vec3(0, 50, 0));
    scene.reference.speed = 16.0F;
    const float straight = 16.0F * (1.0F - 1e-4F);
    EXPECT_EQ(pieces(joining(straight, 0.0F), 1.0F).size(), 1U);
    follow_on(pieces(joining(straight, 0.0F), 1.0F), 1.0F);
    EXPECT_EQ(pieces(joining(std::nextafter(straight, 0.0F), 0.0F), 1.0F).size(), 2U);
}

/// Each piece begins at its stated place on the path, to the bit, also behind a part too short for a piece.
TEST_F(RouteEnds, APieceBeginsWhereItSays)
{
    for (int i = 0; i < 40; ++i) {
        const float first = 17.3F + 0.37F * static_cast<float>(i);
        route = path::Route();
        leg(Vec3(0, 0, 0), Vec3(first, 0, 0));
        turn(7.7F, 2.9F);
        turn(3.1F, -1.3F);
        scene.reference.speed = 1.0F + 0.23F * static_cast<float>(i);
        for (const float cut : {0.0F, 0.0009F, 5.1F}) {
            const Way w = joining(first - cut, first - cut);
            const RoutePieces all = pieces(w, 80.0F);
            for (std::size_t k = 0; k < all.size(); ++k) {
                EXPECT_EQ(all.way_at(all[k].start), all[k].way) << i << ' ' << cut << ' ' << k;
            }
        }
    }
}

/// At the end of the route within a millimetre it stays where it is, not at the end.
TEST_F(RouteEnds, WithinAMillimetreOfTheEndItStaysInItsPlace)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    scene.own.position = Vec3(20, 0.0005F, 0);
    for (const Seconds lookahead : {0.0F, 8.0F}) {
        const RoutePieces all = pieces(way(), lookahead);
        ASSERT_EQ(all.size(), 1U);
        EXPECT_EQ(all[0].own.position, Vec3(20, 0.0005F, 0));
        EXPECT_EQ(all[0].own.velocity, Vec3(0, 0, 0));
        EXPECT_EQ(all[0].end, lookahead);
    }
}

/// Even if all parts are too short for a piece, there is one piece over the whole time.
TEST_F(RouteEnds, ThereIsAlwaysAPiece)
{
    leg(Vec3(0, 0, 0), Vec3(20, 0, 0));
    for (const float straight : {0.0F, 0.0005F, 2.0F}) {
        for (const Seconds lookahead : {0.0F, 0.00005F, 0.0001F}) {
            const RoutePieces all = pieces(joining(straight, 1.0F), lookahead);
            ASSERT_EQ(all.size(), 1U) << straight << ' ' << lookahead;
            EXPECT_EQ(all[0].start, 0.0F);
            EXPECT_EQ(all[0].end, lookahead);
        }
    }
}

}  // namespace
}  // namespace jink::world
