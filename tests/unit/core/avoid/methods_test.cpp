// SPDX-License-Identifier: BSD-3-Clause
// The product's methods under one supervisor: every subset of them, each alone.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

constexpr std::uint8_t kGeometric = geometric::Planner::kTraits.id;
constexpr std::uint8_t kReach = reach::Planner::kTraits.id;
constexpr std::uint8_t kOrca = orca::Planner::kTraits.id;

struct Planners {
    geometric::Planner geometric{geometric::Settings{}};
    std::unique_ptr<reach::Planner> reach = std::make_unique<reach::Planner>(with_sets());
    orca::Planner orca;

    static reach::Settings with_sets()
    {
        reach::Settings settings;
        settings.sets = &reach::kDefaultReducedSets;
        return settings;
    }
};

/// Past head-on traffic and back to the leg: which methods' answers were flown, and the least distance between box and
/// sphere [m].
struct Passed {
    MethodOrder by;
    float least = 1e9F;
    bool back = false;
};

template <class... Methods>
Passed pass(const Settings& settings, Methods&... methods)
{
    Flight f;
    head_on(f, 60.0F);
    const auto supervisor = std::make_unique<Supervisor<Methods...>>(settings, methods...);
    Passed passed;
    Guidance g;
    for (int i = 0; i < 1500; ++i) {
        g = f.update(*supervisor, g.wants_control);
        if (g.new_manoeuvre) {
            static_cast<void>(passed.by.try_add(supervisor->flying()->by));
        }
        const world::Way way = world::way_of(f.scene.situation());
        f.pass(g.wants_control ? g.velocity : Vec3(way.direction * way.speed), 0.02F);
        const world::Track& track = f.scene.tracks[0];
        const Vec3 apart = (track.position - f.scene.own.position).cwiseAbs() - f.scene.limits.half_extents;
        passed.least = std::min(passed.least, apart.cwiseMax(0.0F).norm() - track.radius);
    }
    passed.back = !g.wants_control && std::abs(f.scene.own.position.y()) < 1.0F;
    return passed;
}

void expect_passed(const Passed& passed, const MethodOrder& by)
{
    EXPECT_EQ(passed.by, by);
    EXPECT_GT(passed.least, 0.0F);
    EXPECT_TRUE(passed.back);
}

TEST(EachMethodAlone, PassesHeadOnTraffic)
{
    Planners p;
    expect_passed(pass(quick(), p.geometric), MethodOrder(kGeometric));
    expect_passed(pass(quick(), *p.reach), MethodOrder(kReach));
    expect_passed(pass(quick(), p.orca), MethodOrder(kOrca));
}

/// By whichever answer costs less: the same whoever is asked first.
TEST(EachPairOfMethods, PassesHeadOnTraffic)
{
    Planners p;
    const auto expect_either = [](const Passed& passed, const Passed& turned) {
        EXPECT_FALSE(passed.by.empty());
        EXPECT_GT(passed.least, 0.0F);
        EXPECT_TRUE(passed.back);
        EXPECT_EQ(passed.by, turned.by);
        EXPECT_EQ(passed.least, turned.least);
    };
    expect_either(pass(quick(), p.geometric, *p.reach), pass(quick(), *p.reach, p.geometric));
    p.orca.reset();
    const Passed first = pass(quick(), p.orca, *p.reach);
    p.orca.reset();
    expect_either(first, pass(quick(), *p.reach, p.orca));
}

TEST(AllMethods, AnyOneIsAskedAloneByTheOrder)
{
    Planners p;
    for (const std::uint8_t id : {kGeometric, kReach, kOrca}) {
        Settings settings = quick();
        settings.order = MethodOrder(id);
        expect_passed(pass(settings, p.geometric, *p.reach, p.orca), MethodOrder(id));
        p.orca.reset();
    }
}

}  // namespace
}  // namespace jink::avoid
