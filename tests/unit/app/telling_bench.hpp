// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/coprocessor.hpp"

// A co-processor with a link that records its output, step by step, and an autopilot controlled by the test.

namespace jink::app::test {

/// Delivers `next`; records its output until `forget()`.
class RecordingLink final : public link::Link {
public:
    struct Said {
        link::Severity severity = link::Severity::info;
        std::string text;
    };
    struct Words {
        bool hold = false;
        std::string text;
    };

    void receive(std::span<const std::byte> /*bytes*/, TimePoint /*now*/, link::Inbox& inbox) noexcept override
    {
        inbox = next;
        next.clear();
    }
    void service(TimePoint /*now*/) noexcept override {}
    void ask_for_rates(bool /*on*/) noexcept override {}
    void report_points_to(link::CloudSink& sink) noexcept override { points = &sink; }
    std::span<const std::byte> pending() const noexcept override { return {}; }
    void consume(std::size_t /*n*/) noexcept override {}
    void discard_pending() noexcept override {}
    void drop_setpoint() noexcept override { calls.emplace_back("drop set-point"); }
    void drop_mode_request() noexcept override { calls.emplace_back("drop request"); }
    void send_heartbeat(link::SystemState state) noexcept override
    {
        heartbeats.push_back(state);
        calls.emplace_back("heartbeat");
    }
    void send_velocity(const Vec3& velocity, TimePoint /*now*/) noexcept override { commands.push_back(velocity); }
    void send_collision(const link::CollisionWarning& warning) noexcept override { warnings.push_back(warning); }
    void send_text(link::Severity severity, std::string_view text) noexcept override
    {
        texts.push_back({severity, std::string(text)});
    }
    void send_param(const link::ParamName& /*name*/, float /*value*/, std::uint16_t /*index*/,
                    std::uint16_t /*count*/) noexcept override
    {
    }
    void acknowledge(const link::CommandRequest& /*request*/, link::CommandResult /*result*/) noexcept override {}
    void acknowledge(const link::ConstraintPart& /*part*/, link::ConstraintResult /*result*/) noexcept override {}
    void send_version(const link::Version& /*version*/) noexcept override {}
    bool send_log(const link::LogPart& /*part*/) noexcept override { return false; }
    void request_external_mode() noexcept override { ask(link::FlightMode::external); }
    void request_mode(std::uint32_t /*mode*/) noexcept override { ask(link::FlightMode::mission); }
    void request_heartbeat() noexcept override { heartbeat_asked = true; }
    void request_hold_mode() noexcept override { ask(link::FlightMode::hold); }
    std::optional<link::GlobalPosition> origin() const noexcept override { return std::nullopt; }
    std::size_t compose_last_words(std::span<std::byte> /*out*/, bool hold, std::string_view text) noexcept override
    {
        words.push_back({hold, std::string(text)});
        return 0;
    }
    const link::LinkDiagnostics& diagnostics() const noexcept override { return counts; }

    void forget()
    {
        calls.clear();
        heartbeats.clear();
        commands.clear();
        warnings.clear();
        texts.clear();
        words.clear();
        asked.clear();
        heartbeat_asked = false;
    }

    link::Inbox next;
    std::vector<std::string> calls;
    std::vector<link::SystemState> heartbeats;
    std::vector<Vec3> commands;
    std::vector<link::CollisionWarning> warnings;
    std::vector<Said> texts;
    std::vector<Words> words;
    std::vector<link::FlightMode> asked;
    bool heartbeat_asked = false;
    link::CloudSink* points = nullptr;
    link::LinkDiagnostics counts;

private:
    void ask(link::FlightMode mode)
    {
        asked.push_back(mode);
        calls.emplace_back(mode == link::FlightMode::hold ? "ask to hold" : "ask for a mode");
    }
};

class SwitchedPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> /*into*/) noexcept override { return 0; }
    std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = state;
        return health;
    }
    hal::PortState state = hal::PortState::open;
};

class QuietWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override {}
};

/// Flies east at 5 m/s, 50 m high, without a leg; in the external mode exactly as commanded.
class Teller {
public:
    static constexpr std::int64_t kTickUs = 20'000;

    explicit Teller(const Parameters& parameters = {}, link::SensorBus* bus = nullptr)
        : coprocessor(link, port, watchdog, parameters, bus)
    {
        own.position = Vec3(0.0F, 0.0F, 50.0F);
        own.velocity = Vec3(5.0F, 0.0F, 0.0F);
        autopilot.stack = link::AutopilotStack::ardupilot;
        autopilot.mode = link::FlightMode::mission;
        autopilot.armed = true;
    }

    StepReport step(std::int64_t us = kTickUs)
    {
        now.us += us;
        if (flies_freely) {
            own.velocity = autopilot.mode == link::FlightMode::external && follows && !link.commands.empty()
                               ? link.commands.back()
                               : own.velocity;
        }
        own.position += own.velocity * (static_cast<float>(us) * 1e-6F);
        own.stamp = now;
        obey();
        hear();
        link.forget();
        last = coprocessor.step(now);
        for (const RecordingLink::Said& t : link.texts) {
            texts.push_back(t);
        }
        ++ticks_;
        return last;
    }
    void fly(int n)
    {
        for (int i = 0; i < n; ++i) {
            step();
        }
    }
    template <class Done>
    bool until(Done done, int limit = 1500)
    {
        for (int i = 0; i < limit; ++i) {
            step();
            if (done(last)) {
                return true;
            }
        }
        return false;
    }
    /// A HEARTBEAT in the next step.
    void beat() { beat_due_ = true; }
    void choose(link::FlightMode mode)
    {
        autopilot.mode = mode;
        beat();
    }
    /// Texts that begin like this, so far.
    [[nodiscard]] int said(std::string_view begin) const
    {
        return static_cast<int>(std::count_if(texts.begin(), texts.end(), [&](const RecordingLink::Said& t) {
            return std::string_view(t.text).starts_with(begin);
        }));
    }
    [[nodiscard]] bool said_as(link::Severity severity, std::string_view text) const
    {
        return std::any_of(texts.begin(), texts.end(),
                           [&](const RecordingLink::Said& t) { return t.severity == severity && t.text == text; });
    }
    /// A static threat `ahead` metres in front of the vehicle, reported as traffic.
    void put_ahead(float ahead, const Vec3& velocity = Vec3::Zero(), const Vec3& aside = Vec3::Zero())
    {
        link::TrackReport r;
        r.id = static_cast<world::TrackId>(100 + traffic.size());
        r.position = own.position + ahead * Vec3::UnitX() + aside;
        r.velocity = velocity;
        r.has_velocity = true;
        r.at_rest = velocity.isZero();
        r.stamp = now;
        traffic.push_back(r);
    }

    RecordingLink link;
    SwitchedPort port;
    QuietWatchdog watchdog;
    Coprocessor coprocessor;
    TimePoint now{10'000'000};
    vehicle::VehicleState own;
    link::AutopilotReport autopilot;
    bool heartbeats = true;
    bool answers = true;  ///< sends a HEARTBEAT on request
    bool own_state = true;
    bool has_yaw = true;
    bool grants = true;   ///< grants requested modes
    bool follows = true;  ///< in the external mode flies as commanded
    bool flies_freely = true;
    std::vector<link::TrackReport> traffic;
    std::vector<RecordingLink::Said> texts;
    StepReport last;

private:
    void obey()
    {
        for (const link::FlightMode mode : link.asked) {
            link.next.mode_answers.unchecked_push_back({grants, 0});
            if (grants) {
                choose(mode);
            }
        }
        beat_due_ = beat_due_ || (link.heartbeat_asked && answers);
    }
    void hear()
    {
        link::Inbox& in = link.next;
        if (heartbeats && (beat_due_ || ticks_ % 50 == 0)) {
            in.has_autopilot = true;
            autopilot.stamp = now;
            autopilot.custom_mode = static_cast<std::uint32_t>(autopilot.mode);
            in.autopilot = autopilot;
        }
        beat_due_ = false;
        if (own_state) {
            in.has_own_state = true;
            in.own_state.state = own;
            in.own_state.has_yaw = has_yaw;
        }
        if (ticks_ % 10 == 0) {
            for (const link::TrackReport& r : traffic) {
                link::TrackReport seen = r;
                seen.position += r.velocity * (now - r.stamp);
                seen.stamp = now;
                in.tracks.unchecked_push_back(seen);
            }
        }
    }

    int ticks_ = 0;
    bool beat_due_ = false;
};

inline bool leads(const StepReport& report) { return report.control == Control::ours; }

inline std::unique_ptr<Teller> teller(std::initializer_list<std::pair<Param, float>> values = {})
{
    Parameters parameters;
    for (const auto& [param, value] : values) {
        EXPECT_EQ(parameters.set(param, value), ParamStatus::ok);
    }
    return std::make_unique<Teller>(parameters);
}

/// A threat on the leg, and control.
inline std::unique_ptr<Teller> in_command(std::initializer_list<std::pair<Param, float>> values = {})
{
    auto t = teller(values);
    t->fly(60);
    t->put_ahead(40.0F, Vec3::Zero(), Vec3(0.0F, 0.4F, 0.0F));
    EXPECT_TRUE(t->until(leads));
    t->fly(5);
    EXPECT_TRUE(leads(t->last));
    return t;
}

}  // namespace jink::app::test
