// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

// Traffic of a co-processor's line in each step of a flight, to repeat the flight on any target
// (tests/target/step_probe.cpp). Plain memory, little-endian. A file is a sequence of StepRecords, each followed by its
// bytes in, then its bytes out.

namespace jink::sim {

inline constexpr std::uint32_t kStepMagic = 0x4A535201;  // "JSR", layout 1
/// Largest number of bytes per step and direction: the read limit of one step, and the size of the transmit buffer.
inline constexpr std::uint32_t kStepBytes = 4096;

inline constexpr std::uint32_t kStartsAnew = 1;
inline constexpr std::uint32_t kStartsWithReducedSets = 2;
inline constexpr std::uint32_t kStepClock = 0x10000;

struct StepRecord {
    std::uint32_t magic;
    /// Not 0: the co-processor starts anew before this step; the sum of kStartsAnew or kStartsWithReducedSets, and its
    /// clock (Board::clock) times kStepClock.
    std::uint32_t start;
    std::int64_t now_us;      ///< the step's time
    std::uint32_t bytes_in;   ///< bytes that the step reads
    std::uint32_t bytes_out;  ///< bytes that the step wrote in the recorded flight
};
static_assert(std::is_trivially_copyable_v<StepRecord> && sizeof(StepRecord) == 24);

/// A target's answer; followed by its own bytes out.
struct StepAnswer {
    std::uint32_t magic;
    std::uint32_t state;        ///< link::SystemState
    std::uint32_t faults;       ///< app::Fault bits
    std::uint32_t control;      ///< app::Control
    std::uint32_t guidance;     ///< avoid::State
    std::uint32_t kind;         ///< world::ManoeuvreKind
    std::uint32_t plan_status;  ///< world::PlanStatus of this step's plan
    std::uint32_t plans;        ///< requested since start
    std::uint32_t chosen;       ///< index of the chosen candidate in the last plan
    std::uint32_t candidates;   ///< of the last plan's last attempt
    std::uint32_t manoeuvres;   ///< begun since start
    std::uint32_t work;         ///< work units of the supervisor's budget
    std::uint32_t tracks;
    std::uint32_t obstacles;
    std::uint32_t stack_used;  ///< [bytes] since start; 0 where unknown
    std::uint32_t bytes_out;
    float velocity[3];  ///< command [m/s, ENU]
    float margin;       ///< [m]
    float cost;         ///< of the chosen candidate in the last plan
};
static_assert(std::is_trivially_copyable_v<StepAnswer> && sizeof(StepAnswer) == 84);

}  // namespace jink::sim
