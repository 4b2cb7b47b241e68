// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/vec3.hpp"

namespace jink {

/// Three numbers in a constant table. Eigen's vectors are initialised at run time and would lie in RAM.
struct Point3 {
    float x = 0.0F;
    float y = 0.0F;
    float z = 0.0F;

    [[nodiscard]] Vec3 vec() const noexcept { return {x, y, z}; }
    [[nodiscard]] static Point3 of(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }
};

}  // namespace jink
