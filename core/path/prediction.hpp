// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/path/follower.hpp"
#include "core/vehicle/motion.hpp"

// The predicted flight of the final check: set-points as the application sends them, and chords with a bound of the
// flight's distance from each.

namespace jink::path {

/// Default period of the application's set-points [s], at most (parameter JNK_RATE).
inline constexpr Seconds kSetpointPeriod = 0.05F;

/// Largest distance of a flight from the straight motion between two of its points [m].
struct Sagitta {
    float any = 0.0F;       ///< in any direction
    float vertical = 0.0F;  ///< up or down
};

/// A predicted flight. kMaxPathPoints * 36 bytes + 32.
struct Prediction {
    TimedPath path;
    StaticVector<Sagitta, kMaxPathPoints> sagittas;  ///< of the chord that begins at the point of the same index
    Vec3 velocity = Vec3::Zero();                    ///< at the last point [m/s]; the path holds the chord's
};

/// Writes a flight of the vehicle model into a Prediction, chord by chord.
///
/// While a command is held, the model's acceleration never grows. The sagitta of a chord of duration dt is at most
/// a dt^2 / 8, with a the greatest acceleration at the beginning of any of its parts.
class ChordWriter {
public:
    /// Continues `out`, or begins it with begin(). All outlive this.
    ChordWriter(const vehicle::VehicleLimits& limits, Prediction& out) noexcept
        : limits_(limits), out_(out), fading_(limits.velocity_lag),
          // Without a lag each velocity error decays at the acceleration limit.
          per_squared_lag_(limits.velocity_lag > kMinLag ? 1.0F / (limits.velocity_lag * limits.velocity_lag)
                                                         : 1.0F / (kMinLag * kMinLag))
    {
        if (!out.path.points.empty()) {
            position_ = out.path.points.back().position;
            velocity_ = out.velocity;
        }
    }
    ChordWriter(const ChordWriter&) = delete;
    ChordWriter& operator=(const ChordWriter&) = delete;

    /// Empties the Prediction but for the state, at time 0.
    void begin(const vehicle::VehicleState& state) noexcept
    {
        out_.path.points.clear();
        out_.sagittas.clear();
        out_.path.points.unchecked_push_back({state.position, state.velocity, 0.0F});
        out_.velocity = state.velocity;
        position_ = state.position;
        velocity_ = state.velocity;
    }

    /// A part of the next chord: `command` held for `dt` > 0. O(1).
    void fly(const Vec3& command, Seconds dt) noexcept;

    /// Ends the chord at `time`, later than the last point. The Prediction is not full. O(1).
    void end_chord(Seconds time) noexcept;

    [[nodiscard]] const Vec3& position() const noexcept { return position_; }
    [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }

private:
    static constexpr Seconds kMinLag = 1e-5F;

    /// `error`: of the velocity at the beginning of a part.
    void note_acceleration(const Vec3& error) noexcept
    {
        const float level = std::min((error.x() * error.x() + error.y() * error.y()) * per_squared_lag_,
                                     limits_.max_acceleration * limits_.max_acceleration);
        const float vertical = std::min(error.z() * error.z() * per_squared_lag_,
                                        limits_.max_vertical_acceleration * limits_.max_vertical_acceleration);
        squared_any_ = std::max(squared_any_, level + vertical);
        squared_vertical_ = std::max(squared_vertical_, vertical);
    }

    const vehicle::VehicleLimits& limits_;
    Prediction& out_;
    vehicle::detail::Fading fading_;
    float per_squared_lag_;  ///< [1/s2]
    float squared_any_ = 0.0F;
    float squared_vertical_ = 0.0F;
    Vec3 position_ = Vec3::Zero();
    Vec3 velocity_ = Vec3::Zero();
};

/// The predicted flight: `follow` at every kSetpointPeriod from `start` on, and the vehicle model in between, from
/// `state` (assumed to be at path time `start`). The last command is held until the first set-point at or after the end
/// of the path, so the flight is up to kSetpointPeriod longer than the rest of the path.
///
/// Chords are whole periods long: one, two, then `step` (at least one period), longer where the flight would have more
/// than `most` points (4..kMaxPathPoints). The first two are short because accuracy matters most where a threat is
/// already near. out.path.points[0] is the present position at time 0. If nothing of the path is left, one point
/// remains. Path not empty. Each chord is paid for before it is flown (units::kFlightPart a period); false, and what is
/// in `out` of no use, where the budget ends; at once, with nothing left, where kMaxSetpoints are ahead.
///
/// Exact but for rounding: 1e-4 m within 100 m of the origin. O(rest / kSetpointPeriod).
[[nodiscard]] bool predict_flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start,
                                  Seconds step, const vehicle::VehicleLimits& limits, const FollowerGains& gains,
                                  std::size_t most, WorkBudget& budget, Prediction& out) noexcept;

/// Set-points before the end of a path of which `rest` [s] is left; kMaxSetpoints at most.
inline constexpr std::uint32_t kMaxSetpoints = 1'000'000;
[[nodiscard]] std::uint32_t setpoints_of(Seconds rest) noexcept;

/// The flight from `state` while `command` is held for `horizon` > 0 seconds; a zero command brakes. Chords of one and
/// two periods, then of `step`, the last chord shortened, or until `out` is full. O(horizon / step).
void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds step,
                              const vehicle::VehicleLimits& limits, Prediction& out) noexcept;

/// Extends `out`, not empty, by the flight while `command` is held for `horizon` seconds: chords of `step`, the last
/// chord shortened, or until `out` is full. The previous last point gets the velocity of the first new chord. O(horizon
/// / step).
void extend_by_velocity_command(const Vec3& command, Seconds horizon, Seconds step,
                                const vehicle::VehicleLimits& limits, Prediction& out) noexcept;

}  // namespace jink::path
