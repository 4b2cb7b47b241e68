// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step with vehicles that cannot be steered or do not follow, with moved sticks, and with restored lines:
// actions, and reports made once.
#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

class CoprocessorVehicle : public ::testing::Test {
protected:
    void begin()
    {
        ASSERT_TRUE(until([](const StepReport& r) { return r.faults == 0; }, 200));
        fly(100);
        f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    }
    void note()
    {
        for (const Statustext& m : f->said_of<Statustext>()) {
            const std::string text(m.text.begin(), std::find(m.text.begin(), m.text.end(), '\0'));
            said += text + "\n";
        }
    }
    void fly(int ticks)
    {
        for (int i = 0; i < ticks; ++i) {
            f->fly(1);
            note();
        }
    }
    template <class Done>
    bool until(Done done, int limit = 1500)
    {
        for (int i = 0; i < limit; ++i) {
            fly(1);
            if (done(f->last)) {
                return true;
            }
        }
        return false;
    }
    /// A plane in its mission with an obstacle ahead: nothing is asked for, and that is said once.
    void expect_plane_is_advised_only()
    {
        f->mav_type = 1;
        f->mode = 10;
        f->feed(ExtendedSysState{0, 2});
        begin();
        f->feed(ExtendedSysState{0, 2});
        fly(600);
        EXPECT_TRUE(f->requested.empty());
        EXPECT_EQ(times("advising only"), 1);
    }
    [[nodiscard]] int times(const std::string& text) const
    {
        int n = 0;
        for (std::size_t at = said.find(text); at != std::string::npos; at = said.find(text, at + 1)) {
            ++n;
        }
        return n;
    }
    static bool has_it(const StepReport& r) { return r.control == Control::ours; }

    std::unique_ptr<Flight> f = std::make_unique<Flight>();
    std::string said;
};

TEST_F(CoprocessorVehicle, RoverIsAdvisedOnlyAndReportedSoOnce)
{
    f->mav_type = 10;
    begin();
    fly(600);
    EXPECT_EQ(f->setpoints, 0);
    EXPECT_TRUE(f->requested.empty());
    EXPECT_EQ(times("jink: cannot steer this vehicle, advising only"), 1);
    EXPECT_GT(times("jink: conflict"), 0) << "it advises";
}

TEST_F(CoprocessorVehicle, PlaneIsAdvisedOnly)
{
    f->mav_type = 1;
    f->mode = 10;
    begin();
    fly(600);
    EXPECT_EQ(f->setpoints, 0);
    EXPECT_TRUE(f->requested.empty());
    EXPECT_EQ(times("advising only"), 1);
}

/// An ArduPlane plane that reports no VTOL.
Parameters plane_parameters(float fixed_wing)
{
    Parameters parameters;
    EXPECT_EQ(parameters.set(Param::fixed_wing, fixed_wing), ParamStatus::ok);
    return parameters;
}

TEST_F(CoprocessorVehicle, PlaneThatIsSetUpAsAMultirotorIsAdvisedOnly) { expect_plane_is_advised_only(); }

TEST_F(CoprocessorVehicle, PlaneUnderReciprocalAvoidanceAloneIsAdvisedOnlyBecauseItKeepsItsSpeed)
{
    Parameters parameters = plane_parameters(1.0F);
    ASSERT_EQ(parameters.set(Param::methods, 4.0F), ParamStatus::ok);
    f = std::make_unique<Flight>(parameters);
    said.clear();
    expect_plane_is_advised_only();
}

TEST_F(CoprocessorVehicle, PlaneIsTakenOverAndGetsGuidedPointsAndNoVelocities)
{
    f = std::make_unique<Flight>(plane_parameters(1.0F));
    f->mav_type = 1;
    f->mode = 10;
    f->deaf = true;
    fly(10);
    f->feed(ExtendedSysState{0, 2});
    begin();
    std::size_t points = 0;
    for (int i = 0; i < 600; ++i) {
        fly(1);
        for (const CommandInt& m : f->said_of<CommandInt>()) {
            EXPECT_EQ(m.command, 192);
            EXPECT_EQ(f->mode, 15U) << "in GUIDED alone";
            ++points;
        }
    }
    ASSERT_FALSE(f->requested.empty());
    EXPECT_EQ(f->requested.front(), 15.0F);
    EXPECT_GT(points, 0U);
    EXPECT_EQ(f->setpoints, 0) << "SET_POSITION_TARGET_LOCAL_NED";
    EXPECT_EQ(times("advising only"), 0);
}

TEST_F(CoprocessorVehicle, ThatIgnoresSetpointsIsGivenBackWithinASecondAndAHalfAndAskedToHold)
{
    f->deaf = true;
    begin();
    ASSERT_TRUE(until(has_it));
    // The first manoeuvre may hardly differ from the mission's motion: count from where it does.
    ASSERT_TRUE(until([&](const StepReport& r) { return (r.guidance.velocity - f->velocity).norm() > 2.0F; }, 200));
    ASSERT_TRUE(until([](const StepReport& r) { return r.control != Control::ours; }, 80));
    EXPECT_EQ(times("jink: set-points not followed, asks to hold"), 1);
    EXPECT_EQ(f->mode, wire::kCopterBrake);
    f->mode = wire::kCopterAuto;
    const int setpoints = f->setpoints;
    fly(400);
    EXPECT_EQ(f->setpoints, setpoints) << "advises only from here on";
}

TEST_F(CoprocessorVehicle, ThatFollowsIsNotAccused)
{
    begin();
    ASSERT_TRUE(until(has_it));
    fly(1500);
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().unfollowed, 0U);
}

RcChannels channels(std::uint16_t roll)
{
    RcChannels m;
    m.chan1_raw = roll;
    m.chan2_raw = m.chan4_raw = 1500;
    m.chan3_raw = 1100;
    m.chancount = 8;
    m.rssi = 0;
    return m;
}

TEST_F(CoprocessorVehicle, SticksThatMoveEndTheTakeover)
{
    begin();
    f->feed(channels(1503));
    ASSERT_TRUE(until(has_it));
    for (int i = 0; i < 5; ++i) {
        f->feed(channels(1600));  // 20 % of the half travel
        fly(5);
    }
    EXPECT_EQ(f->last.control, Control::ours);
    f->feed(channels(1700));
    fly(1);
    f->feed(channels(1700));
    fly(1);
    EXPECT_EQ(f->last.control, Control::overruled);
    EXPECT_FALSE(f->last.setpoint_sent);
    EXPECT_EQ(times("jink: sticks moved, hands off"), 1);
    fly(5);
    EXPECT_EQ(f->mode, wire::kCopterAuto) << "the former mode";
}

TEST_F(CoprocessorVehicle, SticksAreNotWatchedWhereTheParameterSaysSo)
{
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::sticks, 0.0F), ParamStatus::ok);
    f = std::make_unique<Flight>(parameters);
    begin();
    f->feed(channels(1500));
    ASSERT_TRUE(until(has_it));
    for (int i = 0; i < 10; ++i) {
        f->feed(channels(2000));
        fly(1);
    }
    EXPECT_EQ(f->last.control, Control::ours);
}

TEST_F(CoprocessorVehicle, LineThatComesBackIsReportedWhyTheVehicleHolds)
{
    begin();
    ASSERT_TRUE(until(has_it));
    f->port.state = hal::PortState::lost;
    fly(20);
    f->mode = wire::kCopterLoiter;  // the autopilot's own failsafe
    fly(100);
    EXPECT_EQ(times("jink: line lost while avoiding, control dropped"), 0);
    f->port.state = hal::PortState::open;
    fly(200);
    EXPECT_EQ(times("jink: line lost while avoiding, control dropped"), 1);
}

TEST_F(CoprocessorVehicle, FoundInGuidedAtTheStartItIsLeftAloneAndSaidOnce)
{
    f->mode = wire::kCopterGuided;
    begin();
    fly(600);
    EXPECT_EQ(times("jink: found in external mode, left alone"), 1);
    EXPECT_TRUE(f->requested.empty());
    EXPECT_EQ(f->setpoints, 0);
}

}  // namespace
}  // namespace jink::app::test
