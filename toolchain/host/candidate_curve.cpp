// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/candidate_curve.hpp"

#include <cmath>

namespace jink::host {

Columns3 candidate_curve(const geometric::CandidateShape& shape, const std::array<double, 3>& start,
                         const std::array<double, 3>& to)
{
    constexpr int kCurvePoints = 24;
    const auto vector = [](const std::array<double, 3>& p) {
        return Vec3(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    };
    Columns3 points;
    const Vec3 direction = vector(to) - vector(start);
    const float distance = direction.norm();
    if (!(distance > 0.0F) || !std::isfinite(distance) || !std::isfinite(shape.plane + shape.offset)) {
        return points;
    }
    const geometric::PathFrame frame = geometric::make_path_frame(vector(start), direction);
    const float length = geometric::curve_length_x(shape.family, distance);
    for (int k = 0; k <= kCurvePoints; ++k) {
        const float s = length * static_cast<float>(k) / static_cast<float>(kCurvePoints);
        const float y = geometric::curve_offset(shape, distance, s);
        const Vec3 at = frame.origin + frame.axes * Vec3(s, y * std::cos(shape.plane), y * std::sin(shape.plane));
        points.x.push_back(static_cast<double>(at.x()));
        points.y.push_back(static_cast<double>(at.y()));
        points.z.push_back(static_cast<double>(at.z()));
    }
    return points;
}

}  // namespace jink::host
