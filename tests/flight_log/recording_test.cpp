// SPDX-License-Identifier: BSD-3-Clause
// What the recorder leaves out of a record, because a replay knows it: health that follows from the calls, and records
// that nobody reads. What it logs again, because an output dropped it.
#include <gtest/gtest.h>

#include <random>

#include "firmware/linux/flight_log/playing_ports.hpp"
#include "firmware/linux/logging.hpp"
#include "firmware/linux/read_ahead.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/recorded_input.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;

/// Ports whose health is what a test sets.
struct FakeSerialPort final : hal::SerialPort {
    hal::PortHealth now;
    std::size_t bytes = 0;  ///< that the next call takes
    std::size_t read(std::span<std::byte> into) noexcept override { return std::min(bytes, into.size()); }
    std::size_t write(std::span<const std::byte> from) noexcept override { return std::min(bytes, from.size()); }
    hal::PortHealth health() const noexcept override { return now; }
};
struct FakeCanPort final : hal::CanPort {
    hal::CanHealth now;
    bool accepts = false;
    bool receive(hal::CanFrame& /*frame*/) noexcept override { return accepts; }
    bool send(const hal::CanFrame& /*frame*/) noexcept override { return accepts; }
    hal::CanHealth health() const noexcept override { return now; }
};

template <class H>
void change_one(H& health, std::mt19937_64& random)
{
    if (random() % 4 == 0) {
        health.state = static_cast<decltype(health.state)>(random() % 3);
    } else {
        health.*kCountersOf<H>[random() % kCountersOf<H>.size()] += random() >> random() % 64;  // also by wrapping
    }
}

void expect_no_health(std::span<const std::byte> record)
{
    EntryReader reader(record);
    while (!reader.empty()) {
        const Entry kind = reader.kind();
        ASSERT_NE(kind, Entry::health);
        reader.pass();
        ASSERT_TRUE(reader.pass_content(kind));
    }
}

/// Counters that follow the calls, and others that change by any number at any time.
TEST(RecordedHealth, IsPlayedAsItWas)
{
    std::mt19937_64 random(12);
    FakeSerialPort line;
    FakeCanPort can;
    HalRecorder recorder(1'000'000);
    RecordingSerialPort recording_line(line, recorder, Port::line);
    RecordingCanPort recording_can(can, recorder);
    Tape tape;
    PlayingSerialPort playing_line(tape, Port::line);
    PlayingCanPort playing_can(tape);
    std::array<std::byte, 100> bytes{};
    for (int step = 0; step < 400; ++step) {
        std::vector<std::function<void(hal::SerialPort&, hal::CanPort&)>> calls;
        std::vector<hal::PortHealth> of_line;
        std::vector<hal::CanHealth> of_can;
        recorder.begin({step});
        for (std::size_t n = random() % 30; n > 0; --n) {
            line.bytes = random() % 120;
            can.accepts = random() % 2 == 0;
            switch (random() % 8) {
            case 0: calls.emplace_back([&](auto& l, auto& /*c*/) { static_cast<void>(l.read(bytes)); }); break;
            case 1: calls.emplace_back([&](auto& l, auto& /*c*/) { static_cast<void>(l.write(bytes)); }); break;
            case 2:
                calls.emplace_back([](auto& /*l*/, auto& c) {
                    hal::CanFrame frame;
                    static_cast<void>(c.receive(frame));
                });
                break;
            case 3: calls.emplace_back([](auto& /*l*/, auto& c) { static_cast<void>(c.send({})); }); break;
            case 4:
                change_one(line.now, random);
                change_one(can.now, random);
                continue;
            default:
                of_line.push_back(recording_line.health());
                of_can.push_back(recording_can.health());
                calls.emplace_back([&, i = of_line.size() - 1](auto& l, auto& c) {
                    ASSERT_TRUE(is_same(l.health(), of_line[i])) << step;
                    ASSERT_TRUE(is_same(c.health(), of_can[i])) << step;
                });
                continue;
            }
            calls.back()(recording_line, recording_can);
            line.now.bytes_in += random() % 3 == 0 ? 1U : 0U;
        }
        const Bytes record(recorder.end().record().begin(), recorder.end().record().end());
        recorder.clear();
        tape.load(record);
        tape.reader().pass();
        static_cast<void>(tape.reader().number<std::int64_t>());
        for (const auto& call : calls) {
            call(playing_line, playing_can);
        }
        tape.finish();
        ASSERT_EQ(tape.difference(), "") << step;
    }
}

/// A line whose counters follow the calls needs no entry after the first one.
TEST(RecordedHealth, IsLeftOutWhereItFollowsFromTheCalls)
{
    FakeSerialPort line;
    FakeCanPort can;
    HalRecorder recorder(100'000);
    RecordingSerialPort recording_line(line, recorder, Port::line);
    RecordingCanPort recording_can(can, recorder);
    std::array<std::byte, 100> bytes{};
    hal::CanFrame frame;
    recorder.begin({0});
    for (std::size_t i = 0; i < 50; ++i) {
        line.bytes = i;
        can.accepts = i % 3 == 0;
        static_cast<void>(recording_line.read(bytes));
        static_cast<void>(recording_line.write(bytes));
        static_cast<void>(recording_can.receive(frame));
        static_cast<void>(recording_can.send(frame));
        line.now.bytes_in += i;
        line.now.bytes_out += i;
        line.now.bytes_refused += bytes.size() - i;
        can.now.frames_in += can.accepts ? 1U : 0U;
        ++(can.accepts ? can.now.frames_out : can.now.frames_refused);
        static_cast<void>(recording_line.health());
        static_cast<void>(recording_can.health());
    }
    expect_no_health(recorder.end().record());
}

/// The ports of jinkd read their devices before the step: what waits was not read yet, whenever health is asked for.
TEST(RecordedHealth, IsLeftOutBehindPortsThatReadAhead)
{
    FakeSerialPort line;
    FakeCanPort can;
    can.accepts = true;
    host::ReadAhead line_ahead(line, 1'000);
    host::CanReadAhead can_ahead(can, 10);
    HalRecorder recorder(100'000);
    RecordingSerialPort recording_line(line_ahead, recorder, Port::line);
    RecordingCanPort recording_can(can_ahead, recorder);
    std::array<std::byte, 70> bytes{};
    hal::CanFrame frame;
    std::size_t read = 0;
    for (std::size_t i = 0; i < 50; ++i) {
        line.bytes = i;
        line_ahead.pump();
        line.now.bytes_in += i;
        can_ahead.pump();
        can.now.frames_in = 10 + 3 * i;  // as many as fit
        recorder.begin({0});
        static_cast<void>(recording_line.health());
        static_cast<void>(recording_can.health());
        read += recording_line.read(std::span(bytes).first(i % 3 == 0 ? 10 : 70));
        for (int k = 0; k < 3; ++k) {
            EXPECT_TRUE(recording_can.receive(frame));
        }
        EXPECT_EQ(recording_line.health().bytes_in, read);
        EXPECT_EQ(recording_can.health().frames_in, 3 * (i + 1));
    }
    expect_no_health(recorder.end().record());
}

/// Bits of counters that do not exist, and kinds that do not: the record is damaged.
TEST(RecordedHealth, RefusesUnknownCountersAndKinds)
{
    const std::array<std::byte, 2> bits{std::byte{0}, std::byte{0x20}};  // bit 13
    for (const bool is_can : {false, true}) {
        EntryReader reader(bits);
        hal::PortHealth port;
        hal::CanHealth can;
        is_can ? reader.health(can) : reader.health(port);
        EXPECT_FALSE(reader.is_good());
    }
    for (const unsigned kind : {0U, 12U, 13U, 14U, 15U}) {
        EXPECT_FALSE(EntryReader(bits).pass_content(static_cast<Entry>(kind))) << kind;
    }
}

/// Messages that are no records, but for the counters of the log itself.
std::vector<Bytes> without_records_of(const std::string& log)
{
    std::vector<Bytes> messages;
    std::span<const std::byte> rest = std::as_bytes(std::span(log));
    for (rest = rest.subspan(ulog::kFileHeader); !rest.empty(); rest = rest.subspan(ulog::size_of_message(rest))) {
        const auto message = rest.first(ulog::size_of_message(rest));
        const bool is_counter =
            static_cast<ulog::Type>(message[2]) == ulog::Type::data &&
            ulog::read_number<std::uint16_t>(message.subspan(3)) == static_cast<std::uint16_t>(TopicId::log);
        if (!is_record(message) && !is_counter) {
            messages.emplace_back(message.begin(), message.end());
        }
    }
    return messages;
}

/// For a live page without a log, on a line and on a bus.
TEST(FlightLog, HasTheSameMessagesWithoutRecords)
{
    sim::Scenario scenario = sim::random_scenario(3);
    scenario.duration = 8.0;
    for (const bool on_bus : {false, true}) {
        FlightOptions options;
        options.setup.on_bus = options.setup.has_bus = on_bus;
        const RecordedFlight with = fly_recorded(scenario, {}, options);
        options.without_records = true;
        const RecordedFlight without = fly_recorded(scenario, {}, options);
        EXPECT_LT(without.log.size(), with.log.size());
        EXPECT_EQ(without_records_of(without.log), without_records_of(with.log));
        EXPECT_TRUE(records_of(std::as_bytes(std::span(without.log)).subspan(ulog::kFileHeader)).empty());
        EXPECT_GT(with.steps, 300U);
    }
}

/// Keeps parameters; drops everything while it is full.
class ParameterOutput final : public Output {
public:
    bool add(std::span<const std::byte> messages, std::uint32_t /*count*/, Records /*records*/) noexcept override
    {
        for (; !is_full && !messages.empty(); messages = messages.subspan(ulog::size_of_message(messages))) {
            const auto content =
                messages.subspan(ulog::kMessageHeader, ulog::size_of_message(messages) - ulog::kMessageHeader);
            const auto keyed = static_cast<ulog::Type>(messages[2]) == ulog::Type::parameter
                                   ? ulog::parse_keyed(content, ulog::Type::parameter)
                                   : std::nullopt;
            if (keyed) {
                values[keyed->name] = keyed->number().value_or(-1.0F);
                ++logged;
            }
        }
        return !is_full;
    }
    void lose() noexcept override {}
    [[nodiscard]] LogCounts counts() const noexcept override { return {}; }

    bool is_full = false;
    std::map<std::string, float> values;  ///< the last ones
    std::size_t logged = 0;
};

/// Two changes in a time of drops, one of them taken back in the next.
TEST(FlightLog, LogsParametersAgainThatWereDropped)
{
    sim::Scenario scenario = sim::random_scenario(3);
    scenario.duration = 3.0;
    for (const bool with_page : {false, true}) {
        for (const bool page_is_full : {false, true}) {
            ParameterOutput files;
            ParameterOutput page;
            host::TwoOutputs both(files, page);
            ParameterOutput& full = with_page && page_is_full ? page : files;
            FlightOptions options;
            options.output = with_page ? static_cast<Output*>(&both) : &files;
            app::ParamValues values{};
            float& age = values[static_cast<std::size_t>(app::Param::track_age)];
            float& lookahead = values[static_cast<std::size_t>(app::Param::lookahead)];
            float age_before = 0.0F;
            options.beside = [&](std::uint64_t step, TimePoint /*now*/, app::Coprocessor& coprocessor, HalRecorder&) {
                const bool is_dropping = (step >= 20 && step < 30) || (step >= 50 && step < 60);
                full.is_full = is_dropping;
                if (step == 10) {  // the scenario's own are logged
                    values = coprocessor.parameters().values();
                    age_before = age;
                    full.values.clear();
                    full.logged = 0;
                    return;
                }
                if (step == 21) {
                    age = 7.0F;
                } else if (step == 25) {
                    lookahead = 9.0F;
                } else if (step == 51) {
                    age = age_before;
                } else {
                    const bool knows = (step > 30 && step < 50) || step > 60;
                    EXPECT_TRUE(!knows || full.values["TRK_AGE"] == age) << step;
                    EXPECT_TRUE(!knows || full.values["JNK_LOOKAHEAD"] == lookahead) << step;
                    return;
                }
                EXPECT_EQ(coprocessor.restore_parameters(values), 0U);
            };
            static_cast<void>(fly_recorded(scenario, {}, options));
            EXPECT_EQ(full.values.size(), 2U) << "and no others";
            EXPECT_EQ(full.logged, 3U) << "once each";
            EXPECT_EQ(full.values["TRK_AGE"], age_before);
        }
    }
}

}  // namespace
