// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/handles.hpp"

#include <array>
#include <atomic>

namespace jink::c_interface {
namespace {

// Global because a handle has to be known as one before it is used.
std::array<std::atomic<Session*>, JINK_MAX_HANDLES>
    sessions{};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace

bool enter(Session* session) noexcept
{
    for (std::atomic<Session*>& place : sessions) {
        Session* none = nullptr;
        if (place.compare_exchange_strong(none, session)) {
            return true;
        }
    }
    return false;
}

Session* session_of(const jink_coprocessor* handle) noexcept
{
    for (const std::atomic<Session*>& place : sessions) {
        Session* const session = place.load();
        if (session != nullptr && handle_of(session) == handle) {
            return session;
        }
    }
    return nullptr;
}

Session* leave(const jink_coprocessor* handle) noexcept
{
    for (std::atomic<Session*>& place : sessions) {
        Session* session = place.load();
        if (session != nullptr && handle_of(session) == handle && place.compare_exchange_strong(session, nullptr)) {
            return session;
        }
    }
    return nullptr;
}

}  // namespace jink::c_interface
