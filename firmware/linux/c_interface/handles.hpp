// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/linux/c_interface/session.hpp"

// The handles that exist, so that a destroyed or made-up one is refused instead of used.

namespace jink::c_interface {

/// False: JINK_MAX_HANDLES exist. Safe from any thread, as are the others.
[[nodiscard]] bool enter(Session* session) noexcept;
/// The session of a handle; nullptr where the handle is none. O(JINK_MAX_HANDLES).
[[nodiscard]] Session* session_of(const jink_coprocessor* handle) noexcept;
/// The same, and the handle is none from now on.
[[nodiscard]] Session* leave(const jink_coprocessor* handle) noexcept;

[[nodiscard]] inline jink_coprocessor* handle_of(Session* session) noexcept
{
    return reinterpret_cast<jink_coprocessor*>(session);
}

}  // namespace jink::c_interface
