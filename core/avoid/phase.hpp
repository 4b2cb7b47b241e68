// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/avoid/guidance.hpp"

namespace jink::avoid {

/// What the state machine does: State, with its sub-states apart. All but `watching` are in control.
enum class Phase : std::uint8_t {
    watching,
    giving_back,  ///< watching: the autopilot is asked to fly again, control is not released yet
    given_up,     ///< watching: blocked, the autopilot is asked to hold, control is not released yet
    avoiding,
    rejoining,
    parallel_offset,  ///< rejoining: parallel to the leg, because the path back is not clear
    braking,
};

[[nodiscard]] constexpr State state_of(Phase phase) noexcept
{
    switch (phase) {
    case Phase::avoiding: return State::avoiding;
    case Phase::rejoining:
    case Phase::parallel_offset: return State::rejoining;
    case Phase::braking: return State::braking;
    default: return State::watching;
    }
}

struct Transition {
    Phase from;
    Phase to;
    friend constexpr bool operator==(const Transition&, const Transition&) noexcept = default;
};

/// All that there are. One update may make several. docs/guides/state_machine.md draws them, and repeats the comments.
inline constexpr std::array kTransitions = std::to_array<Transition>({
    {Phase::watching, Phase::rejoining},     // control taken
    {Phase::giving_back, Phase::watching},   // control released or reset
    {Phase::giving_back, Phase::rejoining},  // conflict, off the leg again, or not all can stop
    {Phase::given_up, Phase::watching},      // control released or reset, or traffic comes
    {Phase::rejoining, Phase::giving_back},  // on the leg, nominal paths clear, all can stop, control held long enough
    {Phase::rejoining, Phase::parallel_offset},  // path back in conflict, flying parallel to the leg is clear
    {Phase::rejoining, Phase::avoiding},         // conflict due, a method has a safe answer
    {Phase::rejoining, Phase::braking},   // conflict urgent without an answer, or neither turn back nor course clear
    {Phase::rejoining, Phase::watching},  // control lost or reset
    {Phase::parallel_offset, Phase::rejoining},  // path back clear, or flying parallel to the leg is not
    {Phase::parallel_offset, Phase::watching},   // control lost or reset
    {Phase::avoiding, Phase::rejoining},         // manoeuvre flown to its end, or nominal path and turn back clear
    {Phase::avoiding, Phase::parallel_offset},   // manoeuvre unsafe, slow or heading back, flying parallel is clear
    {Phase::avoiding, Phase::braking},           // manoeuvre unsafe before the latest manoeuvre time, no safe answer
    {Phase::avoiding, Phase::watching},          // control lost or reset
    {Phase::braking, Phase::rejoining},          // nominal path and turn back clear
    {Phase::braking, Phase::avoiding},           // a method has a safe answer
    {Phase::braking, Phase::given_up},           // blocked by static threats for too long
    {Phase::braking, Phase::watching},           // control lost or reset
});
/// Bit of Guidance::transitions for a transition that the table does not have.
inline constexpr std::uint32_t kUnknownTransition = 1U << 31U;
static_assert(kTransitions.size() < 31);

/// Bit of a transition in Guidance::transitions. O(kTransitions).
[[nodiscard]] constexpr std::uint32_t transition_bit(const Transition& transition) noexcept
{
    for (std::size_t i = 0; i < kTransitions.size(); ++i) {
        if (kTransitions[i] == transition) {
            return 1U << i;
        }
    }
    return kUnknownTransition;
}

}  // namespace jink::avoid
