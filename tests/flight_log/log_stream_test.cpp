// SPDX-License-Identifier: BSD-3-Clause
// A board's log over the link: what a flight's log holds, and that every file is whole.
#include <gtest/gtest.h>

#include <bit>

#include "tests/flight_log/stream_content.hpp"
#include "tests/flight_log/stream_flight.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using link::CommandResult;

/// Everything that was decided is in the log, in its order, and nothing else.
TEST(LogStream, AFlightIsReadAsItWasFlown)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    s.see_a_mast();
    std::vector<app::Control> controls{s.f->last.control};
    std::vector<avoid::State> guidances{s.f->last.guidance.state};
    for (int i = 0; i < 1'000; ++i) {
        s.tick();
        if (s.f->last.control != controls.back()) {
            controls.push_back(s.f->last.control);
        }
        if (s.f->last.guidance.state != guidances.back()) {
            guidances.push_back(s.f->last.guidance.state);
        }
    }
    s.fly(25);  // the last part is only sent once it is full
    ASSERT_GT(s.manoeuvres, 0) << "nothing happened";
    ASSERT_GT(controls.size(), 2U);
    const StreamContent c = read_content(s.receiver.file);
    EXPECT_EQ(c.end, ulog::End::complete);
    EXPECT_TRUE(c.is_in_order);
    EXPECT_EQ(c.dropouts, 0);
    EXPECT_EQ(s.receiver.lost, 0);
    EXPECT_EQ(s.stream->ring().dropped(), 0U);
    EXPECT_EQ(c.topics.at("jink_decision"), s.manoeuvres);
    EXPECT_GE(c.topics.at("jink_step"), 200);
    EXPECT_GE(c.topics.at("jink_own"), 200);
    EXPECT_GE(c.topics.at("jink_track"), 38);
    EXPECT_GE(c.topics.at("jink_app_counters"), 19);
    EXPECT_GE(c.topics.at("jink_avoid_counters"), 19);
    EXPECT_GE(c.topics.at("jink_stream"), 19);
    std::vector<app::Control> logged{static_cast<app::Control>(c.steps.at(0).control)};
    std::vector<avoid::State> states{static_cast<avoid::State>(c.steps.at(0).guidance)};
    int manoeuvres = 0;
    for (const flightlog::StepTopic& step : c.steps) {
        manoeuvres += step.new_manoeuvre ? 1 : 0;
        if (static_cast<app::Control>(step.control) != logged.back()) {
            logged.push_back(static_cast<app::Control>(step.control));
        }
        if (static_cast<avoid::State>(step.guidance) != states.back()) {
            states.push_back(static_cast<avoid::State>(step.guidance));
        }
    }
    EXPECT_EQ(logged, controls);
    EXPECT_EQ(states, guidances);
    EXPECT_EQ(manoeuvres, s.manoeuvres);
    for (const char* text : {"jink: conflict", "control autopilot -> ", "guidance watching -> avoiding"}) {
        EXPECT_TRUE(std::any_of(c.texts.begin(), c.texts.end(), [&](const auto& t) { return t.starts_with(text); }))
            << text;
    }
}

/// A step's own ends after it is logged: each message has that of the step before, 0 where no cycles are counted.
TEST(LogStream, AStepHasTheDurationOfTheStepBefore)
{
    for (const bool counts : {true, false}) {
        StreamFlight s;
        ASSERT_TRUE(s.begin());
        ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        ASSERT_TRUE(s.fly_to_data());
        std::map<std::uint64_t, std::uint32_t> before;  // by the time of the step
        std::uint32_t took = 0;
        for (std::uint32_t i = 0; i < 200; ++i) {
            before[static_cast<std::uint64_t>(s.f->now.us + StreamFlight::Flight::kTickUs)] = took;
            s.tick();
            if (counts) {
                s.f->coprocessor.note_cycles(168 * (1'000 + i) + 167, 168);
                took = 1'000 + i;
            }
        }
        int compared = 0;
        for (const flightlog::StepTopic& step : read_content(s.receiver.file).steps) {
            if (before.contains(step.timestamp)) {
                EXPECT_EQ(step.duration_us, before.at(step.timestamp));
                ++compared;
            }
        }
        EXPECT_GT(compared, 30);
    }
}

TEST(LogStream, DefinitionsHoldTheTopicsTheVersionAndTheParametersInForce)
{
    app::Parameters parameters;
    ASSERT_EQ(parameters.set(app::Param::cruise, 6.25F), app::ParamStatus::ok);
    StreamFlight s(921600, true, parameters);
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    link::mavlink::ParamSet set;
    set.param_id = app::test::wire::param_name("JNK_LOOKAHEAD");
    set.param_type = 9;
    set.param_value = 11.0F;
    s.send(set);
    s.fly(200);
    const StreamContent c = read_content(s.receiver.file);
    EXPECT_EQ(c.end, ulog::End::complete);
    EXPECT_FALSE(c.version.empty());
    ASSERT_EQ(c.parameters.size(), app::kParamCount);
    for (std::size_t i = 0; i < app::kParamCount; ++i) {
        const auto value = c.parameters.at(std::string(app::param_table()[i].name)).number();
        ASSERT_TRUE(value);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(*value), std::bit_cast<std::uint32_t>(parameters.values()[i]))
            << app::param_table()[i].name;
    }
    EXPECT_EQ(c.changed, (std::map<std::string, float>{{"JNK_LOOKAHEAD", 11.0F}}));
}

/// The messages of the link but the log's, without their sequence numbers.
std::vector<std::string> other_messages(const StreamFlight& s)
{
    std::vector<std::string> out;
    for (const auto& received : s.f->said) {
        const auto frame = received.frame();
        if (frame.message_id != link::mavlink::LoggingData::kInfo.id &&
            frame.message_id != link::mavlink::LoggingDataAcked::kInfo.id &&
            frame.message_id != link::mavlink::CommandAck::kInfo.id) {
            out.push_back(std::to_string(frame.message_id) + ":" +
                          std::string(reinterpret_cast<const char*>(frame.payload.data()), frame.payload.size()));
        }
    }
    return out;
}

TEST(LogStream, TheFlightIsTheSameWithAndWithoutIt)
{
    StreamFlight with;
    StreamFlight without(921600, false);
    for (StreamFlight* s : {&with, &without}) {
        ASSERT_TRUE(s->begin());
    }
    ASSERT_EQ(with.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    EXPECT_EQ(without.ask(StreamFlight::kStart), number_of(CommandResult::unsupported));
    with.see_a_mast();
    without.see_a_mast();
    for (int i = 0; i < 1'200; ++i) {
        with.tick();
        without.tick();
        ASSERT_EQ(other_messages(with), other_messages(without)) << "step " << i;
        ASSERT_EQ(with.f->position, without.f->position);
        ASSERT_EQ(with.f->last.work, without.f->last.work);
    }
    EXPECT_GT(with.manoeuvres, 0);
    EXPECT_GT(with.parts.size(), 100U);
    EXPECT_TRUE(without.parts.empty());
}

/// Parts and acknowledgements are lost, doubled and addressed wrongly, the log stops and starts again: whatever arrives
/// is a whole file, with a dropout message for each gap.
TEST(LogStream, EveryFileIsWholeWhateverIsLost)
{
    int losses = 0;
    int files = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        StreamFlight s;
        s.random.seed(seed);
        s.lose_data = static_cast<double>(seed % 5) * 0.1;
        s.lose_ack = static_cast<double>(seed % 3) * 0.2;
        s.wrong_ack = static_cast<double>(seed % 4) * 0.25;
        ASSERT_TRUE(s.begin());
        for (int run = 0; run < 2; ++run) {
            s.receiver = {};
            ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
            const auto started = static_cast<std::uint64_t>(s.f->now.us);
            ASSERT_TRUE(s.fly_to_data(2'000));
            s.see_a_mast();
            s.fly(150 + static_cast<int>(s.random() % 300));
            ASSERT_EQ(s.ask(StreamFlight::kStop), StreamFlight::kAccepted);
            const std::size_t parts = s.parts.size();
            s.fly(50);
            EXPECT_EQ(s.parts.size(), parts) << "nothing after the stop";
            const StreamContent c = read_content(s.receiver.file);
            EXPECT_EQ(c.end, ulog::End::complete);
            EXPECT_EQ(c.parameters.size(), app::kParamCount);
            EXPECT_TRUE(c.is_in_order);
            EXPECT_GT(c.topics.at("jink_step"), 10);
            EXPECT_GT(c.steps.at(0).timestamp, started) << "nothing of the log before";
            EXPECT_EQ(c.dropouts > 0, s.receiver.lost > 0);
            losses += s.receiver.lost;
            ++files;
        }
        EXPECT_EQ(s.stream->counts().given_up, 0U);
    }
    EXPECT_EQ(files, 48);
    EXPECT_GT(losses, 200) << "the line was too good";
}

}  // namespace
