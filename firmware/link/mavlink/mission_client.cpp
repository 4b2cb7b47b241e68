// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/mission_client.hpp"

namespace jink::link::mavlink {
namespace {

constexpr Seconds kAnswerTime = 1.0F;
constexpr Seconds kSulk = 10.0F;
constexpr int kTries = 3;

/// Items with a place: WAYPOINT 16, LOITER 17-19, LAND 21, TAKEOFF 22, SPLINE_WAYPOINT 82.
bool has_place(std::uint16_t command) noexcept
{
    return (command >= 16 && command <= 19) || command == 21 || command == 22 || command == 82;
}

}  // namespace

void MissionClient::ask(State state) noexcept
{
    state_ = state;
    tries_ = 0;
}

void MissionClient::give_up(TimePoint now) noexcept
{
    state_ = State::given_up;
    asked_ = now;
    lost_ = !told_lost_;
    told_lost_ = true;
}

void MissionClient::current(std::uint16_t sequence) noexcept
{
    if (has_current_ && sequence == current_) {
        return;
    }
    has_current_ = true;
    current_ = sequence;
    from_ = to_ = {};
    leg_ready_ = told_lost_ = false;
    ask(State::ask_list);
}

void MissionClient::count(std::uint16_t count, TimePoint now) noexcept
{
    if (state_ != State::await_count) {
        return;
    }
    if (current_ >= count) {
        give_up(now);
        return;
    }
    wanted_ = current_;
    ask(State::ask_item);
}

bool MissionClient::item(std::uint16_t sequence, std::uint16_t command, const MissionPoint& point,
                         TimePoint now) noexcept
{
    if (state_ != State::await_item || sequence != wanted_) {
        return false;
    }
    if (sequence == current_) {
        if (!has_place(command)) {
            give_up(now);
            return true;
        }
        to_ = point;
        to_.known = true;
        if (current_ > 0) {
            wanted_ = static_cast<std::uint16_t>(current_ - 1);
            ask(State::ask_item);
            return true;
        }
    } else if (has_place(command)) {
        from_ = point;
        from_.known = true;
    }
    leg_ready_ = true;
    state_ = State::done;
    tries_ = 0;
    return true;
}

MissionStep MissionClient::next(TimePoint now) noexcept
{
    switch (state_) {
    case State::ask_list:
        state_ = State::await_count;
        asked_ = now;
        ++tries_;
        return MissionStep::list;
    case State::ask_item:
        state_ = State::await_item;
        asked_ = now;
        ++tries_;
        return MissionStep::item;
    case State::await_count:
    case State::await_item:
        if (now - asked_ >= kAnswerTime) {
            if (tries_ >= kTries) {
                give_up(now);
                return MissionStep::none;
            }
            state_ = state_ == State::await_count ? State::ask_list : State::ask_item;
        }
        return MissionStep::none;
    case State::done:
        if (tries_ == 0) {
            tries_ = 1;
            return MissionStep::finish;
        }
        return MissionStep::none;
    case State::given_up:
        if (now - asked_ >= kSulk) {
            ask(State::ask_list);
        }
        return MissionStep::none;
    case State::idle: return MissionStep::none;
    }
    return MissionStep::none;
}

bool MissionClient::take_leg() noexcept
{
    const bool ready = leg_ready_;
    leg_ready_ = false;
    return ready;
}

bool MissionClient::take_loss() noexcept
{
    const bool lost = lost_;
    lost_ = false;
    return lost;
}

}  // namespace jink::link::mavlink
