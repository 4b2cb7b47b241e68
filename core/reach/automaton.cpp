// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/automaton.hpp"

#include <algorithm>

namespace jink::reach {

void MovementAutomaton::begin(const FlightState& at, TimePoint now) noexcept
{
    state_ = at;
    exit_ = {Movement::straight, at.speed};
    since_ = now;
    last_step_ = now;
    is_running_ = false;
    is_placed_ = true;
    planned_.clear();
}

PushStatus MovementAutomaton::judge(const Order& order) const noexcept
{
    return can_be_flown(settings_, order) ? PushStatus::taken : PushStatus::too_short;
}

PushStatus MovementAutomaton::push(const Order& order) noexcept
{
    PushStatus status = judge(order);
    if (status == PushStatus::taken && !planned_.try_push_back(order)) {
        status = PushStatus::full;
    }
    refused_ += status == PushStatus::taken ? 0U : 1U;
    return status;
}

PushStatus MovementAutomaton::replan(std::span<const Order> orders) noexcept
{
    PushStatus status = orders.size() > kMaxPlanned ? PushStatus::full : PushStatus::taken;
    for (std::size_t i = 0; i < orders.size() && status == PushStatus::taken; ++i) {
        status = judge(orders[i]);
    }
    if (status != PushStatus::taken) {
        refused_ += orders.size();
        return status;
    }
    planned_.clear();
    for (const Order& order : orders) {
        planned_.unchecked_push_back(order);
    }
    return status;
}

bool MovementAutomaton::begin_next() noexcept
{
    bool outside = false;
    if (!build_leg(settings_, *segments_, state_, exit_, planned_.front(), 0.0F, planned_.size() == 1, leg_, outside)) {
        return false;
    }
    outside_ += outside ? 1U : 0U;
    std::copy(planned_.begin() + 1, planned_.end(), planned_.begin());
    planned_.pop_back();
    is_running_ = true;
    return true;
}

void MovementAutomaton::finish() noexcept
{
    log_[logged_ % kMaxExecuted] = {leg_.order, since_};
    ++logged_;
    state_ = at(leg_, leg_.order.duration);
    exit_ = leg_.exit;
    since_ = since_ + leg_.order.duration;
    is_running_ = false;
}

StepStatus MovementAutomaton::step(TimePoint now) noexcept
{
    if (!is_usable(settings_)) {
        return StepStatus::not_usable;
    }
    if (now < last_step_) {
        return StepStatus::went_back;
    }
    last_step_ = now;
    // Each turn takes one order out of the plan, or ends.
    for (std::size_t turn = 0; turn <= kMaxPlanned; ++turn) {
        if (is_running_ && now <= since_ + leg_.order.duration) {
            return StepStatus::running;
        }
        if (is_running_) {
            finish();
        }
        if (!is_placed_ || planned_.empty()) {
            // At the very end nothing is late yet.
            is_placed_ = is_placed_ && now <= since_;
            return StepStatus::ran_dry;
        }
        if (!begin_next()) {
            is_placed_ = false;
            return StepStatus::refused;
        }
    }
    return StepStatus::running;
}

PredictStatus MovementAutomaton::trajectory(Trajectory& out) const noexcept
{
    if (!is_running_) {
        const std::size_t count = is_placed_ ? planned_.size() : 0;
        return predict(settings_, *segments_, state_, exit_, 0.0F, {planned_.data(), count}, out);
    }
    const FlightState after = at(leg_, leg_.order.duration);
    const PredictStatus status = predict(settings_, *segments_, after, leg_.exit, leg_.order.duration, planned(), out);
    out.start = leg_.from;
    out.begin = 0.0F;
    out.legs.resize(out.legs.size() + 1);
    std::copy_backward(out.legs.begin(), out.legs.end() - 1, out.legs.end());
    out.legs.front() = leg_;
    return status;
}

bool MovementAutomaton::project(TimePoint now, FlightState& out) const noexcept
{
    Trajectory all;
    trajectory(all);
    if (all.legs.empty()) {
        return false;
    }
    // Clocks count whole microseconds: within two of them past the end is at the end.
    constexpr float kTick = 2e-6F;
    const float t = now - since_;
    const float end = all.end();
    return reach::project(all, t > end && t <= end + kTick * (1.0F + end) ? end : t, out);
}

}  // namespace jink::reach
