// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/reach_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/app/reach_sets.hpp"

namespace jink::app {
namespace {

using link::Ray;

/// Flying north at 5 m/s, the nose to the east.
struct Flying {
    ReachPicture picture{reach_sets()};
    CloudView view;
    link::CloudScan scan;

    Flying()
    {
        view.is_placed = true;
        view.stamp = TimePoint{1'000'000};
        view.position = Vec3(10.0F, 20.0F, 30.0F);
        view.velocity = Vec3(0.0F, 5.0F, 0.0F);
        scan.stamp = TimePoint{1'100'000};
        scan.ray_pitch_level = scan.ray_pitch_vertical = 0.02F;
        scan.max_range = 100.0F;
    }

    /// All around, with one hit 10 m to the north: to the left of the nose.
    void look()
    {
        picture.look_from(view);
        picture.begin_scan(scan);
        for (float h = -3.14F; h < 3.14F; h += 0.02F) {
            for (float v = -0.7F; v < 0.7F; v += 0.02F) {
                picture.add(Ray::nothing, Vec3(std::cos(v) * std::cos(h), std::cos(v) * std::sin(h), std::sin(v)));
            }
        }
        picture.add(Ray::hit, Vec3(0.0F, 10.0F, 0.0F));
        picture.end_scan(0);
    }

    bool rate(const reach::Placed& placed, bool blocks_unseen, std::vector<reach::Level>& blocks)
    {
        std::fill(blocks.begin(), blocks.end(), reach::kFree);
        picture.picture().block_unseen(blocks_unseen);
        WorkBudget budget(100'000);
        const vehicle::VehicleState own;
        const vehicle::VehicleLimits limits;
        const vehicle::Airframe airframe;
        const world::Reference reference;
        const world::FlightRules rules;
        const world::Situation now{scan.stamp, own, limits, airframe, reference, rules};
        return picture.picture().rate(now, placed, reach::CellSpheres(placed.set->grid), 0.0F, blocks, budget) ==
               reach::RateStatus::rated;
    }

    /// Cells of a set that lies along the course: blocked ones of the middle column.
    [[nodiscard]] int blocked_ahead()
    {
        const reach::ReachSet& set = *reach_sets().segments[1].emergency;
        reach::Placed placed;
        placed.set = &set;
        placed.origin = Vec3(10.0F, 20.5F, 30.0F);
        placed.cosine = 0.0F;
        placed.sine = 1.0F;
        placed.unit = 5.0F * reach_sets().period;
        std::vector<reach::Level> blocks(set.grid.cells());
        EXPECT_TRUE(rate(placed, false, blocks));
        int count = 0;
        for (std::size_t layer = 0; layer < set.grid.layers(); ++layer) {
            count += blocks[set.grid.index({static_cast<std::uint8_t>(layer), 3, 2})] == reach::kFree ? 0 : 1;
        }
        return count;
    }
};

TEST(ReachPictures, LieAlongTheCourseWhereverTheNoseLooks)
{
    Flying f;
    f.look();
    EXPECT_EQ(f.picture.scans(), 1U);
    EXPECT_EQ(f.picture.unused(), 0U);
    EXPECT_EQ(f.picture.picture().start().stamp, f.scan.stamp);
    EXPECT_LT((f.picture.picture().start().position - Vec3(10.0F, 20.5F, 30.0F)).norm(), 1e-4F);
    EXPECT_EQ(f.blocked_ahead(), 1);
}

TEST(ReachPictures, WithoutAPlaceOrThePitchOfTheRaysThereIsNone)
{
    for (const auto& spoil : std::vector<void (*)(Flying&)>{
             [](Flying& f) { f.view.is_placed = false; }, [](Flying& f) { f.scan.ray_pitch_level = 0.0F; },
             [](Flying& f) { f.scan.ray_pitch_vertical = 0.0F; }, [](Flying& f) { f.scan.stamp = f.view.stamp + 0.6F; },
             [](Flying& f) { f.scan.ray_pitch_level = 0.5F; }}) {
        Flying f;
        spoil(f);
        f.look();
        EXPECT_EQ(f.picture.scans(), 1U);
        EXPECT_EQ(f.picture.unused(), 1U);
        EXPECT_FALSE(f.picture.picture().is_known());
    }
}

/// Free cells of a set along the course, with hidden cells blocked, after a sweep of such rays.
std::ptrdiff_t free_after(Ray ray)
{
    Flying f;
    f.picture.look_from(f.view);
    f.picture.begin_scan(f.scan);
    for (float h = -3.14F; h < 3.14F; h += 0.02F) {
        for (float v = -0.7F; v < 0.7F; v += 0.02F) {
            f.picture.add(ray, Vec3(std::cos(v) * std::cos(h), std::cos(v) * std::sin(h), std::sin(v)));
        }
    }
    f.picture.end_scan(0);
    reach::Placed placed;
    placed.set = reach_sets().segments[1].emergency;
    placed.origin = Vec3(10.0F, 20.5F, 30.0F);
    placed.cosine = 0.0F;
    placed.sine = 1.0F;
    placed.unit = 5.0F * reach_sets().period;
    std::vector<reach::Level> blocks(placed.set->grid.cells());
    EXPECT_TRUE(f.rate(placed, true, blocks));
    return std::count(blocks.begin(), blocks.end(), reach::kFree);
}

TEST(ReachPictures, RaysThatCameBackFromNowhereSeeAndThoseThatAreNotValidDoNot)
{
    EXPECT_GT(free_after(Ray::nothing), 100);
    EXPECT_EQ(free_after(Ray::invalid), 0);
}

/// The start of a scan, as stored in the range image after the scan's end.
const reach::ScanStart& start_of(Flying& f)
{
    f.look();
    EXPECT_EQ(f.picture.unused(), 0U);
    return f.picture.picture().start();
}

TEST(ReachPictures, StartOfAScanIsCarriedFromTheOwnStateToItsStamp)
{
    for (const Seconds apart : {-0.4F, 0.0F, 0.3F}) {
        Flying f;
        f.scan.stamp = f.view.stamp + apart;
        f.view.velocity = Vec3(3.0F, -4.0F, 1.0F);
        f.view.yaw = 0.7F;
        const reach::ScanStart& start = start_of(f);
        EXPECT_EQ(start.stamp, f.scan.stamp);
        EXPECT_LT((start.position - f.view.position - apart * f.view.velocity).norm(), 1e-4F) << apart;
        EXPECT_EQ(start.nose, 0.7F);
        EXPECT_EQ(start.horizontal_pitch, f.scan.ray_pitch_level);
        EXPECT_EQ(start.vertical_pitch, f.scan.ray_pitch_vertical);
    }
}

TEST(ReachPictures, LayersAreAsThickAsAMovementIsLongAndNeverThinnerThanTheSlowest)
{
    const float slowest = reach_sets().speeds.front() * reach_sets().cruise_speed;
    for (const float speed : {0.0F, 0.5F * slowest, slowest, 2.0F * slowest}) {
        Flying f;
        f.view.velocity = Vec3(0.0F, speed, 0.0F);
        f.view.yaw = -0.4F;
        const reach::ScanStart& start = start_of(f);
        EXPECT_NEAR(start.unit, std::max(speed, slowest) * reach_sets().period, 1e-5F) << speed;
        EXPECT_EQ(start.nose, -0.4F);
    }
}

TEST(ReachPictures, OwnStateMayBeAsOldAsItsBoundEitherWay)
{
    for (const std::int64_t us : {-500'000, 500'000}) {
        Flying f;
        f.scan.stamp = {f.view.stamp.us + us};
        f.look();
        EXPECT_EQ(f.picture.unused(), 0U) << us;
        Flying late;
        late.scan.stamp = {late.view.stamp.us + us + (us > 0 ? 1 : -1)};
        late.look();
        EXPECT_EQ(late.picture.unused(), 1U) << us;
        EXPECT_FALSE(late.picture.picture().is_known());
    }
}

TEST(ReachPictures, EachScanCountsAndOnlyWhatCannotBeUsedIsUnused)
{
    Flying f;
    f.look();
    f.scan.ray_pitch_level = 0.0F;
    f.look();
    f.scan.ray_pitch_level = 0.02F;
    f.look();
    EXPECT_EQ(f.picture.scans(), 3U);
    EXPECT_EQ(f.picture.unused(), 1U);
}

/// Sets of a narrow grid first, or of a wide grid: a hit near the top of the wide grid is known in both cases.
TEST(ReachPictures, GridIsThatOfTheSetsThatReachWidest)
{
    const auto segments = reach_sets().segments;
    const reach::ReachSet& wide = *segments.front().emergency;
    ASSERT_GT(wide.grid.vertical(), segments.back().emergency->grid.vertical() + 0.1F);
    std::vector<reach::SegmentSets> reversed(segments.rbegin(), segments.rend());
    reach::VehicleSets sets = reach_sets();
    sets.segments = reversed;
    for (const reach::VehicleSets* each : {&reach_sets(), static_cast<const reach::VehicleSets*>(&sets)}) {
        ReachPicture picture(*each);
        Flying f;
        picture.look_from(f.view);
        picture.begin_scan(f.scan);
        const float elevation = 0.8F * wide.grid.vertical();
        picture.add(Ray::hit, 12.0F * Vec3(0.0F, std::cos(elevation), std::sin(elevation)));
        picture.end_scan(0);
        ASSERT_TRUE(picture.picture().is_known());
        reach::Placed placed;
        placed.set = &wide;
        placed.origin = Vec3(10.0F, 20.5F, 30.0F);
        placed.cosine = 0.0F;
        placed.sine = 1.0F;
        placed.unit = 5.0F * reach_sets().period;
        std::vector<reach::Level> blocks(wide.grid.cells(), reach::kFree);
        picture.picture().block_unseen(false);
        WorkBudget budget(100'000);
        const vehicle::VehicleState own;
        const vehicle::VehicleLimits limits;
        const vehicle::Airframe airframe;
        const world::Reference reference;
        const world::FlightRules rules;
        const world::Situation now{f.scan.stamp, own, limits, airframe, reference, rules};
        ASSERT_EQ(picture.picture().rate(now, placed, reach::CellSpheres(wide.grid), 0.0F, blocks, budget),
                  reach::RateStatus::rated);
        EXPECT_GT(std::count_if(blocks.begin(), blocks.end(), [](reach::Level b) { return b != reach::kFree; }), 0);
    }
}

}  // namespace
}  // namespace jink::app
