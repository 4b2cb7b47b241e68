// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_table.hpp"
#include "tests/numbers.hpp"

#include <gtest/gtest.h>

namespace jink::world {
namespace {

constexpr TimePoint kNow{50'000'000};

Obstacle sphere(ObstacleId id, const Vec3& centre, float radius = 1.0F)
{
    return {id, geometry::make_sphere(centre, radius)};
}

struct ObstacleTables : testing::Test {
    ObstacleTable table;
    Vec3 own = Vec3::Zero();
    TimePoint later = kNow + 10.0F;
};

TEST_F(ObstacleTables, CreatesAndRenewsInOrderOfId)
{
    for (const ObstacleId id : {5U, 1U, 9U, 3U}) {
        EXPECT_EQ(table.update(sphere(id, Vec3(static_cast<float>(id), 0, 0)), later, own), ObstacleStatus::created);
    }
    EXPECT_EQ(table.update(sphere(9, Vec3(90, 0, 0)), later, own), ObstacleStatus::updated);
    const auto all = table.obstacles();
    ASSERT_EQ(all.size(), 4U);
    const ObstacleId order[] = {1, 3, 5, 9};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(all[i].id, order[i]);
    }
    EXPECT_EQ(all[3].shape.centre.x(), 90.0F);
    EXPECT_EQ(table.diagnostics().created, 4U);
    EXPECT_EQ(table.diagnostics().updated, 1U);
}

TEST_F(ObstacleTables, InvalidShapesAreRefused)
{
    std::vector<geometry::Shape> bad;
    for (const float number : {kNan, kInfinity, -kInfinity}) {
        bad.push_back(geometry::make_sphere(Vec3(number, 0, 0), 1.0F));
        bad.push_back(geometry::make_sphere(Vec3::Zero(), number));
        bad.push_back(geometry::make_box(Vec3::Zero(), Vec3(1, number, 1)));
        bad.push_back(geometry::make_capsule(Vec3::Zero(), Vec3(0, 0, number), 1.0F));
    }
    bad.push_back(geometry::make_sphere(Vec3::Zero(), -1.0F));
    bad.push_back(geometry::make_box(Vec3::Zero(), Vec3(1, -1, 1)));
    bad.push_back(geometry::make_box(Vec3::Zero(), Vec3::Ones(), Mat3(2.0F * Mat3::Identity())));
    bad.push_back(geometry::make_hull({}, Vec3::Zero()));
    const std::vector<Point3> many(kMaxHullVertices + 1, Point3{1, 1, 1});
    bad.push_back(geometry::make_hull(many, Vec3::Zero()));
    for (const geometry::Shape& shape : bad) {
        EXPECT_EQ(table.update({1, shape}, later, own), ObstacleStatus::invalid);
    }
    EXPECT_EQ(table.diagnostics().invalid, bad.size());
    EXPECT_TRUE(table.obstacles().empty());
}

TEST_F(ObstacleTables, AnInvalidRenewalLeavesTheOldOne)
{
    EXPECT_EQ(table.update(sphere(1, Vec3(5, 0, 0)), later, own), ObstacleStatus::created);
    EXPECT_EQ(table.update(sphere(1, Vec3(kNan, 0, 0)), later, own), ObstacleStatus::invalid);
    EXPECT_EQ(table.obstacles()[0].shape.centre.x(), 5.0F);
}

TEST_F(ObstacleTables, RemoveAndExpire)
{
    for (ObstacleId id = 0; id < 6; ++id) {
        EXPECT_EQ(table.update(sphere(id, Vec3::Zero()), kNow + static_cast<float>(id), own), ObstacleStatus::created);
    }
    EXPECT_TRUE(table.remove(3));
    EXPECT_FALSE(table.remove(3));
    table.expire(kNow + 2.0F);
    EXPECT_EQ(table.obstacles().size(), 3U) << "2 expires at this very instant and still counts";
    EXPECT_EQ(table.diagnostics().expired, 2U);
    EXPECT_EQ(table.obstacles()[0].id, 2U);
    EXPECT_EQ(table.update(sphere(4, Vec3::Zero()), kNow + 100.0F, own), ObstacleStatus::updated);
    table.expire(kNow + 50.0F);
    ASSERT_EQ(table.obstacles().size(), 1U) << "renewal moves the expiry";
    EXPECT_EQ(table.obstacles()[0].id, 4U);
    table.clear();
    EXPECT_TRUE(table.obstacles().empty());
}

TEST_F(ObstacleTables, CapacityLessOneFullAndOneMore)
{
    for (std::size_t i = 0; i < kMaxObstacles; ++i) {
        EXPECT_EQ(table.obstacles().size(), i);
        const auto id = static_cast<ObstacleId>(1000 - i);
        EXPECT_EQ(table.update(sphere(id, Vec3(10.0F + static_cast<float>(i), 0, 0)), later, own),
                  ObstacleStatus::created);
    }
    EXPECT_EQ(table.update(sphere(2000, Vec3(500, 0, 0)), later, own), ObstacleStatus::full);
    EXPECT_EQ(table.update(sphere(2000, Vec3(500, 0, 0), 495.0F), later, own), ObstacleStatus::replaced)
        << "surface counts";
    EXPECT_EQ(table.obstacles().size(), kMaxObstacles);
    const auto farthest = static_cast<ObstacleId>(1000 - (kMaxObstacles - 1));
    for (const Obstacle& o : table.obstacles()) {
        EXPECT_NE(o.id, farthest);
    }
    EXPECT_EQ(table.diagnostics().full, 1U);
    EXPECT_EQ(table.diagnostics().replaced, 1U);
    EXPECT_EQ(table.update(sphere(1000, Vec3(11, 0, 0)), later, own), ObstacleStatus::updated);
}

/// A long wall far away is not near because half of its length is.
TEST_F(ObstacleTables, AFullTableKeepsWhatIsNearestByItsSurface)
{
    const Obstacle wall{1, geometry::make_box(Vec3(0, 40, 0), Vec3(60, 0.2F, 10))};
    const Obstacle pillar{2, geometry::make_capsule(Vec3(9, 0, -20), Vec3(9, 0, 20), 1.0F)};
    const Obstacle tank{3, geometry::make_cylinder(Vec3(0, -45, 0), Vec3(0, -45, 3), 20.0F)};
    ASSERT_EQ(table.update(wall, later, own), ObstacleStatus::created);
    ASSERT_EQ(table.update(pillar, later, own), ObstacleStatus::created);
    for (ObstacleId id = 10; table.obstacles().size() + 1 < kMaxObstacles; ++id) {
        ASSERT_EQ(table.update(sphere(id, Vec3(11, 0, 0)), later, own), ObstacleStatus::created);
    }
    ASSERT_EQ(table.update(tank, later, own), ObstacleStatus::created);
    EXPECT_EQ(table.update(sphere(5, Vec3(12, 0, 0)), later, own), ObstacleStatus::replaced) << "the wall, at 39.8 m";
    EXPECT_EQ(table.update(sphere(6, Vec3(12, 0, 0)), later, own), ObstacleStatus::replaced) << "the tank, at 25 m";
    EXPECT_EQ(table.update(wall, later, own), ObstacleStatus::full);
    EXPECT_EQ(table.obstacles()[0].id, pillar.id);
}

/// Numbers too large to be subtracted displace nothing.
TEST_F(ObstacleTables, AFullTableRefusesWhatIsBeyondAllNumbers)
{
    for (ObstacleId id = 10; table.obstacles().size() < kMaxObstacles; ++id) {
        ASSERT_EQ(table.update(sphere(id, Vec3(11, 0, 0)), later, own), ObstacleStatus::created);
    }
    EXPECT_EQ(table.update(sphere(1, Vec3(3e38F, 3e38F, 0)), later, own), ObstacleStatus::full);
    EXPECT_EQ(table.update({2, geometry::make_box(Vec3(3e38F, 3e38F, 3e38F), Vec3::Ones())}, later, own),
              ObstacleStatus::full);
}

/// The smallest possible id is placed first, also in an empty table.
TEST_F(ObstacleTables, TheSmallestIdComesFirst)
{
    for (const ObstacleId id : {0U, 7U}) {
        ObstacleTable fresh;
        for (const ObstacleId other : {id, 9U, 0U, 8U}) {
            static_cast<void>(fresh.update(sphere(other, Vec3::Zero()), later, own));
        }
        ASSERT_EQ(fresh.obstacles().size(), id == 0U ? 3U : 4U);
        EXPECT_EQ(fresh.obstacles()[0].id, 0U);
        EXPECT_EQ(fresh.obstacles().back().id, 9U);
    }
}

/// Memory before the table is neither read nor written.
TEST_F(ObstacleTables, NothingBesideTheTableIsTouched)
{
    struct {
        Obstacle before;
        ObstacleTable table;
    } place;
    place.before.id = 4'000'000'000U;
    for (const ObstacleId id : {9U, 5U, 1U}) {
        EXPECT_EQ(place.table.update(sphere(id, Vec3::Zero()), later, own), ObstacleStatus::created);
        EXPECT_EQ(place.table.obstacles()[0].id, id);
        EXPECT_EQ(place.before.id, 4'000'000'000U);
    }
}

/// As far away as the farthest is not nearer.
TEST_F(ObstacleTables, AnEquallyFarOneDoesNotReplaceTheFarthest)
{
    for (std::size_t i = 0; i < kMaxObstacles; ++i) {
        static_cast<void>(table.update(sphere(static_cast<ObstacleId>(i), Vec3(40, 0, 0)), later, own));
    }
    EXPECT_EQ(table.update(sphere(2000, Vec3(0, -40, 0)), later, own), ObstacleStatus::full);
    EXPECT_EQ(table.update(sphere(2000, Vec3(0, -39.9F, 0)), later, own), ObstacleStatus::replaced);
}

/// A renewal has its own expiry, at any place in the table; an obstacle lives until its expiry.
TEST_F(ObstacleTables, EachExpiresAtItsOwnTime)
{
    for (const ObstacleId id : {3U, 1U, 2U}) {
        static_cast<void>(table.update(sphere(id, Vec3::Zero()), kNow + static_cast<float>(id), own));
    }
    EXPECT_EQ(table.update(sphere(2, Vec3::Zero()), kNow + 9.0F, own), ObstacleStatus::updated);
    table.expire(kNow + 1.0F);
    EXPECT_EQ(table.obstacles().size(), 3U) << "not before";
    table.expire({(kNow + 1.0F).us + 1});
    ASSERT_EQ(table.obstacles().size(), 2U);
    table.expire(kNow + 5.0F);
    ASSERT_EQ(table.obstacles().size(), 1U);
    EXPECT_EQ(table.obstacles()[0].id, 2U);
    EXPECT_EQ(table.diagnostics().expired, 2U);
}

TEST_F(ObstacleTables, OrderStaysSortedThroughReplacement)
{
    for (std::size_t i = 0; i < 2 * kMaxObstacles; ++i) {
        const auto id = static_cast<ObstacleId>((i * 7919) % 1009);
        static_cast<void>(table.update(sphere(id, Vec3(static_cast<float>((i * 31) % 97), 0, 0)), later, own));
        for (std::size_t k = 1; k < table.obstacles().size(); ++k) {
            ASSERT_LT(table.obstacles()[k - 1].id, table.obstacles()[k].id);
        }
    }
}

/// Full: of two equally far ones the one with the smaller id is replaced; one as far as the farthest is not added.
TEST_F(ObstacleTables, OfEquallyFarOnesTheFirstGivesWay)
{
    for (ObstacleId id = 1; id <= kMaxObstacles; ++id) {
        const float x = id == 2 ? -900.0F : id == 3 ? 900.0F : 10.0F + static_cast<float>(id);
        ASSERT_EQ(table.update(sphere(id, Vec3(x, 0, 0)), later, own), ObstacleStatus::created);
    }
    EXPECT_EQ(table.update(sphere(5000, Vec3(0, 900, 0)), later, own), ObstacleStatus::full);
    EXPECT_EQ(table.update(sphere(5000, Vec3(0, 899, 0)), later, own), ObstacleStatus::replaced);
    EXPECT_EQ(table.obstacles()[0].id, 1U);
    EXPECT_EQ(table.obstacles()[1].id, 3U);
}

/// Obstacles of a map lie behind all others, in places of their own, until the table changes.
TEST_F(ObstacleTables, AppendedOnesGiveWayToNothingAndGoWithTheNextChange)
{
    table.keep_places_for_map();
    for (ObstacleId id = 0; id < kMaxObstacles; ++id) {
        static_cast<void>(table.update(sphere(id, Vec3(static_cast<float>(id), 0, 0)), later, own));
    }
    const std::size_t sensed = kMaxObstacles - kMaxMapObstacles;
    ASSERT_EQ(table.obstacles().size(), sensed) << "the others are kept";
    EXPECT_EQ(table.diagnostics().full, kMaxMapObstacles);
    for (std::size_t i = 0; i < kMaxMapObstacles; ++i) {
        EXPECT_TRUE(table.append(sphere(7, Vec3(0, static_cast<float>(i), 0))));
    }
    EXPECT_FALSE(table.append(sphere(7, Vec3::Zero())));
    EXPECT_EQ(table.obstacles().size(), kMaxObstacles);
    EXPECT_EQ(table.own().size(), sensed);
    EXPECT_EQ(table.obstacles()[sensed + 1].shape.centre.y(), 1.0F);
    EXPECT_EQ(table.update(sphere(0, Vec3::Zero()), later, own), ObstacleStatus::updated);
    EXPECT_EQ(table.obstacles().size(), sensed);
    const auto append_and = [&](auto change) {
        EXPECT_TRUE(table.append(sphere(7, Vec3::Zero())));
        change();
        return table.obstacles().size() == table.own().size();
    };
    EXPECT_TRUE(append_and([&] { EXPECT_TRUE(table.remove(3)); }));
    EXPECT_TRUE(append_and([&] { table.expire(kNow); }));
    EXPECT_EQ(table.own().size(), sensed - 1);
    EXPECT_TRUE(append_and([&] { table.clear(); }));
}

}  // namespace
}  // namespace jink::world
