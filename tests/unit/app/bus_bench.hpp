// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <memory>

#include "firmware/app/can_bus.hpp"
#include "firmware/app/can_frame.hpp"
#include "hal/memory/manual_clock.hpp"
#include "hal/memory/memory_can_bus.hpp"
#include "tests/unit/app/flight.hpp"
#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::app::test {

namespace can = link::dronecan;

inline constexpr std::uint8_t kOurNode = 42;
inline constexpr GlobalPosition kFlightOrigin{473977420, 85455940, 488000};  // that of Flight

inline can::NodeOptions node_options(std::uint8_t node = kOurNode)
{
    can::NodeOptions options;
    options.node = node;
    options.unique_id = {1, 2, 3, 4};
    return options;
}

/// Our transfers as received by another node, assembled and decoded.
class Listener {
public:
    static constexpr std::uint8_t kNode = 10;
    Listener() { receiver_.set_node(kNode); }

    void hear(const can::Frame& frame, TimePoint now)
    {
        const can::Transfer* const t = receiver_.accept(frame, now);
        if (t == nullptr || t->source != kOurNode) {
            return;
        }
        keep(*t, statuses) || keep(*t, texts) || keep(*t, near) || keep(*t, infos) || keep(*t, params) ||
            keep(*t, opcodes) || keep(*t, tunnelled);
    }
    [[nodiscard]] bool said(std::string_view text) const
    {
        return std::any_of(texts.begin(), texts.end(), [&](const can::LogMessage& m) {
            return std::string(m.text.begin(), m.text.end()).find(text) != std::string::npos;
        });
    }

    std::vector<can::NodeStatus> statuses;
    std::vector<can::LogMessage> texts;
    std::vector<can::Proximity> near;
    std::vector<can::GetNodeInfoResponse> infos;
    std::vector<can::GetSetResponse> params;
    std::vector<can::ExecuteOpcodeResponse> opcodes;
    std::vector<can::TunnelTargetted> tunnelled;

private:
    template <class M>
    static bool keep(const can::Transfer& transfer, std::vector<M>& list)
    {
        M message;
        const bool ours = transfer.type.id == M::kType.id && transfer.type.kind == M::kType.kind &&
                          can::decode(transfer.payload, message) == can::CodecStatus::ok;
        if (ours) {
            list.push_back(message);
        }
        return ours;
    }
    static constexpr std::array kWanted{can::NodeStatus::kType,     can::LogMessage::kType,
                                        can::Proximity::kType,      can::GetNodeInfoResponse::kType,
                                        can::GetSetResponse::kType, can::ExecuteOpcodeResponse::kType,
                                        can::TunnelTargetted::kType};
    can::Receiver receiver_{kWanted};
};

/// A flight with a bus beside its serial line, or with MAVLink through the bus's tunnel; node 10 listens.
class BusBench {
public:
    explicit BusBench(const Parameters& parameters = {}, bool tunnel = false)
        : bus(wire.port(1), node_options()), f(parameters, &bus, tunnel ? &bus.serial() : nullptr)
    {
    }

    /// A transfer from another node; arrives before the next tick.
    template <class M>
    void give(const M& message, std::uint8_t node = 20, std::uint8_t destination = 0)
    {
        const std::uint8_t transfer = transfers_[node]++ % can::kTransferIds;
        for (const can::Frame& frame :
             can::test::frames_of(message, node, transfer, can::Priority::medium, destination)) {
            if (!wire.port(2).send(to_port(frame))) {
                std::abort();  // a test that loses its own frames proves nothing
            }
        }
    }
    template <class M>
    void ask(const M& message)
    {
        give(message, Listener::kNode, kOurNode);
    }
    StepReport tick()
    {
        clock.advance(Flight::kTickUs);
        const StepReport report = f.tick();
        hal::CanFrame frame;
        while (wire.port(0).receive(frame)) {
            heard.hear(from_port(frame), f.now);
        }
        return report;
    }
    StepReport fly(int n)
    {
        StepReport report;
        for (int i = 0; i < n; ++i) {
            report = tick();
        }
        return report;
    }

    /// A receiver's fix at `local` [m, ENU] from Flight's origin.
    static can::Fix2 fix(const Vec3& local, const Vec3& velocity = Vec3::Zero())
    {
        const GlobalPosition where = to_global(local, kFlightOrigin).value();
        can::Fix2 m;
        m.latitude = std::int64_t{where.lat} * 10;
        m.longitude = std::int64_t{where.lon} * 10;
        m.height_msl = where.alt;
        m.velocity = {velocity.y(), velocity.x(), -velocity.z()};
        m.status = can::Fix2::Status::fix_3d;
        return m;
    }
    static can::TrafficReport traffic(const Vec3& local, const Vec3& velocity = Vec3::Zero(), std::uint32_t id = 0xABC)
    {
        const GlobalPosition where = to_global(local, kFlightOrigin).value();
        can::TrafficReport m;
        m.icao = id;
        m.latitude = where.lat;
        m.longitude = where.lon;
        m.altitude = static_cast<float>(where.alt) * 1e-3F;
        m.velocity = {velocity.y(), velocity.x(), -velocity.z()};
        m.position_valid = m.velocity_valid = m.vertical_velocity_valid = true;
        return m;
    }
    /// Nose towards the compass angle `heading` [rad], level.
    static can::AhrsSolution attitude(float heading)
    {
        can::AhrsSolution m;
        m.orientation = {0.0F, 0.0F, std::sin(0.5F * heading), std::cos(0.5F * heading)};
        return m;
    }

    hal::ManualClock clock{10'000'000};
    hal::MemoryCanBus wire{clock, 7};
    CanBus bus;
    Flight f;
    Listener heard;

private:
    std::array<std::uint8_t, 128> transfers_{};
};

inline Parameters with(std::initializer_list<std::pair<Param, float>> changes)
{
    Parameters parameters;
    for (const auto& [param, value] : changes) {
        if (parameters.set(param, value) != ParamStatus::ok) {
            std::abort();
        }
    }
    return parameters;
}

/// Defaults but for `changes`; `tunnel`: the autopilot's link runs through the bus.
inline std::unique_ptr<BusBench> bus_bench(std::initializer_list<std::pair<Param, float>> changes = {},
                                           bool tunnel = false)
{
    return std::make_unique<BusBench>(with(changes), tunnel);
}

}  // namespace jink::app::test
