// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "firmware/flight_log/log_stream.hpp"
#include "tests/flight_log/stream_receiver.hpp"
#include "tests/unit/app/flight.hpp"

// A flight whose log is streamed, and a receiver that makes a file of it.

namespace jink::test {

/// A part as it came out of the co-processor.
struct SentPart {
    TimePoint at;
    std::uint16_t sequence = 0;
    std::uint8_t to_system = 0;
    std::uint8_t to_component = 0;
    bool acknowledged = false;
    std::size_t frame = 0;  ///< bytes on the line
};

inline int number_of(link::CommandResult result) { return static_cast<int>(result); }

/// Flight with a stream and its receiver, which acknowledges within the same tick.
class StreamFlight {
public:
    using Flight = app::test::Flight;
    static constexpr std::uint8_t kGround = 255;
    static constexpr std::uint8_t kGroundComponent = 190;

    explicit StreamFlight(std::uint32_t baud = 921600, bool streams = true, const app::Parameters& parameters = {})
        : f(std::make_unique<Flight>(parameters)), stream(std::make_unique<flightlog::LogStream>(baud))
    {
        if (streams) {
            f->coprocessor.stream(*stream);
        }
    }

    /// Until the co-processor is at work.
    [[nodiscard]] bool begin()
    {
        return f->until([](const app::StepReport& r) { return r.faults == 0; }, 200);
    }
    template <link::mavlink::Message M>
    void send(M message, std::uint8_t system = kGround, std::uint8_t component = kGroundComponent)
    {
        message.target_system = target_system;
        message.target_component = target_component;
        ASSERT_TRUE(f->port.arrive(link::mavlink::test::frame_of(message, {system, component, sequence_++})));
    }
    void command(std::uint16_t number, float param1 = 0.0F, std::uint8_t system = kGround,
                 std::uint8_t component = kGroundComponent)
    {
        link::mavlink::CommandLong m;
        m.command = number;
        m.param1 = param1;
        send(m, system, component);
    }
    void acknowledge(std::uint16_t sequence, std::uint8_t system = kGround, std::uint8_t component = kGroundComponent)
    {
        link::mavlink::LoggingAck m;
        m.sequence = sequence;
        send(m, system, component);
    }
    /// Result of a command in the next tick; -1: no answer.
    int ask(std::uint16_t number, float param1 = 0.0F, std::uint8_t system = kGround,
            std::uint8_t component = kGroundComponent)
    {
        command(number, param1, system, component);
        tick();
        int result = -1;
        for (const auto& ack : f->said_of<link::mavlink::CommandAck>()) {
            result = ack.command == number && ack.target_system == system ? ack.result : result;
        }
        return result;
    }
    static constexpr std::uint16_t kStart = 2510;
    static constexpr std::uint16_t kStop = 2511;
    static constexpr int kAccepted = 0;

    void tick()
    {
        f->last = f->tick();
        manoeuvres += f->last.guidance.new_manoeuvre && receiver.in_data ? 1 : 0;
        for (const auto& m : f->said_of<link::mavlink::LoggingDataAcked>()) {
            take(m, true);
        }
        for (const auto& m : f->said_of<link::mavlink::LoggingData>()) {
            take(m, false);
        }
    }
    void fly(int ticks)
    {
        for (int i = 0; i < ticks; ++i) {
            tick();
        }
    }
    /// Until data come. @return false: not within the ticks
    [[nodiscard]] bool fly_to_data(int ticks = 500)
    {
        for (int i = 0; i < ticks && !receiver.in_data; ++i) {
            tick();
        }
        return receiver.in_data;
    }
    /// 45 m ahead, from the next report on.
    void see_a_mast() { f->obstacles = {f->position + Vec3(0.0F, 45.0F, 0.0F)}; }
    bool happens(double chance) { return std::uniform_real_distribution<>(0.0, 1.0)(random) < chance; }

    std::unique_ptr<Flight> f;
    std::unique_ptr<flightlog::LogStream> stream;
    StreamReceiver receiver;
    std::vector<SentPart> parts;
    int manoeuvres = 0;  ///< since data came
    bool listens = true;
    bool acknowledges_again = true;  ///< as QGroundControl; PX4's script does not
    double lose_data = 0.0;          ///< chance
    double lose_ack = 0.0;
    double wrong_ack = 0.0;
    std::uint8_t target_system = app::test::wire::kSystem;
    std::uint8_t target_component = app::test::wire::kUs;
    std::mt19937_64 random{1};

private:
    template <class M>
    void take(const M& m, bool acknowledged)
    {
        const std::size_t frame = link::mavlink::test::frame_of(m, {1, 196, 0}).size();
        parts.push_back({f->now, m.sequence, m.target_system, m.target_component, acknowledged, frame});
        ASSERT_GT(m.length, 0U);
        ASSERT_LE(m.length, m.data.size());
        if (!listens || happens(lose_data)) {
            return;
        }
        const bool is_new = receiver.take(m.sequence, m.first_message_offset,
                                          std::as_bytes(std::span(m.data)).first(m.length), acknowledged);
        if (!acknowledged || !(is_new || acknowledges_again)) {
            return;
        }
        if (happens(wrong_ack)) {
            acknowledge(static_cast<std::uint16_t>(m.sequence + 1));
            acknowledge(m.sequence, kGround, 1);
            acknowledge(m.sequence, 9);
        }
        if (!happens(lose_ack)) {
            acknowledge(m.sequence);
        }
        if (happens(wrong_ack)) {
            acknowledge(m.sequence);  // twice
        }
    }

    std::uint8_t sequence_ = 0;
};

}  // namespace jink::test
