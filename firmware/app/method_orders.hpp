// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/avoid/settings.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/app/built_methods.hpp"

// The methods of the co-processor, and the orders that JNK_METHODS names.

namespace jink::app {

inline constexpr std::uint8_t kGeometric = geometric::Planner::kTraits.id;
inline constexpr std::uint8_t kReach = reach::Planner::kTraits.id;
inline constexpr std::uint8_t kOrca = orca::Planner::kTraits.id;
inline constexpr std::array kMethods{geometric::Planner::kTraits, reach::Planner::kTraits, orca::Planner::kTraits};

/// An order, and the one in clutter (empty: the same).
struct MethodOrders {
    avoid::MethodOrder order;
    avoid::MethodOrder in_clutter{};
};

/// By the value of JNK_METHODS.
inline constexpr std::array kMethodOrders{
    MethodOrders{avoid::MethodOrder(kGeometric)},
    MethodOrders{avoid::MethodOrder(kGeometric, kReach), avoid::MethodOrder(kReach, kGeometric)},
    MethodOrders{avoid::MethodOrder(kReach, kGeometric)},
    MethodOrders{avoid::MethodOrder(kReach)},
    MethodOrders{avoid::MethodOrder(kOrca)},
    MethodOrders{avoid::MethodOrder(kOrca, kGeometric, kReach), avoid::MethodOrder(kOrca, kReach, kGeometric)},
};

/// Whether this image has a method. O(1).
[[nodiscard]] constexpr bool is_built(std::uint8_t method) noexcept
{
    return method == kGeometric ? kHasGeometric : method == kReach ? kHasReach : method == kOrca && kHasReciprocal;
}
/// Whether this image has all methods that a value of JNK_METHODS names. O(methods).
[[nodiscard]] constexpr bool is_built(const MethodOrders& orders) noexcept
{
    const auto ids = orders.order.ids();
    return std::all_of(ids.begin(), ids.end(), [](std::uint8_t id) { return is_built(id); });
}
/// Initial JNK_METHODS: geometric then reach sets, or what is there of it, or the reciprocal method.
inline constexpr std::size_t kInitialMethods = kHasGeometric ? (kHasReach ? 1 : 0) : kHasReach ? 3 : 4;

/// Whether an order names a method that decides anew at every update. O(methods).
[[nodiscard]] constexpr bool is_reactive(const avoid::MethodOrder& order) noexcept
{
    return std::any_of(kMethods.begin(), kMethods.end(),
                       [&](const world::MethodTraits& method) { return method.reactive && order.contains(method.id); });
}
/// Whether an order names a method that needs reach sets. O(methods).
[[nodiscard]] constexpr bool needs_sets(const avoid::MethodOrder& order) noexcept
{
    return std::any_of(kMethods.begin(), kMethods.end(), [&](const world::MethodTraits& method) {
        return method.needs_sets && order.contains(method.id);
    });
}

/// The order without the methods that need reach sets. Where none is left, the first other method of this image takes
/// their place: an empty order would name all. O(methods).
[[nodiscard]] constexpr avoid::MethodOrder without_sets(const avoid::MethodOrder& order) noexcept
{
    avoid::MethodOrder left;
    for (const std::uint8_t id : order.ids()) {
        if (!needs_sets(avoid::MethodOrder(id))) {
            static_cast<void>(left.try_add(id));
        }
    }
    return left.empty() ? avoid::MethodOrder(kHasGeometric ? kGeometric : kOrca) : left;
}

}  // namespace jink::app
