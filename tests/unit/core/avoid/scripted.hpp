// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid::test {

/// `command` held for `span` from now on.
inline Manoeuvre velocity_of(const Situation& s, const Vec3& command, Seconds span = 8.0F)
{
    Manoeuvre m;
    m.kind = world::ManoeuvreKind::velocity;
    m.start = s.now;
    m.command = command;
    path::predict_velocity_command(s.own, command, span, 0.2F, s.limits, m.path);
    return m;
}

/// Straight through `positions` at a speed of its own.
inline Manoeuvre at_speed(const Situation& s, const std::vector<Vec3>& positions, float speed, const Vec3& side)
{
    Manoeuvre m = along(s, positions, side);
    static_cast<void>(path::make_timed_path(positions, speed, s.limits, m.path));
    return m;
}

/// Returns the manoeuvre set by the test, or nothing.
struct Scripted {
    std::function<PlanStatus(const Situation&, Manoeuvre&)> next;
    FakeMethod method{[this](const Situation& s, WorkBudget&, Manoeuvre& out) { return next(s, out); }};
    Flight f;
};

}  // namespace jink::avoid::test
