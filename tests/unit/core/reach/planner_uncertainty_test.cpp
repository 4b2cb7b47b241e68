// SPDX-License-Identifier: BSD-3-Clause
// The reach planner's clearance from each kind of threat: the own box, and both position uncertainties.
#include <gtest/gtest.h>

#include "core/reach/planner.hpp"
#include "tests/unit/core/reach/planner_bench.hpp"

namespace jink::reach {
namespace {

using test::PlannerChoice;

/// One trajectory, straight ahead, with its box from 29.5 m to 30.5 m; a movement may bend by 0.12 m.
class PlannerUncertainty : public PlannerChoice {
protected:
    PlannerUncertainty()
    {
        test::SmallTree alone(kGrid);
        alone.chain(Movement::straight, 4, 1024);
        only(alone);
        rules.clearance = 0.0F;
    }
    /// With a known own position the whole trajectory is flown; with 0.1 m uncertainty, which counts three times, it is
    /// not.
    void expect_own_uncertainty_counts(float sigma = 0.1F)
    {
        own.sigma_position = 0.0F;
        EXPECT_EQ(way(), Way::straight);
        own.sigma_position = sigma;
        EXPECT_NE(way(), Way::straight);
        own.sigma_position = 0.0F;
    }
};

TEST_F(PlannerUncertainty, TheFloor)
{
    airspace.has_floor = true;
    airspace.floor = 29.4F;
    expect_own_uncertainty_counts();
    airspace.floor = 29.6F;
    EXPECT_NE(way(), Way::straight) << "the box is in it";
    airspace.has_floor = false;
    EXPECT_EQ(way(), Way::straight);
}

TEST_F(PlannerUncertainty, TheCeiling)
{
    airspace.has_ceiling = true;
    airspace.ceiling = 30.6F;
    expect_own_uncertainty_counts();
    airspace.ceiling = 30.4F;
    EXPECT_NE(way(), Way::straight);
    airspace.has_ceiling = false;
    EXPECT_EQ(way(), Way::straight);
}

/// Its stop ends at 13.16 m, the box's corner 0.71 m farther on.
TEST_F(PlannerUncertainty, TheFence)
{
    airspace.has_keep_in = true;
    airspace.home = Vec3(-3.0F, 0.0F, 5.0F);
    airspace.keep_in_radius = 17.0F;
    expect_own_uncertainty_counts();
    airspace.keep_in_radius = 16.8F;
    EXPECT_NE(way(), Way::straight);
    airspace.has_keep_in = false;
    EXPECT_EQ(way(), Way::straight);
}

TEST_F(PlannerUncertainty, AClosedVolume)
{
    world::Cylinder cylinder;
    cylinder.circle = {world::Vec2(8.0F, 3.0F), 2.2F};  // 0.3 m beside the box
    cylinder.top = 100.0F;
    airspace.cylinders = {&cylinder, 1};
    expect_own_uncertainty_counts();
    cylinder.circle.radius = 2.5F;
    EXPECT_NE(way(), Way::straight);
    // Below the box by 0.3 m.
    cylinder.circle.radius = 5.0F;
    cylinder.top = 29.2F;
    expect_own_uncertainty_counts();
}

TEST_F(PlannerUncertainty, ASphere)
{
    add_sphere(Vec3(8.0F, 0.0F, 30.0F + 0.5F + 1.2F + 0.3F), 0.3F);
    expect_own_uncertainty_counts(0.5F);
}

TEST_F(PlannerUncertainty, ABox)
{
    add_box(Vec3(8.0F, 0.0F, 30.0F + 0.5F + 0.5F + 0.3F), Vec3::Constant(0.3F));
    expect_own_uncertainty_counts();
}

TEST_F(PlannerUncertainty, ATrack)
{
    add_track(Vec3(8.0F, 0.0F, 30.0F + 0.5F + 1.2F + 0.3F), Vec3::Zero(), 0.3F);
    expect_own_uncertainty_counts(0.5F);
    const world::Track known = tracks[0];
    const auto with = [&](auto change) {
        tracks[0] = known;
        change(tracks[0]);
        const Way taken = way();
        tracks[0] = known;
        return taken;
    };
    EXPECT_EQ(with([](world::Track&) {}), Way::straight);
    EXPECT_NE(with([](world::Track& t) { t.sigma_position = 0.5F; }), Way::straight) << "its place";
    EXPECT_NE(with([](world::Track& t) { t.sigma_velocity = 0.35F; }), Way::straight) << "where it may drift to";
    EXPECT_NE(with([](world::Track& t) { t.max_acceleration = 1.2F; }), Way::straight) << "what it may do";
    EXPECT_NE(with([](world::Track& t) { t.half_height = 1.4F; }), Way::straight) << "its height";
    EXPECT_NE(with([](world::Track& t) { t.radius = 1.7F; }), Way::straight);
    EXPECT_NE(with([&](world::Track& t) {
                  t.sigma_velocity = 0.03F;
                  t.stamp = now - 15.0F;
              }),
              Way::straight)
        << "its age";
}

}  // namespace
}  // namespace jink::reach
