// SPDX-License-Identifier: BSD-3-Clause
// Records of steps: entries, texts, and what is set beside the link.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/linux/flight_log/sent_texts.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/setup_signing.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;

TEST(HalRecord, EntriesAreReadAsWritten)
{
    std::mt19937_64 random(9);
    EntryWriter writer(1'000'000);
    std::vector<std::uint64_t> counts;
    for (int i = 0; i < 1'000; ++i) {
        counts.push_back(random() >> random() % 64);
        writer.count(counts.back());
    }
    const auto change = [&](auto now, auto newest, const auto& counters, auto& healths) {
        for (int i = 0; i < 200; ++i) {
            const auto before = now;
            for (std::size_t n = random() % 4; n > 0; --n) {
                now.*counters[random() % counters.size()] = random() >> random() % 64;
            }
            now.state = random() % 3 == 0 ? newest : now.state;
            writer.health(flightlog::differences(before, now), before, now);
            healths.push_back(now);
        }
    };
    std::vector<hal::PortHealth> of_ports;
    std::vector<hal::CanHealth> of_buses;
    change(hal::PortHealth{}, hal::PortState::lost, flightlog::kCountersOf<hal::PortHealth>, of_ports);
    change(hal::CanHealth{}, hal::CanState::bus_off, flightlog::kCountersOf<hal::CanHealth>, of_buses);
    EntryReader reader(writer.record());
    for (const std::uint64_t count : counts) {
        ASSERT_EQ(reader.count(), count);
    }
    const auto compare = [&](auto read, const auto& healths) {
        for (const auto& health : healths) {
            reader.health(read);
            ASSERT_EQ(flightlog::differences(read, health), 0U);
            ASSERT_TRUE(flightlog::is_same(read, health));
        }
    };
    compare(hal::PortHealth{}, of_ports);
    compare(hal::CanHealth{}, of_buses);
    EXPECT_TRUE(reader.empty() && reader.is_good());
}

TEST(HalRecord, AreasAndFramesAreReadAsWritten)
{
    EntryWriter writer(10'000);
    app::Constraint area;
    area.cylinder.circle = {{1.5F, -2.5F}, 30.0F};
    area.cylinder.velocity = {3.0F, -4.0F};
    area.cylinder.top = 120.0F;
    area.cylinder.margin = 5.0F;
    area.stamp.us = -7;
    area.about = link::GlobalPosition{473'977'418, 85'455'939, 488'000};
    hal::CanFrame frame;
    frame.id = 0x1FFFFFFF;
    frame.extended = frame.fd = frame.bit_rate_switch = true;
    frame.length = 64;
    frame.data.fill(std::byte{0x5A});
    writer.area(area);
    writer.area(app::Constraint{});
    writer.frame(frame);
    EntryReader reader(writer.record());
    const app::Constraint read = reader.area();
    EXPECT_EQ(read.cylinder.circle.centre, area.cylinder.circle.centre);
    EXPECT_EQ(read.cylinder.velocity, area.cylinder.velocity);
    EXPECT_EQ(read.cylinder.top, area.cylinder.top);
    EXPECT_EQ(read.stamp, area.stamp);
    EXPECT_EQ(read.ends, area.ends);
    EXPECT_EQ(read.about, area.about);
    EXPECT_FALSE(reader.area().about);
    const hal::CanFrame got = reader.frame();
    EXPECT_EQ(got.id, frame.id);
    EXPECT_TRUE(got.extended && got.fd && got.bit_rate_switch && !got.remote);
    EXPECT_EQ(got.data, frame.data);
    EXPECT_TRUE(reader.empty() && reader.is_good());
    static_cast<void>(reader.frame());
    EXPECT_FALSE(reader.is_good()) << "there is nothing more";
}

TEST(HalRecord, ARecordThatIsTooLongIsLostAsAWhole)
{
    EntryWriter writer(10);
    writer.put(std::uint64_t{1});
    writer.put(std::uint32_t{1});
    EXPECT_TRUE(writer.overflowed());
    writer.clear();
    EXPECT_FALSE(writer.overflowed());
    EXPECT_TRUE(writer.record().empty());
}

/// Texts in any pieces that a line accepts.
TEST(SentTexts, FindsTextsThatALineTakesInPieces)
{
    std::vector<std::byte> bytes;
    const std::vector<std::string> wanted{"jink: first", "second", std::string(50, 'x')};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        link::mavlink::Statustext text;
        text.severity = static_cast<std::uint8_t>(2 + i);
        std::copy(wanted[i].begin(), wanted[i].end(), text.text.begin());
        std::array<std::byte, link::mavlink::kMaxFrame> frame{};
        std::size_t n = link::mavlink::encode(link::mavlink::Heartbeat{}, {1, 196, 0}, frame);
        bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n));
        n = link::mavlink::encode(text, {1, 196, 0}, frame);
        bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n));
    }
    for (const std::size_t piece : {std::size_t{1000}, std::size_t{1}, std::size_t{7}, std::size_t{40}}) {
        SentTexts texts;
        for (std::span<const std::byte> rest(bytes); !rest.empty();) {
            const std::size_t accepted = std::min(piece, rest.size());
            texts.note(rest, accepted);
            rest = rest.subspan(accepted);
        }
        ASSERT_EQ(texts.texts().size(), wanted.size()) << piece;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            EXPECT_EQ(texts.texts()[i].view(), wanted[i]) << piece;
            EXPECT_EQ(texts.texts()[i].severity, 2 + i);
        }
    }
}

sim::Scenario short_flight()
{
    sim::Scenario scenario = sim::random_scenario(2);
    scenario.duration = 4.0;
    return scenario;
}

TEST(FlightReplay, AreasAndStoredParametersAreSetAgain)
{
    const auto beside = [](std::uint64_t step, TimePoint now, app::Coprocessor& coprocessor, HalRecorder& recorder) {
        if (step % 50 == 10) {
            std::vector<app::Constraint> areas(step / 50 + 1);
            for (app::Constraint& area : areas) {
                area.cylinder.circle = {{20.0F, 5.0F}, 8.0F};
                area.cylinder.top = 200.0F;
                area.stamp = now;
            }
            coprocessor.set_constraints(areas, now);
            recorder.areas(areas, now);
        }
        if (step == 30) {
            coprocessor.note_stored(coprocessor.parameters().generation());
            recorder.stored(coprocessor.parameters().generation());
        }
    };
    const RecordedFlight flight = fly_recorded(short_flight(), {}, {.beside = beside});
    const ReplayResult result = replay(flight.log);
    EXPECT_TRUE(result.is_identical()) << result.refused << result.incomplete << result.difference;
    EXPECT_EQ(result.steps, flight.steps);
}

TEST(FlightReplay, AChangedByteOfTheInputOrTheOutputIsFound)
{
    const RecordedFlight flight = fly_recorded(short_flight(), {});
    ASSERT_TRUE(replay(flight.log).is_identical());
    std::mt19937_64 random(11);
    std::vector<std::size_t> heartbeats;  // of ours, as written: MAVLink 2 from system 1, component 196
    const std::string head("\xFD\x09\x00\x00", 4);
    for (std::size_t at = 0; (at = flight.log.find(head, at)) != std::string::npos; ++at) {
        if (static_cast<unsigned char>(flight.log[at + 6]) == 196 && flight.log[at + 7] == 0) {
            heartbeats.push_back(at);
        }
    }
    ASSERT_GT(heartbeats.size(), 2U);
    for (const std::size_t at : heartbeats) {
        std::string changed = flight.log;
        changed[at + 10 + random() % 9] ^= static_cast<char>(1U << random() % 8);
        const ReplayResult result = replay(changed);
        ASSERT_NE(result.difference.find("a write of"), std::string::npos) << result.difference << result.incomplete;
    }
    // HEARTBEATs of the autopilot: their checksums fail, and nobody is heard.
    std::string changed = flight.log;
    for (std::size_t at = 0; (at = changed.find(head, at)) != std::string::npos; ++at) {
        if (changed[at + 6] == 1 && changed[at + 7] == 0) {
            changed[at + 10] ^= 1;
        }
    }
    EXPECT_FALSE(replay(changed).is_identical());
}

TEST(FlightReplay, AMissingMessageIsAGapAndNoDifference)
{
    const std::string log = fly_recorded(short_flight(), {}).log;
    std::istringstream in(log);
    ulog::Reader reader(in);
    std::uint64_t records = 0;
    std::string without;
    std::size_t begin = 16;
    while (const auto message = reader.next()) {
        const std::size_t size = 3 + message->content.size();
        const bool is_record =
            message->type == ulog::Type::data &&
            reader.topic(ulog::read_number<std::uint16_t>(message->content))->name.starts_with("jink_hal_");
        records += is_record ? 1U : 0U;
        if (is_record && records == 100) {
            without = log.substr(0, begin) + log.substr(begin + size);
        }
        begin += size;
    }
    const ReplayResult result = replay(without);
    EXPECT_FALSE(result.is_identical());
    EXPECT_NE(result.incomplete.find("gap"), std::string::npos);
    EXPECT_EQ(result.difference, "");
    EXPECT_EQ(result.steps, 99U);
}

TEST(FlightReplay, AnotherVersionIsRefusedUnlessItIsWanted)
{
    std::string log = fly_recorded(short_flight(), {}).log;
    const std::size_t at = log.find(build_digest());
    ASSERT_NE(at, std::string::npos);
    log[at] = log[at] == 'a' ? 'b' : 'a';
    const ReplayResult refused = replay(log);
    EXPECT_NE(refused.refused.find("another version"), std::string::npos) << refused.refused;
    EXPECT_EQ(refused.steps, 0U);
    ReplayOptions any;
    any.any_version = true;
    EXPECT_TRUE(replay(log, any).is_identical());
}

/// @param payload  length of the frame's payload [bytes]
void expect_no_key_in_a_log(std::size_t payload)
{
    constexpr std::int64_t kStart = 1'000'000;
    hal::ManualClock clock(kStart);
    hal::CountingWatchdog watchdog;
    const auto cable = std::make_unique<sim::Cable>(clock, 1, sim::Timing{});
    flightlog::Setup setup = plain_setup();
    setup.keys_can_be_set = true;
    MemoryLog memory(setup);
    FlightLog log(memory, {}, setup.stored);
    RecordingSerialPort line(cable->port(), log.recorder(), Port::line);
    link::mavlink::Signing signing;
    signing.let_keys_be_set(true);
    Assembly assembly(setup, app::Parameters(), {&line, nullptr, nullptr}, watchdog, signing, nullptr);
    for (int i = 0; i < 100; ++i) {
        std::array<std::byte, link::mavlink::kMaxFrame> frame{};
        link::mavlink::Heartbeat heartbeat;
        heartbeat.type = 2;
        heartbeat.autopilot = 3;
        const std::size_t n = link::mavlink::encode(heartbeat, {1, 1, static_cast<std::uint8_t>(i)}, frame);
        static_cast<void>(cable->write({frame.data(), n}));
        if (i == 50) {
            static_cast<void>(cable->write(setup_signing_frame(payload)));
        }
        clock.advance(20'000);
        log.begin({clock.now_us()});
        const app::StepReport report = assembly.coprocessor().step({clock.now_us()});
        log.end(report, assembly.coprocessor(), {clock.now_us()}, 0);
    }
    ASSERT_TRUE(signing.has_key()) << "the key was to be set";
    EXPECT_LE(longest_part(memory.text()), 3U) << "more than chance";
    const ReplayResult result = replay(memory.text());
    EXPECT_NE(result.incomplete.find("signing key"), std::string::npos) << result.difference << result.refused;
    EXPECT_FALSE(result.is_identical());
    EXPECT_GE(result.steps, 50U);
}

TEST(FlightReplay, ASigningKeyIsNeverInALog)
{
    for (const std::size_t payload : {42U, 43U, 50U, 255U}) {
        SCOPED_TRACE(payload);
        expect_no_key_in_a_log(payload);
    }
}

}  // namespace
