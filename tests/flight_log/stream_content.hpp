// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::test {

/// What a file of a receiver holds.
struct StreamContent {
    std::map<std::string, int> topics;
    std::vector<flightlog::StepTopic> steps;
    std::vector<flightlog::DecisionTopic> decisions;
    std::vector<flightlog::CandidateTopic> candidates;
    std::vector<flightlog::StreamTopic> streams;
    std::vector<std::string> texts;
    std::map<std::string, ulog::Keyed> parameters;
    std::map<std::string, float> changed;
    int dropouts = 0;
    std::string version;
    ulog::End end = ulog::End::none;
    std::uint64_t last = 0;
    bool is_in_order = true;
};

template <class T>
T topic_of(std::span<const std::byte> message)
{
    T topic;
    EXPECT_EQ(message.size(), 2 + flightlog::kBytesOf<T>);
    std::memcpy(static_cast<void*>(&topic), message.data() + 2, flightlog::kBytesOf<T>);
    return topic;
}

inline StreamContent read_content(const std::string& file)
{
    std::istringstream in(file);
    ulog::Reader reader(in);
    StreamContent c;
    while (const auto message = reader.next()) {
        const auto content = message->content;
        if (message->type == ulog::Type::data) {
            const std::string name = reader.topic(ulog::read_number<std::uint16_t>(content))->name;
            ++c.topics[name];
            const auto stamp = ulog::read_number<std::uint64_t>(content.subspan(2));
            c.is_in_order = c.is_in_order && stamp >= c.last;
            c.last = stamp;
            if (name == "jink_step") {
                c.steps.push_back(topic_of<flightlog::StepTopic>(content));
            } else if (name == "jink_decision") {
                c.decisions.push_back(topic_of<flightlog::DecisionTopic>(content));
            } else if (name == "jink_candidate") {
                c.candidates.push_back(topic_of<flightlog::CandidateTopic>(content));
            } else if (name == "jink_stream") {
                c.streams.push_back(topic_of<flightlog::StreamTopic>(content));
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

}  // namespace jink::test
