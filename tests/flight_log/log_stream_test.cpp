// SPDX-License-Identifier: BSD-3-Clause
// A board's log over the link: what receivers make of it, lost parts and acknowledgements, the line's share, commands.
#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>
#include <sstream>

#include "firmware/linux/flight_log/ulog_reader.hpp"
#include "tests/flight_log/stream_flight.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using link::CommandResult;

constexpr std::uint16_t kStart = StreamFlight::kStart;
constexpr std::uint16_t kStop = StreamFlight::kStop;

int number_of(CommandResult result) { return static_cast<int>(result); }

/// What a file of a receiver holds.
struct Content {
    std::map<std::string, int> topics;
    std::vector<flightlog::StepTopic> steps;
    std::vector<std::string> texts;
    std::map<std::string, ulog::Keyed> parameters;
    std::map<std::string, float> changed;
    int dropouts = 0;
    std::string version;
    ulog::End end = ulog::End::none;
    std::uint64_t last = 0;
    bool is_in_order = true;
};

Content read(const std::string& file)
{
    std::istringstream in(file);
    ulog::Reader reader(in);
    Content c;
    while (const auto message = reader.next()) {
        const auto content = message->content;
        if (message->type == ulog::Type::data) {
            const std::string name = reader.topic(ulog::read_number<std::uint16_t>(content))->name;
            ++c.topics[name];
            const auto stamp = ulog::read_number<std::uint64_t>(content.subspan(2));
            c.is_in_order = c.is_in_order && stamp >= c.last;
            c.last = stamp;
            if (name == "jink_step") {
                flightlog::StepTopic step;
                std::memcpy(static_cast<void*>(&step), content.data() + 2, content.size() - 2);
                c.steps.push_back(step);
            }
        } else if (message->type == ulog::Type::text) {
            c.texts.push_back(ulog::text_of(content.subspan(9)));
        } else if (message->type == ulog::Type::dropout) {
            ++c.dropouts;
        } else if (message->type == ulog::Type::parameter && !c.topics.empty()) {
            const auto keyed = ulog::parse_keyed(content, message->type);
            EXPECT_TRUE(keyed);
            c.changed[keyed->name] = keyed->number().value_or(-1.0F);
        }
    }
    c.parameters = reader.parameters();
    c.version = reader.info("ver_sw");
    c.end = reader.end();
    EXPECT_EQ(reader.offset(), c.end == ulog::End::complete ? file.size() : reader.offset());
    return c;
}

void put_a_mast(StreamFlight& s) { s.f->obstacles = {s.f->position + Vec3(0.0F, 45.0F, 0.0F)}; }

/// Everything that was decided is in the log, in its order, and nothing else.
TEST(LogStream, AFlightIsReadAsItWasFlown)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    put_a_mast(s);
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
    const Content c = read(s.receiver.file);
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

TEST(LogStream, DefinitionsHoldTheTopicsTheVersionAndTheParametersInForce)
{
    app::Parameters parameters;
    ASSERT_EQ(parameters.set(app::Param::cruise, 6.25F), app::ParamStatus::ok);
    StreamFlight s(921600, true, parameters);
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    link::mavlink::ParamSet set;
    set.param_id = app::test::wire::param_name("JNK_LOOKAHEAD");
    set.param_type = 9;
    set.param_value = 11.0F;
    s.send(set);
    s.fly(200);
    const Content c = read(s.receiver.file);
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
    ASSERT_EQ(with.ask(kStart), StreamFlight::kAccepted);
    EXPECT_EQ(without.ask(kStart), number_of(CommandResult::unsupported));
    put_a_mast(with);
    put_a_mast(without);
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
            ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
            const auto started = static_cast<std::uint64_t>(s.f->now.us);
            ASSERT_TRUE(s.fly_to_data(2'000));
            put_a_mast(s);
            s.fly(150 + static_cast<int>(s.random() % 300));
            ASSERT_EQ(s.ask(kStop), StreamFlight::kAccepted);
            const std::size_t parts = s.parts.size();
            s.fly(50);
            EXPECT_EQ(s.parts.size(), parts) << "nothing after the stop";
            const Content c = read(s.receiver.file);
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

/// A receiver that acknowledges a part only once is lost with its acknowledgement: the log ends, and can begin anew.
TEST(LogStream, AReceiverThatDoesNotAcknowledgeIsGivenUp)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    s.lose_ack = 1.0;
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    s.fly(400);
    EXPECT_FALSE(s.stream->is_on());
    EXPECT_EQ(s.stream->counts().given_up, 1U);
    EXPECT_EQ(s.stream->counts().repeated, 49U);
    ASSERT_EQ(s.parts.size(), 50U) << "PX4's number of tries";
    for (std::size_t i = 1; i < s.parts.size(); ++i) {
        EXPECT_EQ(s.parts[i].sequence, 0);
        EXPECT_TRUE(s.parts[i].acknowledged);
        EXPECT_GE(s.parts[i].at.us - s.parts[i - 1].at.us, 50'000);
        EXPECT_LE(s.parts[i].at.us - s.parts[i - 1].at.us, 70'000) << "steps of 20 ms";
    }
    s.lose_ack = 0.0;
    s.receiver = {};
    ASSERT_EQ(s.ask(kStart, 0.0F, 12), StreamFlight::kAccepted) << "another receiver";
    EXPECT_EQ(s.parts.back().to_system, 12);
    s.fly(10);
    EXPECT_EQ(s.ask(kStop), StreamFlight::kAccepted);
    s.receiver = {};
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    EXPECT_TRUE(s.fly_to_data());
    EXPECT_EQ(s.stream->counts().starts, 3U);
}

/// Of the part that waits, by the receiver itself: everything else repeats the part.
TEST(LogStream, OnlyTheRightAcknowledgementGoesOn)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    s.listens = false;
    s.acknowledge(0);  // before there is a log
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    for (std::uint16_t part = 0; part < 5; ++part) {
        s.fly(4);
        ASSERT_EQ(s.parts.back().sequence, part);
        for (int i = 0; i < 5; ++i) {
            s.acknowledge(static_cast<std::uint16_t>(part + 1));
            s.acknowledge(static_cast<std::uint16_t>(part - 1));
            s.acknowledge(part, 254);
            s.acknowledge(part, StreamFlight::kGround, 1);
            s.fly(4);
            ASSERT_EQ(s.parts.back().sequence, part);
        }
        s.acknowledge(part);
        s.acknowledge(part);
        s.fly(2);  // the line's share may be used up for one step
        ASSERT_EQ(s.parts.back().sequence, part + 1);
    }
    EXPECT_GT(s.stream->counts().repeated, 10U);
}

TEST(LogStream, OneReceiverAtATimeAndOneFormat)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    EXPECT_EQ(s.ask(kStop), StreamFlight::kAccepted) << "there is none to stop";
    for (const float format : {1.0F, -1.0F, 0.5F, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(s.ask(kStart, format), number_of(CommandResult::denied));
    }
    EXPECT_FALSE(s.stream->is_on());
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    EXPECT_EQ(s.ask(kStart, 0.0F, 254), number_of(CommandResult::temporarily_rejected));
    EXPECT_EQ(s.ask(kStart, 0.0F, 255, 1), number_of(CommandResult::temporarily_rejected));
    const std::uint16_t reached = s.parts.back().sequence;
    EXPECT_EQ(s.ask(kStart), StreamFlight::kAccepted) << "the answer was lost: the same command once more";
    s.fly(100);
    EXPECT_GT(s.parts.back().sequence, reached);
    EXPECT_EQ(s.stream->counts().starts, 1U);
    EXPECT_EQ(read(s.receiver.file).end, ulog::End::complete);

    s.fly(500);
    s.receiver = {};
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted) << "ten seconds later it begins anew";
    EXPECT_EQ(s.parts.back().sequence, 0);
    ASSERT_TRUE(s.fly_to_data());
    s.fly(100);
    EXPECT_EQ(read(s.receiver.file).end, ulog::End::complete);
    EXPECT_EQ(s.ask(kStop, 0.0F, 33), StreamFlight::kAccepted) << "from anyone: the receiver may be gone";
    EXPECT_FALSE(s.stream->is_on());
    EXPECT_EQ(s.stream->counts().refused, 6U);

    s.target_component = 195;
    s.command(kStart);
    s.tick();
    EXPECT_FALSE(s.stream->is_on()) << "to another component";
}

/// Over any time: the share of the line and one part. And behind everything else of its step.
TEST(LogStream, TakesItsShareOfTheLineAtMost)
{
    for (const std::uint32_t baud : {9'600U, 57'600U, 115'200U, 921'600U}) {
        SCOPED_TRACE(baud);
        StreamFlight s(baud);
        ASSERT_TRUE(s.begin());
        for (int i = 0; i < 30; ++i) {
            s.f->obstacles.emplace_back(200.0F + 3.0F * static_cast<float>(i), 100.0F, 50.0F);
        }
        ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
        for (int i = 0; i < 2'000; ++i) {
            s.tick();
            for (std::size_t j = 0; j + 1 < s.f->said.size(); ++j) {
                const std::uint32_t id = s.f->said[j].frame().message_id;
                ASSERT_TRUE(id != 266 && id != 267) << "the last frame of a step";
            }
        }
        ASSERT_GT(s.parts.size(), 5U);
        const double rate = baud / 10.0 * 0.1;
        for (std::size_t i = 0; i < s.parts.size(); ++i) {
            double sum = 0.0;
            for (std::size_t j = i; j < s.parts.size(); ++j) {
                sum += static_cast<double>(s.parts[j].frame);
                const double time = static_cast<double>(s.parts[j].at.us - s.parts[i].at.us) * 1e-6;
                ASSERT_LE(sum, rate * time + 280.0) << i << " to " << j;
            }
        }
        if (baud == 921'600U) {
            EXPECT_EQ(s.stream->ring().dropped(), 0U) << "thirty aircraft fit";
        }
        if (baud == 57'600U) {
            EXPECT_GT(s.stream->ring().dropped(), 0U);
        }
        const Content c = read(s.receiver.file);
        EXPECT_TRUE(c.end == ulog::End::complete) << "after " << s.receiver.file.size();
    }
}

/// A line that takes less than jink itself sends: no part waits on it, nothing of jink's own is lost to the log, and
/// a dropout message follows.
TEST(LogStream, AFullLineIsLeftToTheRest)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    s.fly(100);
    put_a_mast(s);
    s.fly(200);
    const std::uint32_t full = s.f->endpoint.diagnostics().outbox_full;
    std::size_t parts = s.parts.size();
    s.f->port.room = 0;
    s.fly(2);
    for (int i = 0; i < 150; ++i) {
        const std::size_t waiting = s.f->endpoint.pending().size();
        s.tick();
        if (waiting > 0) {
            EXPECT_EQ(s.parts.size(), parts);
        }
        parts = s.parts.size();
    }
    EXPECT_GT(s.stream->ring().dropped(), 0U);
    EXPECT_EQ(s.f->endpoint.diagnostics().outbox_full, full);
    link::mavlink::ParamSet set;
    set.param_id = app::test::wire::param_name("JNK_LOOKAHEAD");
    set.param_type = 9;
    set.param_value = 11.0F;
    s.send(set);
    s.fly(20);
    ASSERT_GT(s.stream->ring().size(), flightlog::MessageRing::kBytes - 20) << "no place for the change";
    s.f->port.room = 1U << 20U;
    s.fly(300);
    const Content c = read(s.receiver.file);
    EXPECT_EQ(c.end, ulog::End::complete);
    EXPECT_GT(c.dropouts, 0);
    EXPECT_EQ(c.changed, (std::map<std::string, float>{{"JNK_LOOKAHEAD", 11.0F}})) << "a change is not lost";
    EXPECT_EQ(s.receiver.lost, 0) << "dropped before it was a part";
}

/// A port that is lost loses the part that is on it, and the receiver finds the next message.
TEST(LogStream, ALostPortIsAGap)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    s.fly(100);
    s.f->port.state = hal::PortState::lost;
    const std::size_t parts = s.parts.size();
    s.fly(100);
    EXPECT_EQ(s.parts.size(), parts);
    s.f->port.state = hal::PortState::open;
    s.fly(200);
    EXPECT_GT(s.parts.size(), parts);
    const Content c = read(s.receiver.file);
    EXPECT_EQ(c.end, ulog::End::complete);
    EXPECT_GT(c.dropouts, 0);
}

/// Until data the receiver's silence is bounded in time too, where a slow line does not carry fifty repetitions.
TEST(LogStream, ASlowLineEndsTheWaiting)
{
    StreamFlight s(9'600);
    ASSERT_TRUE(s.begin());
    s.listens = false;
    ASSERT_EQ(s.ask(kStart), StreamFlight::kAccepted);
    s.fly(400);
    EXPECT_TRUE(s.stream->is_on());
    s.fly(150);
    EXPECT_FALSE(s.stream->is_on()) << "ten seconds";
    EXPECT_LT(s.parts.size(), 10U);
    EXPECT_EQ(s.stream->counts().given_up, 1U);
}

}  // namespace
