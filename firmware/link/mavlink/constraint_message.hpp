// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/constraint.hpp"
#include "firmware/link/mavlink/messages.hpp"

// Closed areas over MAVLink: TUNNEL (385) with own payload types. docs/guides/closed_areas.md specifies both kinds byte
// by byte: 1, an area of a set, 48 bytes; 2, the answer to it, 5 bytes. Unknown versions and kinds and other lengths
// are refused, so that no payload is partly read.
//
// Ages in place of times: no clock synchronisation is needed. The line's delay is not subtracted.

namespace jink::link::mavlink {

/// In MAVLink's range for local use (above 32767).
inline constexpr std::uint16_t kConstraintPayload = 35344;

/// Frame of a constraint's position on the wire.
enum class ConstraintFrame : std::uint8_t { local = 0, global = 1 };

/// Whether the payload claims to be an answer, of any version and length. Answers are never answered: two co-processors
/// would go on for ever.
[[nodiscard]] bool is_constraint_answer(const Tunnel& message) noexcept;
/// Reads kind 1. `part.set` and `part.index` are set as far as the payload contains them, for the answer.
/// @param now  arrival
/// @return false: wrong length, version, kind, frame or index (the values themselves are not checked). O(1).
[[nodiscard]] bool read_constraint(const Tunnel& message, TimePoint now, ConstraintPart& part) noexcept;
/// The reverse, without a target: for senders of areas. Positions in millimetres or degE7 are rounded.
[[nodiscard]] Tunnel constraint_message(const ConstraintPart& part, TimePoint now) noexcept;

struct ConstraintAnswer {
    std::uint8_t set = 0;
    std::uint8_t index = 0;
    ConstraintResult result = ConstraintResult::kept;
};
/// Without a target. O(1).
[[nodiscard]] Tunnel constraint_answer(const ConstraintAnswer& answer) noexcept;
/// @return false: not an answer of this version. O(1).
[[nodiscard]] bool read_constraint_answer(const Tunnel& message, ConstraintAnswer& answer) noexcept;

}  // namespace jink::link::mavlink
