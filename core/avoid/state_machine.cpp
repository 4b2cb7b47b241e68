// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "core/avoid/common_stop.hpp"
#include "core/avoid/tick.hpp"

namespace jink::avoid {
namespace {

/// Slower than this, a conflict lies too near for a plan around it [m/s].
constexpr float kCreeping = 1.5F;
/// Share of the fallback horizon that is left for getting out of traffic's way: sooner, the fallback sees no need to.
constexpr float kGetGoing = 0.75F;
/// What is expected of the check of an answer, and of the search for a fallback where one is near [work units].
constexpr std::uint32_t kCheckUnits = 600;
constexpr std::uint32_t kFallbackUnits = 8000;
constexpr std::uint32_t kUnitsPerThreat = 500;

}  // namespace

bool StateMachine::configure(const Settings& settings) noexcept
{
    if (!is_valid(settings)) {
        return false;
    }
    settings_ = settings;
    drop_plan();
    return true;
}

void StateMachine::reset() noexcept
{
    drop_plan();
    enter(Phase::watching);
    control_since_.reset();
    clear_since_.reset();
    free_since_.reset();
    commanded_.reset();
    fallback_.reset();
    flying_.reset();
    conflict_on_ = conflict_on_ == ConflictOn::other ? ConflictOn::first : conflict_on_;
    backed_off_ = 0.0F;
}

void StateMachine::enter(Phase next) noexcept
{
    if (next == phase_) {
        return;
    }
    transitions_ |= transition_bit({phase_, next});
    phase_ = next;
    if (next != Phase::braking) {
        fallback_.reset();
        standing_since_.reset();
    }
}

/// Control that ends while it is wanted resets the state machine.
void StateMachine::update_control(TimePoint now, bool in_control) noexcept
{
    if (in_control) {
        control_since_ = control_since_.value_or(now);
        return;
    }
    if (control_since_ && state() != State::watching) {
        ++diagnostics_.control_lost;
        reset();
    }
    control_since_.reset();
    enter(Phase::watching);
}

/// The beginning and the end of a conflict.
void StateMachine::update_conflict(const Tick& tick) noexcept
{
    const bool was_in_conflict = conflict_on_ != ConflictOn::none;
    diagnostics_.conflicts += tick.out.conflict && !was_in_conflict ? 1U : 0U;
    if (!tick.out.conflict && was_in_conflict) {
        backed_off_ = 0.0F;
    }
    const ConflictOn path = tick.out.on_other ? ConflictOn::other : ConflictOn::first;
    conflict_on_ = tick.out.conflict ? path : ConflictOn::none;
}

/// Since when the nominal path has been free of conflicts, and clear with something to spare.
void StateMachine::update_clearness(Tick& tick) noexcept
{
    if (tick.out.conflict) {
        free_since_.reset();
        clear_since_.reset();
        return;
    }
    free_since_ = free_since_.value_or(tick.s.now);
    const Inflated inflated(tick.s, settings_.clear_extra);
    world::Conflict unused;
    if (world::main_conflict(inflated.situation, tick.nominal, tick.s.rules.lookahead, tick.budget, unused)) {
        clear_since_.reset();
    } else {
        clear_since_ = clear_since_.value_or(tick.s.now);
    }
}

bool StateMachine::is_clear_for(const Tick& tick, Seconds span) const noexcept
{
    return clear_since_ && tick.s.now - *clear_since_ >= span;
}

/// Tracks get better and threats come nearer: what lies further ahead is planned for when it is known better.
bool StateMachine::is_due(const Tick& tick, Seconds time_to_loss) const noexcept
{
    return time_to_loss <= settings_.commit || is_urgent(tick, time_to_loss);
}

/// The time before the loss of separation at which the vehicle has to stop; or to get going, where it as good as stands
/// in the way of traffic: stopping mends nothing then.
Seconds StateMachine::latest_manoeuvre_time(const Tick& tick) const noexcept
{
    const bool stays = tick.nominal.length <= settings_.on_leg || tick.nominal.speed < kCreeping;
    const bool traffic = tick.out.conflict && is_traffic(*tick.out.conflict);
    const Seconds stop = time_to_stop(tick.s, settings_);
    return stays && traffic ? std::max(stop, kGetGoing * settings_.fallback_horizon) : stop;
}

bool StateMachine::is_urgent(const Tick& tick, Seconds time_to_loss) const noexcept
{
    return time_to_loss <= latest_manoeuvre_time(tick);
}

/// What planning may spend in this update: its slice, and of the mandatory units what a check and a fallback are not
/// expected to need.
std::uint32_t StateMachine::units_for_planning(const Tick& tick) const noexcept
{
    const bool near =
        phase_ == Phase::braking || (tick.out.conflict && is_urgent(tick, tick.out.conflict->time_to_loss));
    const auto threats = static_cast<std::uint32_t>(tick.s.threats.size());
    const std::uint32_t kept = (near ? kFallbackUnits : kCheckUnits) + kUnitsPerThreat * threats;
    return tick.slice + (tick.budget.left() > kept ? tick.budget.left() - kept : 0);
}

/// Takes what planning has spent, out of its slice first.
void StateMachine::charge_planning(Tick& tick, std::uint32_t units) noexcept
{
    const std::uint32_t of_slice = std::min(units, tick.slice);
    tick.slice -= of_slice;
    static_cast<void>(tick.budget.spend(units - of_slice));  // never more than was left
}

world::PlanStatus StateMachine::plan_at_once(Tick& tick, const Settings& settings, Choice& choice) noexcept
{
    const Inflated inflated(tick.s, tick.s.rules.clearance);
    WorkBudget budget(std::min(settings.plan_budget, units_for_planning(tick)));
    const world::PlanStatus status = tick.planning.plan(tick.planning.self, {inflated.situation, tick.s}, settings,
                                                        budget, diagnostics_, answer_, choice);
    tick.ran_out = tick.ran_out || budget.exhausted();
    charge_planning(tick, budget.spent());
    return status;
}

/// Goes on with the plan that has begun, or begins one: once an update. Who is in a hurry takes the best answer that
/// there is so far. An answer was checked against what was known when its plan began, and counts once it is checked
/// against what is known now.
world::PlanStatus StateMachine::plan_a_slice(Tick& tick, const Settings& settings, bool hurries,
                                             Choice& choice) noexcept
{
    const bool begins = !tick.planned && !sliced_->runs();
    if (tick.planned && tick.out.plan_status != world::PlanStatus::running) {
        choice = {tick.out.margin, tick.out.cost, tick.out.answers};
        return tick.out.plan_status;
    }
    if (begins) {
        sliced_->begin(tick.s, tick.planning, settings, diagnostics_);
    }
    if (!tick.planned) {
        static_cast<void>(sliced_->advance(units_for_planning(tick)));
        charge_planning(tick, sliced_->spent());
    }
    if (sliced_->runs()) {
        if (!hurries || sliced_->choice().answers == 0) {
            return world::PlanStatus::running;
        }
        sliced_->drop();
    } else {
        tick.ran_out = tick.ran_out || sliced_->ran_out();
        if (sliced_->status() != world::PlanStatus::found) {
            return sliced_->status();
        }
    }
    answer_ = sliced_->answer();
    choice = sliced_->choice();
    choice.margin = begins ? choice.margin : check_manoeuvre(tick.s, answer_, settings_, tick.budget).margin;
    if (!(choice.margin >= 0.0F)) {
        ++diagnostics_.answers_rejected;
        return world::PlanStatus::none_available;
    }
    return world::PlanStatus::found;
}

/// The methods that are asked for an answer here. A velocity shares the way with traffic. To something that stays it
/// leads up and waits in front of it: there such a method is asked only where the order has no other.
MethodOrder StateMachine::order_for(const Tick& tick) const noexcept
{
    const MethodOrder& order = settings_.order.empty() ? tick.planning.all : settings_.order;
    if (!tick.out.conflict || is_traffic(*tick.out.conflict)) {
        return order;
    }
    const MethodOrder planners = order.within(tick.planning.planners);
    return planners.empty() ? order : planners;
}

/// Asks the methods for an answer; or one of them alone. `hurries`: any answer is better than none.
bool StateMachine::plan(Tick& tick, bool hurries, std::uint8_t only) noexcept
{
    Settings settings = settings_;
    settings.order = order_for(tick);
    if (settings.order.contains(only)) {
        settings.order = MethodOrder(only);
    }
    Choice choice;
    tick.out.plan_status =
        sliced_ != nullptr ? plan_a_slice(tick, settings, hurries, choice) : plan_at_once(tick, settings, choice);
    tick.planned = true;
    const bool found = tick.out.plan_status == world::PlanStatus::found;
    if (found) {
        ++diagnostics_.plans_found;
        tick.out.margin = choice.margin;
        tick.out.answers = choice.answers;
        tick.out.cost = choice.cost;
    }
    return found;
}

void StateMachine::drop_plan() noexcept
{
    if (sliced_ != nullptr) {
        sliced_->drop();
    }
}

void StateMachine::watch(Tick& tick) noexcept
{
    if (stays_given_up(tick)) {
        return;
    }
    if (tick.in_control && phase_ != Phase::giving_back) {
        // In control, whether the conflict is still there or not: rejoining alone gives control back.
        enter(Phase::rejoining);
        rejoin(tick);
        return;
    }
    if (!tick.out.conflict) {
        if (tick.in_control) {
            // Being given back: keep to the leg meanwhile.
            follow_nominal(tick);
            const bool off = cross_track(tick.s) > 2.0F * settings_.on_leg &&
                             !is_held_by_bounds(tick.s, tick.removed, tick.out.velocity, settings_.on_leg);
            tick.out.wants_control = off || !leaves_stop(tick, settings_.reserve);
            if (tick.out.wants_control) {
                control_since_ = tick.s.now;
                enter(Phase::rejoining);
            }
            return;
        }
        if (is_clear_for(tick, settings_.settle)) {
            flying_.reset();
        }
        fallback_.reset();
        tick.out.wants_control = !leaves_stop(tick, settings_.reserve);
        return;
    }
    if (tick.in_control) {
        control_since_ = tick.s.now;
        enter(Phase::rejoining);
        rejoin(tick);
        return;
    }
    const Seconds left = tick.out.conflict->time_to_loss;
    if (is_due(tick, left) && plan(tick, is_urgent(tick, left))) {
        take(tick);
    } else if (is_urgent(tick, left)) {
        fall_back(tick);
    }
}

void StateMachine::run_phase(Tick& tick) noexcept
{
    switch (phase_) {
    case Phase::watching:
    case Phase::giving_back:
    case Phase::given_up: watch(tick); break;
    case Phase::avoiding: avoid(tick); break;
    case Phase::rejoining:
    case Phase::parallel_offset: rejoin(tick); break;
    case Phase::braking: brake(tick); break;
    }
}

/// Two vehicles that avoid each other can always stop together: a command that would take that away is slowed down.
void StateMachine::keep_stoppable(Tick& tick) noexcept
{
    const bool steers = tick.in_control && tick.out.wants_control;
    const bool rises = held_back_ && tick.s.commanded != nullptr;
    held_back_ = false;
    if (!steers) {
        return;
    }
    const float fastest =
        rises ? tick.s.commanded->velocity.norm() + tick.s.limits.max_acceleration * (tick.s.now - tick.s.commanded->at)
              : std::numeric_limits<float>::infinity();
    const bool evades = phase_ == Phase::avoiding || phase_ == Phase::braking;
    const Vec3 command = stoppable_command(tick.s, tick.out.velocity, fastest, tick.budget, evades);
    held_back_ = command != tick.out.velocity;
    diagnostics_.held_back += held_back_ ? 1U : 0U;
    tick.out.velocity = command;
}

Guidance StateMachine::update(const world::Situation& given, const world::Reference* other, bool in_control,
                              const Planning& planning) noexcept
{
    ++diagnostics_.updates;
    transitions_ = 0;
    update_control(given.now, in_control);
    world::Situation first = given;
    if (!world::is_valid(given.rules)) {
        first.threats = {};  // nothing is known to be clear
    }
    first.flying = flying();
    first.commanded = in_control && commanded_ ? &*commanded_ : nullptr;
    const world::Situation second = world::with_reference(first, other != nullptr ? *other : given.reference);
    const world::Situation* const with_other = other != nullptr ? &second : nullptr;
    Tick both{first,
              with_other,
              in_control,
              planning,
              WorkBudget(settings_.work.all - settings_.work.slice),
              settings_.work.slice,
              world::way_of(first),
              {}};
    choose_nominal(both);
    Tick tick{both.out.on_other ? second : first,
              with_other,
              in_control,
              planning,
              both.budget,
              both.slice,
              both.nominal,
              both.out};
    if (flying_) {
        const Vec3 off = parallel_offset(tick.s).off;
        const float far = off.norm();
        if (far > settings_.on_leg) {
            flying_->side = off / far;
        }
    }
    const bool has_to_give_way = see_aircraft(tick);
    update_conflict(tick);
    update_clearness(tick);
    if (!has_to_give_way || !give_way(tick)) {
        run_phase(tick);
    }
    give_up_when_blocked(tick);
    keep_stoppable(tick);
    if (!tick.planned) {
        drop_plan();
    }
    tick.out.state = state();
    tick.out.by = phase_ == Phase::avoiding || phase_ == Phase::watching ? tick.out.by : 0;
    tick.out.transitions = transitions_;
    tick.out.work = tick.budget.spent() + settings_.work.slice - tick.slice;
    last_update_ = given.now;
    commanded_.reset();
    if (in_control && tick.out.wants_control) {
        commanded_ = {tick.out.velocity, given.now};
    }
    diagnostics_.budget_spent += tick.budget.exhausted() || tick.ran_out ? 1U : 0U;
    diagnostics_.most_work = std::max(diagnostics_.most_work, tick.out.work);
    return tick.out;
}

}  // namespace jink::avoid
