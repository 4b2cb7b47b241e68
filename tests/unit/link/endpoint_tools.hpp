// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

// The autopilot's side of the wire for tests: messages of PX4 and ArduPilot, and an endpoint's output.

namespace jink::link::mavlink::test {

constexpr std::uint8_t kSystem = 7;
constexpr std::uint8_t kAutopilot = 1;
constexpr std::uint8_t kUs = 196;

constexpr std::uint32_t kCopterAuto = 3, kCopterGuided = 4, kCopterLoiter = 5, kCopterBrake = 17;

inline Heartbeat heartbeat(std::uint32_t mode = kCopterAuto, bool armed = true, std::uint8_t stack = 3,
                           std::uint8_t type = 2)
{
    Heartbeat m;
    m.custom_mode = mode;
    m.type = type;
    m.autopilot = stack;
    m.base_mode = armed ? 0x81 : 0x01;
    m.system_status = 4;
    return m;
}

inline LocalPositionNed local_position(std::uint32_t boot_ms, const Vec3& enu, const Vec3& velocity_enu = Vec3::Zero())
{
    LocalPositionNed m;
    m.time_boot_ms = boot_ms;
    m.x = enu.y();
    m.y = enu.x();
    m.z = -enu.z();
    m.vx = velocity_enu.y();
    m.vy = velocity_enu.x();
    m.vz = -velocity_enu.z();
    return m;
}

/// Level attitude with this ENU yaw.
inline AttitudeQuaternion attitude(std::uint32_t boot_ms, float yaw_enu)
{
    const float heading = 0.5F * kPi - yaw_enu;
    AttitudeQuaternion m;
    m.time_boot_ms = boot_ms;
    m.q1 = std::cos(0.5F * heading);
    m.q4 = std::sin(0.5F * heading);
    return m;
}

inline GpsGlobalOrigin origin(std::int32_t lat = 473977420, std::int32_t lon = 85455940, std::int32_t alt = 488000)
{
    GpsGlobalOrigin m;
    m.latitude = lat;
    m.longitude = lon;
    m.altitude = alt;
    return m;
}

/// Everything valid, at `where`, flying north with 10 m/s and climbing with 1 m/s.
inline AdsbVehicle adsb(std::uint32_t id, const GlobalPosition& where)
{
    AdsbVehicle m;
    m.ICAO_address = id;
    m.lat = where.lat;
    m.lon = where.lon;
    m.altitude = where.alt;
    m.heading = 0;
    m.hor_velocity = 1000;
    m.ver_velocity = 100;
    m.flags = 1 | 2 | 4 | 8 | 16 | 32 | 128;
    m.altitude_type = 1;
    return m;
}

inline std::string text_of_id(const ParamName& name)
{
    return std::string(name.data(), std::find(name.begin(), name.end(), '\0'));
}

inline ParamName param_name(std::string_view text)
{
    ParamName name{};
    std::copy_n(text.begin(), std::min(text.size(), name.size()), name.begin());
    return name;
}

/// All messages of one type among frames, in their order.
template <Message M>
std::vector<M> all_of(const std::vector<Received>& frames)
{
    std::vector<M> found;
    for (const Received& f : frames) {
        M m;
        if (decode(f.frame(), m)) {
            found.push_back(m);
        }
    }
    return found;
}

/// An endpoint with its inbox; the test owns the time.
struct Wire {
    explicit Wire(const EndpointOptions& options = {}, std::int64_t start_us = 5'000'000)
        : endpoint(options), now{start_us}
    {
    }

    template <Message M>
    void hear(const M& message, std::uint8_t system = kSystem, std::uint8_t component = kAutopilot)
    {
        hear_bytes(frame_of(message, {system, component, sequence++}));
    }
    void hear_bytes(const Bytes& bytes) { endpoint.receive(bytes, now, inbox); }

    /// The endpoint's output since the last call.
    std::vector<Received> said()
    {
        std::vector<Received> frames = parse(parser, endpoint.pending());
        endpoint.consume(endpoint.pending().size());
        return frames;
    }
    template <Message M>
    std::vector<M> said_of()
    {
        return all_of<M>(said());
    }
    void wait(float seconds) { now = now + seconds; }
    [[nodiscard]] std::uint32_t boot_ms() const { return static_cast<std::uint32_t>(now.us / 1000); }
    [[nodiscard]] const LinkDiagnostics& diagnostics() const { return endpoint.diagnostics(); }

    Endpoint endpoint;
    Inbox inbox;
    Parser parser;
    TimePoint now;
    std::uint8_t sequence = 0;
};

}  // namespace jink::link::mavlink::test
