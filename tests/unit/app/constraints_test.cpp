// SPDX-License-Identifier: BSD-3-Clause
// Reported closed areas: refused, moved, grown, merged, placed; and the co-processor that avoids them.
#include "firmware/app/constraints.hpp"

#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

constexpr TimePoint kNow{500'000'000};

Constraint area(float east, float north, float radius, const world::Vec2& velocity = world::Vec2::Zero())
{
    Constraint constraint;
    constraint.cylinder = {{{east, north}, radius}, velocity, 0.0F, 100.0F, 5.0F};
    constraint.stamp = kNow;
    return constraint;
}

TEST(Constraints, WhatIsWrongIsRefusedAndTheRestCounts)
{
    ConstraintTable table;
    std::vector<Constraint> reported(6, area(0, 0, 10));
    reported[0].cylinder.circle.radius = 0.0F;
    reported[1].cylinder.top = -1.0F;
    reported[2].cylinder.circle.centre.x() = std::numeric_limits<float>::quiet_NaN();
    reported[3].cylinder.velocity.y() = std::numeric_limits<float>::infinity();
    reported[4].stamp = kNow + 2.0F;
    table.tell(reported, std::nullopt, Vec3::Zero(), kNow);
    EXPECT_EQ(table.diagnostics().reported, 6U);
    EXPECT_EQ(table.diagnostics().refused, 5U);
    EXPECT_EQ(table.cylinders().size(), 1U);
    table.tell({}, std::nullopt, Vec3::Zero(), kNow);
    EXPECT_TRUE(table.cylinders().empty()) << "a new set replaces the one before";
}

TEST(Constraints, MoveOnFromTheirStamp)
{
    ConstraintTable table;
    std::vector<Constraint> reported{area(10, 20, 5, {3, -1}), area(50, 0, 5)};
    reported[0].stamp = kNow - 4.0F;
    table.tell(reported, std::nullopt, Vec3::Zero(), kNow);
    table.place(std::nullopt, kNow + 6.0F);
    ASSERT_EQ(table.cylinders().size(), 2U);
    EXPECT_NEAR(table.cylinders()[0].circle.centre.x(), 40.0F, 1e-3F);
    EXPECT_NEAR(table.cylinders()[0].circle.centre.y(), 10.0F, 1e-3F);
    EXPECT_EQ(table.cylinders()[0].circle.radius, 5.0F);
    EXPECT_EQ(table.cylinders()[1].circle.centre, world::Vec2(50, 0));
}

TEST(Constraints, WhatMovesAndIsOldGrowsAndWhatStandsDoesNot)
{
    ConstraintTable table;
    const std::vector<Constraint> reported{area(0, 0, 5, {3, 4}), area(0, 0, 5)};
    table.tell(reported, std::nullopt, Vec3::Zero(), kNow);
    table.place(std::nullopt, kNow + (ConstraintTable::kFresh - ConstraintTable::kAhead));
    EXPECT_NEAR(table.cylinders()[0].circle.radius, 5.0F, 1e-2F) << "nothing leaps";
    EXPECT_EQ(table.diagnostics().grown, 0U);
    table.place(std::nullopt, kNow + ConstraintTable::kFresh + 20.0F);
    EXPECT_NEAR(table.cylinders()[0].circle.radius, 5.0F + 5.0F * (20.0F + ConstraintTable::kAhead), 1e-2F);
    EXPECT_EQ(table.cylinders()[1].circle.radius, 5.0F);
    EXPECT_EQ(table.diagnostics().grown, 1U);
}

TEST(Constraints, EndWhenTheyEnd)
{
    ConstraintTable table;
    std::vector<Constraint> reported{area(0, 0, 5)};
    reported[0].ends = kNow + 10.0F;
    table.tell(reported, std::nullopt, Vec3::Zero(), kNow);
    table.place(std::nullopt, kNow + 9.9F);
    EXPECT_EQ(table.cylinders().size(), 1U);
    table.place(std::nullopt, kNow + 10.1F);
    EXPECT_TRUE(table.cylinders().empty());
}

TEST(Constraints, OnTheGlobeTheyWaitForAnOriginAndFollowIt)
{
    ConstraintTable table;
    std::vector<Constraint> reported{area(0, 0, 50)};
    reported[0].about = link::GlobalPosition{473977420, 85465940, 0};
    table.tell(reported, std::nullopt, Vec3::Zero(), kNow);
    EXPECT_TRUE(table.lacks_origin());
    EXPECT_TRUE(table.cylinders().empty());
    const link::GlobalPosition origin{473977420 - 9000, 85465940, 400'000};  // 100 m south of it, 400 m high
    table.place(origin, kNow);
    ASSERT_EQ(table.cylinders().size(), 1U);
    EXPECT_FALSE(table.lacks_origin());
    EXPECT_NEAR(table.cylinders()[0].circle.centre.y(), 100.2F, 0.3F);
    EXPECT_NEAR(table.cylinders()[0].circle.centre.x(), 0.0F, 0.1F);
    EXPECT_NEAR(table.cylinders()[0].bottom, -400.0F, 1e-2F);
    EXPECT_GE(table.cylinders()[0].circle.radius, 50.0F + 1e-3F * 100.0F) << "maps differ by 0.11 %";
}

/// After any merge: every reported area stays closed, now and later.
TEST(Constraints, TooManyAreMergedAndNothingIsLost)
{
    Random random(11);
    for (int round = 0; round < 60; ++round) {
        std::vector<Constraint> reported;
        for (std::size_t i = 0, n = kMaxCylinders + 1 + random.below(12); i < n; ++i) {
            Constraint one =
                area(random.uniform(-900.0F, 900.0F), random.uniform(-900.0F, 900.0F), random.uniform(1.0F, 60.0F),
                     {random.uniform(-9.0F, 9.0F), random.uniform(-9.0F, 9.0F)});
            one.stamp = kNow - random.uniform(0.0F, 80.0F);
            reported.push_back(one);
        }
        ConstraintTable table;
        table.tell(reported, std::nullopt, Vec3(10, 20, 30), kNow);
        EXPECT_EQ(table.diagnostics().merged, reported.size() - kMaxCylinders);
        ASSERT_EQ(table.cylinders().size(), kMaxCylinders);
        for (int sample = 0; sample < 200; ++sample) {
            const Constraint& one = reported[random.below(reported.size())];
            const Seconds later = random.uniform(0.0F, 150.0F);
            ConstraintTable alone;
            alone.tell({&one, 1}, std::nullopt, Vec3::Zero(), kNow);
            alone.place(std::nullopt, kNow + later);
            const world::Cylinder& body = alone.cylinders()[0];
            const float angle = random.uniform(-kPi, kPi);
            const world::Vec2 point = body.circle.centre + body.circle.radius * random.uniform(0.0F, 0.999F) *
                                                               world::Vec2(std::cos(angle), std::sin(angle));
            table.place(std::nullopt, kNow + later);
            const auto cylinders = table.cylinders();
            ASSERT_TRUE(std::any_of(cylinders.begin(), cylinders.end(),
                                    [&](const world::Cylinder& cylinder) {
                                        return (point - cylinder.circle.centre).norm() <= cylinder.circle.radius;
                                    }))
                << "round " << round << ", " << later << " s later";
        }
    }
}

/// A copter flies north at 50 m; a static cell is across its path.
class CoprocessorConstraints : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
    }
    /// `ahead` metres north of the vehicle.
    Constraint cell(float ahead, float radius, const world::Vec2& velocity = world::Vec2::Zero())
    {
        Constraint one;
        one.cylinder = {{{f.position.x(), f.position.y() + ahead}, radius}, velocity, 0.0F, 500.0F, 0.0F};
        one.stamp = f.now;
        return one;
    }
    /// Least level distance from the body while it is flown.
    float fly_past(const Constraint& one, int ticks)
    {
        float least = 1e9F;
        for (int i = 0; i < ticks; ++i) {
            f.fly(1);
            const Seconds t = f.now - one.stamp;
            const world::Vec2 centre = one.cylinder.circle.centre + t * one.cylinder.velocity;
            least = std::min(least, (f.position.head<2>() - centre).norm() - one.cylinder.circle.radius);
        }
        return least;
    }
    std::unique_ptr<Flight> flight_ = std::make_unique<Flight>();
    Flight& f = *flight_;
};

TEST_F(CoprocessorConstraints, KeepsOutOfOneThatStandsAndOneThatComes)
{
    for (const world::Vec2& velocity : {world::Vec2(0, 0), world::Vec2(0.5F, -1.0F)}) {
        const Constraint one = cell(60.0F, 10.0F, velocity);
        f.coprocessor.set_constraints({&one, 1}, f.now);
        EXPECT_GT(fly_past(one, 1500), 0.7F);
        EXPECT_EQ(f.last.cylinders, 1U);
        EXPECT_EQ(f.last.faults, 0U);
    }
    EXPECT_GT(f.setpoints, 0);
}

TEST_F(CoprocessorConstraints, WarnsOfAClosedArea)
{
    const Constraint one = cell(45.0F, 10.0F);
    f.coprocessor.set_constraints({&one, 1}, f.now);
    bool warned = false;
    for (int i = 0; i < 300 && !warned; ++i) {
        f.fly(1);
        for (const Collision& collision : f.said_of<Collision>()) {
            warned = warned || collision.id == 0x04000000U;
        }
    }
    EXPECT_TRUE(warned);
}

TEST_F(CoprocessorConstraints, OnTheGlobeIsPlacedByTheLinksOrigin)
{
    Constraint one = cell(0.0F, 100.0F);
    one.cylinder.circle.centre.setZero();
    one.about = f.endpoint.origin();
    ASSERT_TRUE(one.about);
    one.about->lat += 9000;
    f.coprocessor.set_constraints({&one, 1}, f.now);
    f.fly(2);
    EXPECT_EQ(f.last.cylinders, 1U);
    EXPECT_EQ(f.last.faults, 0U);
}

/// A closed area that cannot be placed must not count as open.
TEST(CoprocessorWithoutOrigin, ClosedAreasOnTheGlobeAreAFault)
{
    const auto flight = std::make_unique<Flight>();
    Constraint one = area(0, 0, 10);
    one.about = link::GlobalPosition{473977420, 85465940, 0};
    one.stamp = {};
    flight->coprocessor.set_constraints({&one, 1}, flight->now);
    // The first HEARTBEAT and no origin yet.
    flight->feed(wire::heartbeat(flight->mode, flight->armed, 3));
    flight->now.us += Flight::kTickUs;
    const StepReport report = flight->coprocessor.step(flight->now);
    EXPECT_NE(report.faults & static_cast<std::uint16_t>(Fault::airspace_unplaced), 0U);
    EXPECT_FALSE(report.setpoint_sent);
    ASSERT_TRUE(flight->until([](const StepReport& r) { return r.faults == 0; }, 200)) << "the origin comes";
}

}  // namespace
}  // namespace jink::app::test
