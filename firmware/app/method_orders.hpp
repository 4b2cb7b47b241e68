// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string_view>

#include "core/avoid/give_way.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/app/built_methods.hpp"

// The methods of the co-processor, and the sets of them that JNK_METHODS names.

namespace jink::app {

inline constexpr std::uint8_t kGeometric = geometric::Planner::kTraits.id;
inline constexpr std::uint8_t kReach = reach::Planner::kTraits.id;
inline constexpr std::uint8_t kOrca = orca::Planner::kTraits.id;
/// In the order in which they are asked.
inline constexpr std::array kMethods{geometric::Planner::kTraits, reach::Planner::kTraits, orca::Planner::kTraits};

/// For people, at most 10 characters. O(1).
[[nodiscard]] constexpr std::string_view method_name(std::uint8_t id) noexcept
{
    return id == kGeometric         ? "geometric"
           : id == kReach           ? "reach sets"
           : id == kOrca            ? "reciprocal"
           : id == avoid::kGivesWay ? "giving way"
                                    : "none";
}

/// The methods that a value of JNK_METHODS names: the sum of 1 geometric, 2 reach sets, 4 reciprocal. O(methods).
[[nodiscard]] constexpr avoid::MethodOrder methods_of(unsigned value) noexcept
{
    avoid::MethodOrder order;
    for (std::size_t i = 0; i < kMethods.size(); ++i) {
        static_cast<void>((value >> i & 1U) != 0 && order.try_add(kMethods[i].id));
    }
    return order;
}
/// The largest value, of all methods.
inline constexpr unsigned kAllMethods = (1U << kMethods.size()) - 1;
/// Of the methods that this image has: the initial value.
inline constexpr unsigned kBuiltMethods =
    (kHasGeometric ? 1U : 0U) + (kHasReach ? 2U : 0U) + (kHasReciprocal ? 4U : 0U);

/// Whether this image has all methods that a value names. O(1).
[[nodiscard]] constexpr bool is_built(unsigned value) noexcept { return (value & ~kBuiltMethods) == 0; }

/// Those of an order for which `holds`. O(methods).
template <class Predicate>
[[nodiscard]] constexpr avoid::MethodOrder those_of(const avoid::MethodOrder& order, Predicate holds) noexcept
{
    avoid::MethodOrder left;
    for (const world::MethodTraits& method : kMethods) {
        static_cast<void>(order.contains(method.id) && holds(method) && left.try_add(method.id));
    }
    return left;
}

/// Whether an order names a method that decides anew at every update. O(methods).
[[nodiscard]] constexpr bool is_reactive(const avoid::MethodOrder& order) noexcept
{
    return !those_of(order, [](const world::MethodTraits& method) { return method.reactive; }).empty();
}
/// Whether an order names a method that needs reach sets. O(methods).
[[nodiscard]] constexpr bool needs_sets(const avoid::MethodOrder& order) noexcept
{
    return !those_of(order, [](const world::MethodTraits& method) { return method.needs_sets; }).empty();
}

/// A plane keeps its own speed and cannot fly what a reactive method asks for: the others, where there are any.
/// O(methods).
[[nodiscard]] constexpr avoid::MethodOrder for_wings(const avoid::MethodOrder& order) noexcept
{
    const avoid::MethodOrder left = those_of(order, [](const world::MethodTraits& method) { return !method.reactive; });
    return left.empty() ? order : left;
}

/// The order without the methods that need reach sets. Where none is left, the first other method of this image takes
/// their place: an empty order would name all. O(methods).
[[nodiscard]] constexpr avoid::MethodOrder without_sets(const avoid::MethodOrder& order) noexcept
{
    const avoid::MethodOrder left =
        those_of(order, [](const world::MethodTraits& method) { return !method.needs_sets; });
    return left.empty() ? avoid::MethodOrder(kHasGeometric ? kGeometric : kOrca) : left;
}

}  // namespace jink::app
