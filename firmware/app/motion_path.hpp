// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/world.hpp"

namespace jink::app {

/// Where measured motion leads: straight on at the present velocity; where the vehicle turns, an arc of half a turn,
/// or legs where it climbs or descends as well, then straight on; below kStanding, it stays where it is. 270 bytes.
class MotionPath {
public:
    static constexpr float kStanding = 0.5F;  ///< slower motion is taken for standing [m/s]
    static constexpr Seconds kAhead = 60.0F;  ///< the motion goes on for so long [s]

    MotionPath() = default;
    MotionPath(const MotionPath&) = delete;  // the reference may refer to the route beside it
    MotionPath& operator=(const MotionPath&) = delete;

    /// @param turn_rate  counter-clockwise; 0: flies straight [rad/s]
    /// O(1).
    void extrapolate(const vehicle::VehicleState& own, float turn_rate, const vehicle::VehicleLimits& limits) noexcept;
    /// Stays at `place`.
    void stay(const Vec3& place, const vehicle::VehicleLimits& limits) noexcept;
    void copy_from(const MotionPath& other) noexcept;
    /// A turn may come near to itself: what was flown of it is not flown again. O(segments).
    void progress_to(const Vec3& position) noexcept;

    /// Valid until the next change.
    [[nodiscard]] const world::Reference& reference() const noexcept { return reference_; }

private:
    [[nodiscard]] bool add_turn(const vehicle::VehicleState& own, float turn_rate) noexcept;

    world::Reference reference_;
    path::Route route_;  ///< that the reference follows; empty where the reference holds a leg
};

}  // namespace jink::app
