// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/point3.hpp"

namespace jink::oracle {

/// Vertices of a hull as constant tables hold them.
inline std::vector<Point3> points_of(const std::vector<Vec3>& vectors)
{
    std::vector<Point3> points;
    for (const Vec3& v : vectors) {
        points.push_back(Point3::of(v));
    }
    return points;
}

}  // namespace jink::oracle
