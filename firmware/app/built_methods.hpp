// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

// Which methods an image is built with: JINK_METHODS of CMake, which defines JINK_WITHOUT_... for each that is left
// out. Every unit of an image has to be compiled with the same ones.

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

/// The methods that a value of JNK_METHODS names, whatever their order.
struct MethodNeeds {
    bool geometric;
    bool reach;
    bool reciprocal;
};
inline constexpr std::array<MethodNeeds, 6> kMethodNeeds{{{true, false, false},
                                                          {true, true, false},
                                                          {true, true, false},
                                                          {false, true, false},
                                                          {false, false, true},
                                                          {true, true, true}}};
/// Whether this image has all methods that the value names.
/// @param methods  JNK_METHODS, less than the size of kMethodNeeds
[[nodiscard]] constexpr bool is_built(std::size_t methods) noexcept
{
    const MethodNeeds& needs = kMethodNeeds[methods];
    return (kHasGeometric || !needs.geometric) && (kHasReach || !needs.reach) && (kHasReciprocal || !needs.reciprocal);
}
/// Initial JNK_METHODS: geometric then reach sets, or what is there of it, or the reciprocal method.
inline constexpr std::size_t kInitialMethods = is_built(1) ? 1 : is_built(0) ? 0 : is_built(3) ? 3 : 4;

}  // namespace jink::app
