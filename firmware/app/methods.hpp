// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <tuple>
#include <type_traits>

#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/app/parameters.hpp"

namespace jink::app {

/// The planner, which counts its plans: as long as their number stays, `last` is of one and the same.
class CountingPlanner final : public geometric::Planner {
public:
    using Planner::Planner;

    [[nodiscard]] world::PlanStatus plan(const world::Situation& situation, WorkBudget& budget,
                                         world::Manoeuvre& out) noexcept
    {
        ++plans_;
        return Planner::plan(situation, budget, out);
    }
    /// Begun so far.
    [[nodiscard]] std::uint32_t plans() const noexcept { return plans_; }

private:
    std::uint32_t plans_ = 0;
};

/// Each method with the settings that it takes from the parameters.
struct GeometricMethod {
    explicit GeometricMethod(const Configuration& c) noexcept : planner(c.planner) {}
    void configure(const Configuration& c) noexcept { static_cast<void>(planner.configure(c.planner)); }
    CountingPlanner planner;
};
struct ReachMethod {
    explicit ReachMethod(const Configuration& c) noexcept : planner(c.reach) {}
    void configure(const Configuration& c) noexcept { static_cast<void>(planner.configure(c.reach)); }
    reach::Planner planner;
};
struct ReciprocalMethod {
    explicit ReciprocalMethod(const Configuration& c) noexcept : planner(c.orca) {}
    void configure(const Configuration& c) noexcept { static_cast<void>(planner.configure(c.orca)); }
    orca::Planner planner;
};

/// The methods of an image, and the supervisor that asks them in this order.
template <class... M>
class MethodSet : M... {
public:
    using Supervisor = avoid::Supervisor<decltype(M::planner)...>;

    explicit MethodSet(const Configuration& c) noexcept : M(c)... {}
    /// Parameters admit only what all methods accept.
    void configure(const Configuration& c) noexcept { (M::configure(c), ...); }
    /// It refers to these methods.
    [[nodiscard]] Supervisor supervisor(const avoid::Settings& settings) noexcept
    {
        return Supervisor(settings, M::planner...);
    }

    template <class Method>
    static constexpr bool kHas = (std::is_same_v<Method, M> || ...);
    /// Of a method that is in the set.
    template <class Method>
    [[nodiscard]] auto& planner() noexcept
    {
        static_assert(kHas<Method>, "JINK_METHODS leaves this method out");
        return Method::planner;
    }
    template <class Method>
    [[nodiscard]] const auto& planner() const noexcept
    {
        static_assert(kHas<Method>, "JINK_METHODS leaves this method out");
        return Method::planner;
    }
    /// Calls `use` with the method's planner where the method is in the set.
    template <class Method, class Use>
    void with_planner(Use use) noexcept
    {
        if constexpr (kHas<Method>) {
            use(Method::planner);
        }
    }
};

namespace detail {

template <bool is_built, class Method>
using IfBuilt = std::conditional_t<is_built, std::tuple<Method*>, std::tuple<>>;

template <class... M>
MethodSet<M...> set_of(std::tuple<M*...>) noexcept;

}  // namespace detail

/// The methods that this image is built with (built_methods.hpp).
using Methods = decltype(detail::set_of(std::tuple_cat(detail::IfBuilt<kHasGeometric, GeometricMethod>{},
                                                       detail::IfBuilt<kHasReach, ReachMethod>{},
                                                       detail::IfBuilt<kHasReciprocal, ReciprocalMethod>{})));

}  // namespace jink::app
