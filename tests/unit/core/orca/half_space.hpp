// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/orca/program.hpp"

namespace jink::orca::test {

/// Velocities whose component along `normal` is at least `offset` [m/s].
inline HalfSpace at_least(const Vec3& normal, float offset, Level level = Level::warning, float yield = 1.0F)
{
    HalfSpace out;
    out.normal = normal;
    out.offset = offset;
    out.level = level;
    out.yield = yield;
    return out;
}

}  // namespace jink::orca::test
