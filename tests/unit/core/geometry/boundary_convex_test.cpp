// SPDX-License-Identifier: BSD-3-Clause
// Cost of a query with an early answer, and answers at the last number before a limit. Work is counted in iterations;
// each case states why no more are needed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/swept_box.hpp"

namespace jink::geometry {
namespace {

const Vec3 kZero = Vec3::Zero();
const Vec3 kHalf = Vec3::Ones();

float above(float x) { return std::nextafter(x, std::numeric_limits<float>::max()); }
float below(float x) { return std::nextafter(x, -std::numeric_limits<float>::max()); }

struct Cost {
    float distance = 0.0F;
    std::uint32_t turns = 0;
};

/// Of a distance search; the early answer by the bounding sphere takes no turn.
Cost search(const Shape& shape, float reach, float resolution)
{
    WorkBudget budget(kUnitsPerQuery);
    const float distance = swept_box_distance(kHalf, kZero, kZero, shape, reach, resolution, budget);
    EXPECT_EQ((budget.spent() - units::kSolidQuery) % units::kSearchTurn, 0U);
    return {distance, (budget.spent() - units::kSolidQuery) / units::kSearchTurn};
}

TEST(ConvexBorder, TheLineOfTheCentresIsLookedAlongFirst)
{
    // Perpendicular to two faces, for any axis: the first plane separates the two.
    for (const Vec3& at : {Vec3(2.5F, 0.0F, 0.0F), Vec3(0.0F, 2.5F, 0.0F), Vec3(0.0F, 0.0F, -2.5F)}) {
        WorkBudget budget(kUnitsPerQuery);
        EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, make_box(at, kHalf), 0.0F, budget), Contact::clear);
        EXPECT_EQ(budget.spent(), units::kSolidQuery + units::kExactTurn);
        EXPECT_EQ(search(make_box(at, kHalf), 10.0F, 0.0F).turns, 1U) << "proven as far as float can tell";
    }
}

TEST(ConvexBorder, ASearchEndsWithTheReachProven)
{
    // Off the line of the centres, so that the first plane proves less than the distance, 2.5 m.
    const Shape shape = make_box(Vec3(4.0F, 1.0F, 0.0F), Vec3(0.5F, 3.0F, 0.5F));
    const Cost first = search(shape, 100.0F, 3.0F);
    ASSERT_EQ(first.turns, 1U);
    ASSERT_GT(first.distance, 1.0F);
    ASSERT_LT(first.distance, 2.4F);
    ASSERT_GT(search(shape, 100.0F, 0.0F).turns, 1U);
    EXPECT_EQ(search(shape, 1.0F, 0.0F).turns, 1U);
    // Reached exactly is reached.
    EXPECT_EQ(search(shape, first.distance, 0.0F).turns, 1U);
    EXPECT_GT(search(shape, above(first.distance), 0.0F).turns, 1U);
}

TEST(ConvexBorder, AClearanceThatTheFirstPointsUndercutIsSearchedNoFurther)
{
    // libccd reports contact, and the search needs one iteration to find a point within the clearance; the proof takes
    // many.
    const Mat3 axes = Eigen::AngleAxisf(0.6F, Vec3(1.0F, 2.0F, 0.3F).normalized()).toRotationMatrix();
    const Shape shape = make_box(Vec3(2.6F, 1.5F, 0.4F), Vec3(1.0F, 0.6F, 0.4F), axes);
    ASSERT_GT(search(shape, 100.0F, 0.0F).turns, 3U);
    ASSERT_GT(search(shape, 100.0F, 0.0F).distance, 0.3F);
    WorkBudget budget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, shape, 6.0F, budget), Contact::contact);
    const std::uint32_t exact = (budget.spent() - units::kSolidQuery) / units::kExactTurn * units::kExactTurn;
    EXPECT_EQ(budget.spent() - units::kSolidQuery - exact, units::kSearchTurn);
}

TEST(ConvexBorder, CornersThatTouchAreFoundAtOnce)
{
    const Shape shape = make_box(Vec3(2.0F, 2.0F, 2.0F), kHalf);
    const Cost cost = search(shape, 100.0F, 0.0F);
    EXPECT_EQ(cost.distance, 0.0F);
    EXPECT_EQ(cost.turns, 1U) << "the first point is no distance away";
}

TEST(ConvexBorder, BeyondTheReachByItsBoundingSphereAlone)
{
    // A hull of one point has no extent, so that its sphere is as near as the point.
    const std::array<Point3, 1> point{};
    const Shape shape = make_hull(point, Vec3(0.0F, 3.5F, 0.0F));
    const detail::SweptBox box{kHalf, kZero, kZero};
    const float surely = 2.5F - box.slack(shape);
    const auto spent = [&](float reach, float expected) {
        WorkBudget budget(kUnitsPerQuery);
        EXPECT_EQ(swept_box_distance(kHalf, kZero, kZero, shape, reach, 0.0F, budget), expected);
        return budget.spent();
    };
    EXPECT_EQ(spent(surely, surely), units::kSolidQuery);
    EXPECT_EQ(spent(below(surely), below(surely)), units::kSolidQuery);
    EXPECT_GT(spent(above(surely), surely), units::kSolidQuery);
    // Never above the true distance, however little the reach is beyond it.
    for (const float reach : {above(2.5F), 2.5F + box.slack(shape), 2.6F}) {
        WorkBudget budget(kUnitsPerQuery);
        EXPECT_LE(swept_box_distance(kHalf, kZero, kZero, shape, reach, 0.0F, budget), 2.5F);
    }
    // Contact: the sphere decides beyond clearance and slack, the search at both exactly.
    const float clearance = surely;
    ASSERT_EQ(clearance + box.slack(shape), 2.5F);
    WorkBudget budget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, shape, clearance, budget), Contact::clear);
    EXPECT_GT(budget.spent(), units::kSolidQuery);
    budget = WorkBudget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, shape, below(clearance), budget), Contact::clear);
    EXPECT_EQ(budget.spent(), units::kSolidQuery);
}

TEST(ConvexBorder, SpheresAndCapsulesAreTouchedUpToTheirSlack)
{
    const detail::SweptBox box{kHalf, kZero, kZero};
    for (const Shape& shape : {make_sphere(Vec3(0.0F, 0.0F, 4.0F), 1.0F),
                               make_capsule(Vec3(-1.0F, 0.0F, 4.0F), Vec3(1.0F, 0.0F, 4.0F), 1.0F)}) {
        ASSERT_EQ(box.closed_form_distance(shape), 2.0F);
        const float slack = box.slack(shape);
        const float clearance = 2.0F - slack;
        ASSERT_EQ(clearance + slack, 2.0F);
        WorkBudget budget(1'000);
        EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, shape, clearance, budget), Contact::contact);
        EXPECT_EQ(swept_box_contact(kHalf, kZero, kZero, shape, below(clearance), budget), Contact::clear);
        EXPECT_EQ(swept_box_distance(kHalf, kZero, kZero, shape, 10.0F, 0.0F, budget), 2.0F - slack);
    }
}

TEST(ConvexBorder, TwoPointsAtOnePlaceAreNoWork)
{
    WorkBudget budget(kUnitsPerQuery);
    EXPECT_EQ(swept_box_contact(kZero, kZero, kZero, make_box(kZero, kZero), 0.0F, budget), Contact::contact);
    EXPECT_LE(budget.spent(), units::kSolidQuery + 4 * units::kExactTurn + units::kSearchTurn);
}

TEST(ConvexBorder, TheSearchEndsAtItsLimits)
{
    // The nearest points are two corners, (2, 3, 6) apart, which the first turn finds; its plane, across the line of
    // the centres, proves less than their distance of 7 m.
    const Shape shape = make_box(Vec3(3.5F, 7.0F, 7.5F), Vec3(0.5F, 3.0F, 0.5F));
    const detail::SweptBox box{kHalf, kZero, kZero};
    const float slack = box.slack(shape);
    const auto turns = [&](float near, float resolution) {
        WorkBudget budget(kUnitsPerQuery);
        const float proven = detail::proven_distance(box, shape, {near, 100.0F, resolution, 128}, budget);
        EXPECT_LE(proven, 7.0F);
        return budget.spent() / units::kSearchTurn;
    };
    WorkBudget budget(kUnitsPerQuery);
    const float proven = detail::proven_distance(box, shape, {10.0F, 100.0F, 0.0F, 128}, budget);
    ASSERT_EQ(budget.spent(), units::kSearchTurn);
    ASSERT_LT(proven, 6.9F);
    ASSERT_GT(turns(0.0F, 0.0F), 1U);
    // Near enough, up to the rounding that float needs.
    ASSERT_EQ((7.0F - slack) + slack, 7.0F);
    EXPECT_EQ(turns(7.0F, 0.0F), 1U);
    EXPECT_EQ(turns(7.0F - slack, 0.0F), 1U);
    EXPECT_GT(turns(below(7.0F - slack), 0.0F), 1U);
    // Known well enough.
    const float known = 7.0F - proven;
    const float resolution = known - 2.0F * slack;
    ASSERT_EQ(resolution + 2.0F * slack, known);
    EXPECT_EQ(turns(0.0F, resolution), 1U);
    EXPECT_GT(turns(0.0F, below(below(below(resolution)))), 1U);
}

TEST(ConvexBorder, LibccdGetsHalfOfTheCallsAndNoMore)
{
    // Integer coordinates: faces, edges and corners in contact, for which libccd's loop is longest. Another test
    // measures the distance search after it.
    std::uint32_t most = 0;
    for (std::uint64_t seed = 1; seed <= 2'000; ++seed) {
        Random random(seed);
        const auto whole = [&](std::uint64_t side) {
            const auto any = [&] { return static_cast<float>(random.below(2 * side + 1)) - static_cast<float>(side); };
            return Vec3(any(), any(), any());
        };
        const Vec3 half = whole(2).cwiseAbs();
        const Vec3 from = whole(3);
        const Vec3 to = from + static_cast<float>(random.below(2)) * whole(6);
        const Vec3 at = from + whole(5);
        const Shape shape = make_cylinder(at, at + Vec3(0.0F, 0.0F, 2.0F), static_cast<float>(random.below(3)));
        const detail::SweptBox box{half, from, to};
        const float clearance = static_cast<float>(random.below(3));
        WorkBudget budget(kUnitsPerQuery);
        if (swept_box_contact(half, from, to, shape, clearance, budget) == Contact::contact) {
            WorkBudget search(kUnitsPerQuery);
            const detail::SearchLimits limits{clearance, clearance + box.slack(shape), 0.0F, 128};
            EXPECT_LE(detail::proven_distance(box, shape, limits, search), clearance);
            const std::uint32_t exact = budget.spent() - units::kSolidQuery - search.spent();
            ASSERT_EQ(exact % units::kExactTurn, 0U) << "seed " << seed;
            most = std::max(most, exact / units::kExactTurn);
        }
    }
    EXPECT_EQ(most, kSupportCallsPerQuery / 4) << "two calls a turn";
}

TEST(ConvexBorder, SearchesEndByThemselves)
{
    // Grazing, distant or thin pairs never need all permitted calls: iterations without progress are counted.
    std::uint32_t most = 0;
    for (std::uint64_t seed = 1; seed <= 3'000; ++seed) {
        Random random(seed);
        const auto any = [&](float side) {
            return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
        };
        const float far = std::pow(10.0F, random.uniform(-1.0F, 3.0F));
        const Vec3 half = any(1.0F).cwiseAbs();
        const Vec3 from = any(far);
        const Vec3 to = from + any(far);
        const Vec3 at = from + random.uniform() * (to - from) + any(4.0F);
        const Mat3 axes = Eigen::AngleAxisf(random.uniform(0.0F, 3.0F), any(1.0F).normalized()).toRotationMatrix();
        const Vec3 size = any(2.0F).cwiseAbs();
        for (const Shape& shape : {make_box(at, size, axes), make_cylinder(at, at + any(3.0F), size.x()),
                                   make_cylinder(at, at + 1e-3F * any(3.0F), size.x())}) {
            WorkBudget budget(kUnitsPerQuery);
            ASSERT_GE(swept_box_distance(half, from, to, shape, 1e4F, 0.0F, budget), 0.0F);
            most = std::max(most, (budget.spent() - units::kSolidQuery) / units::kSearchTurn);
        }
    }
    EXPECT_GT(most, 8U) << "too easy to tell";
    EXPECT_LE(2 * most, 106U) << "convex.hpp";
}

}  // namespace
}  // namespace jink::geometry
