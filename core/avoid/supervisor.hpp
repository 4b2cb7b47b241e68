// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <tuple>
#include <type_traits>

#include "core/avoid/method_order.hpp"

namespace jink::avoid {

/// Decides, once per tick, what is flown: predicts conflicts of the way ahead, asks the methods in their order, checks
/// each answer once more as it will really be flown, holds on to a chosen manoeuvre while it stays safe, replans when
/// it does not, returns to the leg, and brakes (or takes the way of least harm) when nothing is safe.
///
/// `update(situation, in_control)`: `in_control` says whether the vehicle follows our command at present. While it does
/// not, nothing is held on to: the answer is made anew from the present state every tick, on the side chosen before
/// where that is about as good. A method with a member kKeepsRoom keeps Settings::room by itself, as far as there is
/// any, and is asked once a plan; others are asked for a wider vehicle first. A method with a member kReactive decides
/// every tick anew, and is asked as Settings::reactive says. Methods are owned by the caller and outlive the
/// supervisor. Same situations in the same order give the same guidance.
template <world::AvoidanceMethod... Methods>
class Supervisor {
public:
    explicit Supervisor(const Settings& settings, Methods&... methods) noexcept
        : machine_(settings), methods_(methods...)
    {
    }

    /// `other`: a second nominal path, may be null. While not in control the one whose loss of separation comes first
    /// counts (Guidance::on_other); in control, `situation`'s alone is flown, and control is not given back while the
    /// other one is in conflict (Guidance::other_conflict). An obstacle or a closed area on the other one counts once
    /// it is time to stop: before that, the vehicle may still turn where its leg ends.
    Guidance update(const world::Situation& situation, bool in_control,
                    const world::Reference* other = nullptr) noexcept
    {
        return machine_.update(situation, other, in_control, {this, &Supervisor::ask_in_order});
    }

    void reset() noexcept { machine_.reset(); }
    /// Refused (false, nothing changed) when out of range.
    [[nodiscard]] bool configure(const Settings& settings) noexcept { return machine_.configure(settings); }
    [[nodiscard]] const Settings& settings() const noexcept { return machine_.settings(); }
    [[nodiscard]] State state() const noexcept { return machine_.state(); }
    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return machine_.diagnostics(); }
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return machine_.flying(); }

private:
    template <class Method>
    static constexpr bool kIsReactive = requires
    {
        Method::kReactive;
    };
    /// Without the reactive ones.
    static constexpr std::size_t kMethods = (std::size_t{0} + ... + (kIsReactive<Methods> ? 0U : 1U));

    /// One rung: with room to spare, then without. A method that keeps room itself, as far as there is any, is asked
    /// once.
    template <class Method>
    static bool ask(Method& method, const Situations& situations, const Settings& settings, WorkBudget& budget,
                    Diagnostics& diagnostics, world::Manoeuvre& out, float& margin, world::PlanStatus& status) noexcept
    {
        if constexpr (!requires { Method::kKeepsRoom; }) {
            if (ask_in(method, situations.inflated, settings, budget, diagnostics, out, margin, status)) {
                return true;
            }
            if (budget.exhausted()) {
                return false;
            }
        }
        return ask_in(method, situations.plain, settings, budget, diagnostics, out, margin, status);
    }

    template <class Method>
    static bool ask_in(Method& method, const world::Situation& situation, const Settings& settings, WorkBudget& budget,
                       Diagnostics& diagnostics, world::Manoeuvre& out, float& margin,
                       world::PlanStatus& status) noexcept
    {
        ++diagnostics.plans;
        status = method.plan(situation, budget, out);
        if (status != world::PlanStatus::found) {
            return false;
        }
        constexpr world::Cutoff kClearOrNot{0.0F, world::kSeparationCap, {}};
        constexpr Seconds kAllOfIt = std::numeric_limits<Seconds>::infinity();
        margin = check_manoeuvre(situation, out, settings, budget, kAllOfIt, kClearOrNot).margin;
        if (!(margin >= 0.0F)) {
            ++diagnostics.answers_rejected;
            status = world::PlanStatus::none_available;
            return false;
        }
        return true;
    }

    static world::PlanStatus ask_in_order(void* self, const Situations& situations, const Settings& settings,
                                          WorkBudget& budget, Diagnostics& diagnostics, world::Manoeuvre& out,
                                          float& margin) noexcept
    {
        world::PlanStatus status = world::PlanStatus::none_available;
        const MethodOrder order = method_order_of(kMethods, situations.plain, settings);
        const std::size_t first = settings.reactive == Reactive::never ? 1 : 0;  // 0: the reactive ones
        const std::size_t last = settings.reactive == Reactive::alone ? 0 : order.count;
        for (std::size_t i = first; i <= last; ++i) {
            const std::size_t after = last - i;
            const auto kept = static_cast<std::uint32_t>(after * settings.kept_for_next);
            WorkBudget share(budget.left() > kept ? budget.left() - kept : 0);
            std::size_t n = 0;
            const auto is_asked = [&](bool reactive) {
                return reactive ? i == 0 : i > 0 && n++ == order.method(i - 1);
            };
            const bool found = std::apply(
                [&](auto&... method) {
                    return ((is_asked(kIsReactive<std::remove_reference_t<decltype(method)>>) &&
                             ask(method, situations, settings, share, diagnostics, out, margin, status)) ||
                            ...);
                },
                static_cast<Supervisor*>(self)->methods_);
            // What ends the last one's work ends that of the plan, and is told.
            static_cast<void>(budget.spend(after == 0 && share.exhausted() ? budget.left() + 1 : share.spent()));
            if (found) {
                diagnostics.found_by_next += i > first ? 1U : 0U;
                return status;
            }
        }
        return status;
    }

    StateMachine machine_;
    std::tuple<Methods&...> methods_;
};

}  // namespace jink::avoid
