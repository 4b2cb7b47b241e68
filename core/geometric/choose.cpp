// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/geometric/run.hpp"

// What candidates cost, and which is taken.

namespace jink::geometric::detail {

using world::PlanStatus;

bool Run::can_be_flown(const CandidateShape& shape) const noexcept
{
    return shape.family == Family::wait
               ? is_wait_flyable(shape)
               : is_flyable(curve_, vehicle::clamped_velocity(along_, problem_.speed, limits_), base_.rejoin, limits_);
}

bool Run::evaluate(Candidate& candidate, WorkBudget& budget) noexcept
{
    if (!budget.spend(units_of_curve())) {
        candidate.status = CandidateStatus::not_evaluated;
        return false;
    }
    build(candidate.shape);
    candidate.duration = curve_.duration();
    if (settings_.check_acceleration && !can_be_flown(candidate.shape)) {
        candidate.status = CandidateStatus::not_flyable;
        return true;
    }
    candidate.status = CandidateStatus::available;  // for all that is known without evaluate_all
    if (settings_.evaluate_all) {
        const Verdict verdict = clearance_.check(curve_, budget);
        candidate.status = verdict.status;
        candidate.hit = verdict.hit;
    }
    if (candidate.status == CandidateStatus::available && !budget.spend(units_of_costs())) {
        candidate.status = CandidateStatus::not_evaluated;
    }
    if (candidate.status == CandidateStatus::available) {
        assess(candidate);
    }
    return candidate.status != CandidateStatus::not_evaluated;
}

float Run::smoothness_of(const CandidateShape& shape) const noexcept
{
    if (shape.family == Family::wait) {
        return 0.0F;
    }
    const UnitCurve& unit = unit_[static_cast<std::size_t>(shape.family)];
    const cost::tables::Tables* const tables = settings_.tables;
    if (tables != nullptr && tables->waypoints == unit.points &&
        settings_.smoothness == cost::SmoothnessMethod::curvature) {
        const std::optional<float> known =
            cost::tables::smoothness(*tables, static_cast<std::size_t>(shape.family), shape.offset, scale_of(problem_));
        if (known) {
            return *known;
        }
    }
    Coordinates y;
    for (std::size_t i = 0; i < unit.points; ++i) {
        y[i] = std::abs(shape.offset) * unit.f[i];
    }
    return cost::smoothness(scale_of(problem_) * unit.step, {y.data(), unit.points}, settings_.smoothness);
}

cost::Waypoints Run::waypoints() const noexcept
{
    const auto all = [this](const Coordinates& c) { return std::span<const float>(c.data(), curve_.points); };
    return {all(curve_.x), all(curve_.y), all(curve_.z), all(curve_.t)};
}

float Run::closeness() const noexcept
{
    std::array<float, kMaxMoving> per_threat{};
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        const world::Threat& threat = problem_.threats[moving_[i]];
        const AtStart start = about_start(threat);
        const bool is_solid = threat.form == world::ThreatForm::solid;
        per_threat[i] = cost::closeness(waypoints(), start.motion, start.growth.radius, settings_.closeness,
                                        is_solid ? longest_ : clearance_.sweep_end(threat));
    }
    return cost::combined_closeness({per_threat.data(), moving_.size()});
}

float Run::passing() const noexcept
{
    cost::PassingMean mean;
    for (const std::uint16_t index : moving_) {
        const AtStart start = about_start(problem_.threats[index]);
        mean.add(cost::passing(waypoints(), start.motion, start.growth.radius));
    }
    return mean.value();
}

void Run::assess(Candidate& candidate) noexcept
{
    cost::Terms& terms = candidate.terms;
    terms.time = curve_.duration();
    terms.smoothness = smoothness_of(candidate.shape);
    terms.smoothness_penalised =
        cost::penalised_smoothness(terms.smoothness, candidate.sin_alpha, settings_.rotation_penalty);
    terms.closeness = closeness();
    if (settings_.weights.passing > 0.0F || settings_.all_terms) {
        terms.passing = passing();
    }
    if (settings_.weights.beyond > 0.0F || settings_.all_terms) {
        terms.beyond = cost::time_beyond(waypoints(), along_, problem_.distance);
    }
    if (settings_.all_terms) {
        to_timed_path(curve_, Vec3::Zero(), path_);
        terms.energy = cost::energy(path_, airframe_);
        terms.hover_power = cost::hover_power(path_, airframe_);
    }
    candidate.total = std::min(cost::total(cost::normalise(terms, settings_.caps), settings_.weights), 1.0F);
    if (problem_.preferred_side == Vec3::Zero() || candidate.shape.family == Family::wait) {
        return;
    }
    const float sign = std::copysign(1.0F, candidate.shape.offset);
    constexpr float kOtherSide = -1e-3F;  // a plane at right angles to what is flown is on neither side
    candidate.flip_penalty =
        sign * side_of(candidate.shape).dot(problem_.preferred_side) < kOtherSide ? settings_.flip_penalty : 0.0F;
}

void Run::take(std::size_t index) noexcept
{
    Candidate& best = result_.candidates[index];
    best.status = CandidateStatus::chosen;
    result_.chosen = index;
    result_.side = best.shape.family == Family::wait
                       ? Vec3(Vec3::Zero())
                       : Vec3(std::copysign(1.0F, best.shape.offset) * side_of(best.shape));
    result_.path = path_;
    for (path::PathPoint& point : result_.path.points) {
        point.position += problem_.frame.origin;
    }
}

PlanStatus Run::choose() noexcept
{
    for (std::size_t i = 0; i < result_.candidates.size(); ++i) {
        Candidate& candidate = result_.candidates[i];
        if (candidate.status != CandidateStatus::available) {
            continue;
        }
        if (candidate.total <= settings_.max_cost) {
            order_.unchecked_push_back(static_cast<std::uint16_t>(i));
        } else if (!settings_.evaluate_all) {
            candidate.status = CandidateStatus::not_evaluated;
        }
    }
    std::make_heap(order_.begin(), order_.end(), by_cost());
    WorkBudget checks = budget_.part(units_of_checks());
    const bool is_short = checks.left() < units_of_checks();
    const bool found = try_in_turn(checks);
    budget_.charge(checks);
    result_.cut_short = spent_ || checks.exhausted();
    if (found) {
        return PlanStatus::found;
    }
    return spent_ || (checks.exhausted() && is_short) ? PlanStatus::budget_spent : PlanStatus::none_available;
}

/// The candidates of order_, cheapest first, until one is clear. Those that are not reached are not evaluated.
bool Run::try_in_turn(WorkBudget& budget) noexcept
{
    bool found = false;
    while (!order_.empty()) {
        std::pop_heap(order_.begin(), order_.end(), by_cost());
        const std::size_t index = order_.back();
        order_.pop_back();
        Candidate& candidate = result_.candidates[index];
        if (found || budget.exhausted()) {
            candidate.status = found && settings_.evaluate_all ? candidate.status : CandidateStatus::not_evaluated;
            continue;
        }
        const Verdict verdict = verdict_of(candidate.shape, budget);
        candidate.status = verdict.status;
        candidate.hit = verdict.hit;
        if (verdict.status == CandidateStatus::available) {
            take(index);
            found = true;
        }
    }
    return found;
}

/// Of a candidate as a curve, where that is not known yet, and in flight. Its path is in path_ where it is available.
Verdict Run::verdict_of(const CandidateShape& shape, WorkBudget& budget) noexcept
{
    if (!budget.spend(units_of_curve())) {
        return {CandidateStatus::not_evaluated, {}};
    }
    build(shape);
    const Verdict curve = settings_.evaluate_all ? Verdict{} : clearance_.check(curve_, budget, Clearance::Part::near);
    if (curve.status != CandidateStatus::available) {
        return curve;
    }
    to_timed_path(curve_, Vec3::Zero(), path_);
    const Verdict flight = settings_.verify_flight ? flown_.judge(path_, longest_, budget) : Verdict{};
    if (flight.status != CandidateStatus::available || settings_.evaluate_all) {
        return flight;
    }
    const Verdict far = clearance_.check(curve_, budget, Clearance::Part::deferred);
    return far.status == CandidateStatus::available && settings_.verify_flight ? flown_.judge_deferred(budget) : far;
}

}  // namespace jink::geometric::detail
