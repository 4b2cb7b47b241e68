// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/ports.hpp"

namespace jink::c_interface {

bool CallersBus::receive(hal::CanFrame& frame) noexcept
{
    const bool has_frame = in_.pop(frame);
    health_.frames_in += has_frame ? 1U : 0U;
    return has_frame;
}

bool CallersBus::send(const hal::CanFrame& frame) noexcept
{
    if (frame.fd || !hal::is_valid(frame)) {
        ++health_.frames_bad;
        return false;
    }
    const bool is_taken = takes_part() && out_.push(frame);
    ++(is_taken ? health_.frames_out : health_.frames_refused);
    return is_taken;
}

void CallersBus::become(hal::CanState state) noexcept
{
    const bool took_part = takes_part();
    const bool was_off = health_.state == hal::CanState::bus_off;
    const bool was_down = health_.state == hal::CanState::down;
    health_.bus_offs += state == hal::CanState::bus_off && !was_off ? 1U : 0U;
    health_.downs += state == hal::CanState::down && !was_down ? 1U : 0U;
    health_.state = state;
    health_.restarts += takes_part() && was_off ? 1U : 0U;
    health_.ups += takes_part() && was_down ? 1U : 0U;
    if (took_part && !takes_part()) {
        hal::CanFrame gone;
        while (in_.pop(gone) || out_.pop(gone)) {
        }
    }
}

}  // namespace jink::c_interface
