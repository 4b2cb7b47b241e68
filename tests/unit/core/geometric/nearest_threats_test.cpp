// SPDX-License-Identifier: BSD-3-Clause
// Settings::moving_nearest: which moving threats are the nearest, case by case. Only those count for closeness, so that
// each candidate's closeness equals the value with them alone.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Along x at 5 m/s from (0, 0, 50), as Scene's leg is flown: static relative to a straight flight.
const Vec3 kAlongside(5.0F, 0.0F, 0.0F);

/// Unchecked curves, so that all of them are assessed.
struct Assessed : Scene {
    Assessed()
    {
        settings.evaluate_all = settings.all_terms = false;
        settings.check_acceleration = settings.verify_flight = false;
        problem.main = kNoThreat;
        threats.clear();
    }
    std::vector<float> closeness()
    {
        static_cast<void>(run());
        std::vector<float> all;
        for (const Candidate& c : result.candidates) {
            all.push_back(c.terms.closeness);
        }
        return all;
    }
};

std::vector<float> closeness_of(const std::vector<Sphere>& threats)
{
    Assessed alone;
    alone.threats = threats;
    return alone.closeness();
}

/// `threats` with `nearest` first, and in the reverse order.
void expect_nearest(const Sphere& nearest, const Sphere& other, const std::string& what)
{
    const std::vector<float> expected = closeness_of({nearest});
    ASSERT_FALSE(expected.empty());
    ASSERT_NE(expected, closeness_of({other})) << what;
    Assessed scene;
    scene.settings.moving_nearest = 1;
    scene.threats = {nearest, other};
    EXPECT_EQ(scene.closeness(), expected) << what << ", told first";
    scene.threats = {other, nearest};
    EXPECT_EQ(scene.closeness(), expected) << what << ", told last";
}

TEST(NearestThreats, WhatComesNearerIsNearer)
{
    const Sphere alongside{{Vec3(0.0F, 20.0F, 50.0F), kAlongside}, 1.0F};
    expect_nearest({{Vec3(0.0F, 30.0F, 50.0F), Vec3(5.0F, -5.0F, 0.0F)}, 1.0F}, alongside, "after 6 s");
    expect_nearest(alongside, {{Vec3(0.0F, 30.0F, 80.0F), Vec3(5.0F, -5.0F, 0.0F)}, 1.0F}, "30 m above");
    expect_nearest(alongside, {{Vec3(0.0F, 22.0F, 50.0F), kAlongside}, 1.0F}, "by 2 m");
}

TEST(NearestThreats, NeitherWhatWasNearNorWhatWillBeCounts)
{
    const Sphere alongside{{Vec3(0.0F, 35.0F, 50.0F), kAlongside}, 1.0F};
    // It was on the leg 8 s ago.
    expect_nearest(alongside, {{Vec3(0.0F, 40.0F, 50.0F), Vec3(5.0F, 5.0F, 0.0F)}, 1.0F}, "goes away");
    // It is on the line of the leg in 200 s, when any candidate has long ended.
    expect_nearest(alongside, {{Vec3(0.0F, 1000.0F, 50.0F), Vec3(5.0F, -5.0F, 0.0F)}, 1.0F}, "comes late");
}

TEST(NearestThreats, SurfacesAreComparedAsLargeAsTheyAreThen)
{
    const Sphere alongside{{Vec3(0.0F, 16.0F, 50.0F), kAlongside}, 1.0F};
    // All of these have their centre 20 m above the vehicle after 6 s.
    const geometry::Motion above{Vec3(0.0F, 30.0F, 70.0F), Vec3(5.0F, -5.0F, 0.0F)};
    expect_nearest(alongside, {above, 1.0F}, "19 m");
    expect_nearest({above, 8.0F}, alongside, "12 m, being large");
    expect_nearest({above, 1.0F, 1.0F}, alongside, "13 m, growing");
    expect_nearest({above, 1.0F, 0.0F, 0.5F}, alongside, "10 m, growing faster and faster");
}

TEST(NearestThreats, WhatStandsTakesNoPlace)
{
    const Sphere beside{{Vec3(10.0F, 12.0F, 50.0F), Vec3::Zero()}, 1.0F};
    const Sphere near{{Vec3(0.0F, 20.0F, 50.0F), kAlongside}, 1.0F};
    const Sphere far{{Vec3(0.0F, -30.0F, 50.0F), kAlongside}, 1.0F};
    Assessed scene;
    scene.settings.moving_nearest = 1;
    for (const std::vector<Sphere>& threats : {std::vector<Sphere>{beside, near, far}, {far, near, beside}}) {
        scene.threats = threats;
        EXPECT_EQ(scene.closeness(), closeness_of({near}));
    }
}

TEST(NearestThreats, TheMainThreatIsAmongThemWhereverItIs)
{
    const Sphere near{{Vec3(0.0F, 20.0F, 50.0F), kAlongside}, 1.0F};
    const Sphere nearer{{Vec3(0.0F, -15.0F, 50.0F), kAlongside}, 1.0F};
    const Sphere main{{Vec3(0.0F, 60.0F, 50.0F), kAlongside}, 1.0F};
    Assessed scene;
    scene.threats = {near, main, nearer};
    scene.problem.main = 1;
    scene.settings.moving_nearest = 1;
    EXPECT_EQ(scene.closeness(), closeness_of({main}));
    scene.settings.moving_nearest = 2;
    EXPECT_EQ(scene.closeness(), closeness_of({main, nearer}));
    scene.settings.moving_nearest = 3;
    EXPECT_EQ(scene.closeness(), closeness_of({near, main, nearer}));
}

TEST(NearestThreats, OfEquallyNearOnesTheFirstIsNearer)
{
    const Sphere left{{Vec3(0.0F, 20.0F, 50.0F), kAlongside}, 1.0F};
    const Sphere right{{Vec3(0.0F, -20.0F, 50.0F), kAlongside}, 1.0F};
    ASSERT_NE(closeness_of({left}), closeness_of({right}));
    Assessed scene;
    scene.settings.moving_nearest = 1;
    scene.threats = {left, right};
    EXPECT_EQ(scene.closeness(), closeness_of({left}));
    scene.threats = {right, left};
    EXPECT_EQ(scene.closeness(), closeness_of({right}));
}

/// A threat that is checked later is reported later only if it is checked separately: with every candidate evaluated
/// the first cause by index is reported, near or far.
TEST(NearestThreats, TheFirstCauseIsReportedWhereEveryCandidateIsEvaluated)
{
    Scene scene;
    scene.settings.check_acceleration = scene.settings.verify_flight = false;
    scene.settings.moving_nearest = 1;
    scene.problem.main = kNoThreat;
    const Vec3 slow(0.01F, 0.0F, 0.0F);
    // One blocks all candidates; one stays at least a metre from the leg and blocks the upward candidates.
    scene.threats = {{{Vec3(20.0F, 0.0F, 75.0F), slow}, 24.0F}, {{Vec3(5.0F, 0.0F, 50.0F), slow}, 2.0F}};
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    std::size_t up = 0;
    for (const Candidate& c : scene.result.candidates) {
        EXPECT_EQ(c.status, CandidateStatus::hits_moving);
        const bool goes_up = c.shape.offset * std::sin(c.shape.plane) > 2.0F;
        up += goes_up ? 1U : 0U;
        if (goes_up) {
            EXPECT_EQ(c.hit.index, 0U) << c.shape.offset;
        }
    }
    EXPECT_GT(up, 0U);
}

}  // namespace
}  // namespace jink::geometric
