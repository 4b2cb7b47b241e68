// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/meet.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace jink::orca {

namespace {

/// a * b without an error: product and what it rounded off (Dekker; Veltkamp's split, for targets without a fused one).
struct Product {
    float value;
    float rest;
};
Product product(float a, float b) noexcept
{
    constexpr float kSplit = 4097.0F;  // 2^12 + 1: halves of 12 bits
    const float a_wide = kSplit * a;
    const float b_wide = kSplit * b;
    const float a_high = a_wide - (a_wide - a);
    const float b_high = b_wide - (b_wide - b);
    const float a_low = a - a_high;
    const float b_low = b - b_high;
    const float value = a * b;
    return {value, ((a_high * b_high - value) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

}  // namespace

float exact_violation(const Row& row, const Vec3& x) noexcept
{
    float sum = row.offset;
    float rest = 0.0F;
    for (Eigen::Index i = 0; i < 3; ++i) {
        const Product part = product(-row.normal[i], x[i]);
        const float next = sum + part.value;
        const float back = next - sum;
        rest += ((sum - (next - back)) + (part.value - back)) + part.rest;
        sum = next;
    }
    return sum + rest;
}

bool line_of(const Row& one, const Row& other, const Vec3& near, Vec3& from, Vec3& along) noexcept
{
    // Normals of nearly the same direction, or nearly opposite ones: their difference, or sum, is exact where the cross
    // product of both would be a difference of products that are nearly equal.
    const float sign = one.normal.dot(other.normal) >= 0.0F ? 1.0F : -1.0F;
    const Vec3 turn = other.normal - sign * one.normal;
    along = turn.cross(one.normal);
    const float sine = along.norm();
    if (sine <= kSameDirection) {
        return false;
    }
    along /= sine;
    const Vec3 across_line = along.cross(one.normal);  // in plane `one`
    const float steep = across_line.dot(turn);         // = across_line . other.normal, but exact
    from = near + (other.violation(near) / steep) * across_line;
    // What the way of a long step rounded off, once more. Between planes of nearly the same direction the rounding of
    // the violations themselves would be a long way.
    constexpr float kBlunt = 0.1F;  // [rad]
    if (sine > kBlunt) {
        from += one.violation(from) * one.normal;
        from += (other.violation(from) / steep) * across_line;
    } else {
        from += exact_violation(one, from) * one.normal;
        from += (exact_violation(other, from) / steep) * across_line;
    }
    return true;
}

void settle(const Row& a, const Row& b, const Row& c, Balls balls, float tolerance, Vec3& x) noexcept
{
    constexpr float kBlunt = 0.1F;  // volume of the normals
    constexpr float kFlat = 1e-6F;
    const Vec3 bc = b.normal.cross(c.normal);
    const float volume = a.normal.dot(bc);
    if (std::fabs(volume) > kBlunt || std::fabs(volume) < kFlat) {
        return;
    }
    const auto off = [&](const Vec3& at) {
        return Vec3(exact_violation(a, at), exact_violation(b, at), exact_violation(c, at));
    };
    const Vec3 before = off(x);
    const Vec3 settled =
        x + (before.x() * bc + before.y() * c.normal.cross(a.normal) + before.z() * a.normal.cross(b.normal)) / volume;
    // Farther than what rounding explains, it is another corner; and the way there is rounded, too.
    const auto in = [&](const Ball& ball) { return within(ball, settled, tolerance); };
    if (before.cwiseAbs().maxCoeff() <= 4.0F * tolerance && off(settled).cwiseAbs().maxCoeff() <= tolerance &&
        std::all_of(balls.begin(), balls.end(), in)) {
        x = settled;
    }
}

}  // namespace jink::orca
