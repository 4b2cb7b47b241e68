// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step with a PX4 that grants OFFBOARD only after more than a second of set-points, as it documents.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

std::unique_ptr<Flight> px4_flight(bool standby)
{
    Parameters parameters;
    EXPECT_EQ(parameters.set(Param::standby, standby ? 1.0F : 0.0F), ParamStatus::ok);
    auto f = std::make_unique<Flight>(parameters);
    f->px4 = f->acknowledges = true;
    f->mode = f->mission_mode();
    EXPECT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
    f->fly(100);
    return f;
}

/// Time from the detection of an obstacle to the change of mode [s].
float time_to_control(Flight& f)
{
    f.obstacles = {f.position + Vec3(0.4F, 25.0F, 0.0F)};
    const TimePoint seen = f.now;
    EXPECT_TRUE(f.until([](const StepReport& r) { return r.control == Control::ours; }, 300));
    return f.now - seen;
}

TEST(CoprocessorPx4, HasItsStreamSeenBeforeItIsNeededAndTakesOverAtOnce)
{
    const auto f = px4_flight(true);
    EXPECT_GE(f->setpoints, 10) << "about 5 Hz over two seconds";
    EXPECT_LE(f->setpoints, 16);
    EXPECT_EQ(f->mode, f->mission_mode());
    EXPECT_TRUE(f->requested.empty());
    EXPECT_LT(time_to_control(*f), 0.4F);
    EXPECT_EQ(f->requested.size(), 1U);
}

TEST(CoprocessorPx4, WithoutThatAsksUntilTheStreamIsOldEnough)
{
    const auto f = px4_flight(false);
    EXPECT_EQ(f->setpoints, 0);
    const float took = time_to_control(*f);
    EXPECT_GT(took, 1.0F);
    EXPECT_LT(took, 1.6F);
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().refused, 0U);
}

TEST(CoprocessorPx4, StreamsNothingBeforehandWhereItMayNotAct)
{
    const auto f = px4_flight(true);
    const auto quiet = [&](const char* why) {
        f->fly(60);  // the next HEARTBEAT reports it
        const int before = f->setpoints;
        f->fly(100);
        EXPECT_EQ(f->setpoints, before) << why;
    };
    const auto lively = [&] {
        f->fly(60);
        const int before = f->setpoints;
        f->fly(100);
        EXPECT_GT(f->setpoints, before);
    };
    f->mode = px4_mode(3, 0);
    quiet("the pilot flies");
    f->mode = f->mission_mode();
    lively();
    f->armed = false;
    quiet("disarmed");
    f->armed = true;
    lively();
    f->own_state = false;
    quiet("a fault of ours");
    f->own_state = true;
    lively();
    f->mode = f->external_mode();
    quiet("somebody else's OFFBOARD");
}

}  // namespace
}  // namespace jink::app::test
