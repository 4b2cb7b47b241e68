// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/capacity.hpp"

// Requests of the host to a target, and the answers: plain memory, little-endian, the same on every target. One record
// replays exactly one case.

namespace jink::target {

inline constexpr std::uint32_t kProbeMagic = 0x4A504205;  // "JPB", layout 5
inline constexpr std::size_t kProbeTracks = 32;
inline constexpr std::size_t kProbeObstacles = 96;

inline constexpr std::uint32_t kReachChose = 0x10000;

enum class ProbeKind : std::uint32_t {
    plan,        ///< geometric::Planner::plan alone
    update,      ///< avoid::Supervisor::update, not in control before
    info,        ///< sizes; nothing is computed
    reach,       ///< reach::Planner::plan alone
    reciprocal,  ///< orca::Planner::plan alone
    slices,      ///< a plan by `methods` in one piece, and `updates` times in random slices
};

struct ProbeTrack {
    float position[3];
    float velocity[3];
    float radius;
    float sigma_position;
    float sigma_velocity;
    float max_acceleration;
};

enum class ProbeShape : std::uint32_t { sphere, box, capsule, cylinder };

struct ProbeObstacle {
    ProbeShape kind;
    float a[3];  ///< centre; capsule and cylinder: one end
    float b[3];  ///< box: half extents; capsule and cylinder: the other end
    float radius;
    float yaw;  ///< of a box [rad]
};

/// One case. Everything in SI units, ENU.
struct ProbeRecord {
    std::uint32_t magic;
    std::uint32_t seed;
    ProbeKind kind;
    std::uint32_t offsets;
    std::uint32_t extra_planes;
    std::uint32_t families;  ///< sum of: 1 simple, 2 symmetric, 4 smooth, 8 plateau, 16 wait
    std::uint32_t retries;
    std::uint32_t bounds;        ///< 1 floor, 2 ceiling, 4 keep-in
    std::uint32_t reduced_sets;  ///< 0 the build's own reach sets, 1 the default vehicle's reduced ones
    std::uint32_t shared;        ///< bit i: track i is cooperative
    std::uint32_t clock;         ///< of `update`: its work is for this clock [MHz], in slices; 0: the default, at once
    std::uint32_t updates;       ///< of `update`: how many, 20 ms apart; the last one is counted; of `slices`: slicings
    std::uint32_t methods;       ///< of `update` and `slices`: sum of 1 geometric, 2 reach sets, 4 reciprocal; 0: all
    float own_position[3];
    float own_velocity[3];
    float own_sigma;
    float leg_start[3];
    float leg_end[3];
    float leg_speed;
    float half[3];
    float floor;
    float ceiling;
    float keep_in;
    std::uint32_t waypoints;
    std::uint32_t swept;  ///< 0 time-aware security, 1 swept
    float lookahead;
    float k_sigma;
    float cruise_speed;  ///< and on: the vehicle's limits
    float max_climb;
    float max_descent;
    float max_acceleration;
    float max_vertical_acceleration;
    float velocity_lag;
    std::uint32_t track_count;
    std::uint32_t obstacle_count;
    ProbeTrack tracks[kProbeTracks];
    ProbeObstacle obstacles[kProbeObstacles];
};
static_assert(std::is_trivially_copyable_v<ProbeRecord>);
static_assert(sizeof(ProbeTrack) == 40 && sizeof(ProbeObstacle) == 36);
static_assert(sizeof(ProbeRecord) == 13 * 4 + 20 * 4 + 10 * 4 + 2 * 4 + kProbeTracks * 40 + kProbeObstacles * 36);

struct ProbeAnswer {
    std::uint32_t magic;
    std::uint32_t seed;
    std::uint32_t status;      ///< world::PlanStatus; of `update` the one of its plan
    std::uint32_t candidates;  ///< of the last attempt
    std::uint32_t chosen;  ///< index of the candidate; kReachChose and the node where reach sets chose; of `slices`:
                           ///< how many differ from the plan in one piece
    std::uint32_t work;    ///< work units spent
    std::uint32_t state;   ///< avoid::State, of `update`
    std::uint32_t stack_used;  ///< [bytes] since start; 0 where unknown
    float cost;
    float velocity[3];        ///< command, of `update` and `reciprocal`; else first velocity of the path
    float margin;             ///< of `update`
    std::uint32_t cut_short;  ///< 1: the work units ran out: before all candidates of the last plan were checked, or in
                              ///< the update
};
static_assert(std::is_trivially_copyable_v<ProbeAnswer> && sizeof(ProbeAnswer) == 14 * 4);

}  // namespace jink::target
