// SPDX-License-Identifier: BSD-3-Clause
// A map of known surroundings around Coprocessor::step: every method keeps clear of its solids, wherever
// the local frame begins, and what the map cannot say is reported.
#include "firmware/app/known_map.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/oracle/map_of_hulls.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

using Hulls = std::vector<std::vector<Vec3>>;

std::vector<Vec3> block(const Vec3& low, const Vec3& high)
{
    std::vector<Vec3> out;
    for (int i = 0; i < 8; ++i) {
        out.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                         (i & 4) != 0 ? high.z() : low.z());
    }
    return out;
}

/// Where a block of 8 corners begins and ends.
struct Block {
    Vec3 low;
    Vec3 high;
};

/// A copter flies north from the origin at 50 m, with a map.
class MapFlight {
public:
    explicit MapFlight(const Hulls& hulls, const Parameters& parameters = {}, const geometry::MapOrigin& origin = {})
        : tables_(hulls), flight_(std::make_unique<Flight>(parameters)),
          half_(parameters.configuration().limits.half_extents)
    {
        tables_.set_origin(origin);
        EXPECT_EQ(geometry::check(tables_.map()), geometry::MapStatus::good);
        flight_->coprocessor.use_map(tables_.map());
    }
    Flight* operator->() { return flight_.get(); }

    void fly(int ticks)
    {
        for (int i = 0; i < ticks; ++i) {
            flight_->fly(1);
            was_in_control = was_in_control || flight_->last.control == Control::ours;
            saw_conflict = saw_conflict || flight_->last.guidance.conflict.has_value();
            for (const Statustext& m : flight_->said_of<Statustext>()) {
                const std::string text(m.text.data(), m.text.size());
                dense += text.find("map too dense") != std::string::npos ? 1 : 0;
            }
            for (const Block& b : solids) {
                const Vec3 off = (b.low - flight_->position).cwiseMax(flight_->position - b.high) - half_;
                nearest = std::min(nearest, off.maxCoeff());
            }
        }
    }

    std::vector<Block> solids;  ///< what the flight must not touch
    float nearest = 1e9F;       ///< of the own box to a solid, along the axis that parts both best [m]
    bool was_in_control = false;
    bool saw_conflict = false;
    int dense = 0;  ///< times it was said

private:
    oracle::MapOfHulls tables_;
    std::unique_ptr<Flight> flight_;
    Vec3 half_;
};

const Block kWall{{-5.0F, 70.0F, 35.0F}, {4.0F, 72.0F, 65.0F}};

/// Each method alone, and all of them.
TEST(KnownMap, AWallOnTheLegIsKeptClearOfByEveryMethod)
{
    for (const float methods : {1.0F, 2.0F, 4.0F, 7.0F}) {
        SCOPED_TRACE(methods);
        Parameters parameters;
        ASSERT_EQ(parameters.set(Param::methods, methods), ParamStatus::ok);
        MapFlight f({block(kWall.low, kWall.high)}, parameters);
        f.solids = {kWall};
        f.fly(2500);
        EXPECT_TRUE(f.saw_conflict);
        EXPECT_TRUE(f.was_in_control);
        EXPECT_GT(f.nearest, 0.0F);
        EXPECT_TRUE(f->position.y() > kWall.high.y() || f->velocity.norm() < 2.0F) << "flown around, or held before it";
        EXPECT_EQ(f->last.faults, 0U);
    }
}

/// The same flight without the map goes through where the wall is.
TEST(KnownMap, WithoutTheMapNothingIsThere)
{
    MapFlight f({block({0, -500, 0}, {1, -499, 1})});
    f.solids = {kWall};
    f.fly(1200);
    EXPECT_LT(f.nearest, 0.0F);
    EXPECT_FALSE(f.saw_conflict);
    EXPECT_EQ(f->last.map_pieces, 0U) << "out of reach";
}

TEST(KnownMap, ItsPiecesFollowWhatSensorsSee)
{
    MapFlight f({block(kWall.low, kWall.high), block({-40, 70, 35}, {-20, 72, 65})});
    f->ring = 30.0F;
    f.fly(100);
    EXPECT_EQ(f->last.map_pieces, 2U);
    EXPECT_EQ(f->last.obstacles, 74U) << "and 72 sectors";
    EXPECT_EQ(f->coprocessor.known_map().selection().pieces, 2U);
}

/// On the globe, 70 m north of the local origin: the wall is on the leg.
TEST(KnownMap, AnOriginOnTheGlobePlacesTheMap)
{
    const Vec3 shift(0, 70, 0);
    constexpr link::GlobalPosition kLocal{473977420, 85455940, 488000};
    const link::GlobalPosition at = to_global(shift, kLocal).value();
    MapFlight f({block(kWall.low - shift, kWall.high - shift)}, {}, {true, at.lat, at.lon, at.alt});
    f.solids = {kWall};
    f.fly(2500);
    EXPECT_TRUE(f.was_in_control);
    EXPECT_GT(f.nearest, 0.0F);
    EXPECT_EQ(f->last.faults, 0U);
}

/// What cannot be placed must not count as free.
TEST(KnownMap, WithoutAPlaceItIsAFault)
{
    // A map 20 km away: the link's origin comes, and is too far off.
    MapFlight far({block(kWall.low, kWall.high)}, {}, {true, 475977420, 85455940, 488000});
    far.fly(100);
    EXPECT_EQ(far->last.faults, bit(Fault::airspace_unplaced));
    EXPECT_EQ(far->last.map_pieces, 0U);
    EXPECT_FALSE(far->last.setpoint_sent);
    MapFlight near({block(kWall.low, kWall.high)}, {}, {true, 473977420, 85455940, 488000});
    near->feed(wire::heartbeat(near->mode, near->armed, 3));
    near->feed(wire::local_position(near->boot_ms(), near->position, near->velocity));
    near->now.us += Flight::kTickUs;
    EXPECT_NE(near->step().faults & bit(Fault::airspace_unplaced), 0) << "no origin yet";
    ASSERT_TRUE(near->until([](const StepReport& r) { return r.faults == 0; }, 200)) << "the origin comes";
    EXPECT_EQ(near->last.map_pieces, 1U);
}

TEST(KnownMap, WithoutAnAutopilotThereIsNoFrameForIt)
{
    MapFlight f({block(kWall.low, kWall.high)}, {}, {true, 475977420, 85455940, 488000});
    f->heartbeats = false;
    f.fly(20);
    EXPECT_EQ(f->last.map_pieces, 0U);
    EXPECT_FALSE((f->last.faults & bit(Fault::airspace_unplaced)) != 0);
}

/// An alley of posts in pieces, more than there are places for, and one on the leg.
TEST(KnownMap, MorePiecesThanPlacesAreKeptClearOfAndSaid)
{
    Hulls hulls;
    std::vector<Block> posts;
    for (int row = 0; row < 50; ++row) {
        for (const float east : {-9.0F, -7.0F, 6.0F, 8.0F}) {
            for (int part = 0; part < 8; ++part) {
                const Vec3 low(east, 2.0F * static_cast<float>(row), 30.0F + 5.0F * static_cast<float>(part));
                posts.push_back({low, low + Vec3(1, 1, 5)});
            }
        }
    }
    posts.push_back({{-0.5F, 70, 20}, {0.5F, 71, 80}});
    for (const Block& post : posts) {
        hulls.push_back(block(post.low, post.high));
    }
    ASSERT_GT(hulls.size(), 10 * kMaxMapObstacles);
    MapFlight f(hulls);
    f.solids = posts;
    f.fly(2500);
    EXPECT_GT(f.nearest, 0.0F);
    EXPECT_TRUE(f.saw_conflict);
    EXPECT_EQ(f.dense, 1) << "said once";
    EXPECT_GT(f->coprocessor.diagnostics().map_coarse, 0U);
    EXPECT_EQ(f->last.faults & ~bit(Fault::map_unresolved), 0);
}

/// Triangles whose boxes all hold the vehicle, twice as many as there are places: what is about it is not known.
TEST(KnownMap, WhatIsAboutTheVehicleHasToBeKnownPieceByPiece)
{
    Hulls hulls;
    for (std::size_t i = 0; i < 2 * kMaxMapObstacles; ++i) {
        const float off = 30.0F + static_cast<float>(i);
        hulls.push_back({{-off, -200, 0}, {off, 300, 40}, {-off, 300, 120}});
    }
    MapFlight f(hulls);
    f.fly(100);
    EXPECT_EQ(f->last.faults, bit(Fault::map_unresolved));
    EXPECT_EQ(f->last.state, link::SystemState::critical);
    EXPECT_FALSE(f->last.setpoint_sent);
    MapFlight fewer(Hulls(hulls.begin(), hulls.begin() + 2));
    fewer.fly(100);
    EXPECT_EQ(fewer->last.faults, 0U);
}

/// How much larger pieces count where the map lies far from where the local frame begins.
TEST(KnownMap, UncertaintyOfItsPlace)
{
    const oracle::MapOfHulls local({block(kWall.low, kWall.high)});
    oracle::MapOfHulls placed({block(kWall.low, kWall.high)});
    constexpr link::GlobalPosition kLocal{473977420, 85455940, 488000};
    const link::GlobalPosition at = to_global({1000, 0, 0}, kLocal).value();
    placed.set_origin({true, at.lat, at.lon, at.alt});
    const Parameters parameters;
    vehicle::VehicleState own;
    const auto uncertainty = [&](const geometry::MeshMap& map, const Vec3& position) {
        world::ObstacleTable table;
        KnownMap known;
        known.use(map, table);
        own.position = position;
        known.append_to(table, kLocal, own, parameters.configuration());
        EXPECT_EQ(table.obstacles().size(), 1U);
        return table.obstacles().empty() ? 0.0F : table.obstacles()[0].uncertainty;
    };
    EXPECT_LT(uncertainty(local.map(), {0, 50, 50}), 1e-3F) << "the local frame itself";
    const float near = uncertainty(placed.map(), {1000, 50, 50});
    EXPECT_GT(near, 1.5F) << "1.5 m in a kilometre";
    EXPECT_LT(near, 2.5F);
}

}  // namespace
}  // namespace jink::app::test
