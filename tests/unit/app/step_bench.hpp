// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/coprocessor.hpp"
#include "hal/memory/counting_watchdog.hpp"

// Coprocessor::step without a wire: a link, a bus and a port in the test's hands. The contents of `in` arrive with the
// next step; the co-processor's output is recorded.

namespace jink::app::test {

struct StepLink final : link::Link {
    struct Param {
        std::string name;
        float value = 0.0F;
        std::uint16_t index = 0;
        std::uint16_t count = 0;
    };
    struct Said {
        link::Severity severity = link::Severity::info;
        std::string text;
    };

    void receive(std::span<const std::byte> bytes, TimePoint /*now*/, link::Inbox& inbox) noexcept override
    {
        bytes_in += bytes.size();
        const auto from_bus_tracks = inbox.tracks;
        const bool has_bus_state = inbox.has_bus_state;
        const link::OwnStateReport bus_state = inbox.bus_state;
        inbox = in;
        in.clear();
        inbox.tracks = from_bus_tracks;
        for (const link::TrackReport& t : tracks) {
            inbox.tracks.unchecked_push_back(t);
        }
        tracks.clear();
        inbox.has_bus_state = has_bus_state;
        inbox.bus_state = bus_state;
    }
    void service(TimePoint /*now*/) noexcept override {}
    void ask_for_rates(bool on) noexcept override { rates = on; }
    void report_points_to(link::CloudSink& /*sink*/) noexcept override {}
    std::span<const std::byte> pending() const noexcept override { return {waiting.data(), waiting.size()}; }
    void consume(std::size_t n) noexcept override
    {
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(n));
    }
    void discard_pending() noexcept override { waiting.clear(); }
    void drop_setpoint() noexcept override { ++setpoints_dropped; }
    void drop_mode_request() noexcept override { ++requests_dropped; }
    void send_heartbeat(link::SystemState state) noexcept override { heartbeats.push_back(state); }
    void send_velocity(const Vec3& velocity, TimePoint /*now*/) noexcept override { velocities.push_back(velocity); }
    void send_collision(const link::CollisionWarning& warning) noexcept override { warnings.push_back(warning); }
    void send_text(link::Severity severity, std::string_view text) noexcept override
    {
        texts.push_back({severity, std::string(text)});
    }
    void send_param(const link::ParamName& name, float value, std::uint16_t index,
                    std::uint16_t count) noexcept override
    {
        params.push_back({std::string(name.data(), ::strnlen(name.data(), name.size())), value, index, count});
    }
    void acknowledge(const link::CommandRequest& request, link::CommandResult result) noexcept override
    {
        commands.emplace_back(request.command, result);
    }
    void acknowledge(const link::ConstraintPart& /*part*/, link::ConstraintResult result) noexcept override
    {
        constraints.push_back(result);
    }
    void send_version(const link::Version& version) noexcept override { versions.push_back(version); }
    bool send_log(const link::LogPart& part) noexcept override
    {
        if (takes_log) {
            log_parts.push_back({part, {part.bytes.begin(), part.bytes.end()}});
        }
        return takes_log;
    }
    void request_external_mode() noexcept override { requests.emplace_back("external"); }
    void request_mode(std::uint32_t mode) noexcept override { requests.push_back(std::to_string(mode)); }
    void request_heartbeat() noexcept override { requests.emplace_back("heartbeat"); }
    void request_hold_mode() noexcept override { requests.emplace_back("hold"); }
    std::optional<link::GlobalPosition> origin() const noexcept override { return where; }
    std::optional<std::int32_t> undulation() const noexcept override { return above_ellipsoid; }
    std::size_t compose_last_words(std::span<std::byte> /*out*/, bool hold, std::string_view text) noexcept override
    {
        last_words = {hold, std::string(text)};
        return 0;
    }
    const link::LinkDiagnostics& diagnostics() const noexcept override { return counts; }

    link::Inbox in;
    std::vector<link::TrackReport> tracks;  ///< arrive with the next step, after those of the bus
    std::optional<link::GlobalPosition> where;
    std::optional<std::int32_t> above_ellipsoid;  ///< undulation [mm]
    std::vector<std::byte> waiting;

    std::size_t bytes_in = 0;
    std::optional<bool> rates;
    int setpoints_dropped = 0;
    int requests_dropped = 0;
    std::vector<link::SystemState> heartbeats;
    std::vector<Vec3> velocities;
    std::vector<link::CollisionWarning> warnings;
    std::vector<Said> texts;
    std::vector<Param> params;
    std::vector<std::pair<std::uint16_t, link::CommandResult>> commands;
    std::vector<link::ConstraintResult> constraints;
    std::vector<link::Version> versions;
    bool takes_log = true;
    std::vector<std::pair<link::LogPart, std::vector<std::byte>>> log_parts;  ///< and the bytes of each
    std::vector<std::string> requests;
    std::pair<bool, std::string> last_words;
    link::LinkDiagnostics counts;
};

struct StepBus final : link::SensorBus {
    void receive(TimePoint /*now*/, link::Inbox& inbox) noexcept override
    {
        for (const link::TrackReport& t : tracks) {
            inbox.tracks.unchecked_push_back(t);
        }
        tracks.clear();
        inbox.has_bus_state = state.has_value();
        inbox.bus_state = state.value_or(link::OwnStateReport{});
        state.reset();
    }
    void service(TimePoint /*now*/, const link::BusStatus& status) noexcept override { statuses.push_back(status); }
    bool is_lost() const noexcept override { return lost; }
    void follow_origin(const std::optional<link::GlobalPosition>& origin) noexcept override
    {
        origins.push_back(origin);
    }
    void serve(link::ParamServer& server) noexcept override { params = &server; }
    void send_text(link::Severity /*severity*/, std::string_view text) noexcept override { texts.emplace_back(text); }
    bool send_near(const link::NearObject& object) noexcept override
    {
        near.push_back(object);
        return takes_near;
    }

    std::vector<link::TrackReport> tracks;
    std::optional<link::OwnStateReport> state;
    bool lost = false;
    bool takes_near = true;

    std::vector<link::BusStatus> statuses;
    std::vector<std::optional<link::GlobalPosition>> origins;
    link::ParamServer* params = nullptr;
    std::vector<std::string> texts;
    std::vector<link::NearObject> near;
};

struct StepPort final : hal::SerialPort {
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        return std::min(std::exchange(arriving, 0U), into.size());
    }
    std::size_t write(std::span<const std::byte> from) noexcept override
    {
        ++writes;
        const std::size_t n = std::min({room, most, from.size()});
        room -= n;
        return n;
    }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = state;
        return health;
    }
    hal::PortState state = hal::PortState::open;
    std::size_t arriving = 0;
    std::size_t room = 1U << 20U;  ///< bytes accepted from now on
    std::size_t most = 1U << 20U;  ///< at once
    int writes = 0;
};

/// A copter on a mission, 50 m above the origin, northwards at 5 m/s; the test sets its reports.
struct StepBench {
    enum class Bus : std::uint8_t { none, there };

    explicit StepBench(std::initializer_list<std::pair<Param, float>> changes = {}, Bus with_bus = Bus::none)
        : coprocessor(wire, port, watchdog, changed(changes), with_bus == Bus::there ? &bus : nullptr)
    {
    }

    explicit StepBench(const Parameters& parameters) : coprocessor(wire, port, watchdog, parameters) {}

    /// The autopilot's HEARTBEAT, in the next step.
    link::AutopilotReport& hear_autopilot()
    {
        wire.in.has_autopilot = true;
        wire.in.autopilot = {};
        wire.in.autopilot.stamp = next();
        wire.in.autopilot.stack = link::AutopilotStack::ardupilot;
        wire.in.autopilot.mode = link::FlightMode::mission;
        wire.in.autopilot.custom_mode = 3;
        wire.in.autopilot.armed = true;
        return wire.in.autopilot;
    }
    /// Its own state, in the next step, stamped `age` before it.
    link::OwnStateReport& hear_own(Seconds age = 0.0F)
    {
        wire.in.has_own_state = true;
        wire.in.own_state = own_report(age);
        return wire.in.own_state;
    }
    link::OwnStateReport& hear_bus_own(Seconds age = 0.0F)
    {
        bus.state = own_report(age);
        return *bus.state;
    }
    link::TrackReport& hear_track(std::uint32_t id, const Vec3& position)
    {
        wire.tracks.push_back(track_report(id, position));
        return wire.tracks.back();
    }
    [[nodiscard]] link::TrackReport track_report(std::uint32_t id, const Vec3& position) const
    {
        link::TrackReport r;
        r.id = id;
        r.stamp = next();
        r.position = position;
        r.has_velocity = true;
        return r;
    }
    /// A static obstacle, known almost exactly.
    link::TrackReport& hear_mast(std::uint32_t id, const Vec3& position, float radius = 1.0F)
    {
        link::TrackReport& r = hear_track(id, position);
        r.at_rest = true;
        r.radius = radius;
        r.sigma_position = 1e-3F;
        return r;
    }
    StepReport step(std::int64_t us = 20'000)
    {
        now.us += us;
        coming_us = 20'000;
        last = coprocessor.step(now);
        return last;
    }
    /// Steps of 20 ms with own state in each and a HEARTBEAT a second, from 1 step on.
    StepReport fly(int steps)
    {
        for (int i = 0; i < steps; ++i) {
            if (beats_++ % 50 == 0) {
                hear_autopilot();
            }
            hear_own();
            step();
            position += velocity * 0.02F;
        }
        return last;
    }
    [[nodiscard]] bool has(Fault fault) const { return (last.faults & bit(fault)) != 0; }
    [[nodiscard]] int said(std::string_view text) const
    {
        return static_cast<int>(std::count_if(wire.texts.begin(), wire.texts.end(),
                                              [&](const StepLink::Said& s) { return s.text == text; }));
    }
    [[nodiscard]] const Diagnostics& counted() const { return coprocessor.diagnostics(); }
    /// Instant of the next step.
    [[nodiscard]] TimePoint next() const { return {now.us + coming_us}; }

    static Parameters changed(std::initializer_list<std::pair<Param, float>> changes)
    {
        Parameters parameters;
        for (const auto& [param, value] : changes) {
            if (parameters.set(param, value) != ParamStatus::ok) {
                std::abort();
            }
        }
        return parameters;
    }

    Vec3 position = Vec3(0.0F, 0.0F, 50.0F);
    Vec3 velocity = Vec3(0.0F, 5.0F, 0.0F);
    TimePoint now{10'000'000};
    std::int64_t coming_us = 20'000;  ///< length of the next step, where it is not a tick
    StepReport last;
    StepLink wire;
    StepBus bus;
    StepPort port;
    hal::CountingWatchdog watchdog;
    Coprocessor coprocessor;

private:
    [[nodiscard]] link::OwnStateReport own_report(Seconds age) const
    {
        link::OwnStateReport r;
        r.state.stamp = next() - age;
        r.state.position = position;
        r.state.velocity = velocity;
        r.has_yaw = true;
        return r;
    }
    int beats_ = 0;
};

}  // namespace jink::app::test
