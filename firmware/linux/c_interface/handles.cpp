// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/handles.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace jink::c_interface {
namespace {

/// Place of a session. Its generation counts the sessions that have left it, from 1 on: no handle is null.
struct Place {
    std::atomic<Session*> session{nullptr};
    std::atomic<std::uintptr_t> generation{1};
};

// Global because a handle has to be known as one before it is used.
std::array<Place, JINK_MAX_HANDLES> places{};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

std::uintptr_t number_of(const jink_coprocessor* handle) noexcept { return reinterpret_cast<std::uintptr_t>(handle); }

Place& place_of(const jink_coprocessor* handle) noexcept { return places[number_of(handle) % places.size()]; }

std::uintptr_t generation_of(const jink_coprocessor* handle) noexcept { return number_of(handle) / places.size(); }

}  // namespace

jink_coprocessor* enter(Session* session) noexcept
{
    for (std::size_t i = 0; i < places.size(); ++i) {
        Session* none = nullptr;
        if (places[i].session.compare_exchange_strong(none, session)) {
            return reinterpret_cast<jink_coprocessor*>(places[i].generation.load() * places.size() + i);
        }
    }
    return nullptr;
}

Session* session_of(const jink_coprocessor* handle) noexcept
{
    const Place& place = place_of(handle);
    return place.generation.load() == generation_of(handle) ? place.session.load() : nullptr;
}

Session* leave(const jink_coprocessor* handle) noexcept
{
    Place& place = place_of(handle);
    std::uintptr_t generation = generation_of(handle);
    // The generation first: once the place is free, the next session may enter it.
    return session_of(handle) != nullptr && place.generation.compare_exchange_strong(generation, generation + 1)
               ? place.session.exchange(nullptr)
               : nullptr;
}

}  // namespace jink::c_interface
