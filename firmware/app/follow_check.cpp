// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/follow_check.hpp"

#include <algorithm>

namespace jink::app {
namespace {

/// Ticks longer than this are stalls, in which nobody knows what was flown [s].
constexpr Seconds kLongestTick = 0.1F;
constexpr float kTiny = 1e-3F;

bool is_followed(const Vec3& command, const Vec3& velocity) noexcept
{
    const float speed = command.norm();
    const float tolerance = std::max(FollowCheck::kTolerance, FollowCheck::kShare * speed);
    if ((command - velocity).norm() <= tolerance) {
        return true;
    }
    if (speed <= FollowCheck::kTolerance) {
        return false;
    }
    const Vec3 direction = command / speed;
    const float along = velocity.dot(direction);
    return along >= FollowCheck::kSlow * speed && along <= speed && (velocity - along * direction).norm() <= tolerance;
}

/// The command's course and climb at the speed that is flown. Non-finite where the command is.
Vec3 at_speed_of(const Vec3& velocity, const Vec3& command) noexcept
{
    const float speed = command.head<2>().norm();
    if (speed <= FollowCheck::kTolerance) {
        return command;
    }
    const float share = velocity.head<2>().norm() / speed;
    return {command.x() * share, command.y() * share, command.z()};
}

}  // namespace

bool FollowCheck::update(const Vec3& asked, const Vec3& velocity, const vehicle::VehicleLimits& limits,
                         TimePoint now) noexcept
{
    const bool wing = limits.kind == vehicle::VehicleKind::fixed_wing;
    const Vec3 command = wing ? at_speed_of(velocity, asked) : asked;
    const Seconds dt = std::clamp(now - last_, 0.0F, kLongestTick);
    const Vec3 change = velocity - velocity_;
    last_ = now;
    velocity_ = velocity;
    if (!begun_ || !is_finite(command) || !is_finite(velocity)) {
        begun_ = is_finite(velocity) && is_finite(command);
        commanded_ = 0.0F;
        reference_ = command;
        start_ = velocity;
        return false;
    }
    const bool is_first = commanded_ == 0.0F;
    commanded_ += dt;
    const float expected = std::min(kExpected * limits.max_acceleration, kMaxExpected);
    const Vec3 error = command - (velocity - change);
    if ((command - reference_).norm() > kTolerance) {
        // What the command before asked for still goes on for a while.
        missing_ = is_proven_ ? -expected * kAllowance : missing_;
        start_ = is_proven_ ? velocity : start_;
        is_proven_ = false;
        reference_ = command;
    }
    is_proven_ = is_proven_ || (command - start_).norm() - (command - velocity).norm() >= kTolerance;
    const bool followed = is_followed(command, velocity);
    const Vec3 direction = followed ? Vec3(Vec3::Zero()) : Vec3(error / std::max(error.norm(), kTiny));
    answer_ = is_first ? direction : Vec3(answer_ + dt / (kAnswer + dt) * (direction - answer_));
    const float answered = change.dot(answer_);
    const float towards = wing ? std::max(answered, 0.0F) : answered;  // rolling out of a turn goes the wrong way
    const float due = followed ? -expected * dt : expected * answer_.squaredNorm() * dt - towards;
    missing_ = std::max(missing_ + due, std::min(missing_, 0.0F));
    const Seconds patience = wing ? kWingPatience : kPatience;
    return !followed && missing_ >= expected * patience && commanded_ >= patience;
}

}  // namespace jink::app
