// SPDX-License-Identifier: BSD-3-Clause
// Checks what comes from outside; everything else is Session's.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

#include "firmware/linux/c_interface/handles.hpp"

using jink::c_interface::Session;

namespace {

using namespace jink;
using c_interface::find;
using c_interface::find_sized;

template <class Operation>
jink_result on_line(Session& session, std::int32_t port, Operation operation) noexcept
{
    if (port == JINK_PORT_AUTOPILOT && session.autopilot() != nullptr) {
        return operation(*session.autopilot());
    }
    if (port == JINK_PORT_CLOUD && session.cloud() != nullptr) {
        return operation(*session.cloud());
    }
    return JINK_ERROR_PORT;
}

}  // namespace

std::uint32_t jink_abi(void) { return JINK_ABI; }

const char* jink_version(void) { return JINK_VERSION_TEXT; }

jink_result jink_create(std::uint32_t abi, const jink_options* options, jink_coprocessor** created)
{
    if (options == nullptr || created == nullptr) {
        return JINK_ERROR_NULL;
    }
    if (abi != JINK_ABI) {
        return JINK_ERROR_VERSION;
    }
    if (options->size != sizeof(jink_options)) {
        return JINK_ERROR_SIZE;
    }
    if (const jink_result checked = Session::check(*options); checked != JINK_OK) {
        return checked;
    }
    auto* const session = new (std::nothrow) Session(*options);
    if (session == nullptr) {
        return JINK_ERROR_MEMORY;
    }
    const bool has_time = session->has_time_for_plans();
    jink_coprocessor* const handle = has_time ? c_interface::enter(session) : nullptr;
    if (handle == nullptr) {
        delete session;
        return has_time ? JINK_ERROR_TOO_MANY : JINK_ERROR_OPTION;
    }
    *created = handle;
    return JINK_OK;
}

void jink_destroy(jink_coprocessor* jink) { delete c_interface::leave(jink); }

jink_result jink_feed(jink_coprocessor* jink, std::int32_t port, const std::uint8_t* bytes, std::size_t count,
                      std::size_t* taken)
{
    Session* session = nullptr;
    const auto* const from = count == 0 && bytes == nullptr ? reinterpret_cast<const std::uint8_t*>("") : bytes;
    if (const jink_result result = find(jink, session, from); result != JINK_OK) {
        return result;
    }
    return on_line(*session, port, [&](auto& line) -> jink_result {
        if (taken == nullptr && line.space() < count) {
            return JINK_ERROR_FULL;
        }
        const std::size_t n = line.feed(std::as_bytes(std::span(from, count)));
        if (taken != nullptr) {
            *taken = n;
        }
        return JINK_OK;
    });
}

jink_result jink_take(jink_coprocessor* jink, std::uint8_t* into, std::size_t capacity, std::size_t* taken)
{
    Session* session = nullptr;
    std::uint8_t nothing = 0;
    std::uint8_t* const to = capacity == 0 && into == nullptr ? &nothing : into;
    if (const jink_result result = find(jink, session, to, taken); result != JINK_OK) {
        return result;
    }
    Session::AutopilotLine* const line = session->autopilot();
    if (line == nullptr) {
        return JINK_ERROR_PORT;
    }
    *taken = line->take(std::as_writable_bytes(std::span(to, capacity)));
    return JINK_OK;
}

jink_result jink_set_open(jink_coprocessor* jink, std::int32_t port, std::int32_t is_open)
{
    Session* session = nullptr;
    if (const jink_result result = find(jink, session); result != JINK_OK) {
        return result;
    }
    return on_line(*session, port, [&](auto& line) -> jink_result {
        line.set_open(is_open != 0);
        return JINK_OK;
    });
}

jink_result jink_feed_can(jink_coprocessor* jink, const jink_can_frame* frame)
{
    Session* session = nullptr;
    if (const jink_result result = find_sized(jink, session, frame); result != JINK_OK) {
        return result;
    }
    if (session->can() == nullptr) {
        return JINK_ERROR_PORT;
    }
    hal::CanFrame received;
    received.id = frame->id;
    received.extended = frame->extended != 0;
    received.remote = frame->remote != 0;
    received.length = frame->length;
    if (frame->extended > 1 || frame->remote > 1 || frame->reserved != 0 || !hal::is_valid(received)) {
        return JINK_ERROR_VALUE;
    }
    std::ranges::copy(std::as_bytes(std::span(frame->data)), received.data.begin());
    return session->can()->feed(received) ? JINK_OK : JINK_ERROR_FULL;
}

jink_result jink_take_can(jink_coprocessor* jink, jink_can_frame* frame, std::int32_t* has_frame)
{
    Session* session = nullptr;
    if (const jink_result result = find_sized(jink, session, frame, has_frame); result != JINK_OK) {
        return result;
    }
    if (session->can() == nullptr) {
        return JINK_ERROR_PORT;
    }
    hal::CanFrame sent;
    *has_frame = session->can()->take(sent) ? 1 : 0;
    if (*has_frame != 0) {
        *frame = {sizeof *frame, sent.id, std::uint8_t{sent.extended}, std::uint8_t{sent.remote}, sent.length, 0, {}};
        std::ranges::copy(std::span(sent.data).first(sizeof frame->data),
                          std::as_writable_bytes(std::span(frame->data)).begin());
    }
    return JINK_OK;
}

jink_result jink_set_can_state(jink_coprocessor* jink, std::int32_t state)
{
    constexpr std::array kStates{hal::CanState::down, hal::CanState::active, hal::CanState::error_passive,
                                 hal::CanState::bus_off};
    Session* session = nullptr;
    if (const jink_result result = find(jink, session); result != JINK_OK) {
        return result;
    }
    if (session->can() == nullptr) {
        return JINK_ERROR_PORT;
    }
    if (state < 0 || state >= static_cast<std::int32_t>(kStates.size())) {
        return JINK_ERROR_VALUE;
    }
    session->can()->become(kStates[static_cast<std::size_t>(state)]);
    return JINK_OK;
}

jink_result jink_step(jink_coprocessor* jink, std::int64_t now_us)
{
    Session* session = nullptr;
    const jink_result result = find(jink, session);
    return result == JINK_OK ? session->step({now_us}) : result;
}

jink_result jink_shut_down(jink_coprocessor* jink, std::int64_t now_us)
{
    Session* session = nullptr;
    const jink_result result = find(jink, session);
    return result == JINK_OK ? session->shut_down({now_us}) : result;
}

jink_result jink_get_status(const jink_coprocessor* jink, jink_status* status)
{
    Session* session = nullptr;
    const jink_result result = find_sized(jink, session, status);
    if (result == JINK_OK) {
        session->write(*status);
    }
    return result;
}

jink_result jink_get_counters(const jink_coprocessor* jink, jink_counters* counters)
{
    Session* session = nullptr;
    const jink_result result = find_sized(jink, session, counters);
    if (result == JINK_OK) {
        session->write(*counters);
    }
    return result;
}
