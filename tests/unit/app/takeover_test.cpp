// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/takeover.hpp"

namespace jink::app {
namespace {

using link::FlightMode;

constexpr std::uint32_t kMission = 3, kExternal = 4, kLoiter = 5, kManual = 2;

enum class Beat : std::uint8_t { none, former, external, manual, hold, disarmed };

struct Step {
    bool wants = false;
    bool may_act = true;
    Beat beat = Beat::none;
    float dt = 0.02F;
    bool denied = false;
};

std::string describe(const Step& s)
{
    static constexpr const char* kBeats[] = {"none", "former", "external", "manual", "hold", "disarmed"};
    return std::string(s.wants ? "wants" : "calm") + (s.may_act ? "" : " fault") + (s.denied ? " denied" : "") + " " +
           kBeats[static_cast<std::size_t>(s.beat)] + " +" + std::to_string(s.dt);
}

TakeoverInput input_of(const Step& s)
{
    TakeoverInput input;
    input.wants_control = input.in_conflict = input.urgent_hold = s.wants;
    input.may_act = s.may_act;
    input.mode_denied = s.denied;
    input.has_report = s.beat != Beat::none;
    input.report.armed = s.beat != Beat::disarmed;
    switch (s.beat) {
    case Beat::none: break;
    case Beat::former:
    case Beat::disarmed:
        input.report.mode = FlightMode::mission;
        input.report.custom_mode = kMission;
        break;
    case Beat::external:
        input.report.mode = FlightMode::external;
        input.report.custom_mode = kExternal;
        break;
    case Beat::manual:
        input.report.mode = FlightMode::manual;
        input.report.custom_mode = kManual;
        break;
    case Beat::hold:
        input.report.mode = FlightMode::hold;
        input.report.custom_mode = kLoiter;
        break;
    }
    return input;
}

/// A take-over with its clock. As in the application, the newest report stays in the input when none is new.
struct Bench {
    Takeover takeover;
    TimePoint now{1'000'000};
    link::AutopilotReport last;

    TakeoverOutput step(const Step& s)
    {
        now = now + s.dt;
        TakeoverInput input = input_of(s);
        if (input.has_report) {
            last = input.report;
        }
        input.report = last;
        return takeover.update(input, now);
    }
    [[nodiscard]] Control control() const { return takeover.control(); }
};

constexpr Step kWant{true, true, Beat::none, 0.02F, false};
constexpr Step kCalm{false, true, Beat::none, 0.02F, false};
constexpr Step wants(Beat beat, float dt = 0.02F) { return {true, true, beat, dt, false}; }
constexpr Step calm(Beat beat, float dt = 0.02F) { return {false, true, beat, dt, false}; }
constexpr Step fault(Beat beat, float dt = 0.02F) { return {true, false, beat, dt, false}; }
constexpr Step denied(float dt) { return {true, true, Beat::none, dt, true}; }

Bench requesting()
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.control(), Control::requesting);
    return b;
}

Bench flying()
{
    Bench b = requesting();
    EXPECT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
    return b;
}

Bench returning()
{
    Bench b = flying();
    EXPECT_EQ(b.step(calm(Beat::external, 1.0F)).action, TakeoverAction::request_former);
    EXPECT_EQ(b.control(), Control::returning);
    return b;
}

Bench refused()
{
    Bench b = requesting();
    b.step(wants(Beat::none, 1.01F));
    b.step(wants(Beat::none, 1.01F));
    EXPECT_EQ(b.control(), Control::requesting);
    EXPECT_EQ(b.step(wants(Beat::none, 1.01F)).event, TakeoverEvent::refused);
    EXPECT_EQ(b.control(), Control::refused);
    return b;
}

TEST(Takeover, TakesOverAndGivesBack)
{
    Bench b;
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none);
    EXPECT_EQ(b.control(), Control::autopilot);  // nothing heard yet
    b.step(wants(Beat::former));
    EXPECT_TRUE(b.takeover.streaming());
    EXPECT_FALSE(b.takeover.in_control());
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none);
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::none, 0.021F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.takeover.former_mode(), kMission);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
    EXPECT_EQ(b.step(calm(Beat::none, 0.5F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(calm(Beat::external, 0.51F)).action, TakeoverAction::request_former);  // asked again
    EXPECT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_FALSE(b.takeover.streaming());
    const TakeoverDiagnostics& d = b.takeover.diagnostics();
    EXPECT_EQ(d.requests, 1U);
    EXPECT_EQ(d.taken, 1U);
    EXPECT_EQ(d.given_back, 1U);
    EXPECT_EQ(d.refused + d.overruled + d.lost_by_fault, 0U);
}

TEST(Takeover, LeavesAVehicleAloneThatFliesNoMission)
{
    for (const Beat beat : {Beat::external, Beat::manual, Beat::hold, Beat::disarmed}) {
        Bench b;
        b.step(wants(beat));
        b.step(wants(beat, 1.0F));
        EXPECT_EQ(b.control(), Control::autopilot) << describe(wants(beat));
    }
    Takeover landed;
    TakeoverInput input = input_of(wants(Beat::former));
    input.report.landed = true;
    EXPECT_EQ(landed.update(input, TimePoint{1'000'000}).action, TakeoverAction::none);
    EXPECT_EQ(landed.control(), Control::autopilot);
}

TEST(Takeover, AnnouncementEndsWithTheWish)
{
    Bench b;
    b.step(wants(Beat::former));
    b.step(kCalm);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().requests, 0U);
}

TEST(Takeover, ExternalModeChosenByThePilotWhileAnnouncingIsThePilots)
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::overruled);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(Takeover, TriesThreeTimesThenAsksForHoldThreeTimes)
{
    Bench b = refused();
    EXPECT_EQ(b.takeover.diagnostics().requests, 3U);
    EXPECT_EQ(b.takeover.diagnostics().refused, 1U);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
    b.step(calm(Beat::former));
    EXPECT_EQ(b.control(), Control::autopilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);  // the next conflict, a new attempt
}

TEST(Takeover, DenialShortensTheWait)
{
    Bench b = requesting();
    EXPECT_EQ(b.step(denied(0.02F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(denied(0.05F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(denied(0.07F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(denied(0.07F)).event, TakeoverEvent::refused);
}

TEST(Takeover, HoldThatWasAskedForIsNobodysElse)
{
    Bench b = refused();
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::none);
    EXPECT_EQ(b.control(), Control::refused);
    b.step(wants(Beat::external));  // from the hold mode on it is a pilot who chooses
    EXPECT_EQ(b.control(), Control::refused);
}

TEST(Takeover, PilotsModeWhileRefusedEndsAllRequests)
{
    Bench b = refused();
    EXPECT_EQ(b.step(wants(Beat::manual)).event, TakeoverEvent::overruled);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
    }
}

TEST(Takeover, LateGrantIsTakenUp)
{
    Bench b = refused();
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
}

TEST(Takeover, LateGrantWaitsForTheEndOfAFault)
{
    Bench b = refused();
    b.step(fault(Beat::external));
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(b.step(kWant).event, TakeoverEvent::took_over);
}

TEST(Takeover, GrantAfterTheRefusedConflictIsGivenBack)
{
    Bench b = refused();
    b.step(kCalm);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(calm(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
}

TEST(Takeover, PilotsModeIsFinalUntilTheConflictIsOver)
{
    for (const Beat beat : {Beat::manual, Beat::hold, Beat::disarmed}) {
        for (Bench b : {requesting(), flying(), returning()}) {
            EXPECT_EQ(b.step(wants(beat)).event, TakeoverEvent::overruled) << describe(wants(beat));
            EXPECT_FALSE(b.takeover.streaming());
            for (int i = 0; i < 3; ++i) {
                EXPECT_EQ(b.step(wants(Beat::former, 1.0F)).action, TakeoverAction::none);
            }
            EXPECT_EQ(b.control(), Control::overruled);
            b.step(calm(Beat::former));
            EXPECT_EQ(b.control(), Control::autopilot);
            b.step(wants(Beat::former));
            EXPECT_EQ(b.control(), Control::announcing);
        }
    }
}

TEST(Takeover, FormerModeNotAskedForIsThePilots)
{
    Bench b = flying();
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::overruled);
}

TEST(Takeover, NewConflictWhileReturningDoesNotMakeTheConfirmationThePilots)
{
    Bench b = returning();
    b.step(kWant);
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::gave_back);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().overruled, 0U);
    EXPECT_EQ(b.takeover.diagnostics().given_back, 1U);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
}

TEST(Takeover, FormerModeLongAfterALostRequestIsThePilots)
{
    Bench b = returning();
    b.step(kWant);
    b.step(wants(Beat::external, 0.5F));
    b.step(wants(Beat::external, 0.6F));  // a second later still external: the request for the former mode was lost
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::overruled);
}

TEST(Takeover, FaultBeforeControlFallsSilent)
{
    Bench announcing;
    announcing.step(wants(Beat::former));
    for (Bench b : {announcing, requesting()}) {
        const TakeoverOutput out = b.step(fault(Beat::none));
        EXPECT_EQ(out.event, TakeoverEvent::none);
        EXPECT_EQ(out.action, TakeoverAction::none);
        EXPECT_EQ(b.control(), Control::autopilot);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
    }
}

TEST(Takeover, FaultInControlIsLost)
{
    for (Bench b : {flying(), returning()}) {
        EXPECT_EQ(b.step(fault(Beat::none)).event, TakeoverEvent::lost);
        EXPECT_EQ(b.control(), Control::autopilot);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 1U);
        EXPECT_EQ(b.step(fault(Beat::external)).event, TakeoverEvent::none);
        EXPECT_EQ(b.step(kWant).event, TakeoverEvent::took_over);  // nobody changed the mode since
    }
}

TEST(Takeover, HoldAfterALossIsNotResumed)
{
    Bench b = flying();
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::none);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(Takeover, PilotsModeOnTheTickOfAFaultIsThePilots)
{
    for (const Beat beat : {Beat::manual, Beat::former}) {
        Bench b = flying();
        EXPECT_EQ(b.step(fault(beat)).event, TakeoverEvent::overruled) << describe(fault(beat));
        EXPECT_FALSE(b.takeover.streaming());
    }
}

TEST(Takeover, GrantDuringAFaultIsTakenUpAndGivenBack)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    b.step(fault(Beat::former, 0.2F));  // sent before the request arrived
    b.step(fault(Beat::external, 0.5F));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.step(kCalm).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.takeover.diagnostics().taken, 1U);
    EXPECT_EQ(b.step(kCalm).action, TakeoverAction::request_former);
    EXPECT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
}

TEST(Takeover, ExternalModeLongAfterAnUnansweredRequestIsThePilots)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    b.step(fault(Beat::former, 1.1F));
    b.step(calm(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(Takeover, PilotsModeDuringAFaultAfterTheRequestIsThePilots)
{
    Bench b = requesting();
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(fault(Beat::manual)).event, TakeoverEvent::overruled);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::overruled);
}

TEST(Takeover, FlickeringFaultDoesNotMultiplyTheRequests)
{
    Bench b = requesting();
    for (int i = 0; i < 20; ++i) {
        b.step(fault(Beat::none));
        b.step(wants(Beat::former, 1.0F));
        b.step(wants(Beat::none, 0.1F));
    }
    EXPECT_EQ(b.takeover.diagnostics().requests, 3U);
    EXPECT_EQ(b.control(), Control::refused);
}

TEST(Takeover, DropForgetsAllUnlessByFault)
{
    Bench b = flying();
    b.takeover.drop(false);
    EXPECT_EQ(b.control(), Control::autopilot);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
}

/// What must hold whatever happens, kept by a witness that sees inputs and outputs only.
struct Witness {
    bool hands_off = false;       ///< overruled in this conflict
    bool due = false;             ///< the external mode, once seen, is ours to fly
    bool flown = false;           ///< and was confirmed
    int requests = 0;             ///< in this conflict, since last in control
    TimePoint streaming_since{};  ///< meaningful while streaming
    TimePoint requested{};
    bool seen_external = false;  ///< as the newest report

    /// Empty, or what is broken.
    std::string watch(const Bench& before, const Bench& after, const Step& s, const TakeoverOutput& out)
    {
        const Control control = after.control();
        const bool was_streaming = before.takeover.streaming(), streams = after.takeover.streaming();
        const bool was_flying = before.takeover.in_control(), flies = after.takeover.in_control();
        const bool foreign = s.beat == Beat::manual || s.beat == Beat::hold || s.beat == Beat::disarmed;
        seen_external = s.beat == Beat::none ? seen_external : s.beat == Beat::external;
        if (!s.wants) {
            requests = 0;
        }
        if (streams &&
            (control == Control::autopilot || control == Control::refused || control == Control::overruled)) {
            return "streams without being about to fly";
        }
        if (streams && !s.may_act) {
            return "streams in spite of a fault";
        }
        if (was_streaming && foreign && (streams || out.action != TakeoverAction::none)) {
            return "does not yield to the pilot at once";
        }
        if (hands_off && (out.action != TakeoverAction::none || streams)) {
            return "acts after the pilot's mode in the same conflict";
        }
        if (out.action == TakeoverAction::request_external) {
            if (!was_streaming || after.now - streaming_since < Takeover::kAnnounce) {
                return "asks for the external mode before the stream began";
            }
            if (++requests > Takeover::kTries) {
                return "asks too often";
            }
        }
        if (flies && !was_flying && (!seen_external || !due)) {
            return "takes control that was not given to it";
        }
        if (due && s.beat == Beat::external && s.may_act && !flies) {
            return "leaves the vehicle in the external mode without a stream";
        }
        if ((out.event == TakeoverEvent::lost) != (was_flying && !s.may_act && s.beat != Beat::former && !foreign)) {
            return "loss of control reported wrongly";
        }
        if (out.event == TakeoverEvent::gave_back && (!was_flying || s.beat != Beat::former)) {
            return "given back without confirmation";
        }
        if (out.action == TakeoverAction::request_former && !flies) {
            return "asks for the former mode without control";
        }
        note(before.control(), after, s, out, foreign, was_streaming);
        return {};
    }

    void note(Control before, const Bench& after, const Step& s, const TakeoverOutput& out, bool foreign,
              bool was_streaming)
    {
        if (after.takeover.streaming() && !was_streaming) {
            streaming_since = after.now;
        }
        hands_off = (hands_off || out.event == TakeoverEvent::overruled) && s.wants;
        if (after.takeover.in_control()) {
            requests = 0;
        }
        const auto waits = [](Control c) { return c == Control::requesting || c == Control::refused; };
        const bool waiting = waits(before) && waits(after.control());
        const bool unanswered = !waiting && after.now - requested >= Takeover::kConfirm;
        if (foreign || out.event == TakeoverEvent::overruled || out.event == TakeoverEvent::gave_back ||
            (s.beat == Beat::former && (unanswered || flown))) {
            due = false;
        }
        flown = (flown || after.takeover.in_control()) && due;
        if (out.action == TakeoverAction::request_external) {
            due = true;
            requested = after.now;
        }
    }
};

struct Search {
    std::vector<Step> alphabet;
    std::vector<Step> trail;
    std::size_t visited = 0;
    std::size_t reached[7] = {};

    /// All sequences of `depth` more steps; false with a message at the first that breaks a rule.
    bool explore(const Bench& bench, const Witness& witness, int depth)
    {
        for (const Step& s : alphabet) {
            Bench next = bench;
            Witness watch = witness;
            const TakeoverOutput out = next.step(s);
            ++visited;
            ++reached[static_cast<std::size_t>(next.control())];
            const std::string broken = watch.watch(bench, next, s, out);
            trail.push_back(s);
            if (!broken.empty()) {
                std::string all = broken;
                for (const Step& t : trail) {
                    all += "\n  " + describe(t);
                }
                ADD_FAILURE() << all;
                return false;
            }
            if (depth > 1 && !explore(next, watch, depth - 1)) {
                return false;
            }
            trail.pop_back();
        }
        return true;
    }

    /// Walks a given way first, under the same rules.
    bool explore_after(const std::vector<Step>& way, int depth)
    {
        Bench bench;
        Witness witness;
        trail = way;
        for (const Step& s : way) {
            const Bench before = bench;
            const TakeoverOutput out = bench.step(s);
            const std::string broken = witness.watch(before, bench, s, out);
            EXPECT_EQ(broken, "") << describe(s);
        }
        return explore(bench, witness, depth);
    }
};

std::vector<Step> whole_alphabet()
{
    std::vector<Step> steps;
    for (const bool want : {false, true}) {
        for (const bool act : {false, true}) {
            for (const Beat beat :
                 {Beat::none, Beat::former, Beat::external, Beat::manual, Beat::hold, Beat::disarmed}) {
                for (const float dt : {0.02F, 1.0F}) {
                    steps.push_back({want, act, beat, dt, false});
                }
            }
        }
    }
    steps.push_back({true, true, Beat::none, 0.02F, true});
    steps.push_back({true, true, Beat::none, 1.0F, true});
    steps.push_back({false, true, Beat::former, 1.0F, true});
    return steps;
}

TEST(TakeoverSmallWorld, EverySequenceOfStepsFromEveryState)
{
    const std::vector<Step> request{wants(Beat::former), wants(Beat::none, 0.1F)};
    const auto then = [](std::vector<Step> way, std::initializer_list<Step> more) {
        way.insert(way.end(), more);
        return way;
    };
    const std::vector<Step> fly = then(request, {wants(Beat::external, 0.2F)});
    const std::vector<Step> give_back = then(fly, {calm(Beat::external, 1.0F)});
    const Step wait = wants(Beat::none, 1.01F);
    const std::vector<std::vector<Step>> ways{
        {},
        request,
        fly,
        give_back,
        then(give_back, {kWant}),                         // a new conflict while returning
        then(request, {wait, wait, wait}),                // refused
        then(request, {fault(Beat::none)}),               // asked, then a fault
        then(fly, {fault(Beat::none)}),                   // lost
        then(request, {wait, wait, fault(Beat::former)})  // a fault after the last try
    };
    for (const std::vector<Step>& way : ways) {
        Search search;
        search.alphabet = whole_alphabet();
        ASSERT_TRUE(search.explore_after(way, 3));
    }
    Search search;
    search.alphabet = whole_alphabet();
    ASSERT_TRUE(search.explore_after(request, 4));
}

TEST(TakeoverSmallWorld, EverySequenceOfSevenSteps)
{
    Search search;
    search.alphabet = {wants(Beat::none, 1.0F), wants(Beat::former),      wants(Beat::external), wants(Beat::manual),
                       calm(Beat::none, 1.0F),  calm(Beat::former),       calm(Beat::external),  fault(Beat::none),
                       fault(Beat::external),   fault(Beat::former, 1.0F)};
    ASSERT_TRUE(search.explore_after({}, 7));
    EXPECT_EQ(search.visited, 11'111'110U);
    // The world is large enough for every state.
    for (const Control c : {Control::autopilot, Control::announcing, Control::requesting, Control::ours,
                            Control::returning, Control::refused, Control::overruled}) {
        EXPECT_GT(search.reached[static_cast<std::size_t>(c)], 0U) << static_cast<int>(c);
    }
}

}  // namespace
}  // namespace jink::app
