// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink::test {

/// An endpoint with an autopilot (system 7, component 1) on the other end of the line and the test in charge of time.
class EndpointTest : public ::testing::Test {
protected:
    static constexpr std::uint8_t kSystem = 7;
    static constexpr std::uint8_t kUs = 196;
    static constexpr std::int64_t kBootOffset = 50'000'000;  ///< our clock less the autopilot's [us]

    void wait(float seconds) { now = now + seconds; }
    [[nodiscard]] std::uint32_t boot_ms() const { return static_cast<std::uint32_t>((now.us - kBootOffset) / 1000); }

    template <Message M>
    void from(std::uint8_t system, std::uint8_t component, const M& message)
    {
        endpoint->receive(frame_of(message, {system, component, sequence++}), now, *inbox);
    }
    template <Message M>
    void autopilot(const M& message)
    {
        from(kSystem, 1, message);
    }

    void heartbeat(std::uint8_t stack = 3, std::uint32_t custom_mode = 3, bool armed = true, std::uint8_t type = 2)
    {
        Heartbeat m;
        m.type = type;
        m.autopilot = stack;
        m.base_mode = static_cast<std::uint8_t>(armed ? 0x81 : 0x01);
        m.custom_mode = custom_mode;
        autopilot(m);
    }
    /// Position and velocity in NED.
    void local_position(const Vec3& p = Vec3::Zero(), const Vec3& v = Vec3::Zero())
    {
        LocalPositionNed m;
        m.time_boot_ms = boot_ms();
        m.x = p.x();
        m.y = p.y();
        m.z = p.z();
        m.vx = v.x();
        m.vy = v.y();
        m.vz = v.z();
        autopilot(m);
    }
    /// Compass heading [rad].
    void attitude(float heading)
    {
        AttitudeQuaternion m;
        m.q1 = std::cos(heading / 2);
        m.q4 = std::sin(heading / 2);
        autopilot(m);
    }
    void origin(std::int32_t lat = 473977420, std::int32_t lon = 85455940, std::int32_t alt = 488000)
    {
        GpsGlobalOrigin m;
        m.latitude = lat;
        m.longitude = lon;
        m.altitude = alt;
        autopilot(m);
    }
    void clear() { inbox->clear(); }

    /// Frames that the endpoint has queued since the last call.
    std::vector<Received> sent()
    {
        const auto bytes = endpoint->pending();
        const std::vector<Received> frames = parse(ears, bytes);
        endpoint->consume(bytes.size());
        return frames;
    }
    /// The only frame queued, which must be an M.
    template <Message M>
    M sent_one()
    {
        const std::vector<Received> frames = sent();
        M message{};
        EXPECT_EQ(frames.size(), 1U);
        if (!frames.empty()) {
            EXPECT_TRUE(decode(frames[0].frame(), message)) << "message " << frames[0].message_id;
            EXPECT_EQ(frames[0].header.system_id, kSystem);
            EXPECT_EQ(frames[0].header.component_id, kUs);
        }
        return message;
    }
    [[nodiscard]] const LinkDiagnostics& count() const { return endpoint->diagnostics(); }

    static void expect_near(const Vec3& got, const Vec3& expected, float tolerance)
    {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(got[axis], expected[axis], tolerance) << "axis " << axis;
        }
    }

    std::unique_ptr<Endpoint> endpoint = std::make_unique<Endpoint>();
    std::unique_ptr<Inbox> inbox = std::make_unique<Inbox>();
    Parser ears;
    TimePoint now{100'000'000};
    std::uint8_t sequence = 0;
};

/// The same, with the autopilot heard already.
class HeardEndpointTest : public EndpointTest {
protected:
    void SetUp() override
    {
        heartbeat();
        clear();
    }
    /// Runs `service` at 50 Hz for a while and collects all that was sent.
    std::vector<Received> serve(float seconds)
    {
        std::vector<Received> all;
        for (float t = 0.0F; t < seconds; t += 0.02F) {
            wait(0.02F);
            endpoint->service(now);
            const auto frames = sent();
            all.insert(all.end(), frames.begin(), frames.end());
        }
        return all;
    }
    template <Message M>
    static std::vector<M> only(const std::vector<Received>& frames)
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
};

}  // namespace jink::link::mavlink::test
