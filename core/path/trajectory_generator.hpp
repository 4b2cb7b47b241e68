// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/path/dense_path.hpp"
#include "core/vehicle/vehicle.hpp"

namespace jink::path {

/// How the generator follows (G-ORCA 13.2; the source says that its values were tuned empirically).
struct GeneratorSettings {
    // Look-ahead: clamp((base + per_speed V - per_error eps) / (1 + per_curvature kappa most), least, most)
    float base = 0.3F;           ///< L_0 [m]
    float per_speed = 1.0F;      ///< k_v [s]
    float per_error = 0.0F;      ///< k_eps [-]
    float per_curvature = 0.5F;  ///< k_k [-]
    float least = 0.3F;          ///< L_min [m], > 0; never below `stable_look_ahead`
    float most = 3.0F;           ///< L_max [m], >= least

    Seconds delay = 0.0F;            ///< T_d from what is measured to what is flown; a filter's delay counts in
    Seconds lag = 0.0F;              ///< T_v of the velocity loop
    float position_gain = 1.0F;      ///< k_p [1/s], near a carrot and at the end
    float small = 0.2F;              ///< a carrot nearer than this in the level is gone to in proportion [m]
    float acceptance = 0.15F;        ///< r_acc: so near to the end counts as there [m]
    Seconds acceptance_time = 0.5F;  ///< t_acc: for so long
    float lost = 5.0F;               ///< eps_max: farther from the path is lost, once for `lost_time` [m]; ours
    Seconds lost_time = 2.0F;
    /// W_SEARCH: segments that are searched for the nearest point, and walked along to the carrot.
    std::uint16_t search = 64;
    /// And no farther ahead than this [m]: after decimation 64 segments may be the next lane of a search pattern. Ours.
    float search_ahead = 12.0F;
    float turn_radius = 0.0F;  ///< least one of the non-holonomic output [m]; 0: none
};

/// All fields finite and within the ranges said above.
[[nodiscard]] bool is_valid(const GeneratorSettings& settings) noexcept;

enum class GeneratorStatus : std::uint8_t {
    idle,
    tracking,
    done,       ///< at the end for acceptance_time; the end is held
    path_lost,  ///< ERR_PATH_LOST; the way back to the path goes on, and ends the error
    blocked,    ///< ERR_BLOCKED, as long as the avoidance says so; goes on as well
    timed_out,  ///< ERR_TIMEOUT: the task took longer than it may; velocity 0 until the next task
    rejected,   ///< ERR_REJECTED: the task was not taken, and nothing else is flown
};

/// What a task asks for beside its path.
struct Task {
    float cruise_speed = 1.0F;  ///< V_c in the level [m/s], > 0
    Seconds time_limit = 0.0F;  ///< 0: none
};

struct GeneratorOutput {
    Vec3 velocity = Vec3::Zero();  ///< v_pref [m/s]
    GeneratorStatus status = GeneratorStatus::idle;
    // For vehicles that cannot fly sideways: how fast, and by how much to turn (D23).
    float speed = 0.0F;           ///< V in the level [m/s]
    float heading_change = 0.0F;  ///< dphi [rad], counter-clockwise, from the own yaw; within the turn limit

    Vec3 nearest = Vec3::Zero();  ///< point of the path
    Vec3 carrot = Vec3::Zero();
    float error = 0.0F;       ///< eps [m]
    float curvature = 0.0F;   ///< kappa [1/m]
    float look_ahead = 0.0F;  ///< L [m]
    float left = 0.0F;        ///< way to the end [m], along the path, and no less than straight
};

/// Look-ahead that a vehicle at `speed` [m/s] needs: its error across the path obeys y' = -V y / L, delayed; stable
/// above 2 V T_d / pi, free of overshoot from e V T_d on, and 4 V T_v for the loop's lag (G-ORCA 13.2). O(1).
[[nodiscard]] float stable_look_ahead(float speed, Seconds delay, Seconds lag) noexcept;

/// Adaptive pure pursuit on a dense path (Alejo 8.2.1 and C.2): the preferred velocity of the avoidance.
///
/// Unlike path::follow it does not keep to the path's times. Progress is that of the nearest point and never goes back,
/// so the carrot waits while the vehicle is pushed aside, and nothing runs away from it.
///
/// Where the climb to a carrot needs more than the vehicle has, the velocity in the level shrinks with it, so that the
/// direction stays: the source bounds each component, and would fly a steep path beside it.
///
/// Memory: that of the path (41 KiB by default) and 100 bytes. No allocation.
class TrajectoryGenerator {
public:
    /// @param settings, limits  valid (is_valid)
    TrajectoryGenerator(const GeneratorSettings& settings, const vehicle::VehicleLimits& limits) noexcept
        : settings_(settings), limits_(limits)
    {
    }

    /// To load chunks into. A path that replaces the one that is flown ends its task: it is flown once started.
    [[nodiscard]] DensePath& path() noexcept { return path_; }
    [[nodiscard]] const DensePath& path() const noexcept { return path_; }

    /// Flies the path that was committed last from its start. False, and nothing changes, where there is none or the
    /// task's numbers are none. O(1).
    [[nodiscard]] bool start(const Task& task, TimePoint now) noexcept;
    /// A task was refused: told where there is none that is flown, or whose end is held.
    void reject() noexcept;
    /// Forgets path and task.
    void stop() noexcept;

    /// Once per tick. `own` finite. O(settings.search).
    /// @param blocked  the avoidance makes no progress (BLOCKED)
    [[nodiscard]] GeneratorOutput step(const vehicle::VehicleState& own, TimePoint now, bool blocked) noexcept;

    /// Segment of the nearest point; never decreases while a chunk is flown.
    [[nodiscard]] std::size_t progress() const noexcept { return progress_; }
    [[nodiscard]] GeneratorStatus status() const noexcept { return status_; }

private:
    struct Nearest {
        std::size_t segment = 0;
        float share = 0.0F;  ///< of the segment
        Vec3 point = Vec3::Zero();
    };
    [[nodiscard]] Nearest find_nearest(const Vec3& position) const noexcept;
    [[nodiscard]] float curvature_at(const Nearest& nearest) const noexcept;
    [[nodiscard]] Vec3 find_carrot(const Nearest& nearest, const Vec3& position, float look_ahead) const noexcept;
    [[nodiscard]] float look_ahead(float speed, float cruise, float error, float curvature) const noexcept;
    [[nodiscard]] Vec3 velocity_to(const Vec3& way, float speed) const noexcept;
    [[nodiscard]] GeneratorStatus judge(const GeneratorOutput& output, TimePoint now, bool blocked) noexcept;
    void turn(const vehicle::VehicleState& own, Seconds period, GeneratorOutput& output) const noexcept;

    GeneratorSettings settings_;
    vehicle::VehicleLimits limits_;
    DensePath path_;
    Task task_;
    GeneratorStatus status_ = GeneratorStatus::idle;
    std::size_t progress_ = 0;
    std::uint32_t generation_ = 0;  ///< of the path that was started
    TimePoint started_;
    TimePoint last_step_;
    bool is_near_end_ = false;
    TimePoint near_end_since_;
    bool is_off_ = false;
    TimePoint off_since_;
};

}  // namespace jink::path
