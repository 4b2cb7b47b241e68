// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/stream_content.hpp"
#include "tests/flight_log/stream_flight.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/sim/random_scenario.hpp"

// Logs of jinkd and of a board, changed message by message, and their pages.

namespace jink::test {

inline const RecordedFlight& page_flight()
{
    static const RecordedFlight flown = [] {
        sim::Scenario scenario = sim::random_scenario(7);
        scenario.duration = 16.0;
        return fly_recorded(scenario, {});
    }();
    return flown;
}

inline host::PageFlight page_of(const Scratch& scratch, const std::string& log)
{
    return host::read_flight_log(scratch.write("flight.ulg", log)).flights.at(0);
}

/// A log that a board streamed.
inline const std::string& board_log()
{
    static const std::string file = [] {
        StreamFlight s;
        EXPECT_TRUE(s.begin());
        EXPECT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        EXPECT_TRUE(s.fly_to_data());
        s.see_a_mast();
        s.fly(1'000);
        return s.receiver.file;
    }();
    return file;
}

inline std::size_t byte_of(const std::string& bytes, std::size_t i)
{
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
}

/// The log with what `rewrite` makes of each message, header and content. Sizes and types: the ULog format.
template <class Rewrite>
std::string rewritten(const std::string& log, Rewrite rewrite)
{
    std::string made = log.substr(0, 16);
    for (std::size_t at = 16, size = 0; at + 5 <= log.size(); at += size) {
        size = 3 + byte_of(log, at) + 256 * byte_of(log, at + 1);
        made += rewrite(log.substr(at, size));
    }
    return made;
}

inline bool is_of(const std::string& message, flightlog::TopicId topic)
{
    return message[2] == 'D' && byte_of(message, 3) + 256 * byte_of(message, 4) == std::size_t(topic);
}

/// The log without the messages of a topic for which `lacks` holds.
template <class T, class Lacks>
std::string without(const std::string& log, flightlog::TopicId topic, Lacks lacks)
{
    return rewritten(log, [&](const std::string& message) {
        const bool is_left_out =
            is_of(message, topic) && lacks(topic_of<T>(std::as_bytes(std::span(message)).subspan(3)));
        return is_left_out ? std::string() : message;
    });
}

template <class Lacks>
std::string without_candidates(const std::string& log, Lacks lacks)
{
    return without<flightlog::CandidateTopic>(log, flightlog::TopicId::candidate, lacks);
}

inline std::size_t count_of(const host::PageDecision& decision, host::Fate fate)
{
    return static_cast<std::size_t>(std::count_if(decision.candidates.begin(), decision.candidates.end(),
                                                  [&](const auto& candidate) { return candidate.fate == fate; }));
}

}  // namespace jink::test
