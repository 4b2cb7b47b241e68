// SPDX-License-Identifier: BSD-3-Clause
// The ring of messages against a list of them, and the definitions in parts of any size.
#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <set>
#include <sstream>
#include <vector>

#include "firmware/flight_log/message_ring.hpp"
#include "firmware/flight_log/stream_head.hpp"
#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace {

using namespace jink;
using flightlog::MessageRing;
using flightlog::StreamHead;
using Bytes = std::vector<std::byte>;

Bytes message_of(std::size_t content, std::mt19937_64& random)
{
    Bytes bytes{static_cast<std::byte>(content & 0xFFU), static_cast<std::byte>(content >> 8U), std::byte{'D'}};
    for (std::size_t i = 0; i < content; ++i) {
        bytes.push_back(static_cast<std::byte>(random()));
    }
    return bytes;
}

/// Bytes that wait, and which of them begins a message.
struct Waiting {
    std::deque<std::pair<std::byte, bool>> bytes;
    void add(const Bytes& message)
    {
        for (std::size_t i = 0; i < message.size(); ++i) {
            bytes.emplace_back(message[i], i == 0);
        }
    }
};

TEST(MessageRing, IsAListOfWholeMessages)
{
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        MessageRing ring;
        Waiting waiting;
        std::uint32_t dropped = 0;
        std::uint32_t accepted = 0;
        bool is_dropping = false;
        std::int64_t since = 0;
        TimePoint now{1'000'000};
        for (int i = 0; i < 400; ++i) {
            now.us += static_cast<std::int64_t>(random() % 50'000);
            if (random() % 3 != 0) {
                const Bytes message = message_of(random() % 4 == 0 ? 0 : random() % 700, random);
                const std::size_t spare = random() % 3 == 0 ? 512 : 0;
                const std::size_t extra = is_dropping ? 5 : 0;
                const bool fits = waiting.bytes.size() + message.size() + spare + extra <= MessageRing::kBytes;
                ASSERT_EQ(ring.add(message, now, spare), fits);
                if (fits && is_dropping) {
                    const auto ms = static_cast<std::uint64_t>((now.us - since) / 1000);
                    waiting.add({std::byte{2}, std::byte{0}, std::byte{'O'}, static_cast<std::byte>(ms & 0xFFU),
                                 static_cast<std::byte>(ms >> 8U)});
                }
                since = !fits && !is_dropping ? now.us : since;
                is_dropping = !fits;
                dropped += fits ? 0U : 1U;
                accepted += fits ? 1U : 0U;
                if (fits) {
                    waiting.add(message);
                }
            } else {
                Bytes buffer(1 + random() % 249);
                const auto part = ring.peek(buffer);
                ASSERT_EQ(part.size(), std::min(buffer.size(), waiting.bytes.size()));
                std::size_t first = 255;
                for (std::size_t k = part.size(); k-- > 0;) {
                    ASSERT_EQ(part[k], waiting.bytes[k].first);
                    first = waiting.bytes[k].second ? k : first;
                }
                ASSERT_EQ(ring.first_message(part.size()), first);
                ring.remove(part.size());
                waiting.bytes.erase(waiting.bytes.begin(),
                                    waiting.bytes.begin() + static_cast<std::ptrdiff_t>(part.size()));
            }
            ASSERT_EQ(ring.size(), waiting.bytes.size());
            ASSERT_EQ(ring.dropped(), dropped);
            ASSERT_EQ(ring.messages(), accepted);
        }
        EXPECT_GT(dropped, 0U);
        ring.clear();
        EXPECT_EQ(ring.size(), 0U);
        EXPECT_EQ(ring.dropped(), dropped) << "counters stay";
    }
}

std::string all_of(const StreamHead& head, std::size_t largest, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::string out;
    for (StreamHead::Place place; !StreamHead::is_end(place);) {
        Bytes buffer(seed == 0 ? largest : 1 + random() % largest);
        const StreamHead::Part part = head.part(place, buffer);
        EXPECT_FALSE(part.bytes.empty());
        EXPECT_EQ(Bytes(part.bytes.begin(), part.bytes.end()), [&] {
            Bytes again(buffer.size());
            const auto once_more = head.part(place, again).bytes;
            return Bytes(once_more.begin(), once_more.end());
        }()) << "a part that is repeated";
        EXPECT_TRUE(part.bytes.size() == buffer.size() || StreamHead::is_end(part.next));
        out.append(reinterpret_cast<const char*>(part.bytes.data()), part.bytes.size());
        place = part.next;
    }
    return out;
}

TEST(StreamHead, AreTheSameInPartsOfAnySize)
{
    StreamHead head;
    head.begin({77}, app::Parameters().values());
    const std::string whole = all_of(head, 100'000, 0);
    EXPECT_GT(whole.size(), 4'000U);
    EXPECT_LT(whole.size(), 8'000U);
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        ASSERT_EQ(all_of(head, 249, seed), whole) << seed;
    }
    EXPECT_EQ(all_of(head, 249, 0), whole);
    EXPECT_EQ(all_of(head, 1, 0), whole);
}

TEST(StreamHead, HaveTheFormatsOfJinkd)
{
    StreamHead head;
    head.begin({77}, app::Parameters().values());
    std::istringstream in(all_of(head, 249, 0));
    ulog::Reader reader(in);
    while (reader.next()) {
    }
    EXPECT_EQ(reader.end(), ulog::End::complete);
    EXPECT_EQ(reader.started(), 77U);
    EXPECT_EQ(reader.info("sys_name"), "jink");
    std::set<std::string> compared;
    for (std::uint16_t id = 0; const std::string& text : flightlog::topic_formats()) {
        const ulog::Format* const streamed = reader.topic(id++);
        const auto expected = ulog::parse_format(text);
        ASSERT_TRUE(expected);
        if (streamed == nullptr || streamed->name != expected->name) {
            continue;
        }
        compared.insert(expected->name);
        ASSERT_EQ(streamed->size, expected->size);
        ASSERT_EQ(streamed->fields.size(), expected->fields.size());
        for (std::size_t i = 0; i < expected->fields.size(); ++i) {
            EXPECT_EQ(streamed->fields[i].name, expected->fields[i].name);
            EXPECT_EQ(streamed->fields[i].type, expected->fields[i].type);
            EXPECT_EQ(streamed->fields[i].count, expected->fields[i].count);
        }
    }
    EXPECT_EQ(compared, (std::set<std::string>{"jink_step", "jink_own", "jink_track", "jink_decision", "jink_candidate",
                                               "jink_app_counters", "jink_avoid_counters"}));
    ASSERT_NE(reader.topic(7), nullptr);
    EXPECT_EQ(reader.topic(7)->name, "jink_stream");
}

}  // namespace
