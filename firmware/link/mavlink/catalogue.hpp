// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/mavlink/field.hpp"

namespace jink::link::mavlink {

/// The message with this id, or nullptr for an unknown message, whose frames cannot be checked.
///
/// Holds all messages of the dialects minimal, standard, common and ardupilotmega (docs/guides/mavlink_frames.md),
/// decoded or not, so that frames of unused messages are still checked and skipped whole. 8 bytes of constants each.
/// O(log n): at most 9 comparisons.
[[nodiscard]] const MessageInfo* find_message(std::uint32_t id) noexcept;

}  // namespace jink::link::mavlink
