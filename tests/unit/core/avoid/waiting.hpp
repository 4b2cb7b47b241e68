// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid::test {

/// A supervisor without plans, and a vehicle placed by the test.
struct Waiting {
    explicit Waiting(const Settings& s = quick()) : settings(s) {}

    Guidance update(bool in_control = true) { return f.update(supervisor, in_control); }
    Guidance after(Seconds dt, bool in_control = true)
    {
        f.scene.now = f.scene.now + dt;
        f.scene.own.stamp = f.scene.now;
        for (world::Track& t : f.scene.tracks) {
            t.stamp = f.scene.now;
        }
        return update(in_control);
    }
    /// Steps of `step` for `span`; the vehicle stays.
    Guidance wait(Seconds span, Seconds step = 0.1F, bool in_control = true)
    {
        Guidance g;
        for (int i = 0; i < static_cast<int>(std::lround(span / step)); ++i) {
            g = after(step, in_control);
        }
        return g;
    }
    void stand(const Vec3& at)
    {
        f.scene.own.position = at;
        f.scene.own.velocity = Vec3::Zero();
    }

    Settings settings;
    Flight f;
    FakeMethod method = never();
    Supervisor<FakeMethod> supervisor{settings, method};
};

/// Static 3 m in front of a wall across the leg.
struct AtAWall : Waiting {
    explicit AtAWall(const Settings& s = quick()) : Waiting(s)
    {
        stand(Vec3(55, 0, 30));
        f.scene.obstacle(geometry::make_box(Vec3(60, 0, 30), Vec3(1, 200, 200)));
    }
};

}  // namespace jink::avoid::test
