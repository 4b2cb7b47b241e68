// SPDX-License-Identifier: BSD-3-Clause
#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

/// Invariants for every sequence, checked by a witness that observes inputs and outputs only.
struct Witness {
    bool hands_off = false;  ///< overruled in this conflict
    bool due = false;        ///< the external mode, once observed, is under our control
    bool flown = false;      ///< and was confirmed
    int requests = 0;        ///< in this conflict, since last in control
    int most_requests = Takeover::kTries;
    bool needs_stream = true;     ///< before each request
    TimePoint streaming_since{};  ///< meaningful while streaming
    TimePoint requested{};
    bool seen_external = false;  ///< as the newest report
    bool was_seen = false;       ///< a stream of either kind

    /// Empty, or the broken invariant.
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
        if (after.takeover.proving() && (!s.may_act || control != Control::autopilot || seen_external || foreign)) {
            return "proves a stream where it may not act";
        }
        if (was_streaming && foreign && (streams || out.action != TakeoverAction::none)) {
            return "does not yield to the pilot at once";
        }
        if (hands_off && (out.action != TakeoverAction::none || streams)) {
            return "acts after the pilot's mode in the same conflict";
        }
        if (out.action == TakeoverAction::request_external) {
            if (needs_stream && (!was_seen || after.now - streaming_since < Takeover::kAnnounce)) {
                return "asks for the external mode before the stream began";
            }
            if (++requests > most_requests) {
                return "asks too often";
            }
        }
        if (out.action == TakeoverAction::request_hold && before.control() != Control::refused && !seen_external) {
            return "asks to hold although the external mode is over";
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
        const bool seen = after.takeover.streaming() || after.takeover.proving();
        if (seen && !was_seen) {
            streaming_since = after.now;
        }
        was_seen = seen;
        hands_off = (hands_off || out.event == TakeoverEvent::overruled) && s.wants;
        if (after.takeover.in_control()) {
            requests = 0;
        }
        // Once it no longer asks, an external mode long after its last request is a pilot's.
        const auto waits = [](Control c) { return c == Control::requesting; };
        const bool waiting = waits(before) && waits(after.control());
        const bool unanswered = !waiting && after.now - requested >= Takeover::kConfirm;
        if (foreign || out.event == TakeoverEvent::overruled || out.event == TakeoverEvent::gave_back ||
            (s.beat == Beat::former && (unanswered || flown))) {
            due = false;
        }
        // Observed under a fault, and ended again: another party has ended it.
        flown = (flown || after.takeover.in_control() || s.beat == Beat::external) && due;
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

    /// First executes a given sequence, under the same rules.
    bool explore_after(const std::vector<Step>& way, int depth, const Bench& first = {}, const Witness& watch = {})
    {
        Bench bench = first;
        Witness witness = watch;
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

std::vector<Step> with_refusals()
{
    return {wants(Beat::none, 1.0F), wants(Beat::former),   wants(Beat::external), wants(Beat::manual),
            calm(Beat::none, 1.0F),  calm(Beat::former),    calm(Beat::external),  denied(0.1F),
            fault(Beat::none),       fault(Beat::external), denied(0.25F),         wants(Beat::hold)};
}

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
    const Step wait = wants(Beat::none, 1.01F), shown = wants(Beat::former, 1.01F);
    const std::vector<std::vector<Step>> ways{
        {},
        request,
        fly,
        give_back,
        then(give_back, {kWant}),                           // a new conflict while returning
        then(request, {shown, shown, wait}),                // refused
        then(request, {fault(Beat::none)}),                 // asked, then a fault
        then(fly, {fault(Beat::none)}),                     // lost
        then(request, {shown, shown, fault(Beat::former)})  // a fault after the last try
    };
    for (const std::vector<Step>& way : ways) {
        Search search;
        search.alphabet = whole_alphabet();
        ASSERT_TRUE(search.explore_after(way, 3));
    }
    for (const std::vector<Step>& way : {request, ways[4], ways[5], ways[8]}) {
        Search search;
        search.alphabet = whole_alphabet();
        ASSERT_TRUE(search.explore_after(way, 4));
    }
}

/// A PX4 may be asked more often, while the stream is young and it refuses.
TEST(TakeoverSmallWorld, EverySequenceOfSixStepsWithAPx4)
{
    Search search;
    search.alphabet = with_refusals();
    Bench px4;
    px4.stack = link::AutopilotStack::px4;
    Witness witness;
    witness.most_requests = Takeover::kTries + static_cast<int>(Takeover::kProof / Takeover::kAskAgain) + 1;
    ASSERT_TRUE(search.explore_after({wants(Beat::former)}, 6, px4, witness));
    px4.stands_by = true;
    ASSERT_TRUE(search.explore_after({calm(Beat::former)}, 6, px4, witness));
    EXPECT_GT(search.reached[static_cast<std::size_t>(Control::refused)], 0U);
}

/// Standing by, an ArduPilot is asked in the tick in which control is wanted.
TEST(TakeoverSmallWorld, EverySequenceOfSixStepsWithAnArduPilot)
{
    Search search;
    search.alphabet = with_refusals();
    Bench copter;
    copter.stack = link::AutopilotStack::ardupilot;
    copter.stands_by = true;
    Witness witness;
    witness.needs_stream = false;
    ASSERT_TRUE(search.explore_after({calm(Beat::former)}, 6, copter, witness));
    EXPECT_GT(search.reached[static_cast<std::size_t>(Control::ours)], 0U);
    EXPECT_GT(search.reached[static_cast<std::size_t>(Control::refused)], 0U);
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
