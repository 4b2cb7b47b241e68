// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/mission_client.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/link/messages.hpp"

namespace jink::link::mavlink {
namespace {

constexpr Seconds kAnswerTime = 1.0F;
constexpr int kTries = 3;
/// Together with kAnswerTime shorter than the 5 s after which PX4 ends a transfer with a text to the pilot [s].
constexpr Seconds kRest = 3.0F;
constexpr Seconds kDeniedRest = 1.0F;
/// A restart takes longer than this [s].
constexpr Seconds kTransferSilence = 2.0F;
/// Answers delayed by a stalled line have arrived by then: they must not count for the next transfer [s].
constexpr Seconds kLateness = 2.0F;
constexpr Seconds kCheckPeriod = 5.0F;
constexpr Seconds kReadPeriod = 20.0F;
constexpr int kEnds = 3;
constexpr Seconds kEndPeriod = 0.5F;
/// Pause after another system's transfer, and after its end [s].
constexpr Seconds kOthersTime = 9.0F;
constexpr Seconds kOthersEnded = 1.0F;

constexpr std::uint8_t kDenied = 14;           // MAV_MISSION_DENIED
constexpr std::uint16_t kLastNavigation = 95;  // MAV_CMD_NAV_LAST
constexpr std::uint16_t kDoJump = 177;
constexpr std::uint16_t kDoChangeSpeed = 178;

}  // namespace

bool MissionClient::is_kept(std::uint16_t sequence) const noexcept { return sequence >= first_ && sequence < end_; }

const MissionItem* MissionClient::kept(std::size_t sequence) const noexcept
{
    if (sequence < first_ || sequence >= end_) {
        return nullptr;
    }
    const MissionItem& item = items_[sequence - first_];
    return item.known ? &item : nullptr;
}

void MissionClient::drop() noexcept
{
    items_.fill({});
    find_goal();
}

void MissionClient::find_goal() noexcept
{
    MissionItem found;
    std::size_t sequence = progress_.sequence;
    const bool is_home = lone_ && sequence == 0;
    const bool is_flown = has_current_ && is_verified_ && !progress_.complete && !is_home;
    const MissionItem* item = is_flown ? kept(sequence) : nullptr;
    for (std::size_t i = 0; i < kMaxMissionItems && item != nullptr; ++i) {
        if (item->command <= kLastNavigation) {
            found = *item;
            break;
        }
        item = item->command == kDoJump ? nullptr : kept(++sequence);
    }
    goal_ = found;
    goal_sequence_ = static_cast<std::uint16_t>(sequence);
    if (found.known && (!found.is_same_place(last_goal_) || goal_sequence_ != last_sequence_)) {
        ++version_;
        last_goal_ = found;
        last_sequence_ = goal_sequence_;
    }
}

void MissionClient::heard(TimePoint now) noexcept
{
    if (heard_.us != 0 && now - heard_ > kTransferSilence) {
        stale_ = stale_ || (state_ != State::idle && !checks_);
        check_due_ = true;
        state_ = State::idle;
        is_partner_ = false;
        ends_ = 0;
        rest_until_ = now + kLateness;
    }
    heard_ = now;
}

/// Discards the copy: the autopilot's mission differs from it.
void MissionClient::invalidate(TimePoint now) noexcept
{
    if (state_ == State::ask_item || state_ == State::await_item) {
        end(MissionStep::cancel, now);
    } else if (state_ == State::await_count) {
        // The count that follows this announcement is of the announced mission.
        read_total_ = progress_.total;
        read_id_ = progress_.id;
        checks_ = false;
        drop();
        return;
    }
    stale_ = true;
    drop();
}

void MissionClient::current(const MissionProgress& progress, TimePoint now) noexcept
{
    const bool other = has_current_ && progress.sequence != progress_.sequence;
    progress_ = progress;
    check_due_ = check_due_ || other;
    is_verified_ = is_verified_ && !(lone_ && other);
    const bool another = progress.total != read_total_ || progress.id != read_id_;
    if (!has_current_) {
        has_current_ = true;
    } else if (another && stale_) {
        drop();  // while another system's transfer prevents reading
    } else if (another) {
        invalidate(now);
    } else if (!stale_ && state_ == State::idle && !lone_ && id_ != 0 && progress.id == id_) {
        is_verified_ = true;
    }
    find_goal();
}

void MissionClient::count(std::uint16_t count, std::uint32_t id, TimePoint now) noexcept
{
    if (state_ == State::idle) {
        return;
    }
    is_partner_ = true;
    if (state_ != State::await_count) {
        // The answer to a repetition: PX4 has restarted the transfer, perhaps with another mission.
        if (count != count_ || id != id_) {
            invalidate(now);
        }
        return;
    }
    const bool same = count == count_ && id == id_;
    if (!checks_ || !same) {
        begin_items(count, id);
        if (end_ == 0) {
            end(MissionStep::accept, now);
        }
        return;
    }
    if (progress_.sequence >= count || kept(progress_.sequence) == nullptr) {
        is_verified_ = true;
        state_ = State::idle;
        read_ = now;
        return;
    }
    wanted_ = progress_.sequence;
    state_ = State::ask_item;
}

void MissionClient::begin_items(std::uint16_t count, std::uint32_t id) noexcept
{
    constexpr std::size_t kBefore = kMaxMissionItems / 4;
    const std::size_t spare = count > kMaxMissionItems ? count - kMaxMissionItems : 0;
    const std::size_t before = progress_.sequence > kBefore ? progress_.sequence - kBefore : 0;
    const auto first = static_cast<std::uint16_t>(std::min(before, spare));
    const bool same = count == count_ && id == id_ && first == first_;
    count_ = count;
    id_ = id;
    first_ = first;
    end_ = static_cast<std::uint16_t>(std::min<std::size_t>(count, first + kMaxMissionItems));
    // PX4 announces the same count and id in MISSION_CURRENT, perhaps later than here.
    const bool is_announced = !lone_ && id != 0;
    read_total_ = is_announced ? count : progress_.total;
    read_id_ = is_announced ? id : progress_.id;
    speed_ = 0.0F;
    wanted_ = 0;
    checks_ = false;
    state_ = State::ask_item;
    if (!same || lone_ || id != 0) {
        is_verified_ = false;
    }
    if (!same) {
        drop();
    }
}

bool MissionClient::item(std::uint16_t sequence, const MissionItem& item, float param1, float param2,
                         TimePoint now) noexcept
{
    if (state_ != State::await_item || sequence != wanted_) {
        return false;
    }
    if (checks_) {
        compare(item, now);
        return true;
    }
    store(sequence, item, param1, param2);
    ++wanted_;
    state_ = State::ask_item;
    if (wanted_ >= end_) {
        end(end_ == count_ ? MissionStep::accept : MissionStep::cancel, now);
        is_verified_ = !lone_ && id_ == 0;
        check_due_ = true;
        read_ = now;
    }
    find_goal();
    return true;
}

void MissionClient::compare(const MissionItem& item, TimePoint now) noexcept
{
    MissionItem received = item;
    received.known = true;
    const MissionItem* const old = kept(wanted_);
    state_ = State::idle;
    read_ = now;
    if (old == nullptr || !received.is_same_place(*old)) {
        stale_ = true;
        drop();
        return;
    }
    is_verified_ = is_verified_ || wanted_ == progress_.sequence;  // the current item may have changed since
    find_goal();
}

void MissionClient::store(std::uint16_t sequence, MissionItem item, float param1, float param2) noexcept
{
    // Types 0 and 1 are airspeed and ground speed; a copter has one speed for both. -1: no change; -2: the vehicle's
    // own.
    if (item.command == kDoChangeSpeed && (param1 == 0.0F || param1 == 1.0F)) {
        const bool said = param2 > 0.0F && param2 < kLargestSpeed;
        speed_ = said ? param2 : param2 == -1.0F ? speed_ : 0.0F;
    }
    if (!is_kept(sequence)) {
        return;
    }
    item.known = true;
    item.speed = speed_;
    items_[sequence - first_] = item;
}

void MissionClient::end(MissionStep step, TimePoint now) noexcept
{
    state_ = State::idle;
    end_step_ = step;
    ends_ = !is_partner_ ? 0 : lone_ ? 1 : kEnds;
    end_at_ = now;
}

void MissionClient::give_up(Seconds rest, TimePoint now) noexcept
{
    stale_ = stale_ || !checks_;
    check_due_ = check_due_ || !is_verified_;
    state_ = State::idle;
    rest_until_ = now + rest;
    read_ = now;
}

void MissionClient::refused(std::uint8_t result, TimePoint now) noexcept
{
    if (result == 0 || state_ == State::idle) {
        return;
    }
    // A refusal of the comparison means that the mission is changing, or is shorter than before.
    stale_ = true;
    drop();
    give_up(result == kDenied ? kDeniedRest : kRest, now);
}

void MissionClient::others(bool upload, bool ended, TimePoint now) noexcept
{
    stale_ = stale_ || upload || (state_ != State::idle && !checks_);
    state_ = State::idle;
    is_partner_ = false;
    ends_ = 0;
    quiet_until_ = now + (ended ? kOthersEnded : kOthersTime);
}

bool MissionClient::wants_fetch(TimePoint now) const noexcept
{
    const bool outside = progress_.sequence < count_ && !is_kept(progress_.sequence);
    const bool unannounced = !lone_ && progress_.id == 0 && progress_.total == 0 && now - read_ >= kReadPeriod;
    return stale_ || outside || unannounced;
}

bool MissionClient::wants_check(TimePoint now) const noexcept
{
    return lone_ && (check_due_ || now - read_ >= kCheckPeriod);
}

MissionStep MissionClient::begin(TimePoint now) noexcept
{
    const bool fetch = wants_fetch(now);
    if (!has_current_ || now < rest_until_ || (!fetch && !wants_check(now))) {
        return MissionStep::none;
    }
    checks_ = !fetch;
    check_due_ = false;
    if (fetch) {
        stale_ = false;
        read_total_ = progress_.total;
        read_id_ = progress_.id;
    }
    state_ = State::await_count;
    asked_ = now;
    tries_ = 1;
    return MissionStep::list;
}

MissionStep MissionClient::repeat(TimePoint now) noexcept
{
    if (now - asked_ < kAnswerTime) {
        return MissionStep::none;
    }
    if (tries_ >= kTries) {
        const bool open = is_partner_ && !checks_;
        give_up(kRest, now);
        if (open) {
            end(MissionStep::cancel, now);
        }
        return MissionStep::none;
    }
    ++tries_;
    asked_ = now;
    return state_ == State::await_count ? MissionStep::list : MissionStep::item;
}

MissionStep MissionClient::next(TimePoint now) noexcept
{
    if (now < quiet_until_) {
        return MissionStep::none;
    }
    if (ends_ > 0) {
        if (now < end_at_) {
            return MissionStep::none;
        }
        --ends_;
        end_at_ = now + kEndPeriod;
        return end_step_;
    }
    switch (state_) {
    case State::idle: return begin(now);
    case State::ask_item:
        state_ = State::await_item;
        asked_ = now;
        tries_ = 1;
        return MissionStep::item;
    case State::await_count:
    case State::await_item: return repeat(now);
    }
    return MissionStep::none;
}

}  // namespace jink::link::mavlink
