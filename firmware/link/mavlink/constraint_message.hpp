// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/constraint.hpp"
#include "firmware/link/mavlink/messages.hpp"

// Closed areas over MAVLink: TUNNEL (385) with payloads of our own, little-endian, offsets in bytes. The first four
// bytes are the same in both kinds; unknown versions and kinds and other lengths are refused, so that nothing is half
// read.
//
// kind 1, one area of a set, 48 bytes:              kind 2, the answer to it, 5 bytes:
//    0  u8   version, 1                                0  u8  version, 1
//    1  u8   kind, 1                                   1  u8  kind, 2
//    2  u8   number of the set                         2  u8  number of the set
//    3  u8   index of the area, 0 ... count - 1        3  u8  index
//    4  u8   count: areas of the set; 0: none          4  u8  ConstraintResult
//    5  u8   frame: 0 local NED, 1 latitude and longitude
//    6  u16  0
//    8  u32  age of the position when it is sent [ms]
//   12  u32  open after so much [s], counted as the age is; 0: closed until another set comes
//   16  i32  north [mm] or latitude [degE7]
//   20  i32  east [mm] or longitude [degE7]
//   24  f32  bottom [m], 28 f32 top [m]: above the origin of the local frame or above mean sea level
//   32  f32  radius [m], 36 f32 margin [m], soft
//   40  f32  velocity to the north [m/s], 44 f32 to the east
//
// Ages instead of times: no clocks have to agree. The line's delay is not taken off.

namespace jink::link::mavlink {

/// In the range that MAVLink leaves to local use (above 32767).
inline constexpr std::uint16_t kConstraintPayload = 35344;

/// Frame of a constraint's position on the wire.
enum class ConstraintFrame : std::uint8_t { local = 0, global = 1 };

/// Whether the payload says to be an answer, of whatever version and length. Answers are never answered: two
/// co-processors would go on for ever.
[[nodiscard]] bool is_constraint_answer(const Tunnel& message) noexcept;
/// Reads kind 1. `part.set` and `part.index` are filled as far as the payload has them, for the answer.
/// @param now  arrival
/// @return false: length, version, kind, frame or index (the numbers themselves are not checked). O(1).
[[nodiscard]] bool read_constraint(const Tunnel& message, TimePoint now, ConstraintPart& part) noexcept;
/// The reverse, the target left open: for whoever reports areas. Positions in millimetres or degE7 are rounded.
[[nodiscard]] Tunnel constraint_message(const ConstraintPart& part, TimePoint now) noexcept;

struct ConstraintAnswer {
    std::uint8_t set = 0;
    std::uint8_t index = 0;
    ConstraintResult result = ConstraintResult::kept;
};
/// The target left open. O(1).
[[nodiscard]] Tunnel constraint_answer(const ConstraintAnswer& answer) noexcept;
/// @return false: not an answer of this version. O(1).
[[nodiscard]] bool read_constraint_answer(const Tunnel& message, ConstraintAnswer& answer) noexcept;

}  // namespace jink::link::mavlink
