// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

// A closed loop around Coprocessor::step: bytes in, bytes out, and an autopilot of a few lines behind the wire.

namespace jink::app::test {

using namespace link::mavlink;
using link::mavlink::test::all_of;
using link::mavlink::test::Received;
namespace wire = link::mavlink::test;

/// Both directions in fixed memory: the port never allocates within a step.
class FixedPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = state == hal::PortState::open ? std::min(into.size(), in_size_) : 0;
        std::memcpy(into.data(), in_.data(), n);
        std::memmove(in_.data(), in_.data() + n, in_size_ - n);
        in_size_ -= n;
        return n;
    }
    std::size_t write(std::span<const std::byte> from) noexcept override
    {
        const std::size_t n = std::min({from.size(), out_.size() - out_size_, room});
        std::memcpy(out_.data() + out_size_, from.data(), n);
        out_size_ += n;
        return n;
    }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = state;
        return health;
    }

    /// False when the buffer is full: a test that loses its own bytes proves nothing. A cut line loses them as
    /// intended.
    [[nodiscard]] bool arrive(std::span<const std::byte> bytes)
    {
        if (state != hal::PortState::open) {
            return true;
        }
        if (bytes.size() > in_.size() - in_size_) {
            return false;
        }
        std::copy(bytes.begin(), bytes.end(), in_.begin() + static_cast<std::ptrdiff_t>(in_size_));
        in_size_ += bytes.size();
        return true;
    }
    [[nodiscard]] std::span<const std::byte> written() const { return {out_.data(), out_size_}; }
    void clear_written() { out_size_ = 0; }

    hal::PortState state = hal::PortState::open;
    std::size_t room = 1U << 20U;  ///< bytes taken per write

private:
    std::array<std::byte, 1U << 15U> in_{};
    std::array<std::byte, 1U << 15U> out_{};
    std::size_t in_size_ = 0;
    std::size_t out_size_ = 0;
};

inline bool has(const StepReport& report, Fault fault) { return (report.faults & bit(fault)) != 0; }

class CountingWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override { ++fed; }
    int fed = 0;
};

/// A copter flying north at 5 m/s, 50 m above the origin: AUTO follows the leg, GUIDED the set-points, BRAKE stops.
/// prepare(), step(), react() are one tick of 20 ms.
class Flight {
public:
    static constexpr std::int64_t kTickUs = 20'000;

    /// @param line  nullptr: the port of this flight
    explicit Flight(const Parameters& parameters = {}, link::SensorBus* bus = nullptr, hal::SerialPort* line = nullptr)
        : coprocessor(endpoint, line != nullptr ? *line : port, watchdog, parameters, bus)
    {
    }

    void prepare()
    {
        now.us += kTickUs;
        boot_us += kTickUs;
        move();
        if (heartbeats && (ticks % 50 == 0 || mode != reported_mode_)) {
            reported_mode_ = mode;
            feed(wire::heartbeat(mode, armed, px4 ? 12 : 3, mav_type));
        }
        if (ticks % 50 == 0) {
            feed(wire::origin());
        }
        if (own_state) {
            feed(wire::local_position(boot_ms(), position, velocity));
        }
        if (ticks % 50 == 0) {
            MissionCurrent current;
            current.seq = mission_current;
            feed(current);
        }
        if (ticks % 10 == 0) {
            for (std::size_t i = 0; i < obstacles.size(); ++i) {
                feed(obstacle(static_cast<std::uint32_t>(i + 1), obstacles[i]));
            }
        }
        if (ring > 0.0F && ticks % 5 == 0) {
            feed(scan(ring));
        }
        ++ticks;
    }

    StepReport step() { return coprocessor.step(now); }

    void react()
    {
        said = wire::parse(parser_, port.written());
        port.clear_written();
        for (const SetPositionTargetLocalNed& m : said_of<SetPositionTargetLocalNed>()) {
            ++setpoints;
            stream_since_ = now - last_heard_ > 0.5F ? now : stream_since_;
            last_heard_ = now;
            command_ = Vec3(m.vy, m.vx, -m.vz);
        }
        if (answers_mission) {
            answer_mission();
        }
        for (const CommandLong& m : said_of<CommandLong>()) {
            if (m.command == 512 && m.param1 == 0.0F && heartbeats && answers_requests) {
                feed(wire::heartbeat(mode, armed, px4 ? 12 : 3, mav_type));  // as both stacks do
            }
            if (m.command != 176) {
                continue;
            }
            requested.push_back(m.param2);
            const auto number = static_cast<std::uint32_t>(m.param2);
            const std::uint32_t asked = px4 ? px4_mode(number, static_cast<std::uint32_t>(m.param3)) : number;
            // As documented by PX4: more than a second of set-points, 2 Hz or more.
            const bool seen = now - stream_since_ > 1.0F && now - last_heard_ <= 0.5F;
            const bool granted = obeys && (!px4 || asked != external_mode() || seen);
            mode = granted ? asked : mode;
            if (acknowledges) {
                CommandAck ack;
                ack.command = 176;
                ack.result = granted ? 0 : 1;
                ack.target_system = wire::kSystem;
                ack.target_component = wire::kUs;
                feed(ack);
            }
        }
    }

    StepReport tick()
    {
        prepare();
        const StepReport report = step();
        react();
        return report;
    }

    /// Ticks until `done(report)` holds; false when it does not within `limit` ticks.
    template <class Done>
    bool until(Done done, int limit = 1500)
    {
        for (int i = 0; i < limit; ++i) {
            last = tick();
            if (done(last)) {
                return true;
            }
        }
        return false;
    }
    void fly(int n)
    {
        for (int i = 0; i < n; ++i) {
            last = tick();
        }
    }

    template <link::mavlink::Message M>
    void feed(const M& message, std::uint8_t component = wire::kAutopilot)
    {
        lost_input = !port.arrive(wire::frame_of(message, {wire::kSystem, component, sequence_++})) || lost_input;
    }
    void feed_bytes(std::span<const std::byte> bytes) { lost_input = !port.arrive(bytes) || lost_input; }

    template <link::mavlink::Message M>
    [[nodiscard]] std::vector<M> said_of() const
    {
        return all_of<M>(said);
    }
    /// Requests of a mode, in the last tick.
    [[nodiscard]] std::vector<CommandLong> mode_requests() const
    {
        std::vector<CommandLong> found = said_of<CommandLong>();
        std::erase_if(found, [](const CommandLong& m) { return m.command != 176; });
        return found;
    }
    [[nodiscard]] std::uint32_t mission_mode() const
    {
        return px4 ? px4_mode(4, 4) : is_plane() ? 10 : wire::kCopterAuto;
    }
    [[nodiscard]] std::uint32_t external_mode() const
    {
        return px4 ? px4_mode(6, 0) : is_plane() ? 15 : wire::kCopterGuided;
    }
    [[nodiscard]] bool is_plane() const { return mav_type == 1; }
    [[nodiscard]] std::uint32_t boot_ms() const { return static_cast<std::uint32_t>(boot_us / 1000); }

    TimePoint now{10'000'000};
    std::int64_t boot_us = 60'000'000;
    int ticks = 0;
    bool heartbeats = true;
    bool own_state = true;
    bool obeys = true;             ///< grants requested modes
    bool acknowledges = false;     ///< answers requests by COMMAND_ACK
    bool px4 = false;              ///< a PX4; set `mode` too
    bool deaf = false;             ///< grants the external mode and flies on as on its mission
    bool answers_requests = true;  ///< sends a HEARTBEAT on request
    std::uint8_t mav_type = 2;
    bool armed = true;
    bool hovers = false;  ///< hovers on its mission
    bool answers_mission = true;
    std::uint16_t mission_current = 1;
    /// Home, and one waypoint 2 km to the north.
    std::vector<MissionItemInt> mission{waypoint(0, 0.0F), waypoint(20'000'000, 50.0F)};
    std::uint32_t mode = wire::kCopterAuto;
    Vec3 position = Vec3(0.0F, 0.0F, 50.0F);
    Vec3 velocity = Vec3(0.0F, 5.0F, 0.0F);
    std::vector<Vec3> obstacles;  ///< static, reported as traffic
    float ring = 0.0F;            ///< range of a scanner's returns all around [m]; 0: no scanner
    StepReport last;
    std::vector<Received> said;    ///< in the last tick
    std::vector<float> requested;  ///< modes, in their order
    int setpoints = 0;
    bool lost_input = false;  ///< the test fed more than the port holds

    FixedPort port;
    CountingWatchdog watchdog;
    Endpoint endpoint;
    Coprocessor coprocessor;

private:
    void answer_mission()
    {
        if (!said_of<MissionRequestList>().empty()) {
            MissionCount count;
            count.count = static_cast<std::uint16_t>(mission.size());
            count.target_system = wire::kSystem;
            count.target_component = wire::kUs;
            feed(count);
        }
        for (const MissionRequestInt& m : said_of<MissionRequestInt>()) {
            if (m.seq < mission.size()) {
                MissionItemInt item = mission[m.seq];
                item.seq = m.seq;
                item.target_system = wire::kSystem;
                item.target_component = wire::kUs;
                feed(item);
            }
        }
    }
    static MissionItemInt waypoint(std::int32_t north_0_1_mm, float height)
    {
        MissionItemInt item;
        item.command = 16;
        item.frame = 1;
        item.x = north_0_1_mm;
        item.z = -height;
        return item;
    }
    void move()
    {
        Vec3 wanted = Vec3::Zero();
        if (mode == mission_mode() && !hovers) {
            const auto back = [](float error) { return std::clamp(-0.5F * error, -2.0F, 2.0F); };
            wanted = Vec3(back(position.x()), 5.0F, back(position.z() - 50.0F));
        } else if (mode == external_mode()) {
            wanted = deaf ? Vec3(0.0F, 5.0F, 0.0F) : command_;
        }
        constexpr float kDt = 0.02F;
        constexpr float kLag = 0.25F;
        velocity += (wanted - velocity) * (kDt / kLag);
        position += velocity * kDt;
    }
    static AdsbVehicle obstacle(std::uint32_t id, const Vec3& where)
    {
        constexpr GlobalPosition kOrigin{473977420, 85455940, 488000};
        AdsbVehicle m = wire::adsb(id, to_global(where, kOrigin).value());
        m.emitter_type = 19;
        m.hor_velocity = 0;
        m.ver_velocity = 0;
        return m;
    }
    static ObstacleDistance scan(float range)
    {
        ObstacleDistance m;
        m.distances.fill(static_cast<std::uint16_t>(range * 100.0F));
        m.min_distance = 20;
        m.max_distance = 4000;
        m.increment = 5;
        return m;
    }

    Vec3 command_ = Vec3::Zero();
    TimePoint last_heard_;  ///< set-point
    TimePoint stream_since_;
    std::uint32_t reported_mode_ = 0xFFFFFFFF;
    std::uint8_t sequence_ = 0;
    Parser parser_;
};

}  // namespace jink::app::test
