// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/decision.hpp"

#include <algorithm>

#include "core/base/work_units.hpp"
#include "core/reach/scan_picture.hpp"

namespace jink::app {
namespace {

/// What a plan by reach sets takes more where they see by a scan, at most; that is for computers that have LiDARs. A
/// vehicle that hardly moves lays the scan over each of its courses.
constexpr auto kScanUnits =
    static_cast<std::uint32_t>(reach::Planner::kHeadings * units::kReachScanCell * reach::ScanPicture::kRatedCells);

/// Of a step, for the way past the obstacles: among houses it takes about twenty steps.
constexpr std::uint32_t kWayUnits = 20'000;

}  // namespace

avoid::Settings Decision::supervisor_settings(const Configuration& c) const noexcept
{
    avoid::Settings settings = c.supervisor;
    settings.work = work_;
    if (leaves_reach_out_ || c.reach_unsuited) {
        settings.order = without_sets(settings.order);
    }
    if (sight_ != nullptr) {
        // Laying a scan over a set would take most of what a plan may, and a way through clutter takes more than the
        // rest: reach sets have a whole plan's units to themselves, and the checks and fallbacks keep theirs.
        const std::uint32_t more = kScanUnits + settings.plan_budget;
        settings.kept_for_next = more;
        settings.plan_budget += more;
        settings.work.slice += more;
        settings.work.all += more;
    }
    return settings;
}

avoid::Guidance Decision::update(const DecisionInput& input, const Configuration& c) noexcept
{
    const vehicle::VehicleLimits limits = vehicle::limits_in_flight(c.limits, input.own.velocity);
    nominal_.update(input.measured, input.own, input.leg, limits, input.in_control);
    world::Situation situation{input.now, input.own, limits, c.airframe, nominal_.primary(), c.rules};
    situation.own_id = input.own_track;
    static_cast<void>(threats_.collect(situation, input.around));
    situation.threats = threats_.all();
    if (sight_ != nullptr) {
        situation.cost_to_go = &sight_->way_of(situation, supervisor_.plan_runs());
    }
    const avoid::Guidance guidance = supervisor_.update(situation, input.in_control, nominal_.other());
    nominal_.note(guidance.conflict.has_value(), guidance.on_other);
    return guidance;
}

Progress Decision::advance_background(std::uint32_t spent, const Configuration& c) noexcept
{
    static_assert(BackgroundService<reach::TableCheck>);
    if (sight_ != nullptr && supervisor_.settings().work.all > spent) {
        const std::uint32_t left = supervisor_.settings().work.all - spent;
        WorkBudget budget(std::min(left, kWayUnits));
        sight_->advance(budget);
        spent += budget.spent();
    }
    Progress progress = Progress::running;
    methods_.with_planner<ReachMethod>([&](const reach::Planner& planner) {
        const reach::VehicleSets* const sets = planner.settings().sets;
        if (sets == nullptr || leaves_reach_out_) {
            return;
        }
        if (!tables_ || &tables_->sets() != sets) {
            tables_.emplace(*sets);
        }
        const std::uint32_t units = tables_->units_of_next();
        if (supervisor_.settings().work.all < spent + units) {
            return;
        }
        WorkBudget budget(units);
        progress = tables_->advance(budget);
        if (progress == Progress::failed) {
            leave_out_reach_sets(c);
        }
    });
    return progress;
}

void Decision::reset() noexcept
{
    supervisor_.reset();
    nominal_.reset();
    if (sight_ != nullptr) {
        sight_->forget_way();
    }
}

void Decision::configure(const Configuration& c) noexcept
{
    supervisor_.drop_plan();
    methods_.configure(c);
    static_cast<void>(supervisor_.configure(supervisor_settings(c)));
}

bool Decision::plan_in_slices(avoid::SlicedPlan& plan, const avoid::WorkPerUpdate& work,
                              const Configuration& c) noexcept
{
    if (!avoid::is_valid(work)) {
        return false;
    }
    work_ = work;
    supervisor_.plan_in_slices(plan);
    return supervisor_.configure(supervisor_settings(c));
}

void Decision::leave_out_reach_sets(const Configuration& c) noexcept
{
    leaves_reach_out_ = true;
    static_cast<void>(supervisor_.configure(supervisor_settings(c)));
}

void Decision::let_reach_sets_see(Sight& sight, const Configuration& c) noexcept
{
    methods_.with_planner<ReachMethod>([&](reach::Planner& planner) {
        sight_ = &sight;
        planner.look_at(&sight.cells());
        static_cast<void>(supervisor_.configure(supervisor_settings(c)));
    });
}

}  // namespace jink::app
