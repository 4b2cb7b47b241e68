// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step in a closed loop where control ends or never comes: the pilot, a refusal, a stop on purpose.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

bool in_control(const StepReport& report) { return report.control == Control::ours; }

class CoprocessorControl : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.fly(60);
        f.obstacles = {f.position + Vec3(0.4F, 40.0F, 0.0F)};
    }
    bool said_text(const std::string& text) const
    {
        const auto all = f.said_of<Statustext>();
        return std::any_of(all.begin(), all.end(), [&](const Statustext& m) {
            return std::string(m.text.data(), std::min(text.size(), m.text.size())) == text;
        });
    }

    Flight f;
};

TEST_F(CoprocessorControl, PilotTakesOverAndIsLeftAlone)
{
    for (const std::uint32_t pilots : {wire::kCopterLoiter, 0U, 6U}) {  // LOITER, STABILIZE, RTL
        f.mode = wire::kCopterAuto;
        f.obstacles = {f.position + Vec3(0.4F, 40.0F, 0.0F)};
        ASSERT_TRUE(f.until(in_control)) << pilots;
        f.mode = pilots;
        f.fly(1);
        EXPECT_EQ(f.last.control, Control::overruled) << pilots;
        EXPECT_FALSE(f.last.setpoint_sent);
        const int setpoints = f.setpoints;
        const std::size_t requests = f.requested.size();
        f.fly(200);
        EXPECT_EQ(f.setpoints, setpoints) << pilots;
        EXPECT_EQ(f.requested.size(), requests) << pilots;
        f.obstacles.clear();
        f.position = Vec3(0.0F, f.position.y() + 200.0F, 50.0F);
        f.velocity = Vec3(0.0F, 5.0F, 0.0F);
        f.fly(400);  // until the obstacle is forgotten
    }
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().overruled, 3U);
}

TEST_F(CoprocessorControl, DisarmingEndsControl)
{
    ASSERT_TRUE(f.until(in_control));
    f.armed = false;
    f.fly(51);  // the next HEARTBEAT reports it
    EXPECT_NE(f.last.control, Control::ours);
    const int setpoints = f.setpoints;
    f.fly(200);
    EXPECT_EQ(f.setpoints, setpoints);
    EXPECT_NE(f.last.state, link::SystemState::active);
}

TEST_F(CoprocessorControl, RefusedControlIsAskedForThriceAndThenTheAutopilotIsAskedToHold)
{
    f.obeys = false;
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::refused; }));
    EXPECT_TRUE(said_text("jink: control refused, advising only"));
    EXPECT_FALSE(f.last.setpoint_sent);
    const auto guided = static_cast<float>(wire::kCopterGuided);
    EXPECT_EQ(f.requested, std::vector<float>(3, guided));
    const int setpoints = f.setpoints;
    ASSERT_TRUE(f.until([&](const StepReport&) { return f.requested.size() > 3; }));
    EXPECT_EQ(f.requested.back(), static_cast<float>(wire::kCopterBrake));
    EXPECT_LT(f.position.y(), f.obstacles.front().y() - 2.0F) << "before the obstacle, not behind it";
    EXPECT_EQ(f.setpoints, setpoints);
}

TEST_F(CoprocessorControl, ShutDownInControlSaysCriticalAsksToHoldAndStopsStreaming)
{
    ASSERT_TRUE(f.until(in_control));
    f.fly(10);
    f.requested.clear();
    f.coprocessor.shut_down(f.now);
    f.react();
    const auto beats = f.said_of<Heartbeat>();
    ASSERT_EQ(beats.size(), 1U);
    EXPECT_EQ(beats[0].system_status, static_cast<std::uint8_t>(link::SystemState::critical));
    EXPECT_EQ(f.requested, std::vector<float>(1, static_cast<float>(wire::kCopterBrake)));
    EXPECT_TRUE(said_text("jink: stopped"));
    EXPECT_TRUE(f.said_of<SetPositionTargetLocalNed>().empty());
    EXPECT_TRUE(f.endpoint.pending().empty());
}

TEST_F(CoprocessorControl, ShutDownOnTheAutopilotsOwnWayLeavesItsModeAlone)
{
    f.obstacles.clear();
    f.fly(20);
    f.coprocessor.shut_down(f.now);
    f.react();
    EXPECT_TRUE(f.requested.empty());
    EXPECT_TRUE(said_text("jink: stopped"));
}

}  // namespace
}  // namespace jink::app::test
