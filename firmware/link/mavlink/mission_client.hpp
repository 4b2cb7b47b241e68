// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/time.hpp"

namespace jink::link::mavlink {

/// A mission item as far as a leg needs it.
struct MissionPoint {
    bool known = false;
    std::uint8_t frame = 0;
    std::int32_t x = 0;  ///< degE7, or local metres * 1e4
    std::int32_t y = 0;
    float z = 0.0F;  ///< [m]
};

/// What has to be sent next.
enum class MissionStep : std::uint8_t { none, list, item, finish };

/// Fetches the two ends of the leg being flown: the current mission item and the one before it.
///
/// MISSION_CURRENT starts it; MISSION_REQUEST_LIST, MISSION_COUNT, MISSION_REQUEST_INT for each, MISSION_ACK. A step
/// that is not answered within 1 s is repeated twice, then given up until the current item changes or 10 s have passed.
/// Pure and O(1).
class MissionClient {
public:
    /// MISSION_CURRENT.seq. Starts a fetch when it is another one than is known.
    void current(std::uint16_t sequence) noexcept;
    void count(std::uint16_t count, TimePoint now) noexcept;
    /// One item; false when it is not the one asked for.
    bool item(std::uint16_t sequence, std::uint16_t command, const MissionPoint& point, TimePoint now) noexcept;

    /// What to send now; `wanted()` says which item.
    [[nodiscard]] MissionStep next(TimePoint now) noexcept;
    [[nodiscard]] std::uint16_t wanted() const noexcept { return wanted_; }

    /// True once when both ends have arrived (`from().known` is false when the leg starts where the vehicle is).
    [[nodiscard]] bool take_leg() noexcept;
    /// True once per current item when its fetch was given up, or it has no place: where the vehicle is going is not
    /// known.
    [[nodiscard]] bool take_loss() noexcept;
    [[nodiscard]] const MissionPoint& from() const noexcept { return from_; }
    [[nodiscard]] const MissionPoint& to() const noexcept { return to_; }

    void forget() noexcept { *this = {}; }

private:
    enum class State : std::uint8_t { idle, ask_list, await_count, ask_item, await_item, done, given_up };
    void ask(State state) noexcept;
    void give_up(TimePoint now) noexcept;

    State state_ = State::idle;
    bool has_current_ = false;
    bool leg_ready_ = false;
    bool lost_ = false;
    bool told_lost_ = false;
    std::uint16_t current_ = 0;
    std::uint16_t wanted_ = 0;
    int tries_ = 0;
    TimePoint asked_;
    MissionPoint from_;
    MissionPoint to_;
};

}  // namespace jink::link::mavlink
