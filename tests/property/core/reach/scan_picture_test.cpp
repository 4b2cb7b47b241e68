// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/scan_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/base/random.hpp"
#include "core/reach/cell_spheres.hpp"
#include "tests/reference/reach/intruder.hpp"

namespace jink::reach {
namespace {

constexpr float kPitch = 0.02F;
constexpr Level kBlocked = 0;

/// A set of which only the grid counts.
struct GridAlone {
    ReachSet set;
    Placed placed;
    std::vector<Level> blocks;

    GridAlone() : blocks(set.grid.cells(), kFree) { placed.set = &set; }

    bool rate(ScanPicture& picture, bool blocks_unseen)
    {
        WorkBudget budget(100'000);
        return rate(picture, blocks_unseen, budget);
    }
    bool rate(ScanPicture& picture, bool blocks_unseen, WorkBudget& budget)
    {
        picture.block_unseen(blocks_unseen);
        std::fill(blocks.begin(), blocks.end(), kFree);
        const vehicle::VehicleState own;
        const vehicle::VehicleLimits limits;
        const vehicle::Airframe airframe;
        const world::Reference reference;
        const world::FlightRules rules;
        const world::Situation now{TimePoint{1'000'000}, own, limits, airframe, reference, rules};
        return picture.rate(now, placed, CellSpheres(set.grid), 0.0F, blocks, budget) == RateStatus::rated;
    }
    [[nodiscard]] Level level(std::uint8_t layer, std::uint8_t column, std::uint8_t row) const
    {
        return blocks[set.grid.index({layer, column, row})];
    }
};

ScanStart straight_ahead(float unit = 1.0F)
{
    ScanStart start;
    start.stamp = TimePoint{1'000'000};
    start.unit = unit;
    start.horizontal_pitch = start.vertical_pitch = kPitch;
    return start;
}

/// A ray in every direction of a sensor with fields of view `up` and `across` to either side: no returns, except for
/// rays near `hit`, which end there.
void look_around(
    ScanPicture& picture, const std::vector<Vec3>& hits = {}, float across = 1.2F, float up = 0.6F,
    const std::function<bool(const Vec3&)>& is_fired = [](const Vec3&) { return true; })
{
    for (float h = -across; h <= across; h += kPitch) {
        for (float v = -up; v <= up; v += kPitch) {
            const Vec3 ray(std::cos(v) * std::cos(h), std::cos(v) * std::sin(h), std::sin(v));
            if (is_fired(ray)) {
                picture.add_nothing(ray);
            }
        }
    }
    for (const Vec3& hit : hits) {
        picture.add(hit);
    }
    picture.end();
}

TEST(ScanPictures, WhatIsHitIsBlockedAndWhatLiesBehindIsNotSeen)
{
    GridAlone grid;
    ScanPicture picture;
    ASSERT_TRUE(picture.configure(grid.set.grid));
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {Vec3(4.5F, 0.0F, 0.0F)});
    ASSERT_TRUE(grid.rate(picture, true));
    for (std::uint8_t layer = 0; layer < 10; ++layer) {
        EXPECT_EQ(grid.level(layer, 3, 2), layer < 4 ? kFree : kBlocked) << int{layer};
        EXPECT_EQ(grid.level(layer, 1, 2), kFree) << int{layer};
    }
    ASSERT_TRUE(grid.rate(picture, false));
    for (std::uint8_t layer = 0; layer < 10; ++layer) {
        EXPECT_EQ(grid.level(layer, 3, 2), layer == 4 ? kBlocked : kFree) << int{layer};
    }
}

/// A rating that waits for its next slice while a scan ends rates by that scan.
TEST(ScanPictures, AScanThatEndsDuringARatingCounts)
{
    struct Lidar {
        ScanPicture picture;
        WorkSlice* slice = nullptr;
        int waits = 0;
        int ends_at = 0;
    };
    for (int ends_at = 1; ends_at <= 3; ++ends_at) {
        GridAlone grid;
        Lidar lidar;
        lidar.ends_at = ends_at;
        grid.placed.origin = Vec3(0.3F, -0.2F, 0.1F);
        grid.placed.cosine = std::cos(0.3F);
        grid.placed.sine = std::sin(0.3F);
        ASSERT_TRUE(lidar.picture.configure(grid.set.grid));
        ASSERT_TRUE(lidar.picture.begin(straight_ahead()));
        look_around(lidar.picture);
        WorkSlice slice(
            [](void* context) noexcept {
                Lidar& of = *static_cast<Lidar*>(context);
                if (++of.waits == of.ends_at) {
                    // Turned and thinner cells than the set's, which samples of those miss.
                    Random random(7);
                    std::vector<Vec3> hits;
                    for (int i = 0; i < 60; ++i) {
                        const float h = random.uniform(-0.6F, 0.6F);
                        const float v = random.uniform(-0.4F, 0.4F);
                        hits.push_back(random.uniform(2.0F, 9.0F) *
                                       Vec3(std::cos(v) * std::cos(h), std::cos(v) * std::sin(h), std::sin(v)));
                    }
                    static_cast<void>(of.picture.begin(straight_ahead(0.5F)));
                    look_around(of.picture, hits);
                }
                of.slice->begin(2000);
            },
            &lidar);
        lidar.slice = &slice;
        WorkBudget budget(1'000'000, slice);
        ASSERT_TRUE(grid.rate(lidar.picture, false, budget));
        const std::vector<Level> rated = grid.blocks;
        const bool ended = lidar.waits >= ends_at;
        ASSERT_TRUE(ended || ends_at > 1);
        ASSERT_TRUE(grid.rate(lidar.picture, false));
        EXPECT_EQ(rated, grid.blocks) << ends_at;
    }
}

TEST(ScanPictures, NothingIsSeenWithoutAScan)
{
    GridAlone grid;
    ScanPicture picture;
    ASSERT_TRUE(picture.configure(grid.set.grid));
    EXPECT_FALSE(picture.is_known());
    EXPECT_FALSE(picture.is_fresh(TimePoint{1'000'000}, 1.0F));
    ASSERT_TRUE(picture.begin(straight_ahead()));
    picture.add(Vec3(4.5F, 0.0F, 0.0F));
    EXPECT_FALSE(picture.is_known()) << "a scan that has not ended is none";
    picture.end();
    EXPECT_TRUE(picture.is_fresh(TimePoint{1'500'000}, 0.5F));
    EXPECT_FALSE(picture.is_fresh(TimePoint{1'500'001}, 0.5F));
    ASSERT_TRUE(grid.rate(picture, true));
    EXPECT_TRUE(std::all_of(grid.blocks.begin(), grid.blocks.end(), [](Level level) { return level == kBlocked; }))
        << "one ray sees nothing";
}

TEST(ScanPictures, WhereRaysAreMissingNothingIsSeen)
{
    GridAlone grid;
    ScanPicture picture;
    ASSERT_TRUE(picture.configure(grid.set.grid));
    // Half of one direction lost; and a sensor with 15 degrees up and down, not the grid's 30.
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {}, 1.2F, 0.6F,
                [](const Vec3& ray) { return !(std::abs(ray.y()) < 0.11F && ray.z() > 0.0F && ray.z() < 0.105F); });
    ASSERT_TRUE(grid.rate(picture, true));
    for (std::uint8_t layer = 0; layer < 10; ++layer) {
        EXPECT_EQ(grid.level(layer, 3, 2), kBlocked);
        EXPECT_EQ(grid.level(layer, 2, 2), kFree);
        EXPECT_EQ(grid.level(layer, 3, 0), kFree);
    }
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {}, 1.2F, 0.262F);
    ASSERT_TRUE(grid.rate(picture, true));
    for (std::uint8_t layer = 0; layer < 10; ++layer) {
        EXPECT_EQ(grid.level(layer, 3, 0), kBlocked);
        EXPECT_EQ(grid.level(layer, 3, 2), kFree);
        EXPECT_EQ(grid.level(layer, 3, 4), kBlocked);
    }
}

/// A vehicle that hovers may leave in any direction: the picture is of all of them.
TEST(ScanPictures, SeeAllAround)
{
    GridAlone grid;
    ScanPicture picture;
    ASSERT_TRUE(picture.configure(grid.set.grid));
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {}, kPi);
    for (float course = -kPi; course < kPi; course += 0.1F) {
        grid.placed.cosine = std::cos(course);
        grid.placed.sine = std::sin(course);
        ASSERT_TRUE(grid.rate(picture, true));
        EXPECT_EQ(std::count(grid.blocks.begin(), grid.blocks.end(), kBlocked), 0) << course;
    }
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {Vec3(-4.5F, 0.3F, 0.2F)}, kPi);
    for (const float course : {0.0F, 1.5F, 3.0F, -3.0F}) {
        grid.placed.cosine = std::cos(course);
        grid.placed.sine = std::sin(course);
        ASSERT_TRUE(grid.rate(picture, false));
        const bool is_behind = std::abs(course) > 2.0F;
        EXPECT_EQ(std::count(grid.blocks.begin(), grid.blocks.end(), kBlocked) > 0, is_behind) << course;
    }
}

/// Sets of a vehicle that turns slowly have narrow columns: a picture with coarser ones is better than none, with which
/// nothing that is not seen would be blocked.
TEST(ScanPictures, OfNarrowOrManyCellsAreCoarserAndNotMissing)
{
    for (const Grid<float>& sets :
         {Grid<float>(10, 7, 5, 10.0F, 0.293F, 0.196F), Grid<float>(10, 12, 5, 10.0F, 0.1F, 0.5F),
          Grid<float>(10, 3, 10, 10.0F, 0.5F, 0.5F), Grid<float>(16, 3, 8, 10.0F, 0.3F, 0.5F)}) {
        SCOPED_TRACE(sets.columns());
        ASSERT_TRUE(CellSpheres::serves(sets)) << "no vehicle flies with it";
        GridAlone grid;
        grid.set.grid = sets;
        grid.blocks.assign(sets.cells(), kFree);
        ScanPicture picture;
        ASSERT_TRUE(picture.configure(sets));
        ASSERT_TRUE(picture.begin(straight_ahead()));
        look_around(picture, {}, kPi);
        for (const float course : {0.0F, 1.0F, 3.0F, -2.0F}) {
            grid.placed.cosine = std::cos(course);
            grid.placed.sine = std::sin(course);
            ASSERT_TRUE(grid.rate(picture, true));
            EXPECT_EQ(std::count(grid.blocks.begin(), grid.blocks.end(), kBlocked), 0) << course;
        }
        ASSERT_TRUE(picture.begin(straight_ahead()));
        look_around(picture, {}, 0.5F);
        grid.placed.cosine = -1.0F;
        grid.placed.sine = 0.0F;
        ASSERT_TRUE(grid.rate(picture, true));
        EXPECT_EQ(std::count(grid.blocks.begin(), grid.blocks.end(), kFree), 0) << "nobody has looked behind";
    }
}

TEST(ScanPictures, AScanThatCannotBeUsedLeavesTheOneBefore)
{
    GridAlone grid;
    ScanPicture picture;
    EXPECT_FALSE(picture.begin(straight_ahead())) << "no grid yet";
    ASSERT_TRUE(picture.configure(grid.set.grid));
    ASSERT_TRUE(picture.begin(straight_ahead()));
    look_around(picture, {Vec3(4.5F, 0.0F, 0.0F)});
    for (const auto& spoil : std::vector<void (*)(ScanStart&)>{
             [](ScanStart& s) { s.unit = 0.0F; }, [](ScanStart& s) { s.position.x() = NAN; },
             [](ScanStart& s) { s.nose = NAN; }, [](ScanStart& s) { s.unit = INFINITY; },
             [](ScanStart& s) { s.horizontal_pitch = 0.0F; }, [](ScanStart& s) { s.vertical_pitch = 3.0F; }}) {
        ScanStart bad = straight_ahead();
        spoil(bad);
        EXPECT_FALSE(picture.begin(bad));
        picture.add(Vec3(1.5F, 0.0F, 0.0F));
        picture.end();
        ASSERT_TRUE(grid.rate(picture, true));
        EXPECT_EQ(grid.level(1, 3, 2), kFree);
        EXPECT_EQ(grid.level(4, 3, 2), kBlocked);
    }
}

/// Moved, turned and with another unit, the range image gives the correct state at the place of each point.
TEST(ScanPictureLaw, HitsStayWhereTheyAreWhenTheGridMoves)
{
    std::size_t hits = 0;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        Random random(seed);
        GridAlone grid;
        ScanPicture picture;
        ASSERT_TRUE(picture.configure(grid.set.grid));
        ScanStart start = straight_ahead(random.uniform(1.0F, 3.0F));
        start.position =
            Vec3(random.uniform(-200.0F, 200.0F), random.uniform(-200.0F, 200.0F), random.uniform(5.0F, 50.0F));
        start.nose = random.uniform(-kPi, kPi);
        ASSERT_TRUE(picture.begin(start));
        const float course = random.uniform(-kPi, kPi);
        // In the world frame, then in the sensor frame.
        const float azimuth = course + random.uniform(-0.7F, 0.7F);
        const float elevation = random.uniform(-0.45F, 0.45F);
        const Vec3 apart =
            random.uniform(1.0F, 9.5F) * start.unit *
            Vec3(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const float c = std::cos(start.nose);
        const float s = std::sin(start.nose);
        picture.add(Vec3(c * apart.x() + s * apart.y(), -s * apart.x() + c * apart.y(), apart.z()));
        picture.end();
        grid.placed.origin = start.position + 0.3F * start.unit * Vec3(random.uniform(), random.uniform(), 0.0F);
        grid.placed.cosine = std::cos(course);
        grid.placed.sine = std::sin(course);
        grid.placed.unit = start.unit * random.uniform(0.9F, 1.1F);
        ASSERT_TRUE(grid.rate(picture, false));
        const Vec3 point = start.position + apart;
        const Located at = grid.set.grid.locate(grid.placed.to_set(point));
        const auto blocked = std::count(grid.blocks.begin(), grid.blocks.end(), kBlocked);
        const Polar<float> polar = to_polar(grid.placed.to_set(point));
        // At the border the cell of the scan may lie beyond it but for a corner.
        const bool well_inside = polar.distance < 8.5F && std::abs(polar.horizontal) < 0.6F &&
                                 std::abs(polar.vertical) < 0.4F && at.status == LocateStatus::inside;
        ASSERT_TRUE(!well_inside || blocked >= 1) << "seed " << seed;
        ASSERT_LE(blocked, 18) << "seed " << seed << ": a cell of the scan is no larger than that";
        if (well_inside) {
            ++hits;
            // All that is blocked lies about the cell that was hit, which holds the point.
            const CellSphere hit = sphere_of(grid.set.grid, at.place);
            for (std::size_t i = 0; i < grid.blocks.size(); ++i) {
                const CellSphere other = sphere_of(grid.set.grid, grid.set.grid.place(static_cast<CellIndex>(i)));
                ASSERT_TRUE(grid.blocks[i] == kFree ||
                            (hit.centre - other.centre).norm() <= 2.5F * (hit.radius + other.radius))
                    << "seed " << seed;
            }
        }
    }
    EXPECT_GT(hits, 1500U);
}

TEST(CellSpheresLaw, AreThoseOfTheCells)
{
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Random random(seed);
        const Grid<float> grid(1 + random.below(16), 1 + random.below(8), 1 + random.below(8),
                               random.uniform(1.0F, 20.0F), random.uniform(0.2F, 1.5F), random.uniform(0.2F, 1.2F));
        ASSERT_TRUE(CellSpheres::serves(grid));
        const CellSpheres spheres(grid);
        for (std::size_t i = 0; i < grid.cells(); ++i) {
            const CellPlace place = grid.place(static_cast<CellIndex>(i));
            const CellSphere sphere = sphere_of(grid, place);
            const Vec3 centre = spheres.distance(place.layer) * spheres.direction(place.column, place.row);
            ASSERT_LT((centre - sphere.centre).norm(), 1e-5F * grid.distance()) << "seed " << seed;
            ASSERT_NEAR(spheres.radius(place.layer, place.row), sphere.radius, 3e-5F * grid.distance())
                << "seed " << seed;
            ASSERT_GE(spheres.radius(place.layer, place.row), sphere.radius - 1e-6F * grid.distance())
                << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace jink::reach
