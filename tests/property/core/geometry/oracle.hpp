// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/base/random.hpp"
#include "core/geometry/sweep.hpp"

// Double-precision oracle for moving tests: bisection on the slope of a convex function, then on the function itself.
// Independent of the closed forms: no breakpoints, no quadratics.

namespace jink::geometry::oracle {

using Point = std::array<double, 3>;

inline Point to_double(const Vec3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }
inline Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A point moving relative to a box at the origin.
struct Passage {
    Point half, position, velocity;

    Passage(const Vec3& h, const Motion& own, const Motion& threat)
        : half(to_double(h)), position(minus(to_double(threat.position), to_double(own.position))),
          velocity(minus(to_double(threat.velocity), to_double(own.velocity)))
    {
    }
    Passage(const Point& h, const Point& p, const Point& v) : half(h), position(p), velocity(v) {}

    double distance(double t) const
    {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double outside = std::max(std::abs(position[i] + velocity[i] * t) - half[i], 0.0);
            sum += outside * outside;
        }
        return std::sqrt(sum);
    }
    double slope(double t) const
    {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double x = position[i] + velocity[i] * t;
            if (std::abs(x) > half[i]) {
                sum += (x - std::copysign(half[i], x)) * velocity[i];
            }
        }
        return sum;
    }
    /// First instant of the least distance in [0, horizon].
    double closest(double horizon) const
    {
        double low = 0;
        double high = horizon;
        if (slope(low) >= 0) {
            return low;
        }
        if (slope(high) < 0) {
            return high;
        }
        for (int i = 0; i < 100 && high > low; ++i) {
            const double middle = 0.5 * (low + high);
            (slope(middle) < 0 ? low : high) = middle;
        }
        return high;
    }
    /// Instant in between at which the distance passes `radius`; `outside` has more, `inside` at most that.
    double crossing(double outside, double inside, double radius) const
    {
        for (int i = 0; i < 100 && outside != inside; ++i) {
            const double middle = 0.5 * (outside + inside);
            if (middle == outside || middle == inside) {
                break;
            }
            (distance(middle) > radius ? outside : inside) = middle;
        }
        return inside;
    }
};

/// Present where the program is linked with AddressSanitizer, whether this source is instrumented or not.
extern "C" [[gnu::weak]] void __asan_init();  // NOLINT: the sanitizer's name

/// Cases for a test: the environment may ask for another number; sanitized programs take a tenth.
inline std::size_t case_count(std::size_t normal)
{
    if (const char* text = std::getenv("JINK_CASES")) {
        return static_cast<std::size_t>(std::strtoull(text, nullptr, 10));
    }
    return __asan_init != nullptr ? normal / 10 : normal;
}

/// Seed for a test, printed with each failure and accepted back from the environment.
inline std::uint64_t seed_of(std::uint64_t normal)
{
    const char* text = std::getenv("JINK_SEED");
    return text != nullptr ? std::strtoull(text, nullptr, 0) : normal;
}

/// 10^x, x uniform in [low, high).
inline float power_of_ten(Random& random, float low, float high) { return std::pow(10.0F, random.uniform(low, high)); }

inline Vec3 in_cube(Random& random, float side)
{
    return {random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side)};
}

}  // namespace jink::geometry::oracle
