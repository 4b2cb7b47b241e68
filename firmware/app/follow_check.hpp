// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/vehicle/vehicle.hpp"

namespace jink::app {

/// Tells from the own motion whether the vehicle follows the velocities that it is commanded.
///
/// A vehicle that follows changes its velocity towards the command. While the two differ by more than the tolerance,
/// a modest change is expected (kExpected of the configured acceleration, kMaxExpected at most); what is missing adds
/// up, and what exceeds it is taken off again. A second's worth of the expected change missing means: not followed.
/// Never within the first second: a gust may carry the vehicle away before it can answer. Where the change is expected
/// to go follows the command with a lag (kAnswer), as vehicles do: of commands that take turns faster than that, next
/// to nothing is expected, and their answer may come when the next one is there already.
///
/// Tolerance: the larger of kTolerance and kShare of the commanded speed. A vehicle that flies where it shall, only
/// more slowly (kSlow), counts as following: autopilots have speed limits of their own.
/// A command that differs by kTolerance at most is the same command. A vehicle that came closer to a command by
/// kTolerance than it was when the first one came, however often that has changed since, has kAllowance more for
/// another command: it first undoes what the command before asked for, after a dead time and with limited jerk. From
/// full acceleration to full braking this takes so long. A vehicle that ignores the first command is noticed 1 s after
/// the command differs from its motion (1.4 s where it was flown as commanded before), one that ignores a later command
/// after 1.4 s + kAllowance; where commands jump, or take turns with a stop, and gusts carry the vehicle about, within
/// 10 s. Of 100 000 flights in gusts of vehicles that answer with 2.5 m/s2 and a lag of 0.6 s after a dead time of
/// 0.3 s, or better, 1 is accused, and of 100 000 whose command goes and stops several times a second, none
/// (JINK_CASES=100000, tests/property/app/follow_check_property_test.cpp).
///
/// A fixed wing is commanded course and climb alone, so its speed is not compared. It needs the command first and then
/// time to roll in: kWingPatience seconds' worth may be missing.
///
/// Pure, O(1).
class FollowCheck {
public:
    /// Forgets what was missing: call while nothing is commanded.
    void reset() noexcept { *this = {}; }

    /// One tick under a command.
    ///
    /// @param asked     velocity commanded during the tick [m/s]
    /// @param velocity  own velocity, newest [m/s]
    /// @return true: not followed
    [[nodiscard]] bool update(const Vec3& asked, const Vec3& velocity, const vehicle::VehicleLimits& limits,
                              TimePoint now) noexcept;

    static constexpr float kTolerance = 1.0F;    ///< [m/s]
    static constexpr float kShare = 0.3F;        ///< [-]
    static constexpr float kSlow = 0.5F;         ///< [-]
    static constexpr float kExpected = 0.3F;     ///< [-]
    static constexpr float kMaxExpected = 1.5F;  ///< [m/s2]
    static constexpr Seconds kPatience = 1.0F;
    static constexpr Seconds kWingPatience = 2.5F;
    static constexpr Seconds kAllowance = 3.5F;
    static constexpr Seconds kAnswer = 0.25F;  ///< time constant

private:
    bool begun_ = false;
    Seconds commanded_ = 0.0F;
    TimePoint last_;
    Vec3 velocity_ = Vec3::Zero();
    float missing_ = 0.0F;           ///< change of velocity [m/s]
    Vec3 reference_ = Vec3::Zero();  ///< the command that is_proven_ is about
    Vec3 start_ = Vec3::Zero();      ///< the velocity from which the vehicle has to come closer to what is commanded
    Vec3 answer_ = Vec3::Zero();     ///< direction in which the velocity is expected to change by now
    bool is_proven_ = false;         ///< came closer by kTolerance
};

}  // namespace jink::app
