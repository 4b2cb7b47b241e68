// SPDX-License-Identifier: BSD-3-Clause
// Candidates in a board's log: what the planner had, in rounds; what is left out, and that it shows.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <random>

#include "firmware/app/plan_memory.hpp"
#include "firmware/app/work_rate.hpp"
#include "tests/flight_log/candidate_bench.hpp"
#include "tests/flight_log/stream_flight.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using flightlog::CandidateTopic;
using flightlog::DecisionTopic;

/// Those of one decision, in the order of the file.
std::vector<CandidateTopic> candidates_of(const StreamContent& c, std::uint32_t decision)
{
    std::vector<CandidateTopic> found = c.candidates;
    std::erase_if(found, [&](const CandidateTopic& topic) { return topic.decision != decision; });
    return found;
}

/// The first n of a plan of make_plan.
void expect_first(const std::vector<CandidateTopic>& found, std::size_t n, std::uint32_t plan)
{
    ASSERT_EQ(found.size(), n);
    for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(found[i].index, i);
        EXPECT_EQ(found[i].cost, static_cast<float>(plan)) << i;
        EXPECT_EQ(found[i].offset, static_cast<float>(i));
        EXPECT_EQ(found[i].attempt, plan % 4);
    }
}

/// Fields of a candidate as the planner has it, against those that were read.
void expect_same(const geometric::Candidate& had, const CandidateTopic& read)
{
    EXPECT_EQ(read.status, static_cast<std::uint8_t>(had.status));
    EXPECT_EQ(read.family, static_cast<std::uint8_t>(had.shape.family));
    EXPECT_EQ(read.plane, had.shape.plane);
    EXPECT_EQ(read.offset, had.shape.offset);
    EXPECT_EQ(read.share, had.shape.share);
    EXPECT_EQ(read.until, had.shape.until);
    EXPECT_EQ(read.duration, had.duration);
    EXPECT_EQ(read.cost, had.total);
    EXPECT_EQ(read.flip_penalty, had.flip_penalty);
    EXPECT_EQ(read.time, had.terms.time);
    EXPECT_EQ(read.smoothness, had.terms.smoothness);
    EXPECT_EQ(read.closeness, had.terms.closeness);
    EXPECT_EQ(read.hit_kind, static_cast<std::uint8_t>(had.hit.kind));
    EXPECT_EQ(read.hit_index, had.hit.index);
}

/// With and without thirty aircraft in sight, which take two thirds of the log's share of the line.
TEST(LogStreamCandidates, AreThoseOfThePlannerAtEachManoeuvre)
{
    for (const int aircraft : {0, 30}) {
        SCOPED_TRACE(aircraft);
        StreamFlight s;
        ASSERT_TRUE(s.begin());
        ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        ASSERT_TRUE(s.fly_to_data());
        s.see_a_mast();
        for (int i = 0; i < aircraft; ++i) {
            s.f->obstacles.emplace_back(400.0F + 3.0F * static_cast<float>(i), 100.0F, 50.0F);
        }
        std::vector<std::pair<std::uint64_t, geometric::Result>> had;
        for (int i = 0; i < 1'000; ++i) {
            s.tick();
            if (s.f->last.guidance.new_manoeuvre) {
                had.emplace_back(static_cast<std::uint64_t>(s.f->now.us), *s.f->coprocessor.last_plan().result);
            }
        }
        s.fly(25);
        ASSERT_GT(had.size(), 0U) << "nothing was decided";
        const StreamContent c = read_content(s.receiver.file);
        EXPECT_EQ(s.stream->ring().dropped(), 0U);
        ASSERT_EQ(c.decisions.size(), had.size());
        EXPECT_EQ(c.streams.back().candidates_left_out, s.stream->counts().candidates_left_out);
        EXPECT_EQ(s.stream->counts().candidates_left_out, 0U);
        for (std::size_t k = 0; k < had.size(); ++k) {
            const DecisionTopic& decision = c.decisions[k];
            const geometric::Result& plan = had[k].second;
            EXPECT_EQ(decision.timestamp, had[k].first);
            ASSERT_GT(plan.candidates.size(), 8U);
            ASSERT_EQ(decision.candidates, plan.candidates.size());
            const bool found = plan.candidates[plan.chosen].status == geometric::CandidateStatus::chosen;
            EXPECT_EQ(decision.chosen, found ? plan.chosen : DecisionTopic::kNoneChosen);
            const std::vector<CandidateTopic> read = candidates_of(c, decision.decision);
            ASSERT_EQ(read.size(), plan.candidates.size());
            for (std::size_t i = 0; i < read.size(); ++i) {
                EXPECT_EQ(read[i].index, i);
                EXPECT_EQ(read[i].attempt, plan.attempt);
                expect_same(plan.candidates[i], read[i]);
            }
            EXPECT_LT(read.back().timestamp - decision.timestamp, aircraft > 0 ? 3'000'000U : 600'000U);
        }
    }
}

/// In one piece and in slices, as a board plans: from a decision on the planner's last plan is the same to the last bit
/// as long as its number is, and the plan after it has another number.
TEST(LogStreamCandidates, APlanHasItsNumberAlone)
{
    const auto plans = std::make_unique<app::PlanMemory>();
    for (const bool slices : {false, true}) {
        SCOPED_TRACE(slices);
        StreamFlight s;
        if (slices) {
            ASSERT_TRUE(s.f->coprocessor.plan_in_slices(plans->plan, app::WorkRate::of_megahertz(168).work()));
        }
        ASSERT_TRUE(s.begin());
        std::optional<std::uint32_t> number;
        std::string had;
        const auto content = [&] {
            const geometric::Result& plan = *s.f->coprocessor.last_plan().result;
            std::string bytes;
            for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
                const CandidateTopic topic = flightlog::candidate_topic(plan, i, {}, 0);
                const auto view = flightlog::content_of(topic);
                bytes.append(reinterpret_cast<const char*>(view.data()), view.size());
            }
            return bytes;
        };
        int kept = 0;
        int overwritten = 0;
        for (int i = 0; i < 4'000; ++i) {
            if (i % 600 == 0) {
                s.see_a_mast();
                s.f->obstacles.push_back(s.f->position + Vec3(12.0F, 60.0F, 0.0F));
            }
            s.tick();
            const std::uint32_t now = s.f->coprocessor.last_plan().number;
            if (number && *number == now) {
                ASSERT_EQ(content(), had) << "step " << i;
                ++kept;
            } else if (number) {
                overwritten += content() != had ? 1 : 0;
                number.reset();
            }
            if (s.f->last.guidance.new_manoeuvre) {
                number = now;
                had = content();
            }
        }
        EXPECT_GT(kept, 50);
        EXPECT_GT(overwritten, 1);
    }
}

/// Two a step from the step after the decision on: a plan that begins n steps later leaves 2 (n - 1) of them.
TEST(LogStreamCandidates, ANewPlanLeavesTheRestOut)
{
    for (const int steps : {1, 2, 5, 15, 16, 17, 40}) {
        SCOPED_TRACE(steps);
        CandidateBench b;
        b.start();
        b.make_plan(31);
        b.tick(true);
        b.ticks(steps - 1);
        b.make_plan(20);  // of the next plan, which comes to nothing
        const auto gone = static_cast<std::size_t>(std::min(31, 2 * (steps - 1)));
        const StreamContent c = b.content();
        ASSERT_EQ(c.decisions.size(), 1U);
        EXPECT_EQ(c.decisions[0].candidates, 31);
        expect_first(c.candidates, gone, 1);
        EXPECT_EQ(b.log.counts().candidates_left_out, 31U - gone);
    }
}

TEST(LogStreamCandidates, ADecisionLeavesTheRestOfTheOneBeforeOut)
{
    for (const bool has_new_plan : {false, true}) {
        CandidateBench b;
        b.start();
        b.make_plan(32);
        b.tick(true);
        b.ticks(4);
        if (has_new_plan) {
            b.make_plan(12);
        }
        b.tick(true);
        const StreamContent c = b.content();
        ASSERT_EQ(c.decisions.size(), 2U);
        expect_first(candidates_of(c, c.decisions[0].decision), 8, 1);
        expect_first(candidates_of(c, c.decisions[1].decision), has_new_plan ? 12 : 32, has_new_plan ? 2 : 1);
        EXPECT_EQ(b.log.counts().candidates_left_out, 24U);
    }
}

/// A plan without candidates, and an image without the planner.
TEST(LogStreamCandidates, NoneAreNone)
{
    CandidateBench b;
    b.start();
    b.make_plan(0);
    b.tick(true);
    b.make_plan(8);
    b.has_planner = false;
    b.tick(true);
    const StreamContent c = b.content();
    ASSERT_EQ(c.decisions.size(), 2U);
    for (const DecisionTopic& decision : c.decisions) {
        EXPECT_EQ(decision.candidates, 0);
        EXPECT_EQ(decision.chosen, DecisionTopic::kNoneChosen);
    }
    EXPECT_TRUE(c.candidates.empty());
    EXPECT_EQ(b.log.counts().candidates_left_out, 0U);
}

TEST(LogStreamCandidates, TheChosenOneIsNamedWhereTheStatusSaysSo)
{
    CandidateBench b;
    b.start();
    b.make_plan(32);
    b.plan->chosen = 17;  // left over from an earlier plan
    b.tick(true);
    b.ticks(20);
    b.plan->candidates[17].status = geometric::CandidateStatus::chosen;
    b.tick(true);
    const StreamContent c = b.content();
    ASSERT_EQ(c.decisions.size(), 2U);
    EXPECT_EQ(c.decisions[0].chosen, DecisionTopic::kNoneChosen);
    EXPECT_EQ(c.decisions[1].chosen, 17);
}

/// A line that takes nothing for a while delays candidates and drops none of them; they leave half of the ring to the
/// rest.
TEST(LogStreamCandidates, WaitWhileTheLineTakesNothing)
{
    CandidateBench b;
    b.start();
    b.is_line_free = false;
    b.make_plan(32);
    b.tick(true);
    b.ticks(6);
    EXPECT_LT(b.log.ring().size(), flightlog::MessageRing::kBytes / 2 + 500);
    EXPECT_EQ(b.log.ring().dropped(), 0U);
    b.is_line_free = true;
    const StreamContent c = b.content();
    expect_first(c.candidates, 32, 1);
    EXPECT_EQ(c.dropouts, 0);
    EXPECT_EQ(b.log.counts().candidates_left_out, 0U);
}

/// Where the ring is full at the decision, its message is dropped, and no candidate comes without it.
TEST(LogStreamCandidates, AreLeftOutWithADecisionThatIsDropped)
{
    CandidateBench b;
    b.start();
    b.is_line_free = false;
    b.ticks(300);
    ASSERT_GT(b.log.ring().dropped(), 0U);
    const std::uint32_t dropped = b.log.ring().dropped();
    b.make_plan(32);
    b.tick(true);
    ASSERT_GE(b.log.ring().dropped() - dropped, 2U) << "the step and the decision";
    EXPECT_EQ(b.log.counts().candidates_left_out, 32U);
    b.is_line_free = true;
    const StreamContent c = b.content();
    EXPECT_GT(c.dropouts, 0);
    EXPECT_TRUE(c.decisions.empty());
    EXPECT_TRUE(c.candidates.empty());
}

/// The plan is the same as before the stop: its candidates belong to a decision of the log before.
TEST(LogStreamCandidates, ALogBeginsWithoutCandidatesOfTheOneBefore)
{
    for (const int steps : {0, 3}) {
        CandidateBench b;
        b.start();
        b.make_plan(32);
        b.tick(true);
        b.ticks(steps);
        b.stop();
        b.ticks(2);
        b.start();
        EXPECT_TRUE(b.content().candidates.empty());
        b.tick(true);
        const StreamContent c = b.content();
        ASSERT_EQ(c.decisions.size(), 1U);
        EXPECT_EQ(c.decisions[0].decision, 2U) << "since the start of the program";
        expect_first(c.candidates, 32, 1);
    }
}

/// A decision while the definitions go out is not in the log, and neither are its candidates.
TEST(LogStreamCandidates, ADecisionBeforeTheDataHasNone)
{
    CandidateBench b;
    link::CommandRequest request;
    request.command = StreamFlight::kStart;
    request.from_system = StreamFlight::kGround;
    request.from_component = StreamFlight::kGroundComponent;
    ASSERT_EQ(b.log.take(request, b.parameters), link::CommandResult::accepted);
    b.make_plan(32);
    b.tick(true);
    for (int i = 0; i < 400 && !b.receiver.in_data; ++i) {
        b.tick();
    }
    ASSERT_TRUE(b.receiver.in_data);
    const StreamContent c = b.content();
    EXPECT_TRUE(c.decisions.empty());
    EXPECT_TRUE(c.candidates.empty());
}

/// What became of the candidates of one plan.
struct Sent {
    std::uint32_t plan = 0;
    std::size_t n = 0;
};

/// Plans, decisions, a busy line, lost parts, stops and starts at random. Whatever arrives belongs to its decision, in
/// order; what is lost on no line and not left out is there.
TEST(LogStreamCandidates, WhateverArrivesBelongsToItsDecision)
{
    std::size_t complete = 0;
    std::size_t incomplete = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        CandidateBench b;
        b.log.begin(b.now, {});
        std::map<std::uint32_t, Sent> made;
        std::uint32_t decisions = 0;
        for (int run = 0; run < 2; ++run) {
            b.loses_parts = false;
            b.start();
            const std::uint32_t left_out = b.log.counts().candidates_left_out;
            const std::uint32_t dropped = b.log.ring().dropped();
            std::size_t asked = 0;
            const std::uint32_t first = decisions + 1;
            for (int i = 0; i < 400; ++i) {
                const auto chance = [&](unsigned of) { return random() % of == 0; };
                if (chance(30)) {
                    b.make_plan(random() % 33);
                }
                b.is_line_free = chance(40) ? !b.is_line_free : b.is_line_free;
                b.loses_parts = seed % 2 == 0 && chance(20);
                const bool decides = chance(30);
                if (decides) {
                    made[++decisions] = {b.plans, b.plan->candidates.size()};
                    asked += b.plan->candidates.size();
                }
                b.tick(decides);
            }
            b.is_line_free = true;
            b.loses_parts = false;
            b.ticks(60);
            const StreamContent c = b.content();
            std::map<std::uint32_t, std::uint16_t> number;
            for (const DecisionTopic& decision : c.decisions) {
                ASSERT_GE(decision.decision, first) << "of the log before";
                ASSERT_EQ(decision.candidates, made.at(decision.decision).n);
                number[decision.decision] = decision.candidates;
            }
            std::size_t arrived = 0;
            for (std::uint32_t d = first; d <= decisions; ++d) {
                const std::vector<CandidateTopic> found = candidates_of(c, d);
                int before = -1;
                for (const CandidateTopic& candidate : found) {
                    ASSERT_GT(static_cast<int>(candidate.index), before);
                    before = candidate.index;
                    ASSERT_LT(candidate.index, made.at(d).n);
                    ASSERT_EQ(candidate.cost, static_cast<float>(made.at(d).plan)) << "of another plan";
                    ASSERT_EQ(candidate.offset, static_cast<float>(candidate.index));
                }
                arrived += found.size();
                const bool is_there = number.contains(d);
                ASSERT_TRUE(is_there || found.empty() || b.receiver.lost > 0);
                complete += is_there && found.size() == number[d] ? 1U : 0U;
                incomplete += is_there && found.size() < number[d] ? 1U : 0U;
            }
            ASSERT_EQ(arrived, c.candidates.size()) << "of a decision that was not made";
            if (b.receiver.lost == 0) {
                ASSERT_EQ(arrived + b.log.counts().candidates_left_out - left_out, asked)
                    << b.log.ring().dropped() - dropped << " messages dropped";
            }
            b.stop();
        }
    }
    EXPECT_GT(complete, 100U);
    EXPECT_GT(incomplete, 100U);
}

}  // namespace
