// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/capacity.hpp"

// The reach sets that this build flies: the default vehicle's, or where there is space for fewer nodes its reduced
// ones. JINK_REACH_SETS names another generated header, and JINK_REACH_SETS_OF its sets.

#if defined(JINK_REACH_SETS)
#include JINK_REACH_SETS
#elif JINK_MAX_REACH_NODES >= 2560
#include "firmware/vehicles/default/reach_sets.hpp"
#define JINK_REACH_SETS_OF jink::reach::kDefaultSets
#else
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#define JINK_REACH_SETS_OF jink::reach::kDefaultReducedSets
#endif

namespace jink::app {

[[nodiscard]] constexpr const reach::VehicleSets& reach_sets() noexcept { return JINK_REACH_SETS_OF; }

}  // namespace jink::app
