// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>

#include "core/avoid/supervisor.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::avoid::test {

using world::Manoeuvre;
using world::PlanStatus;
using world::Situation;

/// A method controlled by the test.
struct FakeMethod {
    static constexpr world::MethodTraits kTraits{
        .id = 11, .reactive = false, .keeps_clearance = false, .needs_sets = false};

    std::function<PlanStatus(const Situation&, WorkBudget&, Manoeuvre&)> answer;
    int asked = 0;

    PlanStatus plan(const Situation& situation, WorkBudget& budget, Manoeuvre& out) noexcept
    {
        ++asked;
        return answer(situation, budget, out);
    }
};

/// A second method beside it.
struct SecondFake : FakeMethod {
    static constexpr world::MethodTraits kTraits{
        .id = 12, .reactive = false, .keeps_clearance = false, .needs_sets = false};
};

/// A method that decides anew every tick.
struct ReactiveFake : FakeMethod {
    static constexpr world::MethodTraits kTraits{
        .id = 13, .reactive = true, .keeps_clearance = true, .needs_sets = false};
};

inline constexpr std::uint8_t kFirst = FakeMethod::kTraits.id;
inline constexpr std::uint8_t kSecond = SecondFake::kTraits.id;
inline constexpr std::uint8_t kReacting = ReactiveFake::kTraits.id;

inline Manoeuvre along(const Situation& s, const std::vector<Vec3>& positions, const Vec3& side)
{
    Manoeuvre m;
    m.kind = world::ManoeuvreKind::follow_path;
    m.start = s.now;
    m.side = side;
    static_cast<void>(path::make_timed_path(positions, s.limits.cruise_speed, s.limits, m.path));
    m.valid_until = s.now + m.path.duration();
    return m;
}

/// Out to `side` by `width`, past and back to the leg, over `length` along the leg.
inline Manoeuvre detour(const Situation& s, const Vec3& side, float width, float length)
{
    const world::Way way = world::way_of(s);
    std::vector<Vec3> positions;
    for (int i = 0; i <= 24; ++i) {
        const float u = static_cast<float>(i) / 24.0F;
        const float out = 0.5F * (1.0F - std::cos(2.0F * kPi * u));
        positions.push_back(way.origin + way.direction * (length * u) + side * (width * out));
    }
    return along(s, positions, side);
}

inline FakeMethod always(const Vec3& side, float width = 6.0F, float length = 60.0F)
{
    return {[=](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, side, width, length);
        return PlanStatus::found;
    }};
}

inline FakeMethod never(PlanStatus status = PlanStatus::none_available)
{
    return {[=](const Situation&, WorkBudget&, Manoeuvre&) { return status; }};
}

/// A vehicle on its leg to the east at 30 m height, 5 m/s, and the supervisor's clock.
struct Flight {
    Flight()
    {
        scene.leg(Vec3(0, 0, 30), Vec3(300, 0, 30), 5.0F);
        scene.own.position = Vec3(0, 0, 30);
        scene.own.velocity = Vec3(5, 0, 0);
        scene.own.stamp = scene.now;
    }

    template <class S>
    Guidance update(S& supervisor, bool in_control)
    {
        return supervisor.update(scene.situation(), in_control);
    }
    /// Advances time: the vehicle follows `command`, tracks fly straight on (and are measured at their place).
    void pass(const Vec3& command, Seconds dt)
    {
        vehicle::advance(scene.own, command, scene.limits, dt);
        scene.now = scene.now + dt;
        scene.own.stamp = scene.now;
        for (world::Track& t : scene.tracks) {
            t.position += t.velocity * dt;
            t.stamp = scene.now;
        }
    }

    world::test::Scene scene;
};

inline const Vec3 kLeft(0, 1, 0);

inline Settings quick()
{
    Settings s;
    s.settle = 0.5F;
    return s;
}

/// A head-on threat `ahead` metres away.
inline void head_on(Flight& f, float ahead = 40.0F)
{
    f.scene.track(f.scene.own.position + Vec3(ahead, 0, 0), Vec3(-5, 0, 0), 1.0F);
}

/// Brings a supervisor to `avoiding` around a head-on threat.
template <class S>
Guidance avoid_head_on(Flight& f, S& supervisor)
{
    head_on(f);
    static_cast<void>(f.update(supervisor, false));
    return f.update(supervisor, true);
}

}  // namespace jink::avoid::test
