// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step when the autopilot flies to an unknown place: the previous leg is not used for conflicts.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

class CoprocessorLeg : public ::testing::Test {
protected:
    /// Static on a leg to the north, with an obstacle on the leg.
    void SetUp() override
    {
        f.hovers = true;
        f.obeys = false;  // no take-over: the leg alone is checked
        f.velocity = Vec3::Zero();
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.fly(300);
        f.obstacles = {f.position + Vec3(0.0F, 15.0F, 0.0F)};
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.guidance.conflict.has_value(); }, 30))
            << "the leg leads through it";
    }
    void next_item(std::uint8_t frame, std::uint16_t command = 16)
    {
        MissionItemInt item;
        item.frame = frame;
        item.x = 473977420;
        item.y = 85465940;
        item.z = 50.0F;
        item.command = command;
        f.mission.push_back(item);
        f.mission_current = 2;
        f.fly(60);
    }
    void expect_dropped()
    {
        EXPECT_EQ(f.coprocessor.diagnostics().legs_dropped, 1U);
        EXPECT_FALSE(f.last.guidance.conflict.has_value()) << "it hovers, and may go anywhere";
    }

    Flight f;
};

TEST_F(CoprocessorLeg, AnItemThatCannotBePlacedEndsTheOldOne)
{
    next_item(10);  // above terrain
    expect_dropped();
    f.fly(100);
    expect_dropped();
}

TEST_F(CoprocessorLeg, AnItemAboveAHomeThatIsNotKnownEndsTheOldOneAndIsTakenUpWhenItIs)
{
    next_item(6);
    expect_dropped();
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    home.altitude = 488000;
    home.q = {1.0F, 0.0F, 0.0F, 0.0F};
    f.feed(home);
    f.obstacles = {f.position + Vec3(15.0F, -f.position.y() * 0.02F, 0.0F)};
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.guidance.conflict.has_value(); }, 60))
        << "the new leg leads east";
    EXPECT_EQ(f.coprocessor.diagnostics().legs_dropped, 1U);
}

TEST_F(CoprocessorLeg, AnItemWithoutAPlaceEndsTheOldOne)
{
    next_item(0, 20);  // return to launch
    expect_dropped();
}

TEST_F(CoprocessorLeg, AnItemThatDoesNotComeEndsTheOldOneOnce)
{
    f.answers_mission = false;
    next_item(6);
    f.fly(50 * 4);
    expect_dropped();
    f.fly(50 * 30);
    expect_dropped();
}

TEST_F(CoprocessorLeg, LeavingTheMissionEndsTheLegAndReturningBeginsItAnew)
{
    f.mode = wire::kCopterLoiter;
    f.fly(60);
    expect_dropped();
    f.mode = wire::kCopterAuto;
    EXPECT_TRUE(f.until([](const StepReport& r) { return r.guidance.conflict.has_value(); }, 60));
}

}  // namespace
}  // namespace jink::app::test
