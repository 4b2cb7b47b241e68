// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/mavlink/field.hpp"

namespace jink::link::mavlink {

/// The message with this id, or nullptr when it is not known here and a frame of it cannot be checked.
///
/// Holds all of the dialects minimal, standard, common and ardupilotmega (docs/guides/mavlink_frames.md), decoded or
/// not, so that frames which mean nothing to us are still checked and stepped over whole. 8 bytes of constants each.
/// O(log n): at most 9 comparisons.
[[nodiscard]] const MessageInfo* find_message(std::uint32_t id) noexcept;

}  // namespace jink::link::mavlink
