// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/linux/c_interface/session.hpp"

// The handles that exist, so that a destroyed or made-up one is refused instead of used. A handle is no address: it is
// the number of a place and how many sessions were in that place before. A handle comes again only after 2^58 sessions
// in its place, on a processor of 32 bits after 2^26.

namespace jink::c_interface {

/// The handle of a new session; nullptr: JINK_MAX_HANDLES exist. Safe from any thread, as are the others.
[[nodiscard]] jink_coprocessor* enter(Session* session) noexcept;
/// The session of a handle; nullptr where the handle is none.
[[nodiscard]] Session* session_of(const jink_coprocessor* handle) noexcept;
/// The same, and the handle is none from now on.
[[nodiscard]] Session* leave(const jink_coprocessor* handle) noexcept;

/// The session of a call's handle.
/// @param pointers  further ones that must not be null; they are checked first
/// @return JINK_OK, JINK_ERROR_NULL or JINK_ERROR_HANDLE; `session` is valid with JINK_OK alone
template <class... Pointers>
[[nodiscard]] jink_result find(const jink_coprocessor* handle, Session*& session, const Pointers*... pointers) noexcept
{
    if (handle == nullptr || (... || (pointers == nullptr))) {
        return JINK_ERROR_NULL;
    }
    session = session_of(handle);
    return session != nullptr ? JINK_OK : JINK_ERROR_HANDLE;
}

/// The same for a call with a structure, whose `size` is checked last: JINK_ERROR_SIZE.
template <class Sized, class... Pointers>
[[nodiscard]] jink_result find_sized(const jink_coprocessor* handle, Session*& session, const Sized* sized,
                                     const Pointers*... pointers) noexcept
{
    const jink_result result = find(handle, session, sized, pointers...);
    return result == JINK_OK && sized->size != sizeof(Sized) ? JINK_ERROR_SIZE : result;
}

}  // namespace jink::c_interface
