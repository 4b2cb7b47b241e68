// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step in a closed loop over the MAVLink endpoint: taking over, faults, reboots, advice.
#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

constexpr std::uint8_t kCritical = 5;

bool controls(const StepReport& report) { return report.control == Control::ours; }
bool healthy(const StepReport& report) { return report.faults == 0; }

bool says_critical(const Flight& f)
{
    const auto beats = f.said_of<Heartbeat>();
    return std::any_of(beats.begin(), beats.end(), [](const Heartbeat& m) { return m.system_status == kCritical; });
}

std::unique_ptr<Flight> make_flight(std::initializer_list<std::pair<Param, float>> values = {})
{
    Parameters parameters;
    for (const auto& [param, value] : values) {
        EXPECT_EQ(parameters.set(param, value), ParamStatus::ok);
    }
    return std::make_unique<Flight>(parameters);
}

/// In the air, everything heard, quiet.
void settle(Flight& f)
{
    ASSERT_TRUE(f.until(healthy, 200));
    f.fly(60);
    ASSERT_EQ(f.last.state, link::SystemState::active);
    ASSERT_EQ(f.last.control, Control::autopilot);
    ASSERT_EQ(f.setpoints, 0);
}

/// As `settle`, then an obstacle on the path and control over the vehicle.
void take_over(Flight& f)
{
    ASSERT_NO_FATAL_FAILURE(settle(f));
    f.obstacles = {f.position + Vec3(0.4F, 40.0F, 0.0F)};
    ASSERT_TRUE(f.until(controls));
    f.fly(10);
    ASSERT_EQ(f.last.control, Control::ours);
    ASSERT_EQ(f.last.guidance.state, avoid::State::avoiding);
}

TEST(CoprocessorFault, StaleOwnStateIsReportedCriticalAndSilencesTheStream)
{
    const auto f = make_flight();
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    f->own_state = false;
    int waited = 0;
    while (!says_critical(*f) && waited < 100) {
        f->fly(1);
        ++waited;
    }
    // OWN_AGE 0.5 s is 25 ticks; one more to detect the age, one for the initial age of the stamp.
    EXPECT_LE(waited, 27);
    EXPECT_GE(waited, 23);
    EXPECT_TRUE(has(f->last, Fault::own_state_stale));
    EXPECT_EQ(f->last.state, link::SystemState::critical);
    EXPECT_FALSE(f->last.setpoint_sent);
    EXPECT_EQ(f->said_of<SetPositionTargetLocalNed>().size(), 0U);
    ASSERT_FALSE(f->requested.empty());
    EXPECT_EQ(f->requested.back(), static_cast<float>(wire::kCopterBrake));
    const int before = f->setpoints;
    f->fly(100);
    EXPECT_EQ(f->setpoints, before);
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().lost_by_fault, 1U);
    EXPECT_EQ(f->coprocessor.diagnostics().faults, 1U);

    f->own_state = true;
    ASSERT_TRUE(f->until(healthy, 200));
    f->fly(100);  // the autopilot holds, as asked: nothing of ours any more
    EXPECT_EQ(f->setpoints, before);
    EXPECT_EQ(f->last.state, link::SystemState::active);
}

TEST(CoprocessorFault, SilentAutopilotIsReportedCriticalAndSilencesTheStream)
{
    const auto f = make_flight({{Param::heartbeat_age, 1.5F}});
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    f->heartbeats = false;
    ASSERT_TRUE(f->until([](const StepReport& r) { return has(r, Fault::autopilot_silent); }, 100));
    EXPECT_TRUE(says_critical(*f));
    const int before = f->setpoints;
    f->fly(50);
    EXPECT_EQ(f->setpoints, before);
}

TEST(CoprocessorFault, NothingHeardYetIsNoFaultReportedButBoot)
{
    const auto f = make_flight();
    f->heartbeats = f->own_state = false;
    f->fly(10);
    EXPECT_TRUE(has(f->last, Fault::no_autopilot));
    EXPECT_TRUE(has(f->last, Fault::own_state_missing));
    EXPECT_EQ(f->last.state, link::SystemState::boot);
    EXPECT_EQ(f->coprocessor.diagnostics().faults, 0U);
    EXPECT_EQ(f->setpoints, 0);
}

TEST(CoprocessorFault, LateStepIsCountedAndAStallDropsControlAndStarvesTheWatchdog)
{
    const auto f = make_flight();
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    const auto skip = [&](std::int64_t us) {
        f->now.us += us;
        f->boot_us += us;
        f->fly(1);
    };
    skip(60'000);
    EXPECT_TRUE(f->last.deadline_missed);
    EXPECT_EQ(f->coprocessor.diagnostics().deadlines_missed, 1U);
    EXPECT_EQ(f->last.control, Control::ours);
    const int fed = f->watchdog.fed;
    skip(600'000);
    EXPECT_TRUE(has(f->last, Fault::late));
    EXPECT_TRUE(says_critical(*f));
    EXPECT_FALSE(f->last.setpoint_sent);
    EXPECT_NE(f->last.control, Control::ours);
    EXPECT_EQ(f->watchdog.fed, fed);
    EXPECT_EQ(f->coprocessor.diagnostics().deadlines_missed, 2U);
    f->fly(1);
    EXPECT_EQ(f->watchdog.fed, fed + 1);
}

class CoprocessorRate : public ::testing::TestWithParam<float> {};

TEST_P(CoprocessorRate, StreamsAtTenHertzOrMoreWhileInControlAndNeverElse)
{
    const auto f = make_flight({{Param::rate, GetParam()}});
    ASSERT_NO_FATAL_FAILURE(settle(*f));
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    TimePoint last_sent{};
    TimePoint began{};
    int ours = 0;
    int sent_while_ours = 0;
    bool returned = false;
    for (int i = 0; i < 3000 && !returned; ++i) {
        f->fly(1);
        const bool sent = !f->said_of<SetPositionTargetLocalNed>().empty();
        ASSERT_EQ(sent, f->last.setpoint_sent);
        if (!f->requested.empty() && f->requested.size() == 1 && ours == 0) {
            ASSERT_GT(f->setpoints, 0) << "the stream comes before the request";
        }
        if (f->last.control == Control::autopilot) {
            ASSERT_FALSE(sent) << "tick " << i;
        }
        if (controls(f->last) || f->last.control == Control::returning) {
            began = ours == 0 ? f->now : began;
            ++ours;
            sent_while_ours += sent ? 1 : 0;
            ASSERT_LE(f->now - last_sent, 0.1001F) << "tick " << i;
        }
        last_sent = sent ? f->now : last_sent;
        returned = ours > 0 && f->last.control == Control::autopilot;
    }
    ASSERT_TRUE(returned);
    ASSERT_GT(ours, 50);
    const float rate = static_cast<float>(sent_while_ours) / (static_cast<float>(ours) * Coprocessor::kTick);
    EXPECT_GE(rate, 10.0F - 0.2F);
    EXPECT_EQ(f->requested.front(), static_cast<float>(wire::kCopterGuided));
    EXPECT_EQ(f->requested.back(), static_cast<float>(wire::kCopterAuto));
    const int before = f->setpoints;
    f->fly(200);
    EXPECT_EQ(f->setpoints, before);
    EXPECT_EQ(f->coprocessor.diagnostics().setpoints, static_cast<std::uint32_t>(f->setpoints));
    EXPECT_EQ(f->coprocessor.diagnostics().setpoints_withheld, 0U);
    EXPECT_FALSE(f->lost_input);
}
INSTANTIATE_TEST_SUITE_P(Rates, CoprocessorRate, ::testing::Values(10.0F, 20.0F, 50.0F));

TEST(CoprocessorMode, AdviseOnlyWarnsAndNeverSteers)
{
    const auto f = make_flight({{Param::mode, 1.0F}});
    ASSERT_NO_FATAL_FAILURE(settle(*f));
    f->obstacles = {f->position + Vec3(0.0F, 40.0F, 0.0F)};
    std::size_t collisions = 0;
    std::size_t texts = 0;
    for (int i = 0; i < 600; ++i) {
        f->fly(1);
        collisions += f->said_of<Collision>().size();
        for (const Statustext& m : f->said_of<Statustext>()) {
            texts += std::string(m.text.data(), 14) == "jink: conflict" ? 1U : 0U;
        }
        for (const Collision& m : f->said_of<Collision>()) {
            EXPECT_EQ(m.id, 1U);
            EXPECT_EQ(m.action, static_cast<std::uint8_t>(link::CollisionAction::report));
        }
        ASSERT_TRUE(f->said_of<SetPositionTargetLocalNed>().empty());
        ASSERT_TRUE(f->mode_requests().empty());
        ASSERT_EQ(f->last.control, Control::autopilot);
    }
    EXPECT_GE(collisions, 3U);
    EXPECT_GE(texts, 1U);
}

TEST(CoprocessorMode, OffSaysNothingOfConflicts)
{
    const auto f = make_flight({{Param::mode, 0.0F}});
    ASSERT_TRUE(f->until(healthy, 200));
    f->obstacles = {f->position + Vec3(0.0F, 40.0F, 0.0F)};
    for (int i = 0; i < 400; ++i) {
        f->fly(1);
        ASSERT_TRUE(f->said_of<Collision>().empty());
        ASSERT_TRUE(f->said_of<SetPositionTargetLocalNed>().empty());
        ASSERT_TRUE(f->mode_requests().empty());
    }
    EXPECT_EQ(f->last.state, link::SystemState::standby);
}

TEST(CoprocessorPort, LostWhileAvoidingStopsTheStreamAndDropsWhatWasQueued)
{
    const auto f = make_flight();
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    f->port.room = 5;  // the line chokes: bytes pile up
    f->fly(10);
    const std::size_t waiting = f->endpoint.pending().size();
    ASSERT_GT(waiting, 0U);
    ASSERT_EQ(f->endpoint.diagnostics().bytes_discarded, 0U);
    f->port.room = 1U << 20U;
    f->port.state = hal::PortState::lost;
    const std::uint32_t sent = f->coprocessor.diagnostics().setpoints;
    for (int i = 0; i < 50; ++i) {
        f->fly(1);
        ASSERT_TRUE(has(f->last, Fault::port_lost));
        ASSERT_EQ(f->last.bytes_out, 0U);
        ASSERT_FALSE(f->last.setpoint_sent);
        ASSERT_EQ(f->last.control, Control::autopilot);
        ASSERT_TRUE(f->endpoint.pending().empty());
    }
    EXPECT_EQ(f->coprocessor.diagnostics().setpoints, sent);
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().lost_by_fault, 1U);
    EXPECT_GE(f->endpoint.diagnostics().bytes_discarded, waiting / 2);

    f->port.state = hal::PortState::open;
    const auto reopened = static_cast<std::uint32_t>(f->now.us / 1000);
    for (int i = 0; i < 100; ++i) {
        f->fly(1);
        for (const SetPositionTargetLocalNed& m : f->said_of<SetPositionTargetLocalNed>()) {
            ASSERT_GT(m.time_boot_ms, reopened) << "said before the line broke";
        }
    }
    EXPECT_TRUE(healthy(f->last));
}

TEST(CoprocessorReboot, ForgetsEverythingThatTheOldAutopilotSaidAndRecovers)
{
    const auto f = make_flight();
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    ASSERT_GT(f->last.tracks, 0U);
    f->obstacles.clear();
    f->boot_us = 1'000'000;
    f->mode = wire::kCopterLoiter;
    const auto rebooted = [&](const StepReport&) { return f->coprocessor.diagnostics().autopilot_reboots > 0; };
    ASSERT_TRUE(f->until(rebooted, 200));
    const auto texts = f->said_of<Statustext>();
    EXPECT_TRUE(std::any_of(texts.begin(), texts.end(), [](const Statustext& m) {
        return std::string_view(m.text.data()).starts_with("jink: autopilot restarted");
    })) << "the pilot must know why nobody avoids any more";
    EXPECT_EQ(f->coprocessor.flying(), nullptr);
    EXPECT_EQ(f->last.control, Control::autopilot);
    EXPECT_FALSE(f->last.setpoint_sent);
    EXPECT_EQ(f->last.tracks, 0U);
    const int before = f->setpoints;
    ASSERT_TRUE(f->until(healthy, 200));
    f->fly(100);
    EXPECT_EQ(f->setpoints, before);
    EXPECT_EQ(f->coprocessor.diagnostics().autopilot_reboots, 1U);

    f->mode = wire::kCopterAuto;
    f->fly(200);
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    ASSERT_TRUE(f->until(controls));
    EXPECT_EQ(f->coprocessor.takeover_diagnostics().taken, 2U);
}

/// A threat that appears at 16 m, 3 s ahead. The first one is ahead on the way, the second one aside.
TEST(CoprocessorStream, AThreatThatAppearsNearIsAnsweredInTheStepThatHearsIt)
{
    for (const Vec3& place : {Vec3(0.4F, 16.0F, 0.0F), Vec3(40.0F, 16.0F, 0.0F)}) {
        const auto f = make_flight();
        ASSERT_NO_FATAL_FAILURE(settle(*f));
        while (f->ticks % 10 != 0) {
            f->fly(1);
        }
        ASSERT_EQ(f->last.tracks, 0U);
        f->obstacles = {f->position + place};
        f->fly(1);
        const bool near = place.x() < 1.0F;
        EXPECT_EQ(f->last.guidance.wants_control, near);
        EXPECT_EQ(f->last.guidance.by != 0, near);
        EXPECT_EQ(f->said_of<SetPositionTargetLocalNed>().size(), near ? 1U : 0U);
        EXPECT_EQ(f->mode_requests().size(), near ? 1U : 0U);
        EXPECT_EQ(f->last.tracks, 1U);
    }
}

/// The stream has a fixed rate, but a new decision is sent at once.
TEST(CoprocessorStream, ANewCommandGoesOutInTheStepThatDecidesIt)
{
    const auto f = make_flight({{Param::rate, 10.0F}});
    ASSERT_NO_FATAL_FAILURE(take_over(*f));
    Vec3 sent = Vec3::Zero();
    TimePoint sent_at{};
    int early = 0;
    for (int i = 0; i < 400 && f->last.control == Control::ours; ++i) {
        if (i == 60) {  // another near threat on the path
            f->obstacles.push_back(f->position + f->velocity.normalized() * 9.0F);
        }
        f->fly(1);
        const auto said = f->said_of<SetPositionTargetLocalNed>();
        const bool leads = f->last.control == Control::ours;
        if (leads && i > 10 && (f->last.guidance.velocity - sent).norm() > 1.01F) {
            ASSERT_FALSE(said.empty()) << "tick " << i;
            early += f->now - sent_at < 0.09F ? 1 : 0;
        }
        if (!said.empty()) {
            sent = Vec3(said.back().vy, said.back().vx, -said.back().vz);
            sent_at = f->now;
        }
    }
    EXPECT_GT(early, 0) << "nothing was ever decided between two turns: this says nothing";
}

}  // namespace
}  // namespace jink::app::test
