// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/work_units.hpp"
#include "core/path/prediction.hpp"
#include "core/world/method.hpp"
#include "core/world/separation.hpp"

/// Keeps the level velocity, and climbs or descends past whatever is in the way.
class VerticalEscape {
public:
    static constexpr jink::world::MethodTraits kTraits{
        .id = 4, .reactive = true, .keeps_clearance = false, .needs_sets = false};

    [[nodiscard]] jink::world::PlanStatus plan(const jink::world::Situation& situation, jink::WorkBudget& budget,
                                               jink::world::Manoeuvre& out) noexcept
    {
        using namespace jink;
        if (!world::is_complete(situation)) {
            return world::PlanStatus::bad_input;  // no reference, or threats that were never collected
        }
        constexpr Seconds kStep = 0.25F;
        const Seconds horizon = situation.rules.lookahead;
        const auto steps = static_cast<std::uint32_t>(horizon / kStep) + 3U;
        bool found = false;
        float best = 0.0F;  // margin to the nearest threat [m]; below 0: contact
        for (const float climb : {situation.limits.max_climb, -situation.limits.max_descent}) {
            const Vec3 command(situation.own.velocity.x(), situation.own.velocity.y(), climb);
            if (!budget.spend(steps * units::kCommandStep)) {
                return world::PlanStatus::budget_spent;
            }
            path::predict_velocity_command(situation.own, command, horizon, kStep, situation.limits, flight_);
            const float margin = world::least_separation(situation, flight_, horizon, budget).margin;
            if (budget.exhausted()) {
                return world::PlanStatus::budget_spent;  // never a guess
            }
            if (margin >= best) {
                best = margin;
                command_ = command;
                path_ = flight_.path;
                found = true;
            }
        }
        if (!found) {
            return world::PlanStatus::none_available;
        }
        out.kind = world::ManoeuvreKind::velocity;  // written only now
        out.start = situation.now;
        out.valid_until = situation.now + path_.duration();
        out.command = command_;
        out.side = Vec3::Zero();
        out.cost = 0.0F;
        out.path = path_;
        return world::PlanStatus::found;
    }

private:
    jink::path::Prediction flight_;  // about 4 KiB, not on the stack
    jink::path::TimedPath path_;
    jink::Vec3 command_ = jink::Vec3::Zero();
};
static_assert(jink::world::AvoidanceMethod<VerticalEscape>);
