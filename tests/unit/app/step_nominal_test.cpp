// SPDX-License-Identifier: BSD-3-Clause
// The two nominal paths in Coprocessor::step: a conflict on either counts, and the one that it was on is flown.
#include <gtest/gtest.h>

#include "tests/oracle/reference_ends.hpp"
#include "tests/unit/app/step_flight.hpp"

namespace jink::app::test {
namespace {

/// Reports a leg to the east of the place where the vehicle is; it flies north.
void report_leg_east(StepBench& b)
{
    b.wire.in.has_leg = true;
    b.wire.in.leg.leg = {b.position, b.position + Vec3(500.0F, 0.0F, 0.0F), 5.0F};
}

TEST(StepNominal, AConflictOnTheMeasuredMotionCountsBesideALegThatIsClear)
{
    StepBench b({{Param::mode, 1.0F}});
    report_leg_east(b);
    b.fly(1);
    b.hear_track(1, b.position + Vec3(0.0F, 50.0F, 0.0F)).velocity = Vec3(0.0F, -5.0F, 0.0F);
    b.fly(1);
    ASSERT_TRUE(b.coprocessor.nominal_paths().believes_leg());
    EXPECT_TRUE(b.last.guidance.conflict.has_value());
    EXPECT_TRUE(b.last.guidance.on_other);
}

TEST(StepNominal, AConflictOnTheLegCountsBesideMotionThatIsClear)
{
    StepBench b({{Param::mode, 1.0F}});
    report_leg_east(b);
    b.fly(1);
    b.hear_track(1, b.position + Vec3(50.0F, 0.0F, 0.0F)).velocity = Vec3(-5.0F, 0.0F, 0.0F);
    b.fly(1);
    EXPECT_TRUE(b.last.guidance.conflict.has_value());
    EXPECT_FALSE(b.last.guidance.on_other);
}

/// Taken over because of the motion, that is what is flown, and the leg has to be clear too.
TEST(StepNominal, ThePathThatTheConflictWasOnIsFlown)
{
    StepFlight f;
    for (int i = 0; i < 60; ++i) {
        f.tick();
    }
    report_leg_east(f);
    f.intruder = f.position + Vec3(0.0F, 45.0F, 0.0F);
    f.intruder_velocity = Vec3(0.0F, -6.0F, 0.0F);
    ASSERT_TRUE(f.until(StepFlight::ours, 70));
    ASSERT_TRUE(f.coprocessor.nominal_paths().believes_leg());
    for (int i = 0; i < 20; ++i) {
        f.tick();
        ASSERT_EQ(f.last.control, Control::ours);
        EXPECT_FALSE(f.coprocessor.nominal_paths().is_intended()) << i;
        EXPECT_NE(f.coprocessor.nominal_paths().other(), nullptr);
    }
}

/// The leg is judged in real time, however seldom the own state comes.
TEST(StepNominal, ALegIsDoubtedAsSoonWhereTheOwnStateComesSeldom)
{
    StepBench b({{Param::mode, 1.0F}});
    report_leg_east(b);
    int steps = 0;
    while (steps < 400 && (steps < 25 || b.coprocessor.nominal_paths().believes_leg())) {
        if (steps % 25 == 0) {
            b.hear_autopilot();
        }
        if (steps % 20 == 0) {
            b.hear_own();
        }
        b.step();
        b.position += 0.02F * b.velocity;
        ++steps;
    }
    EXPECT_NEAR(0.02F * static_cast<float>(steps), ReportedLeg::kContradicted, 0.45F);
}

TEST(StepNominal, TheMotionBeginsWhereTheVehicleIsNow)
{
    StepBench b({{Param::mode, 1.0F}});
    b.fly(2);
    const Vec3 known = b.coprocessor.own().position;
    b.step(300'000);
    ASSERT_FALSE(b.coprocessor.nominal_paths().is_intended());
    EXPECT_NEAR(start_of(b.coprocessor.nominal_paths().primary()).y() - known.y(), 1.5F, 0.01F);
}

}  // namespace
}  // namespace jink::app::test
