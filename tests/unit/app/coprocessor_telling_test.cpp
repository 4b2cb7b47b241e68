// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's reports about itself, step by step: state, faults, notices, last words.
#include <array>

#include <gtest/gtest.h>

#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

using link::Severity;
using link::SystemState;

TEST(TellingState, WaitingIsBootAndEveryOtherFaultIsCritical)
{
    const auto t = teller();
    t->heartbeats = t->own_state = false;
    EXPECT_EQ(t->step().state, SystemState::boot) << "nothing heard";
    t->own_state = true;
    EXPECT_EQ(t->step().faults, bit(Fault::no_autopilot));
    EXPECT_EQ(t->last.state, SystemState::boot);
    t->port.state = hal::PortState::lost;
    EXPECT_EQ(t->step().state, SystemState::critical) << "no autopilot, and the port is lost";
    t->port.state = hal::PortState::open;
    EXPECT_EQ(t->step().state, SystemState::boot);
    t->heartbeats = true;
    t->beat();
    EXPECT_EQ(t->step().state, SystemState::active);
    t->own_state = false;
    t->fly(30);
    EXPECT_EQ(t->last.faults, bit(Fault::own_state_stale));
    EXPECT_EQ(t->last.state, SystemState::critical);
    t->own_state = true;
    t->fly(1);
    EXPECT_EQ(t->last.state, SystemState::active);
    t->heartbeats = false;
    t->fly(240);
    EXPECT_EQ(t->last.faults, bit(Fault::autopilot_silent));
    EXPECT_EQ(t->last.state, SystemState::critical);
    t->heartbeats = true;
    t->beat();
    EXPECT_EQ(t->step().state, SystemState::active);
    EXPECT_EQ(t->step(600'000).faults, bit(Fault::late));
    EXPECT_EQ(t->last.state, SystemState::critical);
    EXPECT_EQ(t->step().state, SystemState::active);
    t->coprocessor.stay_passive();
    EXPECT_EQ(t->step().state, SystemState::critical);
}

TEST(TellingState, OwnStateThatNeverCameAndAirspaceWithoutAPlaceAreWaitedFor)
{
    const auto t = teller();
    t->own_state = false;
    t->step();
    EXPECT_EQ(t->step().faults, bit(Fault::own_state_missing));
    EXPECT_EQ(t->last.state, SystemState::boot);
    t->own_state = true;
    link::Constraint closed;
    closed.cylinder.circle.radius = 10.0F;
    closed.cylinder.top = 100.0F;
    closed.about = link::GlobalPosition{473977420, 85455940, 488000};
    t->coprocessor.set_constraints({&closed, 1}, t->now);
    t->step();
    EXPECT_EQ(t->step().faults, bit(Fault::airspace_unplaced));
    EXPECT_EQ(t->last.state, SystemState::boot);
}

TEST(TellingState, OnGuardIsArmedWhileAnythingIsDoneAboutConflicts)
{
    for (const float mode : {0.0F, 1.0F, 2.0F}) {
        const auto t = teller({{Param::mode, mode}});
        t->fly(3);
        EXPECT_EQ(t->last.state, mode > 0.0F ? SystemState::active : SystemState::standby) << mode;
        t->autopilot.armed = false;
        t->beat();
        EXPECT_EQ(t->step().state, SystemState::standby) << mode;
    }
}

TEST(TellingHeartbeat, GoesOutEverySecondAndWithEachChangeOfState)
{
    const auto t = teller();
    t->heartbeats = t->own_state = false;
    t->step();
    EXPECT_EQ(t->link.heartbeats, std::vector<SystemState>{SystemState::boot}) << "at once";
    for (int i = 0; i < 49; ++i) {
        t->step();
        EXPECT_TRUE(t->link.heartbeats.empty()) << i;
    }
    t->step(19'999);
    EXPECT_TRUE(t->link.heartbeats.empty());
    t->step(1);
    EXPECT_EQ(t->link.heartbeats.size(), 1U) << "a second later";
    t->port.state = hal::PortState::lost;
    t->step();
    EXPECT_EQ(t->link.heartbeats, std::vector<SystemState>{SystemState::critical});
    t->step();
    EXPECT_TRUE(t->link.heartbeats.empty());
    t->fly(48);
    t->step();
    EXPECT_EQ(t->link.heartbeats.size(), 1U) << "a second after the change";
}

TEST(TellingFault, IsSaidOnceByItsBitsAndCounted)
{
    const auto t = teller();
    t->fly(60);
    for (std::uint32_t i = 1; i <= 2; ++i) {
        t->port.state = hal::PortState::lost;
        t->fly(20);
        EXPECT_EQ(t->said("jink: fault 0x10"), static_cast<int>(i));
        EXPECT_EQ(t->coprocessor.diagnostics().faults, i);
        t->port.state = hal::PortState::open;
        t->fly(20);
    }
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: fault 0x10"));
    EXPECT_EQ(t->said("jink: fault"), 2);
    const auto waiting = teller();
    waiting->heartbeats = waiting->own_state = false;
    waiting->fly(20);
    EXPECT_EQ(waiting->said(""), 0) << "boot is no fault";
}

TEST(TellingLastWords, SayWhatIsAskedOfTheAutopilot)
{
    const auto t = teller();
    t->step();
    EXPECT_TRUE(t->link.words.empty()) << "nobody keeps them";
    hal::LastWords words{};
    words.clear();
    t->coprocessor.keep_last_words(words);
    t->step();
    ASSERT_EQ(t->link.words.size(), 1U);
    EXPECT_FALSE(t->link.words[0].hold);
    EXPECT_EQ(t->link.words[0].text, "jink: processor fault, restarting");
    t->fly(60);
    t->put_ahead(40.0F, Vec3::Zero(), Vec3(0.0F, 0.4F, 0.0F));
    ASSERT_TRUE(t->until(leads));
    ASSERT_EQ(t->link.words.size(), 1U);
    EXPECT_TRUE(t->link.words[0].hold);
    EXPECT_EQ(t->link.words[0].text, "jink: processor fault, hold asked, restarting");
    t->heartbeats = false;
    t->fly(90);
    ASSERT_TRUE(leads(t->last));
    EXPECT_FALSE(t->link.words.at(0).hold) << "the last HEARTBEAT is too old to ask on";
    EXPECT_EQ(t->link.words.at(0).text, "jink: processor fault, restarting");
    t->coprocessor.stay_passive();
    t->step();
    EXPECT_EQ(t->link.words.at(0).text, "");
    EXPECT_FALSE(t->link.words.at(0).hold);
}

TEST(TellingNotices, WaitUntilAnAutopilotIsHeardAndAreSaidOnce)
{
    const auto t = teller();
    t->heartbeats = false;
    Text text;
    text << "jink: restart 1";
    EXPECT_TRUE(t->coprocessor.tell_when_heard(Severity::error, text));
    t->coprocessor.leave_out_reach_sets();
    t->fly(20);
    EXPECT_EQ(t->said(""), 0);
    t->heartbeats = true;
    t->beat();
    t->fly(100);
    EXPECT_TRUE(t->said_as(Severity::error, "jink: restart 1"));
    EXPECT_TRUE(t->said_as(Severity::critical, "jink: reach sets damaged, left out"));
    EXPECT_EQ(t->said(""), 2);
}

TEST(TellingNotices, ANeighbourThatAcceleratesHarderThanTheOwnVehicleMayIsSaidOnce)
{
    for (const float acceleration : {4.0F, 9.0F}) {  // VEH_ACC is 5
        const auto t = teller();
        t->fly(20);
        t->put_ahead(300.0F);
        t->traffic.back().source = world::TrackSource::datalink;
        t->traffic.back().at_rest = false;
        for (int i = 0; i < 150; ++i) {
            link::TrackReport& r = t->traffic.back();
            r.velocity = Vec3(0.0F, std::min(acceleration * 0.02F * static_cast<float>(i), 15.0F), 0.0F);
            r.position += 0.02F * r.velocity;
            r.stamp = t->now;
            t->fly(1);
        }
        EXPECT_EQ(t->said("jink: neighbour accelerates beyond VEH_ACC"), acceleration > 5.0F ? 1 : 0) << acceleration;
    }
}

TEST(TellingNotices, TooMuchTrafficIsSaidOnce)
{
    const auto t = teller();
    t->heartbeats = false;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 45; ++k) {
            link::TrackReport r;
            r.id = static_cast<world::TrackId>(1000 + 45 * i + k);
            r.stamp = t->now;
            r.position = Vec3(500.0F + 20.0F * static_cast<float>(k), 300.0F * static_cast<float>(i), 50.0F);
            r.has_velocity = true;
            t->link.next.tracks.unchecked_push_back(r);
        }
        t->step();
    }
    const world::TrackDiagnostics& d = t->coprocessor.track_diagnostics();
    ASSERT_GT(d.floods + d.replaced + d.full, 0U);
    EXPECT_EQ(t->said("jink: too much traffic"), 0) << "nobody is there";
    t->heartbeats = true;
    t->beat();
    t->fly(100);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: too much traffic, some is left out"));
    EXPECT_EQ(t->said("jink: too much traffic"), 1);
    const auto quiet = teller();
    quiet->put_ahead(300.0F);
    quiet->fly(100);
    EXPECT_EQ(quiet->said("jink: too much traffic"), 0);
}

TEST(TellingNotices, ReachSetsThatDoNotSuitTheVehicleAreSaidEachTimeThatTheyComeNotTo)
{
    const auto set = [](Teller& t, std::string_view name, float value) {
        link::ParamRequest request;
        request.kind = link::ParamRequestKind::set;
        std::copy(name.begin(), name.end(), request.name.begin());
        request.value = value;
        t.link.next.params.unchecked_push_back(request);
        t.fly(5);
    };
    const auto t = teller({{Param::acceleration, 4.0F}});
    t->heartbeats = false;
    t->fly(5);
    EXPECT_EQ(t->said("jink: reach sets do not"), 0) << "nobody is there";
    t->heartbeats = true;
    t->beat();
    t->fly(50);
    EXPECT_TRUE(t->said_as(Severity::warning, "jink: reach sets do not suit this vehicle"));
    EXPECT_EQ(t->said("jink: reach sets do not"), 1);
    set(*t, "VEH_ACC", 5.0F);
    set(*t, "VEH_ACC", 4.0F);
    EXPECT_EQ(t->said("jink: reach sets do not"), 2);
    set(*t, "JNK_METHODS", 1.0F);
    set(*t, "VEH_ACC", 5.0F);
    set(*t, "VEH_ACC", 4.0F);
    EXPECT_EQ(t->said("jink: reach sets do not"), 2) << "nobody asks them";
}

/// Records the reported application state.
class NotingBus final : public link::SensorBus {
public:
    void receive(TimePoint /*now*/, link::Inbox& /*inbox*/) noexcept override {}
    void service(TimePoint /*now*/, const link::BusStatus& status) noexcept override { statuses.push_back(status); }
    bool is_lost() const noexcept override { return lost; }
    void follow_origin(const std::optional<link::GlobalPosition>& /*origin*/) noexcept override {}
    void serve(link::ParamServer& /*params*/) noexcept override {}
    void send_text(Severity /*severity*/, std::string_view /*text*/) noexcept override {}
    bool send_near(const link::NearObject& /*object*/) noexcept override { return true; }

    bool lost = false;
    std::vector<link::BusStatus> statuses;
};

TEST(TellingShutDown, TakesBackWhatWaitsAndSaysCriticalLast)
{
    NotingBus bus;
    Teller t({}, &bus);
    t.fly(60);
    t.link.forget();
    bus.statuses.clear();
    t.coprocessor.shut_down(t.now);
    const std::vector<std::string> calls{"drop set-point", "drop request", "heartbeat"};
    EXPECT_EQ(t.link.calls, calls);
    EXPECT_EQ(t.link.heartbeats, std::vector<SystemState>{SystemState::critical});
    ASSERT_EQ(t.link.texts.size(), 1U);
    EXPECT_EQ(t.link.texts[0].severity, Severity::notice);
    EXPECT_EQ(t.link.texts[0].text, "jink: stopped");
    ASSERT_EQ(bus.statuses.size(), 1U);
    EXPECT_EQ(bus.statuses[0].state, SystemState::critical);
    EXPECT_FALSE(bus.statuses[0].advising_only);
    EXPECT_EQ(bus.statuses[0].faults, 0);
}

TEST(TellingShutDown, InControlAsksToHoldOnFreshEvidenceAlone)
{
    for (const bool fresh : {true, false}) {
        const auto t = in_command();
        t->heartbeats = fresh;
        t->fly(90);
        ASSERT_TRUE(leads(t->last));
        t->link.forget();
        t->coprocessor.shut_down(t->now);
        const auto hold = std::find(t->link.calls.begin(), t->link.calls.end(), "ask to hold");
        EXPECT_EQ(hold != t->link.calls.end(), fresh);
        EXPECT_TRUE(std::find(hold, t->link.calls.end(), "drop request") == t->link.calls.end())
            << "what was asked for is not taken back";
        t->heartbeats = true;
        t->beat();
        t->step();
        EXPECT_EQ(t->last.control, Control::autopilot) << "control was dropped for good";
    }
}

TEST(TellingBus, ThatWasNeverThereIsWaitedForAndALostOneIsCritical)
{
    NotingBus bus;
    bus.lost = true;
    Teller t({}, &bus);
    t.fly(20);
    EXPECT_EQ(t.last.faults, bit(Fault::bus_lost));
    EXPECT_EQ(t.last.state, SystemState::boot);
    bus.lost = false;
    t.fly(20);
    EXPECT_EQ(t.last.state, SystemState::active);
    bus.lost = true;
    t.fly(2);
    EXPECT_EQ(t.last.state, SystemState::critical);
}

}  // namespace
}  // namespace jink::app::test
