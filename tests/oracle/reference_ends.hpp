// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/world.hpp"

// Where references begin and end.

namespace jink::world {

inline Vec3 start_of(const Reference& reference) { return reference.route().at(0.0F).position; }
inline Vec3 end_of(const Reference& reference)
{
    const path::RouteView route = reference.route();
    return route.at(route.length()).position;
}
/// More than one leg.
inline bool turns(const Reference& reference) { return reference.route().segments().size() > 1; }

}  // namespace jink::world
