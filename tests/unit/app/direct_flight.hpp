// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/app/coprocessor.hpp"

// A closed loop around Coprocessor::step without a wire: a link controlled by the test, and an autopilot whose motion
// may differ from the link's reports.

namespace jink::app::test {

struct SaidText {
    link::Severity severity = link::Severity::info;
    std::string text;
};

/// Delivers `next`, and records its output.
class DirectLink final : public link::Link {
public:
    void receive(std::span<const std::byte> /*bytes*/, TimePoint /*now*/, link::Inbox& inbox) noexcept override
    {
        inbox = next;
        next.clear();
    }
    void service(TimePoint /*now*/) noexcept override {}
    void ask_for_rates(bool /*on*/) noexcept override {}
    void report_points_to(link::CloudSink& /*sink*/) noexcept override {}
    std::span<const std::byte> pending() const noexcept override { return {}; }
    void consume(std::size_t /*n*/) noexcept override {}
    void discard_pending() noexcept override {}
    void drop_setpoint() noexcept override {}
    void drop_mode_request() noexcept override {}
    void send_heartbeat(link::SystemState /*state*/) noexcept override {}
    void send_velocity(const Vec3& velocity, TimePoint /*now*/) noexcept override { command = velocity; }
    void send_collision(const link::CollisionWarning& /*warning*/) noexcept override {}
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
    void request_external_mode() noexcept override { asked = link::FlightMode::external; }
    void request_mode(std::uint32_t /*mode*/) noexcept override { asked = link::FlightMode::mission; }
    void request_heartbeat() noexcept override { ++heartbeats_asked_for; }
    void request_hold_mode() noexcept override { asked = link::FlightMode::hold; }
    std::optional<link::GlobalPosition> origin() const noexcept override { return std::nullopt; }
    std::size_t compose_last_words(std::span<std::byte> /*out*/, bool /*hold*/,
                                   std::string_view /*text*/) noexcept override
    {
        return 0;
    }
    const link::LinkDiagnostics& diagnostics() const noexcept override { return counts; }

    link::Inbox next;
    Vec3 command = Vec3::Zero();
    std::optional<link::FlightMode> asked;
    std::vector<SaidText> texts;
    int heartbeats_asked_for = 0;
    link::LinkDiagnostics counts;
};

class SilentPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> /*into*/) noexcept override { return 0; }
    std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = hal::PortState::open;
        return health;
    }
};

class IdleWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override {}
};

/// Flies straight, reported at 5 Hz with noise.
struct Intruder {
    Vec3 position = Vec3::Zero();  ///< at time 0
    Vec3 velocity = Vec3::Zero();
    Seconds seen_from = 0.0F;

    [[nodiscard]] Vec3 at(Seconds t) const { return position + t * velocity; }
};

/// The true mission: position and speed at mission time `s` [s].
struct Course {
    std::function<Vec3(Seconds)> position;
    std::function<Vec3(Seconds)> velocity;
};

/// A multirotor on `course` while in AUTO, after our set-points in GUIDED, braking in BRAKE. Ticks of 20 ms.
class DirectFlight {
public:
    static constexpr Seconds kDt = 0.02F;

    DirectFlight(Course course, const Parameters& parameters, std::uint64_t seed)
        : course_(std::move(course)), random_(seed), limits_(parameters.configuration().limits),
          coprocessor(link, port_, watchdog_, parameters)
    {
        state.position = course_.position(0.0F);
        state.velocity = course_.velocity(0.0F);
        limits_.max_acceleration = 8.0F;  // the autopilot's own flight
    }

    void tick()
    {
        move();
        ++ticks_;
        now = now + kDt;
        time += kDt;
        report();
        last = coprocessor.step(now);
        const bool ours = last.control == Control::ours || last.control == Control::returning;
        if (ours && !was_ours_) {
            taken.push_back(time);
        }
        if (!ours && was_ours_) {
            given_back.push_back(time);
        }
        was_ours_ = ours;
        if (link.asked) {
            mode = *link.asked;
            link.asked.reset();
        }
        for (const Intruder& i : intruders) {
            nearest = std::min(nearest, (i.at(time) - state.position).norm());
        }
    }
    void fly(Seconds span)
    {
        for (const Seconds until = time + span; time < until;) {
            tick();
        }
    }
    /// Of the course [s].
    [[nodiscard]] Seconds mission_time() const { return mission_time_; }
    [[nodiscard]] int said(std::string_view text) const
    {
        return static_cast<int>(
            std::count_if(link.texts.begin(), link.texts.end(), [&](const SaidText& t) { return t.text == text; }));
    }
    [[nodiscard]] int said(link::Severity severity) const
    {
        return static_cast<int>(std::count_if(link.texts.begin(), link.texts.end(),
                                              [&](const SaidText& t) { return t.severity == severity; }));
    }

private:
    void move()
    {
        Vec3 wanted = Vec3::Zero();
        if (mode == link::FlightMode::mission) {
            // Continues from the nearest place of the course, searched ahead and a little behind.
            Seconds best = mission_time_;
            for (int i = -10; i <= 20; ++i) {
                const Seconds at = std::max(0.0F, mission_time_ + 0.02F * static_cast<float>(i));
                if ((course_.position(at) - state.position).norm() <
                    (course_.position(best) - state.position).norm() - 1e-4F) {
                    best = at;
                }
            }
            mission_time_ = best;
            const Vec3 v = course_.velocity(best);
            const Vec3 a = (course_.velocity(best + 0.05F) - v) / 0.05F;
            Vec3 back = 0.7F * (course_.position(best) - state.position);
            back *= std::min(1.0F, 3.0F / std::max(back.norm(), 1e-3F));
            wanted = v + limits_.velocity_lag * a + back;
        } else if (mode == link::FlightMode::external) {
            wanted = link.command;
        }
        vehicle::VehicleLimits limits = limits_;
        vehicle::advance(state, wanted, limits, kDt);
    }
    void report()
    {
        link::Inbox& in = link.next;
        in.has_own_state = true;
        in.own_state.state = state;
        in.own_state.state.stamp = now;
        in.own_state.has_yaw = true;
        if (ticks_ % 50 == 1 || mode != reported_mode_) {
            reported_mode_ = mode;
            in.has_autopilot = true;
            in.autopilot.stamp = now;
            in.autopilot.stack = link::AutopilotStack::ardupilot;
            in.autopilot.mode = mode;
            in.autopilot.custom_mode = static_cast<std::uint32_t>(mode);
            in.autopilot.armed = true;
            in.has_leg = reports_leg;
            in.leg.leg = leg;
        }
        if (ticks_ % 10 == 0) {
            for (std::size_t i = 0; i < intruders.size(); ++i) {
                if (time >= intruders[i].seen_from) {
                    in.tracks.unchecked_push_back(seen(i));
                }
            }
        }
        if (wall_at > 0.0F && ticks_ % 5 == 0) {
            in.scans.unchecked_push_back(wall());
        }
    }
    /// A level scan of 72 sectors and 40 m, and the plane x = wall_at.
    [[nodiscard]] link::RangeScan wall() const
    {
        link::RangeScan scan;
        scan.stamp = now;
        scan.increment = 2.0F * kPi / 72.0F;
        scan.min_range = 0.2F;
        scan.max_range = 40.0F;
        for (int i = 0; i < 72; ++i) {
            const float range = (wall_at - state.position.x()) / std::cos(scan.increment * static_cast<float>(i));
            scan.ranges.unchecked_push_back(range > 0.2F && range < 40.0F ? range : link::RangeScan::kNothing);
        }
        return scan;
    }
    [[nodiscard]] link::TrackReport seen(std::size_t i)
    {
        const auto noise = [&](float sigma) {
            return Vec3(sigma * random_.normal(), sigma * random_.normal(), sigma * random_.normal());
        };
        link::TrackReport r;
        r.id = static_cast<world::TrackId>(100 + i);
        r.stamp = now;
        r.position = intruders[i].at(time) + noise(0.3F);
        r.velocity = intruders[i].velocity + noise(0.2F);
        r.has_velocity = true;
        return r;
    }

    Course course_;
    Random random_;
    vehicle::VehicleLimits limits_;
    SilentPort port_;
    IdleWatchdog watchdog_;
    link::FlightMode reported_mode_ = link::FlightMode::unknown;
    Seconds mission_time_ = 0.0F;
    int ticks_ = 0;
    bool was_ours_ = false;

public:
    DirectLink link;
    Coprocessor coprocessor;
    vehicle::VehicleState state;
    TimePoint now{10'000'000};
    Seconds time = 0.0F;
    link::FlightMode mode = link::FlightMode::mission;
    bool reports_leg = false;
    world::Leg leg;
    std::vector<Intruder> intruders;
    float wall_at = 0.0F;  ///< position of a wall detected by a scanner; 0: none [m]
    StepReport last;
    float nearest = 1e9F;        ///< between the centres, over all intruders [m]
    std::vector<Seconds> taken;  ///< times of take-overs
    std::vector<Seconds> given_back;
};

}  // namespace jink::app::test
