// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/cylinder.hpp"

#include <algorithm>
#include <cmath>

namespace jink::reach {
namespace {

/// Tolerance for points inside by rounding alone, of the extent of the points.
constexpr float kSlack = 1e-5F;

Circle through(const Vec2& a, const Vec2& b) noexcept { return {0.5F * (a + b), 0.5F * (a - b).norm()}; }

/// Around three points: through all of them, or, where they are in line, around the two farthest apart.
Circle through(const Vec2& a, const Vec2& b, const Vec2& c) noexcept
{
    const Vec2 ab = b - a;
    const Vec2 ac = c - a;
    const float twice = 2.0F * (ab.x() * ac.y() - ab.y() * ac.x());
    const float scale = ab.squaredNorm() + ac.squaredNorm();
    if (std::abs(twice) <= 1e-6F * scale) {
        Circle widest = through(a, b);
        for (const Circle& other : {through(a, c), through(b, c)}) {
            widest = other.radius > widest.radius ? other : widest;
        }
        return widest;
    }
    const float d = ab.squaredNorm();
    const float e = ac.squaredNorm();
    const Vec2 to((ac.y() * d - ab.y() * e) / twice, (ab.x() * e - ac.x() * d) / twice);
    return {a + to, to.norm()};
}

bool holds(const Circle& circle, const Vec2& point, float slack) noexcept
{
    return (point - circle.centre).norm() <= circle.radius + slack;
}

}  // namespace

Circle smallest_circle(std::span<const Vec2> points) noexcept
{
    if (points.empty()) {
        return {};
    }
    float extent = 0.0F;
    for (const Vec2& point : points) {
        extent = std::max(extent, (point - points[0]).norm());
    }
    const float slack = kSlack * extent;
    // Welzl's algorithm without recursion: each point outside the circle so far is on the border of the next one.
    Circle circle{points[0], 0.0F};
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (holds(circle, points[i], slack)) {
            continue;
        }
        circle = {points[i], 0.0F};
        for (std::size_t j = 0; j < i; ++j) {
            if (holds(circle, points[j], slack)) {
                continue;
            }
            circle = through(points[i], points[j]);
            for (std::size_t k = 0; k < j; ++k) {
                if (!holds(circle, points[k], slack)) {
                    circle = through(points[i], points[j], points[k]);
                }
            }
        }
    }
    for (const Vec2& point : points) {
        circle.radius = std::max(circle.radius, (point - circle.centre).norm());
    }
    return circle;
}

}  // namespace jink::reach
