// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/plane_steering.hpp"

#include <algorithm>
#include <cmath>

namespace jink::link::mavlink {

std::optional<Vec3> PlaneSteering::next(const Vec3& command, const Vec3& position, TimePoint now) noexcept
{
    const float speed = command.head<2>().norm();
    if (!is_finite(command) || !is_finite(position) || speed < kNoCourse) {
        return std::nullopt;
    }
    const Vec3 course(command.x() / speed, command.y() / speed, 0.0F);
    const bool turned = (course - course_).norm() >= kTurned;
    const bool changed = turned || std::abs(command.z() - climb_) >= kClimbChanged;
    if (has_sent_ && now - sent_ < (changed ? kPeriod : kRefresh)) {
        return std::nullopt;
    }
    has_sent_ = true;
    sent_ = now;
    course_ = course;
    climb_ = command.z();
    const float ahead = std::max(share_ * std::max(kAhead * speed, kMinAhead), kNearest);
    const float rise = std::clamp(kClimbTime * climb_, -kMaxClimb, kMaxClimb);
    return position + ahead * course + Vec3(0.0F, 0.0F, rise);
}

void PlaneSteering::note_refusal() noexcept
{
    constexpr float kMinShare = 1.0F / 16.0F;
    share_ = std::max(0.5F * share_, kMinShare);
    has_sent_ = false;
}

}  // namespace jink::link::mavlink
