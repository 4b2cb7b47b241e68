// SPDX-License-Identifier: BSD-3-Clause
// An intruder whose height is known to 60 m, reported 40 m above: every method and the fallback against the whole
// capsule, by dense flight in double precision.
#include <gtest/gtest.h>

#include <memory>

#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/vehicles/default/reach_sets.hpp"
#include "tests/property/core/avoid/drawn_manoeuvre.hpp"

namespace jink::avoid {
namespace {

using dense::kAmple;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;

constexpr int kCourses = 48;
/// From core/avoid/final_check.hpp [m].
constexpr double kAccuracy = 2e-3;

/// Level encounter after 6 to 8 s, at a random course.
void draw_intruder(Random& random, dense::Scene& s)
{
    s.own.position = Vec3(0, 0, 30);
    s.own.velocity = Vec3(5, 0, 0);
    s.own.stamp = s.now;
    s.leg(s.own.position, Vec3(300, 0, 30), 5.0F);
    const float course = random.uniform(-kPi, kPi);
    const Vec3 velocity = random.uniform(3.0F, 12.0F) * Vec3(std::cos(course), std::sin(course), 0.0F);
    const Vec3 off(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), 40.0F);
    const float until = random.uniform(6.0F, 8.0F);
    world::Track& track = s.track(s.own.position + until * (s.own.velocity - velocity) + off, velocity, 1.5F);
    track.half_height = 60.0F;
}

struct Outcome {
    int found = 0;
    int clear = 0;
    int too_near = 0;  ///< stated clear, and enters the capsule
    int above = 0;     ///< stated more than there is
};

void judge(const dense::Scene& s, const dense::DenseFlight& flight, float stated, Outcome& out)
{
    const double floor = double(stated) - kAccuracy;
    const double truth = dense::least_of_all(s, flight, 1e9, floor);
    ++out.found;
    out.clear += stated >= 0.0F ? 1 : 0;
    out.too_near += stated >= 0.0F && truth < -kAccuracy ? 1 : 0;
    out.above += truth < floor ? 1 : 0;
}

template <class Method>
Outcome fly_with(Method& method)
{
    Random random(seed_of(20261126));
    Outcome out;
    for (int i = 0; i < kCourses; ++i) {
        dense::Scene s;
        draw_intruder(random, s);
        WorkBudget budget(kAmple);
        world::Manoeuvre m;
        if (method.plan(s.situation(), budget, m) != world::PlanStatus::found) {
            continue;
        }
        const float stated = check_manoeuvre(s.situation(), m, Settings{}, budget).margin;
        judge(s, dense::fly_densely(s, m, dense::kPeriod), stated, out);
    }
    std::printf("[ measured ] %d plans of %d, %d stated clear, %d of these enter the capsule, %d above the truth\n",
                out.found, kCourses, out.clear, out.too_near, out.above);
    return out;
}

void expect_sound(const Outcome& out, int least_clear)
{
    EXPECT_EQ(out.too_near, 0);
    EXPECT_EQ(out.above, 0);
    EXPECT_GE(out.clear, least_clear);
}

TEST(UncertainHeight, TheGeometricPlannerGoesAroundTheWholeCapsule)
{
    const auto planner = std::make_unique<geometric::Planner>(geometric::Settings{});
    expect_sound(fly_with(*planner), kCourses / 2);
}

TEST(UncertainHeight, ReachSetsGoAroundTheWholeCapsule)
{
    reach::Settings settings;
    settings.sets = &reach::kDefaultSets;
    const auto planner = std::make_unique<reach::Planner>(settings);
    expect_sound(fly_with(*planner), kCourses / 2);
}

/// Its half-spaces are not as tall as the capsule; manoeuvres reported clear are still clear.
TEST(UncertainHeight, TheReciprocalMethodIsCheckedAgainstTheWholeCapsule)
{
    const auto planner = std::make_unique<orca::Planner>();
    expect_sound(fly_with(*planner), kCourses / 4);
}

/// Nothing may be climbed over or dived under within the capsule.
TEST(UncertainHeight, TheFallbackKeepsClearOfTheWholeCapsule)
{
    Random random(seed_of(20261127));
    Outcome out;
    for (int i = 0; i < kCourses; ++i) {
        dense::Scene s;
        draw_intruder(random, s);
        s.tracks[0].position += 3.0F * s.tracks[0].velocity;  // encounter 3 s earlier
        s.own.position += 3.0F * s.own.velocity;
        WorkBudget budget(kAmple);
        const world::Situation situation = s.situation();
        const Fallback chosen = choose_fallback(situation, world::way_of(situation), nullptr, Settings{}, budget);
        dense::DenseFlight flight(s.own, s.limits);
        flight.hold(chosen.command.cast<double>(), double(Settings{}.fallback_horizon));
        judge(s, flight, chosen.margin, out);
    }
    expect_sound(out, kCourses / 2);
}

}  // namespace
}  // namespace jink::avoid
