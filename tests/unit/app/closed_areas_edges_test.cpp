// SPDX-License-Identifier: BSD-3-Clause
// Closed areas and their upload at the limits: stamps, ends, growth, the origin, differences between sets.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/constraint_upload.hpp"
#include "firmware/app/constraints.hpp"
#include "tests/numbers.hpp"

namespace jink::app {
namespace {

using link::ConstraintPart;
using link::ConstraintResult;

constexpr TimePoint kReported{500'000'000};
constexpr link::GlobalPosition kArea{473977420, 85465940, 400'000};

Constraint closed_at(float east, float north, float radius = 10.0F, const world::Vec2& velocity = world::Vec2::Zero())
{
    Constraint constraint;
    constraint.cylinder = {{{east, north}, radius}, velocity, 20.0F, 100.0F, 5.0F};
    constraint.stamp = kReported;
    return constraint;
}

class ClosedAreas : public ::testing::Test {
protected:
    void tell(const std::vector<Constraint>& constraints, const std::optional<link::GlobalPosition>& origin = {},
              const Vec3& own = Vec3::Zero())
    {
        table.tell(constraints, origin, own, kReported);
    }
    ConstraintTable table;
};

TEST_F(ClosedAreas, AStampMayLieHalfASecondAhead)
{
    Constraint c = closed_at(0, 0);
    c.stamp = {kReported.us + 500'000};
    EXPECT_TRUE(ConstraintTable::accepts(c, kReported));
    c.stamp.us += 1;
    EXPECT_FALSE(ConstraintTable::accepts(c, kReported));
    c.stamp = kReported;
    c.cylinder.circle.radius = 0.0F;
    EXPECT_FALSE(ConstraintTable::accepts(c, kReported));
}

TEST_F(ClosedAreas, OneStampedAheadIsNotMovedBack)
{
    Constraint c = closed_at(0, 0, 10.0F, {100.0F, 0.0F});
    c.stamp = {kReported.us + 500'000};
    tell({c});
    ASSERT_EQ(table.cylinders().size(), 1U);
    EXPECT_EQ(table.cylinders()[0].circle.centre.x(), 0.0F);
}

TEST_F(ClosedAreas, CountsToTheMicrosecondOfItsEnd)
{
    Constraint c = closed_at(0, 0);
    c.ends = {kReported.us + 1'000'000};
    tell({c});
    table.place({}, {kReported.us + 1'000'000});
    EXPECT_EQ(table.cylinders().size(), 1U);
    table.place({}, {kReported.us + 1'000'001});
    EXPECT_TRUE(table.cylinders().empty());
    EXPECT_FALSE(table.empty()) << "told, and over";
}

TEST_F(ClosedAreas, AllOfItsBodyStaysAsReported)
{
    for (const std::optional<link::GlobalPosition>& origin : {std::optional<link::GlobalPosition>(), {kArea}}) {
        tell({closed_at(30, -40)}, origin);
        const world::Cylinder& b = table.cylinders()[0];
        EXPECT_EQ(b.circle.centre, world::Vec2(30, -40)) << "in the local frame, wherever that lies";
        EXPECT_EQ(b.circle.radius, 10.0F);
        EXPECT_EQ(b.bottom, 20.0F);
        EXPECT_EQ(b.top, 100.0F);
        EXPECT_EQ(b.margin, 5.0F);
    }
}

/// Heights and the larger radius of a map that is 0.15 % off: 111.3 m north on our sphere.
TEST_F(ClosedAreas, OnTheGlobeItIsPlacedAboutTheOrigin)
{
    Constraint c = closed_at(3, 4, 50.0F);
    c.about = kArea;
    link::GlobalPosition origin = kArea;
    origin.lat -= 10'000;
    origin.alt -= 30'000;
    tell({c}, origin);
    ASSERT_EQ(table.cylinders().size(), 1U);
    const world::Cylinder& b = table.cylinders()[0];
    EXPECT_NEAR(b.circle.centre.x(), 3.0F, 1e-3F);
    EXPECT_NEAR(b.circle.centre.y(), 111.319F + 4.0F, 1e-2F);
    EXPECT_NEAR(b.bottom, 50.0F, 1e-3F);
    EXPECT_NEAR(b.top, 130.0F, 1e-3F);
    EXPECT_NEAR(b.circle.radius, 50.0F + 1.5e-3F * 111.319F, 1e-3F);
    EXPECT_FALSE(table.lacks_origin());
    table.place({}, kReported);
    EXPECT_TRUE(table.lacks_origin());
    EXPECT_TRUE(table.cylinders().empty());
    // One in the local frame needs none.
    tell({closed_at(0, 0)});
    EXPECT_FALSE(table.lacks_origin());
    EXPECT_EQ(table.cylinders().size(), 1U);
}

TEST_F(ClosedAreas, OneWithoutAnOriginDoesNotHideTheOthers)
{
    Constraint c = closed_at(3, 4);
    c.about = kArea;
    tell({c, closed_at(7, 8)});
    ASSERT_EQ(table.cylinders().size(), 1U);
    EXPECT_EQ(table.cylinders()[0].circle.centre.x(), 7.0F);
    EXPECT_TRUE(table.lacks_origin());
    c.ends = kReported - 1.0F;
    tell({c});
    EXPECT_FALSE(table.lacks_origin()) << "one that is over needs none";
}

/// It grows at its own speed, from kAhead before it is old.
TEST_F(ClosedAreas, GrowsFromItsAgeOnAndNotBefore)
{
    tell({closed_at(0, 0, 10.0F, {0.0F, 2.0F})});
    const auto radius_at = [&](Seconds age) {
        table.place({}, kReported + age);
        return table.cylinders()[0].circle.radius;
    };
    EXPECT_EQ(radius_at(0.0F), 10.0F);
    EXPECT_EQ(radius_at(49.0F), 10.0F);
    EXPECT_NEAR(radius_at(51.0F), 12.0F, 1e-2F);
    EXPECT_NEAR(radius_at(60.0F), 30.0F, 1e-2F) << "as far as it may be 10 s on";
    EXPECT_EQ(table.diagnostics().grown, 2U);
}

TEST_F(ClosedAreas, WhatIsRefusedIsNoReasonToMerge)
{
    std::vector<Constraint> reported(kMaxCylinders, closed_at(0, 0));
    for (std::size_t i = 0; i < reported.size(); ++i) {
        reported[i].cylinder.circle.centre.x() = 100.0F * static_cast<float>(i);
    }
    reported.push_back(closed_at(0, 0, -1.0F));
    tell(reported);
    EXPECT_EQ(table.diagnostics().merged, 0U);
    EXPECT_EQ(table.diagnostics().refused, 1U);
    EXPECT_EQ(table.cylinders().size(), kMaxCylinders);
    reported.front().cylinder.circle.radius = kNan;  // the first is invalid: the merged area is placed about the next
    reported.back() = closed_at(5000, 0);
    reported.push_back(closed_at(5050, 0));
    tell(reported);
    EXPECT_EQ(table.diagnostics().merged, 1U);
    EXPECT_EQ(table.diagnostics().refused, 2U);
    EXPECT_EQ(table.cylinders().size(), kMaxCylinders);
}

/// Areas far from the vehicle are merged first; isolated areas are kept.
TEST_F(ClosedAreas, WhatIsFarFromTheVehicleIsMerged)
{
    enum class Reported : std::uint8_t { locally, locally_with_an_origin, on_the_globe };
    for (const Reported how : {Reported::locally, Reported::locally_with_an_origin, Reported::on_the_globe}) {
        SCOPED_TRACE(static_cast<int>(how));
        std::vector<Constraint> reported;
        for (std::size_t i = 0; i < kMaxCylinders + 1; ++i) {
            reported.push_back(closed_at(200.0F * static_cast<float>(i), 0.0F));
        }
        std::optional<link::GlobalPosition> origin;
        float south = 0.0F;
        if (how == Reported::locally_with_an_origin) {
            origin = kArea;
        } else if (how == Reported::on_the_globe) {
            origin = kArea;
            origin->lat -= 50'000;  // 557 m
            south = 556.6F;
            for (Constraint& c : reported) {
                c.about = kArea;
            }
        }
        const float last = 200.0F * static_cast<float>(kMaxCylinders);
        const auto holds = [&](float east, float radius) {
            const auto cylinders = table.cylinders();
            return std::any_of(cylinders.begin(), cylinders.end(), [&](const world::Cylinder& b) {
                return std::abs(b.circle.centre.x() - east) < 1.0F && std::abs(b.circle.radius - radius) < 2.0F;
            });
        };
        tell(reported, origin, Vec3(0.0F, south, 0.0F));
        EXPECT_EQ(table.cylinders().size(), kMaxCylinders);
        EXPECT_TRUE(holds(0.0F, 10.0F)) << "near the vehicle";
        EXPECT_FALSE(holds(last, 10.0F));
        tell(reported, origin, Vec3(last, south, 0.0F));
        EXPECT_TRUE(holds(last, 10.0F));
        EXPECT_FALSE(holds(0.0F, 10.0F));
    }
}

TEST_F(ClosedAreas, TooManyOnTheGlobeWaitForAnOriginToo)
{
    std::vector<Constraint> reported;
    for (std::size_t i = 0; i < kMaxCylinders + 1; ++i) {
        reported.push_back(closed_at(200.0F * static_cast<float>(i), 0.0F));
        reported.back().about = kArea;
    }
    tell(reported);
    EXPECT_TRUE(table.lacks_origin());
    EXPECT_TRUE(table.cylinders().empty());
    table.place(kArea, kReported);
    EXPECT_EQ(table.cylinders().size(), kMaxCylinders);
    EXPECT_EQ(table.diagnostics().merged, 1U);
}

/// One stamped ahead of us is neither moved back nor made smaller before it is merged.
TEST_F(ClosedAreas, WhatIsMergedIsNoYoungerThanNow)
{
    std::vector<Constraint> reported;
    for (std::size_t i = 0; i < kMaxCylinders + 1; ++i) {
        reported.push_back(closed_at(2000.0F * static_cast<float>(i), 0.0F, 30.0F, {0.0F, 50.0F}));
        reported.back().stamp = kReported + 0.4F;
    }
    tell(reported);
    const auto cylinders = table.cylinders();
    const auto first = std::find_if(cylinders.begin(), cylinders.end(),
                                    [](const world::Cylinder& b) { return std::abs(b.circle.centre.x()) < 1.0F; });
    ASSERT_NE(first, cylinders.end());
    // Static from now on, and contains its present and its later positions.
    EXPECT_LE((first->circle.centre - world::Vec2(0, 0)).norm() + 30.0F, first->circle.radius + 0.1F);
}

/// A merged area ends with the last of its parts, and grows at twice the greatest speed once outdated.
TEST_F(ClosedAreas, TheMergedEndWithTheLastAndGrowTwiceAsFastAsTheFastest)
{
    std::vector<Constraint> reported;
    for (std::size_t i = 0; i < kMaxCylinders + 1; ++i) {
        reported.push_back(closed_at(200.0F * static_cast<float>(i), 0.0F, 10.0F, {0.0F, i == 3 ? 3.0F : 1.0F}));
        reported.back().ends = kReported + (i == 5 ? 90.0F : 80.0F);
    }
    tell(reported);
    ASSERT_EQ(table.cylinders().size(), kMaxCylinders);
    const auto radius_of_the_first_at = [&](Seconds age) {
        table.place({}, kReported + age);
        float radius = -1.0F;
        for (const world::Cylinder& b : table.cylinders()) {
            radius = std::abs(b.circle.centre.x()) < 1.0F ? b.circle.radius : radius;
        }
        return radius;
    };
    const float fresh = radius_of_the_first_at(0.0F);
    EXPECT_NEAR(radius_of_the_first_at(49.9F), fresh, 1e-3F);
    EXPECT_NEAR(radius_of_the_first_at(60.0F), fresh + 6.0F * 10.0F, 0.1F);
    EXPECT_GT(radius_of_the_first_at(90.0F), 0.0F);
    table.place({}, kReported + 90.1F);
    EXPECT_TRUE(table.cylinders().empty());
}

/// A part of set 1, which has two.
ConstraintPart half_of_it(std::uint8_t index)
{
    ConstraintPart part;
    part.constraint = closed_at(100.0F * static_cast<float>(index), 0.0F, 10.0F, {1.0F, 2.0F});
    part.constraint.ends = kReported + 60.0F;
    part.constraint.about = kArea;
    part.set = 1;
    part.index = index;
    part.count = 2;
    part.from_system = 255;
    part.from_component = 190;
    return part;
}

TEST(ClosedAreaUpload, EachValueTellsASetFromTheOneInForce)
{
    const std::vector<std::function<void(Constraint&)>> others{
        [](Constraint& c) { c.cylinder.circle.centre.x() += 1.0F; },
        [](Constraint& c) { c.cylinder.circle.centre.y() += 1.0F; },
        [](Constraint& c) { c.cylinder.circle.radius += 1.0F; },
        [](Constraint& c) { c.cylinder.velocity.x() += 1.0F; },
        [](Constraint& c) { c.cylinder.velocity.y() += 1.0F; },
        [](Constraint& c) { c.cylinder.bottom -= 1.0F; },
        [](Constraint& c) { c.cylinder.top += 1.0F; },
        [](Constraint& c) { c.cylinder.margin += 1.0F; },
        [](Constraint& c) { c.ends.us += 1; },
        [](Constraint& c) { c.ends = Constraint{}.ends; },
        [](Constraint& c) { c.stamp.us -= 1; },  // it ends later after it
        [](Constraint& c) { c.about.reset(); },
        [](Constraint& c) { c.about->alt += 1; },
    };
    for (std::size_t i = 0; i < others.size(); ++i) {
        SCOPED_TRACE(i);
        ConstraintUpload upload;
        static_cast<void>(upload.take(half_of_it(0), kReported));
        ASSERT_EQ(upload.take(half_of_it(1), kReported), ConstraintResult::in_force);
        ConstraintPart part = half_of_it(1);
        others[i](part.constraint);
        EXPECT_EQ(upload.take(part, kReported), ConstraintResult::kept);
        EXPECT_EQ(upload.diagnostics().abandoned, 0U) << "the one in force was complete";
        // And the former end that had none.
        ConstraintUpload endless;
        ConstraintPart never = half_of_it(1);
        never.constraint.ends = Constraint{}.ends;
        static_cast<void>(endless.take(half_of_it(0), kReported));
        ASSERT_EQ(endless.take(never, kReported), ConstraintResult::in_force);
        EXPECT_EQ(endless.take(half_of_it(1), kReported), ConstraintResult::kept);
    }
}

/// Without an end the stamp is irrelevant: the same area, reported again later.
TEST(ClosedAreaUpload, AnEndlessAreaReportedAgainIsTheSame)
{
    ConstraintUpload upload;
    ConstraintPart part = half_of_it(0);
    part.constraint.ends = Constraint{}.ends;
    part.count = 1;
    ASSERT_EQ(upload.take(part, kReported), ConstraintResult::in_force);
    upload.mark_in_force();
    part.constraint.stamp.us += 5'000'000;
    EXPECT_EQ(upload.take(part, kReported + 5.0F), ConstraintResult::in_force);
    EXPECT_EQ(upload.diagnostics().sets, 1U) << "no other set";
    EXPECT_TRUE(upload.is_new()) << "with its new stamp";
    EXPECT_EQ(upload.set()[0].stamp.us, kReported.us + 5'000'000);
}

TEST(ClosedAreaUpload, TheIncompleteSetTakesTheLaterValueOfAPart)
{
    ConstraintUpload upload;
    EXPECT_EQ(upload.take(half_of_it(0), kReported), ConstraintResult::kept);
    ConstraintPart moved = half_of_it(0);
    moved.constraint.cylinder.circle.centre.x() = -70.0F;
    EXPECT_EQ(upload.take(moved, kReported), ConstraintResult::kept);
    EXPECT_EQ(upload.take(half_of_it(1), kReported), ConstraintResult::in_force);
    ASSERT_EQ(upload.set().size(), 2U);
    EXPECT_EQ(upload.set()[0].cylinder.circle.centre.x(), -70.0F);
    EXPECT_EQ(upload.diagnostics().abandoned, 0U);
    EXPECT_EQ(upload.diagnostics().sets, 1U);
}

TEST(ClosedAreaUpload, ALargestSetAndNoLarger)
{
    ConstraintUpload upload;
    for (std::uint8_t i = 0; i < link::kMaxReportedConstraints; ++i) {
        ConstraintPart part = half_of_it(i);
        part.count = link::kMaxReportedConstraints;
        EXPECT_EQ(upload.take(part, kReported),
                  i + 1U < link::kMaxReportedConstraints ? ConstraintResult::kept : ConstraintResult::in_force);
    }
    EXPECT_EQ(upload.set().size(), link::kMaxReportedConstraints);
    ConstraintPart more = half_of_it(0);
    more.count = link::kMaxReportedConstraints + 1;
    EXPECT_EQ(upload.take(more, kReported), ConstraintResult::too_many);
    EXPECT_EQ(upload.set().size(), link::kMaxReportedConstraints) << "changes nothing";
}

TEST(ClosedAreaUpload, AnEmptySetAgainIsTheSame)
{
    ConstraintUpload upload;
    ConstraintPart none;
    none.set = 4;
    none.constraint.cylinder.circle.radius = -1.0F;  // invalid
    EXPECT_EQ(upload.take(none, kReported), ConstraintResult::in_force);
    upload.mark_in_force();
    EXPECT_EQ(upload.take(none, kReported), ConstraintResult::in_force);
    EXPECT_EQ(upload.diagnostics().sets, 1U);
    none.set = 5;
    EXPECT_EQ(upload.take(none, kReported), ConstraintResult::in_force);
    EXPECT_EQ(upload.diagnostics().sets, 2U);
    EXPECT_EQ(upload.diagnostics().abandoned, 0U);
    EXPECT_EQ(upload.diagnostics().refused, 0U);
    ConstraintPart first = half_of_it(0);
    first.set = 5;
    EXPECT_EQ(upload.take(first, kReported), ConstraintResult::kept) << "of the same number, and another count";
    EXPECT_FALSE(upload.is_new());
}

TEST(ClosedAreaUpload, ThePoleIsOnTheEarthAndWhatLiesBeyondIsNot)
{
    const auto result_at = [](std::int32_t lat, std::int32_t lon) {
        ConstraintUpload upload;
        ConstraintPart part = half_of_it(0);
        part.count = 1;
        part.constraint.about = link::GlobalPosition{lat, lon, 0};
        return upload.take(part, kReported);
    };
    EXPECT_EQ(result_at(900'000'000, 1'800'000'000), ConstraintResult::in_force);
    EXPECT_EQ(result_at(-900'000'001, 0), ConstraintResult::out_of_range);
    EXPECT_EQ(result_at(0, -1'800'000'001), ConstraintResult::out_of_range);
}

}  // namespace
}  // namespace jink::app
