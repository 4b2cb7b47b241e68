// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step when the autopilot flies on to a place that cannot be known: nobody is judged on the leg before.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

class CoprocessorLeg : public ::testing::Test {
protected:
    /// Hovering on a leg that leads north, with an obstacle on it.
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.fly(60);
        f.mode = wire::kCopterLoiter;
        f.fly(300);
        f.obstacles = {f.position + Vec3(0.0F, 15.0F, 0.0F)};
        f.fly(30);
        ASSERT_TRUE(f.last.guidance.has_conflict) << "the leg leads through it";
    }
    void next_item(std::uint16_t seq)
    {
        MissionCurrent current;
        current.seq = seq;
        f.feed(current);
        f.fly(2);
        ASSERT_EQ(f.coprocessor.diagnostics().legs_dropped, 0U) << "not before it is known where it leads";
    }
    void answer_count(std::uint16_t n)
    {
        MissionCount count;
        count.count = n;
        count.target_system = wire::kSystem;
        count.target_component = wire::kUs;
        f.feed(count);
        f.fly(2);
    }
    void answer_item(std::uint16_t seq, std::uint8_t frame, std::uint16_t command = 16)
    {
        MissionItemInt item;
        item.seq = seq;
        item.frame = frame;
        item.x = 473977420;
        item.y = 85465940;
        item.z = 50.0F;
        item.command = command;
        item.target_system = wire::kSystem;
        item.target_component = wire::kUs;
        f.feed(item);
        f.fly(2);
    }
    void expect_dropped()
    {
        EXPECT_EQ(f.coprocessor.diagnostics().legs_dropped, 1U);
        EXPECT_FALSE(f.last.guidance.has_conflict) << "it hovers, and may go anywhere";
    }

    Flight f;
};

TEST_F(CoprocessorLeg, AnItemThatCannotBePlacedEndsTheOldOne)
{
    ASSERT_NO_FATAL_FAILURE(next_item(0));
    answer_count(3);
    answer_item(0, 10);  // above terrain
    expect_dropped();
    f.fly(100);
    expect_dropped();
}

TEST_F(CoprocessorLeg, AnItemAboveAHomeThatIsNotKnownEndsTheOldOneAndIsTakenUpWhenItIs)
{
    ASSERT_NO_FATAL_FAILURE(next_item(0));
    answer_count(3);
    answer_item(0, 6);
    expect_dropped();
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    home.altitude = 488000;
    home.q = {1.0F, 0.0F, 0.0F, 0.0F};
    f.feed(home);
    f.obstacles = {f.position + Vec3(15.0F, -1.0F, 0.0F)};
    f.fly(30);
    EXPECT_TRUE(f.last.guidance.has_conflict) << "the new leg leads east";
    EXPECT_EQ(f.coprocessor.diagnostics().legs_dropped, 1U);
}

TEST_F(CoprocessorLeg, AnItemWithoutAPlaceEndsTheOldOne)
{
    ASSERT_NO_FATAL_FAILURE(next_item(0));
    answer_count(3);
    answer_item(0, 0, 20);  // return to launch
    expect_dropped();
}

TEST_F(CoprocessorLeg, AnItemThatDoesNotComeEndsTheOldOneOnce)
{
    ASSERT_NO_FATAL_FAILURE(next_item(0));
    f.fly(50 * 4);
    expect_dropped();
    f.fly(50 * 30);
    expect_dropped();
}

}  // namespace
}  // namespace jink::app::test
