// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Which methods an image is built with: JINK_METHODS of CMake, which defines JINK_WITHOUT_... for each that is left
// out. Every unit of an image has to be compiled with the same ones; those that do not read this header are compiled
// once for all.
#ifdef JINK_OF_ANY_METHODS
#error "firmware/CMakeLists.txt: this source belongs to jink_app_of_methods"
#endif

namespace jink::app {

#ifdef JINK_WITHOUT_GEOMETRIC
inline constexpr bool kHasGeometric = false;
#else
inline constexpr bool kHasGeometric = true;
#endif
#ifdef JINK_WITHOUT_REACH
inline constexpr bool kHasReach = false;
#else
inline constexpr bool kHasReach = true;
#endif
#ifdef JINK_WITHOUT_ORCA
inline constexpr bool kHasReciprocal = false;
#else
inline constexpr bool kHasReciprocal = true;
#endif
static_assert(kHasGeometric || kHasReach || kHasReciprocal, "JINK_METHODS: at least one of geometric, reach, orca");

}  // namespace jink::app
