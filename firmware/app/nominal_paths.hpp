// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "core/base/static_vector.hpp"
#include "core/world/world.hpp"

namespace jink::app {

/// Where the vehicle is expected to fly: the intended path, which is the leg that the link reports, and the measured
/// motion. A conflict on either counts (avoid::Supervisor).
///
/// Measured motion: straight on at the present velocity; where the vehicle turns, an arc at the turn rate of the last
/// second, half a turn at most, then straight on; below kStanding, it stays where it is.
///
/// The leg is believed until the motion contradicts it for kContradicted: faster than kMoving, and away from the leg,
/// or neither along it nor back to it. It is believed again once the motion has agreed with it for kAgreed, or when
/// another leg is reported. A vehicle that stands, or turns within kCornerTime of the leg's end, contradicts nothing.
///
/// Speed along the leg: the mission's where the link reports it; else the last steady speed that was measured along a
/// leg; else the cruise parameter. When the vehicle now flies steadily along the leg at another speed, that is taken; a
/// greater speed always is. So the intended path says where the vehicle would be at the speed that it is going to have,
/// from rest or out of a corner too, and the measured motion where it would be at the one that it has.
///
/// Turn rate: least squares over the angles between successive samples of the level velocity (direction_angle of their
/// cross and dot product). Accuracy against double precision: 1e-5 rad/s, while the ground speed stays above kMoving;
/// 0 otherwise. No function of the C library but the square root, so every target has the same paths to the bit.
///
/// From a take-over on the measured motion as it was then is kept: control is given back along the path that the
/// conflict was on. Of motion slower than kMoving and half the cruise speed the place alone is kept. 1 KiB. O(samples)
/// per update.
class NominalPaths {
public:
    static constexpr float kMoving = 1.0F;          ///< slower motion contradicts no leg and leads nowhere [m/s]
    static constexpr float kStanding = 0.5F;        ///< slower motion is taken for standing [m/s]
    static constexpr Seconds kContradicted = 1.5F;  ///< [s]
    static constexpr Seconds kAgreed = 1.0F;        ///< [s]
    static constexpr Seconds kCornerTime = 2.0F;    ///< of flight before the end of the leg [s]
    static constexpr float kMinTurn = 0.06F;        ///< a slower turn is noise: 3 m off after 5 s at 5 m/s [rad/s]
    static constexpr Seconds kWindow = 1.0F;        ///< of the turn rate and of what is steady [s]
    static constexpr Seconds kAhead = 60.0F;        ///< the measured motion goes on for so long [s]

    NominalPaths() = default;
    NominalPaths(const NominalPaths&) = delete;
    NominalPaths& operator=(const NominalPaths&) = delete;

    /// @param measured    the newest own state, as measured
    /// @param own         the same carried forward to now
    /// @param leg         as reported, speed 0: not said; null: none is known
    /// @param in_control  the vehicle follows our commands: its motion says nothing of where the autopilot goes
    void update(const vehicle::VehicleState& measured, const vehicle::VehicleState& own, const world::Leg* leg,
                const vehicle::VehicleLimits& limits, bool in_control) noexcept;
    /// What the supervisor made of them: which one the conflict was on, and whether the other one is in the way of
    /// giving back control.
    void note(bool has_conflict, bool on_other, bool other_conflict) noexcept;
    /// The frame jumped, or own state comes from elsewhere.
    void reset() noexcept;

    /// The path that is flown in control. Valid until the next update.
    [[nodiscard]] const world::Reference& primary() const noexcept { return on_motion_ ? motion() : intended_; }
    /// The primary path is the leg that the link reports; otherwise it is the measured motion.
    [[nodiscard]] bool is_intended() const noexcept { return !on_motion_; }
    /// The other one; null where there is none.
    [[nodiscard]] const world::Reference* other() const noexcept;
    [[nodiscard]] bool believes_leg() const noexcept { return has_leg_ && believed_; }
    [[nodiscard]] float turn_rate() const noexcept
    {
        return turn_rate_;
    }  ///< counter-clockwise; 0: flies straight [rad/s]
    [[nodiscard]] std::uint32_t legs_doubted() const noexcept { return doubted_; }

private:
    struct Sample {
        TimePoint at;
        float turned = 0.0F;           ///< since the sample before, counter-clockwise [rad]
        Vec3 velocity = Vec3::Zero();  ///< [m/s]
    };
    /// A reference, and the route that it follows where the vehicle turns; empty where the reference holds a leg.
    struct Motion {
        world::Reference reference;
        path::Route route;

        void copy_from(const Motion& other) noexcept;
    };
    static constexpr std::size_t kSamples = 12;

    void sample(const vehicle::VehicleState& measured) noexcept;
    void estimate() noexcept;
    void take_leg(const world::Leg* leg) noexcept;
    void judge_leg(const vehicle::VehicleState& own) noexcept;
    void intend(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits, bool in_control) noexcept;
    void extrapolate(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits) noexcept;
    void keep(const vehicle::VehicleLimits& limits) noexcept;
    void progress(const vehicle::VehicleState& own) noexcept;
    [[nodiscard]] bool add_turn(const vehicle::VehicleState& own) noexcept;
    [[nodiscard]] const world::Reference& motion() const noexcept
    {
        return in_control_ ? kept_.reference : live_.reference;
    }

    StaticVector<Sample, kSamples> samples_;
    float turn_rate_ = 0.0F;
    float steady_now_ = 0.0F;  ///< [m/s]; 0: speed or direction change
    float steady_leg_ = 0.0F;  ///< the last steady speed along a leg; 0: not measured yet
    world::Leg leg_;
    bool has_leg_ = false;
    bool believed_ = true;
    Seconds disagreeing_ = 0.0F;
    Seconds agreeing_ = 0.0F;
    TimePoint judged_;
    bool in_control_ = false;
    bool on_motion_ = true;  ///< the primary one
    bool was_on_motion_ = false;
    bool outdated_ = false;  ///< what is kept: the frame has jumped
    std::uint32_t doubted_ = 0;
    world::Reference intended_;
    Motion live_;
    Motion kept_;
};

}  // namespace jink::app
