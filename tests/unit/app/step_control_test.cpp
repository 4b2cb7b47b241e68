// SPDX-License-Identifier: BSD-3-Clause
// Taking over in Coprocessor::step: which vehicles are steered and how, output waiting for the line, alternative
// requests.
#include <gtest/gtest.h>

#include "tests/unit/app/step_flight.hpp"

namespace jink::app::test {
namespace {

const Vec3 kMast(0.4F, 60.0F, 50.0F);

TEST(StepControl, TheStreamSaysTheOwnMotionUntilTheVehicleFollows)
{
    StepFlight f;
    f.mast = kMast;
    bool streamed = false;
    ASSERT_TRUE(f.until([&](const StepReport& r) {
        if (r.setpoint_sent && r.control != Control::ours) {
            streamed = true;
            EXPECT_EQ(f.wire.velocities.back(), f.coprocessor.own().velocity);
        }
        return r.control == Control::ours;
    }));
    EXPECT_TRUE(streamed);
    EXPECT_EQ(f.asked_for("external"), 1);
    EXPECT_EQ(f.said("jink: avoiding, has control"), 1);
    for (int i = 0; i < 30; ++i) {
        f.tick();
        if (f.last.setpoint_sent) {
            EXPECT_EQ(f.wire.velocities.back(), f.last.guidance.velocity);
        }
    }
    EXPECT_EQ(f.counted().setpoints, f.wire.velocities.size());
    EXPECT_EQ(f.counted().setpoints_withheld, 0U);
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::autopilot; }, 2000));
    EXPECT_EQ(f.asked_for("11"), 1) << "the mode that stood before, as on the wire";
    EXPECT_EQ(f.mode, link::FlightMode::mission);
    const std::size_t before = f.wire.velocities.size();
    f.until([](const StepReport&) { return false; }, 50);
    EXPECT_EQ(f.wire.velocities.size(), before);
}

/// PX4 says a change of its mode at its next HEARTBEAT, up to a second later.
TEST(StepControl, WhatIsWantedIsFlownFromTheGrantOnAndNotFromTheHeartbeatThatShowsIt)
{
    StepFlight f({{Param::rate, 10.0F}});
    f.mast = kMast;
    f.answers = false;
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::requesting; }));
    EXPECT_EQ(f.wire.velocities.back(), f.coprocessor.own().velocity) << "not granted yet";
    f.until([](const StepReport& r) { return r.setpoint_sent; }, 20);
    f.until([](const StepReport& r) { return r.guidance.wants_control; }, 20);
    ASSERT_EQ(f.last.control, Control::requesting);
    f.wire.in.mode_answers.unchecked_push_back({true, 1});
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.setpoint_sent; }, 2)) << "does not wait for its turn";
    for (int i = 0; i < 10; ++i) {
        if (f.last.setpoint_sent) {
            ASSERT_EQ(f.last.control, Control::requesting);
            EXPECT_EQ(f.wire.velocities.back(), f.last.guidance.velocity);
        }
        EXPECT_TRUE(f.last.guidance.wants_control) << "decides as in control, in every step";
        f.tick();
    }
}

/// Whatever the step in which the grant comes: before control a plan is not made in every one.
TEST(StepControl, TheStreamNeverSaysAVelocityThatNobodyWants)
{
    for (int offset = 0; offset < 12; ++offset) {
        StepFlight f({{Param::rate, 50.0F}});
        f.mast = kMast;
        f.answers = false;
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::requesting; }));
        f.until([](const StepReport&) { return false; }, offset);
        f.wire.in.mode_answers.unchecked_push_back({true, 1});
        f.until([](const StepReport&) { return false; }, 10);
        for (const Vec3& said : f.wire.velocities) {
            EXPECT_GT(said.norm(), 2.0F) << "neither zero nor a stop; grant after " << offset;
        }
    }
}

/// An intruder so near that no method has an answer.
void meet_late(StepFlight& f)
{
    f.until([](const StepReport&) { return false; }, 60);
    f.intruder = f.position + Vec3(0.3F, 10.0F, 0.0F);
    f.intruder_velocity = Vec3(0.0F, -5.0F, 0.0F);
}

bool flees(const StepReport& r) { return r.guidance.wants_control && r.guidance.by == 0; }

/// Between the grant and the HEARTBEAT that shows it, the autopilot follows the stream already.
TEST(StepControl, AFallbackIsStreamedFromTheRequestOn)
{
    StepFlight f;
    f.answers = false;
    meet_late(f);
    int announced = 0;
    int requested = 0;
    Vec3 before = Vec3::Zero();
    ASSERT_TRUE(f.until([&](const StepReport& r) {
        if (r.setpoint_sent && r.control == Control::announcing) {
            ++announced;
            before = f.velocity;
            EXPECT_EQ(f.wire.velocities.back(), f.coprocessor.own().velocity);
        }
        if (r.setpoint_sent && r.control == Control::requesting) {
            requested += flees(r) ? 1 : 0;
            EXPECT_EQ(f.wire.velocities.back(), flees(r) ? r.guidance.velocity : f.coprocessor.own().velocity);
        }
        return r.control == Control::ours;
    }));
    EXPECT_GT(announced, 0);
    EXPECT_GT(requested, 0);
    EXPECT_GT((f.velocity - before).norm(), 0.5F) << "before it is confirmed";
    EXPECT_TRUE(f.last.setpoint_sent) << "set-points before the grant may have been ignored";
}

/// A refused request, and then no conflict any more: nothing is left to flee from.
TEST(StepControl, TheStreamSaysTheOwnMotionWhereARequestIsNoLongerWanted)
{
    StepFlight f;
    f.obeys = f.answers = false;
    meet_late(f);
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::requesting; }));
    f.intruder_velocity = Vec3(60.0F, 0.0F, 0.0F);
    int unwanted = 0;
    for (int i = 0; i < 45; ++i) {
        f.tick();
        if (f.last.setpoint_sent && f.last.control == Control::requesting && !f.last.guidance.wants_control) {
            ++unwanted;
            EXPECT_EQ(f.wire.velocities.back(), f.coprocessor.own().velocity);
        }
    }
    EXPECT_GT(unwanted, 0);
}

TEST(StepControl, TheStreamKeepsItsRate)
{
    StepFlight f({{Param::rate, 10.0F}});
    f.mast = kMast;
    ASSERT_TRUE(f.until(StepFlight::ours));
    TimePoint sent{};
    Vec3 said = Vec3::Zero();
    int n = 0;
    for (int i = 0; i < 60 && f.last.control == Control::ours; ++i) {
        f.tick();
        if (f.last.setpoint_sent) {
            const bool anew = (f.wire.velocities.back() - said).norm() > 1.0F;
            if (n++ > 0) {
                EXPECT_LE(f.now - sent, 0.1001F);
                EXPECT_TRUE(anew || f.now - sent > 0.0899F) << f.now - sent;
            }
            sent = f.now;
            said = f.wire.velocities.back();
        }
    }
    EXPECT_GT(n, 8);
}

TEST(StepControl, ASetPointThatIsNoNumberIsWithheldAndControlDropped)
{
    StepFlight f;
    f.mast = kMast;
    ASSERT_TRUE(f.until(StepFlight::ours));
    const std::size_t sent = f.wire.velocities.size();
    f.velocity.x() = std::numeric_limits<float>::quiet_NaN();
    f.tick();
    EXPECT_TRUE(f.has(Fault::not_finite));
    EXPECT_EQ(f.counted().setpoints_withheld, 1U);
    EXPECT_EQ(f.wire.velocities.size(), sent);
    EXPECT_NE(f.last.control, Control::ours);
}

/// 1: advise. Nothing is asked for, nothing streamed, and the pilot is warned all the same.
TEST(StepControl, AdvisingItSteersNobody)
{
    StepFlight f({{Param::mode, 1.0F}});
    f.mast = kMast;
    bool conflict = false;
    f.until([&](const StepReport& r) {
        conflict = conflict || r.guidance.conflict.has_value();
        return false;
    });
    EXPECT_TRUE(conflict);
    EXPECT_FALSE(f.wire.warnings.empty());
    EXPECT_TRUE(f.wire.velocities.empty());
    EXPECT_TRUE(f.wire.requests.empty());
}

TEST(StepControl, OnlyAVehicleThatCanBeSteeredIs)
{
    const auto steered = [](StepFlight& f) {
        f.mast = kMast;
        return f.until(StepFlight::ours, 400);
    };
    {
        StepFlight f;
        f.steerable = false;
        EXPECT_FALSE(steered(f));
        EXPECT_EQ(f.said("jink: cannot steer this vehicle, advising only"), 1);
        EXPECT_TRUE(f.wire.requests.empty());
    }
    {
        StepFlight f;
        f.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
        f.fixed_wing = true;
        EXPECT_FALSE(steered(f)) << "a plane, and we would steer it as a copter";
        EXPECT_TRUE(f.wire.requests.empty());
    }
    const std::initializer_list<std::pair<Param, float>> wing{{Param::fixed_wing, 1.0F}};
    {
        StepFlight f(wing);
        f.fixed_wing = true;
        EXPECT_FALSE(steered(f)) << "it is told waypoints, for which there is no origin";
    }
    {
        StepFlight f(wing);
        f.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
        f.fixed_wing = true;
        EXPECT_TRUE(steered(f));
    }
    {
        StepFlight f({{Param::fixed_wing, 1.0F}, {Param::methods, 4.0F}});
        f.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
        f.fixed_wing = true;
        EXPECT_FALSE(steered(f)) << "it cannot fly what reciprocal avoidance asks for";
    }
}

TEST(StepControl, AnUnfollowedCommandIsGivenUpAndTheHoldAskedFor)
{
    StepFlight f;
    f.mast = kMast;
    f.deaf = true;
    ASSERT_TRUE(f.until(StepFlight::ours));
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.control != Control::ours; }, 400));
    EXPECT_EQ(f.said("jink: set-points not followed, asks to hold"), 1);
    EXPECT_GE(f.asked_for("hold"), 1);
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().unfollowed, 1U);
}

TEST(StepControl, ARefusedModeAdvisesAndAsksToHoldInTime)
{
    StepFlight f;
    f.mast = kMast;
    f.obeys = false;
    bool denied = false;
    ASSERT_TRUE(f.until([&](const StepReport&) {
        if (!denied && f.asked_for("external") > 0) {
            f.wire.in.mode_answers.unchecked_push_back({false, 1});
        }
        denied = f.said("jink: control refused, advising only") > 0;
        return denied;
    }));
    EXPECT_EQ(f.last.control, Control::refused);
    EXPECT_EQ(f.asked_for("hold"), 0) << "it is early yet";
    float left = 0.0F;
    ASSERT_TRUE(f.until([&](const StepReport& r) {
        left = r.guidance.conflict ? r.guidance.conflict->time_to_loss : 0.0F;
        return f.asked_for("hold") > 0;
    }));
    // From 5 m/s with 5 m/s2 after a lag of 0.25 s, and the reserve of 0.75 s.
    EXPECT_GT(left, 1.0F);
    EXPECT_LT(left, 3.5F);
}

TEST(StepControl, NothingIsAskedThatMayBeAskedAgainWhileTheLineIsFull)
{
    for (const std::size_t waiting : {1023U, 1024U}) {
        StepFlight f;
        f.until([](const StepReport&) { return false; }, 10);
        f.mast = kMast;
        f.wire.waiting.resize(waiting);
        f.port.room = 0;
        f.answers = false;
        f.until([](const StepReport&) { return false; }, 5);
        const int before = f.asked_for("heartbeat");
        f.until([](const StepReport& r) { return r.guidance.wants_control; });
        f.until([](const StepReport&) { return false; }, 60);
        EXPECT_EQ(f.asked_for("heartbeat") > before, waiting < 1024U) << waiting;
    }
}

TEST(StepControl, WhatWaitsAndIsNoLongerTrueIsTakenBack)
{
    StepFlight f;
    f.tick();
    const int setpoints = f.wire.setpoints_dropped;
    const int requests = f.wire.requests_dropped;
    f.until([](const StepReport&) { return false; }, 10);
    EXPECT_EQ(f.wire.setpoints_dropped, setpoints + 10) << "no stream is due";
    EXPECT_EQ(f.wire.requests_dropped, requests + 10) << "nothing was asked for lately";
    f.mast = kMast;
    f.obeys = false;
    ASSERT_TRUE(f.until([&](const StepReport&) { return f.asked_for("external") > 0; }));
    const int asked = f.wire.requests_dropped;
    f.until([](const StepReport&) { return false; }, 10);
    EXPECT_EQ(f.wire.requests_dropped, asked) << "a request that waits for a fifth of a second is still meant";
    EXPECT_EQ(f.asked_for("external"), 1);
    // While a stream is due, one that is as old as its period is taken back, and no other.
    StepFlight g({{Param::rate, 10.0F}});
    g.mast = kMast;
    ASSERT_TRUE(g.until(StepFlight::ours));
    TimePoint sent = g.now;
    for (int i = 0; i < 40; ++i) {
        const int before = g.wire.setpoints_dropped;
        g.tick();
        sent = g.last.setpoint_sent ? g.now : sent;
        EXPECT_EQ(g.wire.setpoints_dropped - before, g.now - sent >= 0.1F ? 1 : 0);
    }
}

TEST(StepControl, SticksThatMoveEndIt)
{
    for (const float threshold : {30.0F, 0.0F}) {
        StepFlight f({{Param::sticks, threshold}});
        f.mast = kMast;
        ASSERT_TRUE(f.until(StepFlight::ours));
        for (int i = 0; i < 10; ++i) {
            f.wire.in.has_sticks = true;
            f.wire.in.sticks.sticks = {i < 3 ? 0.0F : 0.8F, 0.0F, 0.0F, 0.0F};
            f.tick();
        }
        EXPECT_EQ(f.last.control == Control::ours, threshold == 0.0F);
        EXPECT_EQ(f.said("jink: sticks moved, hands off"), threshold == 0.0F ? 0 : 1);
    }
}

TEST(StepControl, ARestartInControlIsSaidAsOne)
{
    StepFlight f;
    f.mast = kMast;
    ASSERT_TRUE(f.until(StepFlight::ours));
    f.hear_autopilot().rebooted = true;
    f.hear_own();
    f.step();
    EXPECT_EQ(f.said("jink: autopilot restarted, control dropped"), 1);
    EXPECT_EQ(f.last.control, Control::autopilot);
    EXPECT_FALSE(f.last.setpoint_sent);
    EXPECT_EQ(f.coprocessor.flying(), nullptr);
}

TEST(StepControl, LastWordsAskForTheHoldWhileTheVehicleFollows)
{
    StepFlight f;
    hal::LastWords words;
    f.tick();
    EXPECT_EQ(f.wire.last_words.second, "") << "nobody keeps them";
    f.coprocessor.keep_last_words(words);
    f.tick();
    EXPECT_FALSE(f.wire.last_words.first);
    EXPECT_EQ(f.wire.last_words.second, "jink: processor fault, restarting");
    f.mast = kMast;
    ASSERT_TRUE(f.until(StepFlight::ours));
    f.tick();
    EXPECT_TRUE(f.wire.last_words.first);
    EXPECT_EQ(f.wire.last_words.second, "jink: processor fault, hold asked, restarting");
    f.coprocessor.stay_passive();
    f.tick();
    EXPECT_EQ(f.wire.last_words.second, "");
}

TEST(StepControl, AShutDownSilencesAndSaysSo)
{
    StepFlight f({}, StepBench::Bus::there);
    f.mast = kMast;
    ASSERT_TRUE(f.until(StepFlight::ours));
    const int holds = f.asked_for("hold");
    const int setpoints = f.wire.setpoints_dropped;
    const int requests = f.wire.requests_dropped;
    const std::size_t heartbeats = f.wire.heartbeats.size();
    f.wire.waiting.resize(20);
    f.coprocessor.shut_down(f.now);
    EXPECT_EQ(f.asked_for("hold"), holds + 1);
    EXPECT_EQ(f.wire.setpoints_dropped, setpoints + 1);
    EXPECT_EQ(f.wire.requests_dropped, requests + 1);
    ASSERT_EQ(f.wire.heartbeats.size(), heartbeats + 1);
    EXPECT_EQ(f.wire.heartbeats.back(), link::SystemState::critical);
    EXPECT_EQ(f.said("jink: stopped"), 1);
    EXPECT_EQ(f.bus.statuses.back().state, link::SystemState::critical);
    EXPECT_TRUE(f.wire.waiting.empty()) << "written as far as the port takes it";
}

}  // namespace
}  // namespace jink::app::test
