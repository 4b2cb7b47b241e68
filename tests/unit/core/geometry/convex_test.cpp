// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/convex.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include <Eigen/Geometry>

namespace jink::geometry {
namespace {

const Vec3 kConvexHalf(1.0F, 1.0F, 1.0F);
const Vec3 kStill = Vec3::Zero();
const std::array<Point3, 4> kWedge{{{0, -1, -1}, {0, 1, -1}, {2, 0, -1}, {0, 0, 1}}};

/// One of each kind, all about 1 m in size.
std::array<Shape, 5> one_of_each(const Vec3& centre)
{
    return {make_sphere(centre, 1.0F), make_box(centre, Vec3::Ones()),
            make_capsule(centre - Vec3::UnitX(), centre + Vec3::UnitX(), 0.5F),
            make_cylinder(centre - Vec3::UnitZ(), centre + Vec3::UnitZ(), 1.0F), make_hull(kWedge, centre)};
}

Contact contact(const Vec3& from, const Vec3& to, const Shape& shape, float clearance = 0.0F)
{
    WorkBudget budget(kUnitsPerQuery);
    return swept_box_contact(kConvexHalf, from, to, shape, clearance, budget);
}

float distance(const Vec3& from, const Vec3& to, const Shape& shape, float reach = 100.0F, float resolution = 1e-4F)
{
    WorkBudget budget(kUnitsPerQuery);
    return swept_box_distance(kConvexHalf, from, to, shape, reach, resolution, budget);
}

TEST(SweptBoxContact, WithEachKindOnItsWayAndBesideIt)
{
    const Vec3 from(-10.0F, 0.0F, 0.0F);
    const Vec3 to(10.0F, 0.0F, 0.0F);
    for (const Shape& shape : one_of_each({3.0F, 0.5F, 0.0F})) {
        EXPECT_EQ(contact(from, to, shape), Contact::contact) << int(shape.kind);
    }
    for (const Shape& shape : one_of_each({3.0F, 4.0F, 0.0F})) {
        EXPECT_EQ(contact(from, to, shape), Contact::clear) << int(shape.kind);
        EXPECT_EQ(contact(from, to, shape, 3.0F), Contact::contact) << int(shape.kind);
    }
    // Short of it, and past it.
    for (const Shape& shape : one_of_each({13.5F, 0.0F, 0.0F})) {
        EXPECT_EQ(contact(from, to, shape), Contact::clear) << int(shape.kind);
        EXPECT_EQ(contact(-from, -to, shape), Contact::clear) << int(shape.kind);
    }
}

TEST(SweptBoxContact, ASweptBoxIsNotTheBoxAroundItsWay)
{
    // A diagonal path leaves two corners of its bounding box free.
    const Shape post = make_cylinder({8.0F, -8.0F, -5.0F}, {8.0F, -8.0F, 5.0F}, 1.0F);
    EXPECT_EQ(contact({-10.0F, -10.0F, 0.0F}, {10.0F, 10.0F, 0.0F}, post), Contact::clear);
    EXPECT_NEAR(distance({-10.0F, -10.0F, 0.0F}, {10.0F, 10.0F, 0.0F}, post), 8.8995F, 1e-3F);
}

TEST(SweptBoxContact, TouchingCounts)
{
    EXPECT_EQ(contact(kStill, kStill, make_box({2.0F, 0.0F, 0.0F}, Vec3::Ones())), Contact::contact);
    EXPECT_EQ(contact(kStill, kStill, make_box({2.001F, 0.0F, 0.0F}, Vec3::Ones())), Contact::clear);
    EXPECT_EQ(contact(kStill, kStill, make_box({2.5F, 0.0F, 0.0F}, Vec3::Ones()), 0.5F), Contact::contact);
    EXPECT_EQ(contact(kStill, kStill, make_sphere({3.0F, 0.0F, 0.0F}, 2.0F)), Contact::contact);
    // Corner to corner, edge to edge.
    EXPECT_EQ(contact(kStill, kStill, make_box({2.0F, 2.0F, 2.0F}, Vec3::Ones())), Contact::contact);
    EXPECT_EQ(contact(kStill, kStill, make_box({2.0F, 2.0F, 0.0F}, Vec3::Ones())), Contact::contact);
}

TEST(SweptBoxContact, OfThingsWithoutSize)
{
    const std::array<Point3, 1> point{};
    WorkBudget budget(10'000);
    EXPECT_EQ(swept_box_contact(kStill, kStill, kStill, make_hull(point, kStill), 0.0F, budget), Contact::contact);
    EXPECT_EQ(swept_box_contact(kStill, kStill, kStill, make_hull(point, Vec3::UnitX()), 0.0F, budget), Contact::clear);
    EXPECT_EQ(swept_box_contact(kStill, kStill, kStill, make_hull(point, Vec3::UnitX()), 1.0F, budget),
              Contact::contact);
    EXPECT_EQ(swept_box_contact(kStill, -Vec3::UnitX(), Vec3::UnitX(), make_hull(point, kStill), 0.0F, budget),
              Contact::contact);
    EXPECT_EQ(swept_box_contact(kStill, kStill, kStill, make_box(kStill, kStill), 0.0F, budget), Contact::contact);
    EXPECT_FALSE(budget.exhausted());
}

TEST(SweptBoxContact, TheSameAtMillimetresAndAtAKilometre)
{
    for (const float scale : {1e-3F, 1.0F, 1e3F}) {
        const Mat3 axes = Eigen::AngleAxisf(0.7F, Vec3(1.0F, 2.0F, 3.0F).normalized()).toRotationMatrix();
        const Vec3 at = scale * Vec3(3.0F, 0.3F, -0.2F);
        const Shape shape = make_box(at, scale * Vec3(1.0F, 0.5F, 0.2F), axes);
        const Vec3 half = scale * kConvexHalf;
        WorkBudget budget(10'000);
        const float apart = swept_box_distance(half, kStill, kStill, shape, 100.0F * scale, 0.0F, budget);
        EXPECT_GT(apart, 0.5F * scale);
        EXPECT_EQ(swept_box_contact(half, kStill, kStill, shape, apart * 0.9999F, budget), Contact::clear);
        EXPECT_EQ(swept_box_contact(half, kStill, kStill, shape, apart * 1.0001F, budget), Contact::contact);
    }
}

TEST(SweptBoxContact, ABudgetTooSmallIsSpentAndNeverClear)
{
    // Slanted and close, so that no first direction parts them.
    const Mat3 axes = Eigen::AngleAxisf(0.6F, Vec3(1.0F, 1.0F, 0.3F).normalized()).toRotationMatrix();
    const Shape shape = make_box({1.7F, 1.5F, 1.1F}, {1.0F, 0.6F, 0.4F}, axes);
    WorkBudget ample(kUnitsPerQuery);
    const Contact full = swept_box_contact(kConvexHalf, kStill, kStill, shape, 0.0F, ample);
    ASSERT_GE(ample.spent(), units::kSolidQuery + 2 * units::kExactTurn);
    for (std::uint32_t units = 0; units < ample.spent(); ++units) {
        WorkBudget budget(units);
        EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, shape, 0.0F, budget), Contact::budget_spent) << units;
        EXPECT_TRUE(budget.exhausted());
        EXPECT_LE(budget.spent(), units);
    }
    WorkBudget exact(ample.spent());
    EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, shape, 0.0F, exact), full);
    EXPECT_FALSE(exact.exhausted());
}

TEST(SweptBoxContact, ClosedFormsTakeTheirWeight)
{
    const std::array<std::pair<Shape, std::uint32_t>, 2> weighed{
        {{make_sphere({3.0F, 0.0F, 0.0F}, 1.0F), units::kSphereQuery},
         {make_capsule({3.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}, 1.0F), units::kCapsuleQuery}}};
    for (const auto& [shape, weight] : weighed) {
        WorkBudget less(weight - 1);
        EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, shape, 0.0F, less), Contact::budget_spent);
        less = WorkBudget(weight - 1);
        EXPECT_EQ(swept_box_distance(kConvexHalf, kStill, kStill, shape, 10.0F, 0.01F, less), 0.0F);
        WorkBudget exact(weight);
        EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, shape, 0.0F, exact), Contact::clear);
        EXPECT_EQ(exact.spent(), weight);
        EXPECT_FALSE(exact.exhausted());
    }
}

TEST(SweptBoxContact, BeyondTheBoundingSphereNoSearchIsPaidFor)
{
    const Shape far = make_box({9.0F, 0.0F, 0.0F}, Vec3::Ones());
    WorkBudget exact(2 * units::kSolidQuery);
    EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, far, 1.0F, exact), Contact::clear);
    EXPECT_EQ(swept_box_distance(kConvexHalf, kStill, kStill, far, 5.0F, 0.01F, exact), 5.0F);
    EXPECT_FALSE(exact.exhausted());
    EXPECT_EQ(exact.left(), 0U);
    WorkBudget less(units::kSolidQuery - 1);
    EXPECT_EQ(swept_box_contact(kConvexHalf, kStill, kStill, far, 1.0F, less), Contact::budget_spent);
    less = WorkBudget(units::kSolidQuery - 1);
    EXPECT_EQ(swept_box_distance(kConvexHalf, kStill, kStill, far, 5.0F, 0.01F, less), 0.0F);
}

TEST(SweptBoxContact, AHullPaysForItsVertices)
{
    std::array<Point3, 16> many;
    for (std::size_t i = 0; i < many.size(); ++i) {
        many[i] = kWedge[i % kWedge.size()];
    }
    const auto spent = [](const Shape& shape) {
        WorkBudget budget(kUnitsPerQuery);
        EXPECT_GT(swept_box_distance(kConvexHalf, kStill, kStill, shape, 10.0F, 0.0F, budget), 0.0F);
        return budget.spent() - units::kSolidQuery;
    };
    const Vec3 at(1.5F, 1.7F, 0.4F);
    const std::uint32_t few = spent(make_hull(kWedge, at));
    EXPECT_EQ(few % (units::kSearchTurn + 1), 0U);
    EXPECT_EQ(spent(make_hull(many, at)), few / (units::kSearchTurn + 1) * (units::kSearchTurn + 4))
        << "the same search";
}

TEST(SweptBoxDistance, OfEachKind)
{
    const Vec3 centre(0.0F, 7.0F, 0.0F);
    const auto shapes = one_of_each(centre);
    const std::array<float, 5> expected{5.0F, 5.0F, 5.5F, 5.0F, 5.0F};
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const float found = distance(kStill, kStill, shapes[i]);
        EXPECT_LE(found, expected[i]) << i;
        EXPECT_NEAR(found, expected[i], 3e-4F) << i;
    }
}

TEST(SweptBoxDistance, IsZeroInContactAndCappedAtReach)
{
    for (const Shape& shape : one_of_each({0.5F, 0.0F, 0.0F})) {
        EXPECT_EQ(distance(kStill, kStill, shape), 0.0F) << int(shape.kind);
    }
    for (const Shape& shape : one_of_each({8.0F, 0.0F, 0.0F})) {
        EXPECT_EQ(distance(kStill, kStill, shape, 2.0F), 2.0F) << int(shape.kind);
        EXPECT_EQ(distance(kStill, kStill, shape, 0.0F), 0.0F) << int(shape.kind);
    }
}

TEST(SweptBoxDistance, IsZeroWhenTheBudgetRunsOut)
{
    const Shape shape = make_cylinder({2.5F, -1.0F, 0.3F}, {2.0F, 2.0F, 3.0F}, 0.7F);
    WorkBudget ample(kUnitsPerQuery);
    ASSERT_GT(swept_box_distance(kConvexHalf, kStill, Vec3::UnitZ(), shape, 10.0F, 0.0F, ample), 0.0F);
    for (std::uint32_t units = 0; units < ample.spent(); ++units) {
        WorkBudget budget(units);
        EXPECT_EQ(swept_box_distance(kConvexHalf, kStill, Vec3::UnitZ(), shape, 10.0F, 0.0F, budget), 0.0F);
        EXPECT_TRUE(budget.exhausted());
    }
}

TEST(SweptBoxDistance, AHullNeedNotHoldItsOwnCentre)
{
    const std::array<Point3, 2> far{{{10, 0, -1}, {10, 0, 1}}};
    EXPECT_NEAR(distance(kStill, kStill, make_hull(far, kStill)), 9.0F, 1e-3F);
    EXPECT_EQ(contact(kStill, kStill, make_hull(far, kStill)), Contact::clear);
}

}  // namespace
}  // namespace jink::geometry
