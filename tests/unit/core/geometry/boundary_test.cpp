// SPDX-License-Identifier: BSD-3-Clause
// Where an answer changes: contact exactly at the border, intervals of no length, things of no size, the last number
// before a limit and the first one past it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::geometry {
namespace {

const Vec3 kNoSize = Vec3::Zero();
const Vec3 kAway(3.0F, -4.0F, 12.0F);

float next_after(float x) { return std::nextafter(x, std::numeric_limits<float>::max()); }

TEST(Border, PointsAtOnePlaceAreInContactForAsLongAsTheyStay)
{
    const auto of_box = contact_interval(kNoSize, {}, {}, 0.0F, 5.0F);
    ASSERT_TRUE(of_box);
    EXPECT_EQ(of_box->first, 0.0F);
    EXPECT_EQ(of_box->last, 5.0F);
    const auto of_sphere = contact_interval({}, {}, 0.0F, 5.0F);
    ASSERT_TRUE(of_sphere);
    EXPECT_EQ(of_sphere->last, 5.0F);
    EXPECT_EQ(quick_reject(kNoSize, kNoSize, kNoSize, 0.0F), QuickReject::touches);
    EXPECT_EQ(swept_distance(kNoSize, kNoSize, kNoSize, kNoSize, kNoSize), 0.0F);
    EXPECT_EQ(point_segment_distance(kNoSize, kNoSize, kNoSize), 0.0F);
    for (const Shape& shape : {make_sphere(kNoSize, 0.0F), make_capsule(kNoSize, kNoSize, 0.0F),
                               make_cylinder(kNoSize, kNoSize, 0.0F), make_box(kNoSize, kNoSize)}) {
        WorkBudget budget(kUnitsPerQuery);
        EXPECT_EQ(swept_box_contact(kNoSize, kNoSize, kNoSize, shape, 0.0F, budget), Contact::contact)
            << int(shape.kind);
        EXPECT_EQ(swept_box_distance(kNoSize, kNoSize, kNoSize, shape, 1.0F, 0.0F, budget), 0.0F) << int(shape.kind);
    }
}

TEST(Border, PointsThatPartAtOnceMetAtTheStart)
{
    const Motion leaving{kNoSize, kAway};
    const auto of_box = contact_interval(kNoSize, {}, leaving, 0.0F, 5.0F);
    ASSERT_TRUE(of_box);
    EXPECT_EQ(of_box->first, 0.0F);
    EXPECT_EQ(of_box->last, 0.0F);
    const auto of_sphere = contact_interval({}, leaving, 0.0F, 5.0F);
    ASSERT_TRUE(of_sphere);
    EXPECT_EQ(of_sphere->first, 0.0F);
    EXPECT_EQ(of_sphere->last, 0.0F);
}

TEST(Border, PointsThatMeetAtTheEndOfTheHorizonHaveMet)
{
    // All numbers are exact: the threat arrives at 4 s.
    const Motion coming{Vec3(-12.0F, 16.0F, -48.0F), kAway};
    for (const auto& contact :
         {contact_interval(kNoSize, {}, coming, 0.0F, 4.0F), contact_interval({}, coming, 0.0F, 4.0F)}) {
        ASSERT_TRUE(contact);
        EXPECT_NEAR(contact->first, 4.0F, 1e-4F);
        EXPECT_EQ(contact->last, 4.0F);
    }
    EXPECT_FALSE(contact_interval(kNoSize, {}, coming, 0.0F, 3.9F));
    EXPECT_FALSE(contact_interval({}, coming, 0.0F, 3.9F));
}

TEST(Border, AHorizonOfNoLengthTellsContactNow)
{
    const Motion inside{Vec3(0.5F, 0.5F, 0.5F), kAway};
    const Motion outside{Vec3(2.5F, 0.0F, 0.0F), kAway};
    for (const auto& contact :
         {contact_interval(Vec3::Ones(), {}, inside, 1.0F, 0.0F), contact_interval({}, inside, 1.0F, 0.0F)}) {
        ASSERT_TRUE(contact);
        EXPECT_EQ(contact->first, 0.0F);
        EXPECT_EQ(contact->last, 0.0F);
    }
    EXPECT_FALSE(contact_interval(Vec3::Ones(), {}, outside, 1.0F, 0.0F));
    EXPECT_FALSE(contact_interval({}, outside, 1.0F, 0.0F));
    EXPECT_EQ(least_distance(Vec3::Ones(), {}, outside, 0.0F).distance, 1.5F);
}

TEST(Border, FlyingInThePlaneOfAFaceIsNoExceptionForTheClosestApproach)
{
    // x stays on the plane of the face x = 1; passes the box in y and stays 2 above it in z.
    const Motion along{Vec3(1.0F, -7.0F, 5.0F), Vec3(0.0F, 2.0F, 0.0F)};
    const Vec3 half(1.0F, 2.0F, 3.0F);
    const Approach approach = least_distance(half, {}, along, 10.0F);
    EXPECT_EQ(approach.distance, 2.0F);
    EXPECT_NEAR(approach.when, 2.5F, 1e-5F);
    const auto contact = contact_interval(half, {}, along, 2.0F, 10.0F);
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->first, 2.5F, 0.01F);
    EXPECT_NEAR(contact->last, 4.5F, 0.01F);
    EXPECT_FALSE(contact_interval(half, {}, along, 1.999F, 10.0F));
}

TEST(Border, ASpeedTooSmallToBeSquaredIsRest)
{
    const Vec3 slow(1e-30F, 0.0F, -1e-25F);
    for (const float x : {1.5F, 2.5F}) {
        const Motion creeping{Vec3(x, 0.0F, 0.0F), slow};
        const Motion still{Vec3(x, 0.0F, 0.0F), kNoSize};
        const Approach approach = least_distance(Vec3::Ones(), {}, creeping, 100.0F);
        EXPECT_EQ(approach.distance, x - 1.0F);
        EXPECT_EQ(approach.when, 0.0F);
        EXPECT_EQ(contact_interval(Vec3::Ones(), {}, creeping, 1.0F, 100.0F).has_value(), x < 2.0F);
        EXPECT_EQ(contact_interval({}, creeping, 2.0F, 100.0F).has_value(), x < 2.0F);
        if (x < 2.0F) {
            EXPECT_EQ(contact_interval(Vec3::Ones(), {}, creeping, 1.0F, 100.0F)->last, 100.0F);
            EXPECT_EQ(contact_interval({}, creeping, 2.0F, 100.0F)->last, 100.0F);
        }
        EXPECT_EQ(least_distance(Vec3::Ones(), {}, still, 100.0F).distance, approach.distance);
    }
}

TEST(Border, AxesAreValidUpToTheirTolerance)
{
    // A shear of s leaves s itself off the diagonal of axes^T * axes, and s^2 on it.
    constexpr std::array<std::pair<int, int>, 3> kPlaces{{{0, 1}, {1, 2}, {2, 0}}};
    for (const auto& [row, column] : kPlaces) {
        for (const float sign : {1.0F, -1.0F}) {
            Mat3 axes = Mat3::Identity();
            axes(row, column) = sign * 1e-3F;
            EXPECT_TRUE(is_valid(make_box(kNoSize, Vec3::Ones(), axes)));
            axes(row, column) = sign * next_after(1e-3F);
            EXPECT_FALSE(is_valid(make_box(kNoSize, Vec3::Ones(), axes)));
        }
    }
}

TEST(Border, APlaneFoundAtOnceCostsOneTurn)
{
    // Inside of the bounding sphere, so that a search is needed; the line of the centres is square to both faces.
    const Shape shape = make_box(Vec3(2.5F, 0.0F, 0.0F), Vec3::Ones());
    WorkBudget budget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_contact(Vec3::Ones(), kNoSize, kNoSize, shape, 0.0F, budget), Contact::clear);
    EXPECT_EQ(budget.spent(), units::kSolidQuery + units::kExactTurn);
    budget = WorkBudget(kUnitsPerQuery);
    const float proven = swept_box_distance(Vec3::Ones(), kNoSize, kNoSize, shape, 10.0F, 3.0F, budget);
    EXPECT_NEAR(proven, 0.5F, 1e-4F);
    EXPECT_EQ(budget.spent(), units::kSolidQuery + units::kSearchTurn);
    // Reached exactly: no more to be learnt.
    budget = WorkBudget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_distance(Vec3::Ones(), kNoSize, kNoSize, shape, proven, 0.0F, budget), proven);
    EXPECT_EQ(budget.spent(), units::kSolidQuery + units::kSearchTurn);
}

TEST(Border, TheQuickRejectLeavesTouchingToTheExactTest)
{
    const Vec3 beside(0.0F, 3.0F, 0.0F);
    const Vec3 way(4.0F, 0.0F, 0.0F);
    EXPECT_EQ(quick_reject(Vec3::Ones(), beside - way, beside + way, 2.0F), QuickReject::unclear);
    EXPECT_EQ(quick_reject(Vec3::Ones(), beside - way, beside + way, 1.999F), QuickReject::apart);
    EXPECT_EQ(quick_reject(Vec3::Ones(), beside - way, beside + way, 2.01F), QuickReject::touches);
    // On the face itself, without a radius.
    EXPECT_EQ(quick_reject(Vec3::Ones(), Vec3::UnitY() - way, Vec3::UnitY() + way, 0.0F), QuickReject::touches);
}

TEST(Border, EverySolidIsTouchedAtItsClearance)
{
    // Straight above: the distance is exactly the gap between the faces, and every solid has the same height.
    const Vec3 above(0.0F, 0.0F, 6.0F);
    const std::array<Point3, 3> flat{{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}};
    for (const Shape& shape : {make_sphere(above, 1.0F), make_box(above, Vec3::Ones()), make_hull(flat, above),
                               make_capsule(above - Vec3(0.0F, 0.0F, 0.5F), above + Vec3(0.0F, 0.0F, 0.5F), 0.5F),
                               make_cylinder(above - Vec3::UnitX(), above + Vec3::UnitX(), 1.0F)}) {
        WorkBudget budget(100'000);
        EXPECT_EQ(swept_box_contact(Vec3::Ones(), kNoSize, kNoSize, shape, 4.0F, budget), Contact::contact);
        EXPECT_EQ(swept_box_contact(Vec3::Ones(), kNoSize, kNoSize, shape, 4.001F, budget), Contact::contact);
        EXPECT_EQ(swept_box_contact(Vec3::Ones(), kNoSize, kNoSize, shape, 3.999F, budget), Contact::clear);
        EXPECT_FALSE(budget.exhausted());
    }
}

}  // namespace
}  // namespace jink::geometry
