// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometry/mesh_map.hpp"

// The map of known surroundings that an image is built with: JINK_MAP of CMake names a header that `jink mesh build
// --header` made, and JINK_MAP_OF is its map.

#if defined(JINK_MAP)
#include JINK_MAP

namespace jink::app {

/// Only where there is one.
[[nodiscard]] constexpr const geometry::MeshMap& built_map() noexcept { return JINK_MAP_OF; }

}  // namespace jink::app
#endif
