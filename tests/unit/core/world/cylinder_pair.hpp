// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "core/world/cylinder.hpp"

namespace jink::world::test {

/// A box and a cylinder that both may move, with named members so that a test can change each number.
struct Pair {
    Vec3 half = Vec3(1, 1, 1);
    Vec3 own = Vec3(-20, 8, 0);
    Vec3 velocity = Vec3(5, 0, 0);
    Cylinder cylinder{{Vec2(0, 0), 3.0F}, Vec2(0, 0), -10.0F, 10.0F, 0.0F};
    Seconds start = 0.0F;
    float outset = 0.0F;
    float growth = 0.0F;

    [[nodiscard]] detail::CylinderApproach approach() const
    {
        return {half, {own, velocity}, cylinder, start, outset, growth};
    }
    [[nodiscard]] double distance() const
    {
        const auto beyond = [](double c, double h) { return std::max(0.0, std::abs(c) - h); };
        const double x = double(cylinder.circle.centre.x()) + double(cylinder.velocity.x()) * double(start);
        const double y = double(cylinder.circle.centre.y()) + double(cylinder.velocity.y()) * double(start);
        const double level =
            std::hypot(beyond(x - double(own.x()), double(half.x())), beyond(y - double(own.y()), double(half.y()))) -
            double(cylinder.circle.radius);
        const double below = double(cylinder.bottom) - double(half.z()) - double(own.z());
        const double above = double(own.z()) - double(half.z()) - double(cylinder.top);
        const double height = std::max(below, above);
        const double apart = level > 0.0 && height > 0.0 ? std::hypot(level, height) : std::max(level, height);
        return apart - double(outset);
    }
};

}  // namespace jink::world::test
