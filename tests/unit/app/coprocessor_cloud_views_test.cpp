// SPDX-License-Identifier: BSD-3-Clause
// Own state that the co-processor passes to its point clouds, and inputs of a reach range image.
#include "firmware/app/clouds.hpp"

#include <gtest/gtest.h>

#include "firmware/app/reach_picture.hpp"
#include "firmware/app/reach_sets.hpp"
#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

class NotingSink final : public link::CloudSink {
public:
    void begin_scan(const link::CloudScan& /*scan*/) noexcept override {}
    void add(link::Ray /*ray*/, const Vec3& /*point*/) noexcept override {}
    void end_scan(std::uint32_t /*points_lost*/) noexcept override {}
};

/// Records its inputs.
class NotingClouds final : public Clouds {
public:
    void give_to(world::ObstacleTable& obstacles) noexcept override { table = &obstacles; }
    link::CloudSink& link_points() noexcept override { return points; }
    void forward_to(link::CloudSink& sink) noexcept override { forwarded = &sink; }
    void serve(TimePoint now, const CloudView& reported) noexcept override
    {
        served = now;
        view = reported;
        ++times;
    }

    NotingSink points;
    world::ObstacleTable* table = nullptr;
    link::CloudSink* forwarded = nullptr;
    TimePoint served;
    CloudView view;
    int times = 0;
};

struct CloudViews : ::testing::Test {
    void begin(std::initializer_list<std::pair<Param, float>> values = {})
    {
        Parameters parameters;
        for (const auto& [param, value] : values) {
            ASSERT_EQ(parameters.set(param, value), ParamStatus::ok);
        }
        t = std::make_unique<Teller>(parameters);
        t->coprocessor.use_clouds(clouds);
    }
    NotingClouds clouds;
    std::unique_ptr<Teller> t;
};

TEST_F(CloudViews, ServedOnceAStepFromTheFirstOn)
{
    begin();
    ASSERT_NE(clouds.table, nullptr);
    EXPECT_EQ(t->link.points, &clouds.points) << "the single points of the link go there";
    t->step();
    EXPECT_EQ(clouds.times, 1);
    EXPECT_EQ(clouds.served, t->now);
    t->fly(5);
    EXPECT_EQ(clouds.times, 6);
    EXPECT_EQ(clouds.served, t->now);
}

TEST_F(CloudViews, SayHowTheVehicleLies)
{
    begin({{Param::bounds, 0.0F},
           {Param::own_age, 0.3F},
           {Param::scan_keep, 2.0F},
           {Param::half_xy, 1.5F},
           {Param::half_z, 0.75F}});
    t->own.velocity = Vec3(1.0F, -2.0F, 0.5F);
    t->own.yaw = 0.9F;
    t->fly(3);
    EXPECT_TRUE(clouds.view.is_placed);
    EXPECT_EQ(clouds.view.stamp, t->now);
    EXPECT_EQ(clouds.view.position, t->own.position);
    EXPECT_EQ(clouds.view.velocity, t->own.velocity);
    EXPECT_EQ(clouds.view.yaw, 0.9F);
    EXPECT_EQ(clouds.view.own_age, 0.3F);
    EXPECT_EQ(clouds.view.keep, 2.0F);
    EXPECT_EQ(clouds.view.half_extents, Vec3(1.5F, 1.5F, 0.75F));
    EXPECT_FALSE(clouds.view.has_floor);
    const TimePoint known = t->now;
    const Vec3 place = t->own.position;
    t->own_state = false;
    t->fly(3);
    EXPECT_EQ(clouds.view.stamp, known) << "as known last";
    EXPECT_EQ(clouds.view.position, place);
}

TEST_F(CloudViews, AreNotPlacedWithoutAPlaceOrAHeading)
{
    begin();
    t->own_state = false;
    t->fly(2);
    EXPECT_FALSE(clouds.view.is_placed) << "no own state yet";
    t->own_state = true;
    t->has_yaw = false;
    t->fly(2);
    EXPECT_FALSE(clouds.view.is_placed) << "no heading";
    t->has_yaw = true;
    t->fly(2);
    EXPECT_TRUE(clouds.view.is_placed);
    t->own_state = false;
    t->autopilot.rebooted = true;
    t->beat();
    t->step();
    EXPECT_FALSE(clouds.view.is_placed) << "the frame of the autopilot before is gone, the heading is not";
}

TEST_F(CloudViews, SayWhereTheFloorIs)
{
    begin({{Param::bounds, 1.0F}, {Param::floor, 12.0F}});
    t->fly(3);
    EXPECT_TRUE(clouds.view.has_floor);
    EXPECT_EQ(clouds.view.floor, 12.0F) << "above home at 0 m";
    t->link.next.has_home = true;
    t->link.next.home = Vec3(0.0F, 0.0F, 5.0F);
    t->step();
    EXPECT_EQ(clouds.view.floor, 17.0F);
}

TEST_F(CloudViews, ReachPictureIsForwardedToAndLooksFromTheSamePlace)
{
    for (const bool blocks : {false, true}) {
        begin({{Param::unseen, blocks ? 1.0F : 0.0F}});
        ReachPicture picture(reach_sets());
        t->coprocessor.let_reach_sets_see(picture);
        EXPECT_EQ(clouds.forwarded, &picture);
        t->own.yaw = 0.4F;
        t->fly(3);
        link::CloudScan scan;
        scan.stamp = t->now;
        scan.ray_pitch_level = scan.ray_pitch_vertical = 0.02F;
        scan.max_range = 50.0F;
        picture.begin_scan(scan);
        picture.end_scan(0);
        EXPECT_EQ(picture.unused(), 0U);
        ASSERT_TRUE(picture.picture().is_known());
        EXPECT_EQ(picture.picture().start().position, t->own.position);
        EXPECT_EQ(picture.picture().start().nose, 0.4F);
        // Nothing was fired: all is unseen, and is blocked or not.
        reach::Placed placed;
        placed.set = reach_sets().segments[1].emergency;
        placed.origin = t->own.position;
        placed.unit = 5.0F * reach_sets().period;
        std::vector<reach::Level> levels(placed.set->grid.cells(), reach::kFree);
        WorkBudget budget(100'000);
        const vehicle::VehicleLimits limits;
        const vehicle::Airframe airframe;
        const world::Reference reference;
        const world::FlightRules rules;
        const world::Situation now{t->now, t->own, limits, airframe, reference, rules};
        ASSERT_EQ(picture.picture().rate(now, placed, reach::CellSpheres(placed.set->grid), 0.0F, levels, budget),
                  reach::RateStatus::rated);
        const bool any = std::any_of(levels.begin(), levels.end(), [](reach::Level l) { return l != reach::kFree; });
        EXPECT_EQ(any, blocks);
        t.reset();
    }
}

TEST_F(CloudViews, NothingIsForwardedWithoutClouds)
{
    Teller without;
    without.coprocessor.forward_clouds_to(clouds.points);
    EXPECT_EQ(clouds.forwarded, nullptr);
    begin();
    t->coprocessor.forward_clouds_to(clouds.points);
    EXPECT_EQ(clouds.forwarded, &clouds.points);
}

}  // namespace
}  // namespace jink::app::test
