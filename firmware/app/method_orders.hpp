// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/avoid/settings.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"

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

/// Whether an order names a method that decides anew at every update. O(methods).
[[nodiscard]] constexpr bool is_reactive(const avoid::MethodOrder& order) noexcept
{
    return std::any_of(kMethods.begin(), kMethods.end(),
                       [&](const world::MethodTraits& method) { return method.reactive && order.contains(method.id); });
}

/// The order without the methods that need reach sets. Where none is left, the geometric method takes their place: an
/// empty order would name all. O(methods).
[[nodiscard]] constexpr avoid::MethodOrder without_sets(const avoid::MethodOrder& order) noexcept
{
    avoid::MethodOrder left;
    for (const std::uint8_t id : order.ids()) {
        const auto* const method = std::find_if(kMethods.begin(), kMethods.end(),
                                                [&](const world::MethodTraits& traits) { return traits.id == id; });
        if (method == kMethods.end() || !method->needs_sets) {
            static_cast<void>(left.try_add(id));
        }
    }
    return left.empty() ? avoid::MethodOrder(kGeometric) : left;
}

}  // namespace jink::app
