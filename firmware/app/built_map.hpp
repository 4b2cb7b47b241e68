// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometry/mesh_map.hpp"
#include "firmware/app/known_map.hpp"
#include "firmware/app/work_rate.hpp"

// The map of known surroundings that an image is built with: JINK_MAP of CMake names a header that `jink mesh build
// --header` made, and JINK_MAP_OF is its map.

#if defined(JINK_MAP)
#include JINK_MAP

namespace jink::app {

/// Only where there is one.
[[nodiscard]] constexpr const geometry::MeshMap& built_map() noexcept { return JINK_MAP_OF; }

}  // namespace jink::app
#endif

namespace jink::app {

/// Work of a step of an image with this clock, less what its map takes, which is part of the mandatory part.
[[nodiscard]] constexpr avoid::WorkPerUpdate work_of_image(const WorkRate& rate) noexcept
{
    avoid::WorkPerUpdate work = rate.work();
#if defined(JINK_MAP)
    work.all -= KnownMap::kUnits;
#endif
    return work;
}

}  // namespace jink::app
