// SPDX-License-Identifier: BSD-3-Clause
// ULog as it is written and read: cut at every byte, with damaged bytes, with unknown messages.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>
#include <set>

#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using namespace jink::test;

/// The log of a short flight, flown once.
const std::string& short_log()
{
    static const std::string log = [] {
        sim::Scenario scenario = sim::random_scenario(3);
        scenario.duration = 4.0;
        return fly_recorded(scenario, {}).log;
    }();
    return log;
}

struct Count {
    std::size_t messages = 0;
    ulog::End end = ulog::End::none;
    std::uint64_t offset = 0;
};

Count count(const std::string& log)
{
    std::istringstream in(log);
    ulog::Reader reader(in);
    Count count;
    while (reader.next()) {
        ++count.messages;
    }
    count.end = reader.end();
    count.offset = reader.offset();
    return count;
}

TEST(Ulog, HeaderAndFlagsAreWhereTheFormatHasThem)
{
    const std::string& log = short_log();
    EXPECT_EQ(log.substr(0, 8), std::string("ULog\x01\x12\x35\x01", 8));
    EXPECT_EQ(log.substr(16, 3), std::string("\x28\x00\x42", 3)) << "the flags come first";
    EXPECT_EQ(log[19], 1) << "there are default parameters";
}

TEST(Ulog, EverythingThatIsWrittenIsRead)
{
    std::istringstream in(short_log());
    ulog::Reader reader(in);
    std::set<std::string> topics;
    std::uint64_t texts = 0;
    while (const auto message = reader.next()) {
        if (message->type == ulog::Type::data) {
            topics.insert(reader.topic(ulog::read_number<std::uint16_t>(message->content))->name);
        }
        texts += message->type == ulog::Type::text ? 1U : 0U;
    }
    EXPECT_EQ(reader.end(), ulog::End::complete);
    EXPECT_EQ(reader.offset(), short_log().size());
    for (const char* topic : {"jink_step", "jink_own", "jink_app_counters", "jink_avoid_counters", "jink_log"}) {
        EXPECT_TRUE(topics.contains(topic)) << topic;
    }
    EXPECT_GT(texts, 2U);
    EXPECT_EQ(reader.info("sys_name"), "jink");
    ASSERT_EQ(reader.parameters().size(), app::kParamCount);
    ASSERT_EQ(reader.defaults().size(), app::kParamCount);
    const app::Parameters parameters;
    for (std::size_t i = 0; i < app::kParamCount; ++i) {
        const std::string name(app::param_table()[i].name);
        const auto value = reader.parameters().at(name).number();
        ASSERT_TRUE(value) << name;
        EXPECT_EQ(std::bit_cast<std::uint32_t>(*value), std::bit_cast<std::uint32_t>(parameters.values()[i])) << name;
    }
}

TEST(Ulog, FormatsAreAsLargeAsTheirTopics)
{
    for (const std::string& format : flightlog::topic_formats()) {
        const auto parsed = ulog::parse_format(format);
        ASSERT_TRUE(parsed) << format;
        EXPECT_EQ(parsed->size, ulog::size_of_format(format)) << format;
        EXPECT_EQ(parsed->fields.front().name, "timestamp");
    }
    for (const char* bad : {"", "name", "name:", ":uint8_t a;", "n:uint8_t a", "n:uint8_t;", "n:uint9_t a;",
                            "n:uint8_t[] a;", "n:uint8_t[0] a;", "n:uint8_t[99999] a;", "n:uint8_t[3 a;",
                            "n:uint8_t[-1] a;", "n m:uint8_t a;", "n:float[16384] a;"}) {
        EXPECT_FALSE(ulog::parse_format(bad)) << bad;
    }
    const auto padded = ulog::parse_format("n:uint32_t a;uint8_t b;uint8_t[3] _padding0;");
    ASSERT_TRUE(padded);
    EXPECT_EQ(padded->size, 5U);
}

constexpr std::size_t kTail = 64U * 1024U;

/// The flight's last records and reports without what is read at the head of each file: quick to read many times.
std::string without_definitions()
{
    ulog::Messages kept;
    std::set<std::uint16_t> kept_topics;
    kept.file_header(0);
    kept.flag_bits(0);
    for (std::uint16_t id = 0; const std::string& format : flightlog::topic_formats()) {
        if (format.starts_with("jink_hal") || format.starts_with("jink_step") || format.starts_with("jink_own")) {
            kept.format(format);
            kept.subscription(id, flightlog::name_of_format(format));
            kept_topics.insert(id);
        }
        ++id;
    }
    std::istringstream in(short_log());
    ulog::Reader reader(in);
    std::size_t begin = 16;
    while (const auto message = reader.next()) {
        const std::size_t size = ulog::kMessageHeader + message->content.size();
        const bool is_late = begin + kTail + 2'000 > short_log().size();
        if (!is_late) {
            begin += size;
            continue;
        }
        if (message->type == ulog::Type::text ||
            (message->type == ulog::Type::data &&
             kept_topics.contains(ulog::read_number<std::uint16_t>(message->content)))) {
            kept.append(std::as_bytes(std::span(short_log())).subspan(begin, size));
        }
        begin += size;
    }
    return {reinterpret_cast<const char*>(kept.bytes().data()), kept.bytes().size()};
}

/// Reads the log cut at some of its bytes.
void expect_all_before_the_cut(const std::string& log, std::size_t from, std::size_t to, std::size_t step)
{
    std::vector<std::size_t> ends{16};  // of the messages
    while (ends.back() < log.size()) {
        const auto low = static_cast<unsigned char>(log[ends.back()]);
        const auto high = static_cast<unsigned char>(log[ends.back() + 1]);
        ends.push_back(ends.back() + 3U + low + 256U * high);
    }
    ASSERT_EQ(ends.back(), log.size());
    for (std::size_t size = from; size < to; size += step) {
        const Count read = count(log.substr(0, size));
        const auto whole = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), size) - ends.begin());
        ASSERT_EQ(read.messages, whole == 0 ? 0 : whole - 1) << size;
        const bool at_an_end = whole > 0 && ends[whole - 1] == size;
        ASSERT_EQ(read.end, size < 16 ? ulog::End::not_ulog : at_an_end ? ulog::End::complete : ulog::End::cut) << size;
    }
}

TEST(Ulog, CutAtAnyByteOfTheLast64KibEverythingBeforeIsRead)
{
    const std::string log = without_definitions();
    ASSERT_GT(log.size(), kTail);
    expect_all_before_the_cut(log, log.size() - kTail, log.size(), 1);
}

TEST(Ulog, CutAtAnyByteOfTheDefinitionsEverythingBeforeIsRead)
{
    expect_all_before_the_cut(short_log(), 0, 16'000, 1);
    expect_all_before_the_cut(short_log(), 16'000, short_log().size(), 997);
}

/// Whatever the bytes are, reading, summing up and replaying end.
TEST(Ulog, DamagedBytesNeverHarmTheReader)
{
    std::mt19937_64 random(20);
    const std::string& log = short_log();
    std::uint64_t damaged = 0;
    for (int i = 0; i < 300; ++i) {
        std::string bad = log;
        const std::size_t region = i % 2 == 0 ? bad.size() : 14'000;  // definitions, half of the time
        for (int flips = 0; flips < 1 + i % 8; ++flips) {
            bad[random() % region] ^= static_cast<char>(1U << random() % 8);
        }
        const Count read = count(bad);
        EXPECT_NE(read.end, ulog::End::none);
        EXPECT_LE(read.offset, bad.size());
        damaged += read.end != ulog::End::complete ? 1U : 0U;
        if (i % 4 < 2) {
            static_cast<void>(replay(bad));
        }
    }
    EXPECT_GT(damaged, 50U);
}

TEST(Ulog, RandomBytesAreNoLog)
{
    std::mt19937_64 random(21);
    for (int i = 0; i < 2'000; ++i) {
        std::string bytes = short_log().substr(0, 16);
        for (std::size_t n = random() % 3'000; n > 0; --n) {
            bytes += static_cast<char>(random());
        }
        EXPECT_NE(count(bytes).end, ulog::End::none);
    }
}

TEST(Ulog, UnknownMessagesArePassedOver)
{
    ulog::Messages messages;
    messages.file_header(5);
    messages.flag_bits(0);
    const std::string unknown("\x04\x00Zabcd", 7);
    messages.append(std::as_bytes(std::span(unknown)));
    messages.info("name", "value");
    std::string text(reinterpret_cast<const char*>(messages.bytes().data()), messages.bytes().size());
    const Count read = count(text);
    EXPECT_EQ(read.messages, 3U);
    EXPECT_EQ(read.end, ulog::End::complete);
    text[16 + 3 + 8] = 2;  // an incompatible flag
    EXPECT_EQ(count(text).end, ulog::End::refused);
}

TEST(Ulog, DataOfUnknownTopicsOrSizesAreDamage)
{
    ulog::Messages head;
    head.file_header(0);
    head.flag_bits(0);
    head.format("a:uint64_t timestamp;uint8_t b;");
    head.subscription(0, "a");
    const std::string good(reinterpret_cast<const char*>(head.bytes().data()), head.bytes().size());
    const auto with_data = [&](std::uint16_t id, std::size_t size) {
        std::string text = good;
        text += static_cast<char>(size + 2);
        text += std::string("\0D", 2);
        text += static_cast<char>(id);
        text += '\0';
        return text + std::string(size, 'x');
    };
    EXPECT_EQ(count(with_data(0, 9)).end, ulog::End::complete);
    EXPECT_EQ(count(with_data(1, 9)).end, ulog::End::damaged);
    EXPECT_EQ(count(with_data(0, 8)).end, ulog::End::damaged);
    EXPECT_EQ(count(with_data(0, 10)).end, ulog::End::damaged);
}

TEST(Ulog, ASetupIsReadAsItWasWritten)
{
    flightlog::Setup setup = plain_setup();
    setup.system_id = 7;
    setup.clock = 168;
    setup.on_bus = setup.has_bus = true;
    setup.node.node = 42;
    setup.node.seed = 0x123456789ABCDEFULL;
    setup.node.unique_id = {1, 2, 3, 250, 251, 252};
    setup.has_cloud = setup.logs_cloud = setup.keeps_state = setup.keys_can_be_set = true;
    setup.map = 0xDEADBEEF;
    setup.has_key = true;
    setup.signing_time = 1ULL << 47U;
    setup.unsigned_frames = "109,246";
    setup.stored[static_cast<std::size_t>(app::Param::track_age)] = std::nextafterf(7.0F, 8.0F);
    setup.stored[static_cast<std::size_t>(app::Param::own_address)] = 16'777'215.0F;
    std::istringstream in(MemoryLog(setup).text());
    ulog::Reader reader(in);
    while (reader.next()) {
    }
    std::string why;
    const auto read = flightlog::read_setup(reader, why);
    ASSERT_TRUE(read) << why;
    EXPECT_EQ(read->system_id, 7);
    EXPECT_EQ(read->clock, 168U);
    EXPECT_TRUE(read->on_bus && read->has_bus && read->has_cloud && read->logs_cloud && read->keeps_state);
    EXPECT_EQ(read->node.node, 42);
    EXPECT_EQ(read->node.seed, setup.node.seed);
    EXPECT_EQ(read->node.unique_id, setup.node.unique_id);
    EXPECT_EQ(read->map, setup.map);
    EXPECT_TRUE(read->has_key && read->keys_can_be_set);
    EXPECT_EQ(read->signing_time, setup.signing_time);
    EXPECT_EQ(read->unsigned_frames, "109,246");
    EXPECT_EQ(read->initial, setup.initial);
    EXPECT_EQ(read->stored, setup.stored);
    EXPECT_EQ(read->digest, setup.digest);
}

}  // namespace
