// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "core/avoid/final_check.hpp"
#include "core/avoid/state_machine.hpp"

namespace jink::avoid {

/// Decides, once per tick, what is flown: predicts conflicts of the nominal path, asks the methods, checks each answer
/// once more as it will really be flown, takes the one that costs least (objective.hpp), holds on to it while it stays
/// safe, replans when it does not, returns to the leg, and brakes (or takes the max-clearance escape) when nothing is
/// safe.
///
/// `update(situation, in_control)`: `in_control` says whether the vehicle follows our command at present. While it does
/// not, nothing is held on to: the answer is made anew from the present state every tick, on the side chosen before
/// where that is about as good. Situation::threats is collected by the caller (world::ThreatSet); without threats, or
/// with flight rules out of range, everything counts as contact. Settings::order says which methods are asked. A method
/// that keeps clearance by itself (MethodTraits) is asked once a plan; others are asked for an inflated vehicle first.
/// Methods are owned by the caller and outlive the supervisor. Same situations in the same order give the same
/// guidance.
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
        return machine_.update(situation, other, in_control, planning());
    }

    /// How a plan is made: by all methods of the order, the answer that costs least.
    [[nodiscard]] Planning planning() noexcept { return {this, kAll, planners(), &Supervisor::ask_all}; }

    void reset() noexcept { machine_.reset(); }
    /// From now on a plan goes on over several updates (WorkPerUpdate). It outlives this.
    void plan_in_slices(SlicedPlan& plan) noexcept { machine_.plan_in_slices(plan); }
    /// From now on a plan is made in one update, as at first.
    void plan_in_whole() noexcept { machine_.plan_in_whole(); }
    /// Drops what is planned at present: before a method is configured anew.
    void drop_plan() noexcept { machine_.drop_plan(); }
    /// A plan has begun and goes on in the next update.
    [[nodiscard]] bool plan_runs() const noexcept { return machine_.plan_runs(); }
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

    static constexpr MethodOrder planners() noexcept
    {
        MethodOrder order;
        (static_cast<void>(!Methods::kTraits.reactive && order.try_add(Methods::kTraits.id)), ...);
        return order;
    }

    /// Those of an order that are here.
    static MethodOrder present(const MethodOrder& order) noexcept { return order.empty() ? kAll : order.within(kAll); }

    /// What one of the methods answers.
    struct Answer {
        world::Manoeuvre& manoeuvre;
        Assessment assessment;
        world::PlanStatus status = world::PlanStatus::none_available;
    };

    /// One method: for the inflated vehicle, then for the vehicle as it is. A method that keeps clearance by itself, as
    /// far as it can, is asked once.
    template <class Method>
    static bool ask(Method& method, const Situations& situations, const Settings& settings, WorkBudget& budget,
                    Diagnostics& diagnostics, Answer& out) noexcept
    {
        if constexpr (!Method::kTraits.keeps_clearance) {
            const float kept = situations.plain.rules.clearance;
            if (ask_in(method, situations.inflated, kept, settings, budget, diagnostics, out)) {
                return true;
            }
            if (budget.exhausted()) {
                return false;
            }
        }
        return ask_in(method, situations.plain, 0.0F, settings, budget, diagnostics, out);
    }

    template <class Method>
    static bool ask_in(Method& method, const world::Situation& situation, float kept, const Settings& settings,
                       WorkBudget& budget, Diagnostics& diagnostics, Answer& out) noexcept
    {
        ++diagnostics.plans;
        // What is found with the last units can still be checked.
        const std::uint32_t kept_for_check =
            Method::kTraits.reactive ? 0 : std::min(settings.kept_for_check, budget.left() / 2);
        WorkBudget planning = budget.part(budget.left() - kept_for_check);
        out.status = method.plan(situation, planning, out.manoeuvre);
        budget.charge(planning);
        if (out.status != world::PlanStatus::found) {
            if (planning.exhausted()) {
                budget.exhaust();
            }
            return false;
        }
        out.manoeuvre.by = Method::kTraits.id;
        out.assessment = assess(situation, out.manoeuvre, settings, kept, budget);
        if (out.manoeuvre.kind == world::ManoeuvreKind::velocity) {
            out.manoeuvre.side = out.assessment.cost.side;
        }
        if (!(out.assessment.margin >= 0.0F)) {
            ++diagnostics.answers_rejected;
            out.status = world::PlanStatus::none_available;
            return false;
        }
        return true;
    }

    /// What is kept of a plan's units for a method that is asked after others.
    static std::uint32_t kept_for(std::uint8_t id, const Settings& settings) noexcept
    {
        const bool reactive = ((id == Methods::kTraits.id && Methods::kTraits.reactive) || ...);
        return reactive ? settings.kept_for_reactive : settings.kept_for_next;
    }

    static world::PlanStatus ask_all(void* self, const Situations& situations, const Settings& settings,
                                     WorkBudget& budget, Diagnostics& diagnostics, world::Manoeuvre& out,
                                     Choice& choice) noexcept
    {
        Supervisor& own = *static_cast<Supervisor*>(self);
        const MethodOrder order = present(settings.order);
        std::uint32_t kept = 0;
        for (const std::uint8_t id : order.ids()) {
            kept += kept_for(id, settings);
        }
        world::PlanStatus status = world::PlanStatus::none_available;
        for (const std::uint8_t id : order.ids()) {
            const bool last = id == order.ids().back();
            kept -= kept_for(id, settings);
            WorkBudget share = budget.part(budget.left() > kept ? budget.left() - kept : 0);
            Answer answer{own.answer_, {}};
            const bool found = std::apply(
                [&](Methods&... method) {
                    return (
                        (id == Methods::kTraits.id && ask(method, situations, settings, share, diagnostics, answer)) ||
                        ...);
                },
                own.methods_);
            // What ends the last method's work ends that of the plan, and is reported.
            budget.charge(share);
            if (last && share.exhausted()) {
                budget.exhaust();
            }
            if (!found) {
                status = choice.answers > 0 ? status : answer.status;
                continue;
            }
            status = world::PlanStatus::found;
            ++choice.answers;
            const Seconds cost = answer.assessment.cost.total();
            if (choice.answers == 1 || cost < choice.cost) {
                out = answer.manoeuvre;
                choice.margin = answer.assessment.margin;
                choice.cost = cost;
            }
        }
        diagnostics.found_by_next += status == world::PlanStatus::found && out.by != order.ids().front() ? 1U : 0U;
        return status;
    }

    StateMachine machine_;
    std::tuple<Methods&...> methods_;
    world::Manoeuvre answer_;  ///< of the method that is asked at present
};

}  // namespace jink::avoid
