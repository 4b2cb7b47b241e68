// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "tests/flight_log/stream_bench.hpp"
#include "tests/flight_log/stream_content.hpp"
#include "tests/flight_log/stream_flight.hpp"

namespace jink::test {

/// A stream without a co-processor, and its receiver. A plan's number is the cost of its candidates.
class CandidateBench : public StreamBench {
public:
    CandidateBench() { tracks.resize(4); }
    /// From here on data.
    void start()
    {
        receiver = {};
        parser = link::mavlink::Parser();
        link::CommandRequest request;
        request.command = StreamFlight::kStart;
        request.from_system = StreamFlight::kGround;
        request.from_component = StreamFlight::kGroundComponent;
        ASSERT_EQ(log.take(request, parameters), link::CommandResult::accepted);
        for (int i = 0; i < 400 && !receiver.in_data; ++i) {
            tick();
        }
        ASSERT_TRUE(receiver.in_data);
        // The first step of the log is behind it.
        tick();
    }
    void stop()
    {
        link::CommandRequest request;
        request.command = StreamFlight::kStop;
        ASSERT_EQ(log.take(request, parameters), link::CommandResult::accepted);
        acks.clear();
    }
    /// A step; with it a manoeuvre begins or not.
    void tick(bool decides = false)
    {
        prepare(false);
        report.guidance.new_manoeuvre = decides;
        log.begin(now, acks);
        acks.clear();
        log.end(step(), endpoint);
        const auto said = link::mavlink::test::parse(parser, endpoint.pending());
        for (const auto& m : link::mavlink::test::all_of<link::mavlink::LoggingDataAcked>(said)) {
            take(m, true);
            acks.push_back({m.sequence, StreamFlight::kGround, StreamFlight::kGroundComponent});
        }
        for (const auto& m : link::mavlink::test::all_of<link::mavlink::LoggingData>(said)) {
            if (!loses_parts) {
                take(m, false);
            }
        }
    }
    void ticks(int n)
    {
        for (int i = 0; i < n; ++i) {
            tick();
        }
    }
    /// What the receiver has, once enough has followed to send the last part.
    [[nodiscard]] StreamContent content()
    {
        ticks(30);
        StreamContent c = read_content(receiver.file);
        EXPECT_EQ(c.end, ulog::End::complete);
        EXPECT_TRUE(c.is_in_order);
        return c;
    }

    flightlog::LogStream log{100 * 921'600};  // a part in each step
    StreamReceiver receiver;
    link::mavlink::Parser parser;
    std::vector<link::LogAck> acks;
    bool loses_parts = false;

private:
    template <class M>
    void take(const M& m, bool acknowledged)
    {
        static_cast<void>(receiver.take(m.sequence, m.first_message_offset,
                                        std::as_bytes(std::span(m.data)).first(m.length), acknowledged));
    }
};

}  // namespace jink::test
