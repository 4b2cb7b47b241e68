// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "toolchain/sim/autopilot.hpp"

namespace jink::sim {

using namespace link::mavlink;

/// The autopilot with a hand at the other end of the cable.
class Line {
public:
    explicit Line(const Scenario& scenario) : world(scenario), autopilot(world) {}

    World world;
    Autopilot autopilot;

    template <Message M>
    void send(const M& message)
    {
        std::array<std::byte, kMaxFrame> frame{};
        const std::size_t n = encode(message, {1, 196, sequence_++}, frame);
        autopilot.receive({frame.data(), n});
    }
    void send_velocity(float north, float east, float down, std::uint16_t mask = kVelocityMask, std::uint8_t frame = 1)
    {
        SetPositionTargetLocalNed m;
        m.vx = north;
        m.vy = east;
        m.vz = down;
        m.type_mask = mask;
        m.coordinate_frame = frame;
        m.target_system = m.target_component = 1;
        send(m);
    }
    /// Asks for a mode; the result of the acknowledgement.
    std::optional<int> ask(float param2, float param3 = 0.0F, float param1 = 129.0F)
    {
        CommandLong m;
        m.command = 176;
        m.param1 = param1;
        m.param2 = param2;
        m.param3 = param3;
        m.target_system = m.target_component = 1;
        send(m);
        const auto ack = heard<CommandAck>();
        return ack ? std::optional<int>(ack->result) : std::nullopt;
    }
    void run(double seconds, bool stream = false)
    {
        for (Micros i = 0; i < to_micros(seconds); i += kStep) {
            if (stream && i % 50'000 == 0) {
                send_velocity(0.0F, 2.0F, 0.0F);
            }
            autopilot.step();
            static_cast<void>(keep());
        }
    }
    /// The newest message of a kind since this was last asked for, or since `run` began.
    template <Message M>
    std::optional<M> heard()
    {
        static_cast<void>(keep());
        std::optional<M> newest;
        M message;
        Parser parser;
        std::span<const std::byte> bytes(kept_);
        while (const auto frame = parser.next(bytes)) {
            if (decode(*frame, message)) {
                newest = message;
            }
        }
        return newest;
    }
    template <Message M>
    int count()
    {
        static_cast<void>(keep());
        int n = 0;
        Parser parser;
        std::span<const std::byte> bytes(kept_);
        while (const auto frame = parser.next(bytes)) {
            n += frame->message_id == M::kInfo.id ? 1 : 0;
        }
        return n;
    }
    void forget() { kept_.clear(); }

private:
    std::size_t keep()
    {
        const auto out = autopilot.take_output();
        kept_.insert(kept_.end(), out.begin(), out.end());
        return kept_.size();
    }

    std::uint8_t sequence_ = 0;
    std::vector<std::byte> kept_;
};

inline Scenario scenario_of(Stack stack)
{
    Scenario s;
    s.name = "test";
    s.stack = stack;
    s.mission = {Vec(0, 0, 30), Vec(200, 0, 30)};
    s.start_position = s.mission[0];
    s.start_velocity = Vec(5, 0, 0);
    return s;
}

inline const Scenario kArdupilotFlight = scenario_of(Stack::ardupilot);
inline const Scenario kPx4Flight = scenario_of(Stack::px4);

}  // namespace jink::sim
