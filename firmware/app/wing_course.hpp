// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "core/base/vec3.hpp"

namespace jink::app {

/// The command to send to a plane that is to turn back: which way round is decided once.
///
/// A course nearly opposite to the own one may come from either side from tick to tick, and the plane would turn to
/// neither. A command that lies more than 135 degrees off the own course is replaced by one 120 degrees off it: on the
/// side of the command sent before, where that was clearly on one (10 degrees), else on its own side. Speed and climb
/// stay.
///
/// @param command  [m/s], finite
/// @param own      own velocity [m/s]
/// @param sent     command sent before [m/s]
/// Pure, O(1).
[[nodiscard]] inline Vec3 wing_course(const Vec3& command, const Vec3& own, const Vec3& sent) noexcept
{
    constexpr float kReverse = -0.7071F;
    constexpr float kCos = -0.5F;
    constexpr float kSin = 0.8660F;
    constexpr float kClearly = 0.17F;
    const auto level = [](const Vec3& v) { return std::hypot(v.x(), v.y()); };
    const auto across = [&own](const Vec3& v) { return own.x() * v.y() - own.y() * v.x(); };
    const float speed = level(command);
    const float own_speed = level(own);
    const float along = own.x() * command.x() + own.y() * command.y();
    if (!(along < kReverse * speed * own_speed)) {
        return command;
    }
    const bool turns = std::abs(across(sent)) > kClearly * level(sent) * own_speed;
    const float side = across(turns ? sent : command) < 0.0F ? -1.0F : 1.0F;
    const Vec3 forward(own.x() / own_speed, own.y() / own_speed, 0.0F);
    const Vec3 left(-forward.y(), forward.x(), 0.0F);
    Vec3 course = speed * (kCos * forward + side * kSin * left);
    course.z() = command.z();
    return course;
}

}  // namespace jink::app
