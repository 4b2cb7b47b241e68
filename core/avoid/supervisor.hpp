// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <tuple>

#include "core/avoid/method_order.hpp"
#include "core/avoid/state_machine.hpp"

namespace jink::avoid {

/// Decides, once per tick, what is flown: predicts conflicts of the nominal path, asks the methods in order, checks
/// each answer once more as it will really be flown, holds on to a chosen manoeuvre while it stays safe, replans when
/// it does not, returns to the leg, and brakes (or takes the max-clearance escape) when nothing is safe.
///
/// `update(situation, in_control)`: `in_control` says whether the vehicle follows our command at present. While it does
/// not, nothing is held on to: the answer is made anew from the present state every tick, on the side chosen before
/// where that is about as good. Situation::threats is collected by the caller (world::ThreatSet); without threats, or
/// with flight rules out of range, everything counts as contact. Settings::order says which methods are asked, and in
/// which order. A method that keeps clearance by itself (MethodTraits) is asked once a plan; others are asked for an
/// inflated vehicle first. Methods are owned by the caller and outlive the supervisor. Same situations in the same
/// order give the same guidance.
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
    /// From now on a plan goes on over several updates (WorkPerUpdate). It outlives this.
    void plan_in_slices(SlicedPlan& plan) noexcept { machine_.plan_in_slices(plan); }
    /// From now on a plan is made in one update, as at first.
    void plan_in_whole() noexcept { machine_.plan_in_whole(); }
    /// Drops what is planned at present: before a method is configured anew.
    void drop_plan() noexcept { machine_.drop_plan(); }
    /// Refused (false, nothing changed) when out of range.
    [[nodiscard]] bool configure(const Settings& settings) noexcept { return machine_.configure(settings); }
    [[nodiscard]] const Settings& settings() const noexcept { return machine_.settings(); }
    [[nodiscard]] State state() const noexcept { return machine_.state(); }
    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return machine_.diagnostics(); }
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return machine_.flying(); }

private:
    /// All of them, in the order in which they were given.
    static constexpr MethodOrder kAll{Methods::kTraits.id...};
    static_assert(sizeof...(Methods) >= 1 && sizeof...(Methods) <= kMaxMethods);
    static_assert(kAll.size() == sizeof...(Methods), "ids of methods are unique and not 0");

    /// Those of an order that are here.
    static MethodOrder present(const MethodOrder& order) noexcept
    {
        if (order.empty()) {
            return kAll;
        }
        MethodOrder here;
        for (const std::uint8_t id : order.ids()) {
            static_cast<void>(kAll.contains(id) && here.try_add(id));
        }
        return here;
    }

    /// One method: for the inflated vehicle, then for the vehicle as it is. A method that keeps clearance by itself, as
    /// far as it can, is asked once.
    template <class Method>
    static bool ask(Method& method, const Situations& situations, const Settings& settings, WorkBudget& budget,
                    Diagnostics& diagnostics, world::Manoeuvre& out, float& margin, world::PlanStatus& status) noexcept
    {
        if constexpr (!Method::kTraits.keeps_clearance) {
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
        out.by = Method::kTraits.id;
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
        const MethodOrder order = present(order_for(situations.plain, settings));
        std::size_t after = order.size();
        for (const std::uint8_t id : order.ids()) {
            --after;
            const auto kept = static_cast<std::uint32_t>(after * settings.kept_for_next);
            WorkBudget share = budget.part(budget.left() > kept ? budget.left() - kept : 0);
            const bool found = std::apply(
                [&](Methods&... method) {
                    return ((id == Methods::kTraits.id &&
                             ask(method, situations, settings, share, diagnostics, out, margin, status)) ||
                            ...);
                },
                static_cast<Supervisor*>(self)->methods_);
            // What ends the last method's work ends that of the plan, and is reported.
            budget.charge(share);
            if (after == 0 && share.exhausted()) {
                budget.exhaust();
            }
            if (found) {
                diagnostics.found_by_next += after + 1 < order.size() ? 1U : 0U;
                return status;
            }
        }
        return status;
    }

    StateMachine machine_;
    std::tuple<Methods&...> methods_;
};

}  // namespace jink::avoid
