// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "firmware/app/takeover.hpp"

namespace jink::app::test {

using link::FlightMode;

inline constexpr std::uint32_t kMission = 3, kExternal = 4, kLoiter = 5, kManual = 2;

enum class Beat : std::uint8_t { none, former, external, manual, hold, disarmed };

struct Step {
    bool wants = false;
    bool may_act = true;
    Beat beat = Beat::none;
    float dt = 0.02F;
    bool denied = false;
    bool accepted = false;
    bool alive = true;
};

inline std::string describe(const Step& s)
{
    static constexpr const char* kBeats[] = {"none", "former", "external", "manual", "hold", "disarmed"};
    return std::string(s.wants ? "wants" : "calm") + (s.may_act ? "" : " fault") + (s.denied ? " denied" : "") + " " +
           kBeats[static_cast<std::size_t>(s.beat)] + " +" + std::to_string(s.dt);
}

inline TakeoverInput input_of(const Step& s)
{
    TakeoverInput input;
    input.wants_control = input.in_conflict = input.urgent_hold = s.wants;
    input.may_act = s.may_act;
    input.mode_denied = s.denied;
    input.mode_accepted = s.accepted;
    input.link_alive = s.alive;
    input.has_report = s.beat != Beat::none;
    input.report.armed = s.beat != Beat::disarmed;
    switch (s.beat) {
    case Beat::none: break;
    case Beat::former:
    case Beat::disarmed:
        input.report.mode = FlightMode::mission;
        input.report.custom_mode = kMission;
        break;
    case Beat::external:
        input.report.mode = FlightMode::external;
        input.report.custom_mode = kExternal;
        break;
    case Beat::manual:
        input.report.mode = FlightMode::manual;
        input.report.custom_mode = kManual;
        break;
    case Beat::hold:
        input.report.mode = FlightMode::hold;
        input.report.custom_mode = kLoiter;
        break;
    }
    return input;
}

/// A take-over with its clock. As in the application, the input keeps the newest report if no new report arrives.
struct Bench {
    Takeover takeover;
    TimePoint now{1'000'000};
    link::AutopilotReport last;
    link::AutopilotStack stack = link::AutopilotStack::unknown;
    bool stands_by = false;

    TakeoverOutput step(const Step& s)
    {
        now = now + s.dt;
        TakeoverInput input = input_of(s);
        if (input.has_report) {
            last = input.report;
        }
        input.report = last;
        input.report.stack = stack;
        input.stands_by = stands_by;
        return takeover.update(input, now);
    }
    [[nodiscard]] Control control() const { return takeover.control(); }
};

inline constexpr Step kWant{true, true, Beat::none, 0.02F, false};
inline constexpr Step kCalm{false, true, Beat::none, 0.02F, false};
inline constexpr Step wants(Beat beat, float dt = 0.02F) { return {true, true, beat, dt, false}; }
inline constexpr Step calm(Beat beat, float dt = 0.02F) { return {false, true, beat, dt, false}; }
inline constexpr Step fault(Beat beat, float dt = 0.02F) { return {true, false, beat, dt, false}; }
inline constexpr Step denied(float dt) { return {true, true, Beat::none, dt, true}; }

/// As the application reports HEARTBEATs that arrive within one step.
inline TakeoverOutput with_two(Bench& b, const Step& first, const Step& newest)
{
    b.now = b.now + newest.dt;
    TakeoverInput input = input_of(newest);
    const std::array<link::AutopilotReport, 1> earlier{input_of(first).report};
    input.earlier = earlier;
    return b.takeover.update(input, b.now);
}

using Change = std::function<void(TakeoverInput&)>;

/// A step with an input outside the alphabet of Step. The newest report stays if no new report arrives.
inline TakeoverOutput varied(Bench& b, const Step& s, const Change& change)
{
    b.now = b.now + s.dt;
    TakeoverInput input = input_of(s);
    input.report = input.has_report ? input.report : b.last;
    input.report.stack = b.stack;
    input.stands_by = b.stands_by;
    change(input);
    b.last = input.report;
    return b.takeover.update(input, b.now);
}

inline Bench awaiting()
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    return b;
}

inline Bench commanding()
{
    Bench b = awaiting();
    EXPECT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    return b;
}

inline Bench declined()
{
    Bench b = awaiting();
    b.step(wants(Beat::former, 1.01F));
    b.step(wants(Beat::former, 1.01F));
    EXPECT_EQ(b.step(wants(Beat::none, 1.01F)).event, TakeoverEvent::refused);
    return b;
}

inline const Change kPredictedAlone = [](TakeoverInput& in) { in.wants_control = in.urgent_hold = false; };
inline const Change kFlownAlone = [](TakeoverInput& in) { in.in_conflict = in.urgent_hold = false; };
inline const Change kSticks = [](TakeoverInput& in) { in.sticks_moved = true; };
inline const Change kUnfollowed = [](TakeoverInput& in) { in.unfollowed = true; };

}  // namespace jink::app::test
