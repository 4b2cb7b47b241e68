// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/capacity.hpp"

namespace jink::link::mavlink {

/// The fields of a mission item that a leg needs.
struct MissionItem {
    bool known = false;
    std::uint8_t frame = 0;     ///< MAV_FRAME
    std::uint16_t command = 0;  ///< MAV_CMD
    std::int32_t x = 0;         ///< degE7, or local metres * 1e4
    std::int32_t y = 0;
    float z = 0.0F;      ///< [m]
    float speed = 0.0F;  ///< ground speed set by DO_CHANGE_SPEED items up to this one [m/s]; 0: not given

    [[nodiscard]] bool is_same_place(const MissionItem& other) const noexcept
    {
        return known == other.known && frame == other.frame && command == other.command && x == other.x &&
               y == other.y && z == other.z;
    }
};

/// The used fields of MISSION_CURRENT. Fields that the autopilot does not send are 0.
struct MissionProgress {
    std::uint16_t sequence = 0;
    std::uint16_t total = 0;
    std::uint32_t id = 0;
    bool complete = false;  ///< mission_state MISSION_STATE_COMPLETE: the current item is no longer flown
};

/// The next message to send: MISSION_REQUEST_LIST, MISSION_REQUEST_INT, MISSION_ACK accepted or cancelled.
enum class MissionStep : std::uint8_t { none, list, item, accept, cancel };

/// Keeps a copy of the autopilot's mission, read within the rules of PX4 and ArduPilot.
///
/// PX4 (mavlink_mission.cpp): after MISSION_REQUEST_LIST it accepts a request for the next item in order or for the
/// last one again, and answers every other with a CRITICAL text to the pilot. A transfer without a final MISSION_ACK
/// ends 5 s after the last request, with a CRITICAL text too. A MISSION_ACK or a request from a system other than PX4's
/// partner is a third such text. Hence:
/// * Items are requested from 0 on, one after the other. A step without answer for 1 s is repeated twice.
/// * Every transfer ends with MISSION_ACK, three times 0.5 s apart (PX4 ignores repetitions; ArduPilot all, and gets
///   one): also the transfer of an empty mission, one cut short, and one given up. The next transfer begins after the
///   last of them.
/// * MISSION_ACK is sent only once a MISSION_COUNT has shown that the autopilot accepts us as its partner. Without a
///   MISSION_COUNT, MISSION_REQUEST_LIST is repeated after 4 s at most, which keeps PX4's 5 s from running out.
/// * 2 s without a frame may be a restart, after which PX4 has no partner: the transfer restarts with
///   MISSION_REQUEST_LIST, 2 s later, when the late answers of a stalled line have arrived.
/// * While another system's transfer is visible, nothing is sent: 9 s after its last message (PX4 ends it after 5 s,
///   ArduPilot after 8 s), 1 s after the MISSION_ACK that ends it. ArduPilot answers MISSION_ACK denied, without a
///   text, during an upload on another line; PX4 keeps a transfer per line.
///
/// The copy is dropped and read again when MISSION_CURRENT announces another id or total, or MISSION_COUNT another
/// count or id. PX4 announces a checksum as id. ArduPilot (MissionItemProtocol.cpp) announces the total, has an id in
/// MISSION_COUNT in newer versions only, and answers requests in any order (`set_lone`): every 5 s, and when the
/// current item changes, the count and the current item are read and compared. A PX4 without id and total is read again
/// every 20 s.
///
/// goal() is known once the copy is verified: a mission may be replaced during reading, and ArduPilot's by one of the
/// same length without notice. PX4: the first MISSION_CURRENT after the last item announces the id of MISSION_COUNT.
/// ArduPilot: the comparison after the last item, or after a change of the current one. So on a line without losses the
/// goal is the autopilot's present goal, as of the newest MISSION_CURRENT (PX4) or comparison (ArduPilot, 5 s). A PX4
/// without ids is not verified.
///
/// Pure. O(1), except current(), count() and item(): O(kMaxMissionItems).
class MissionClient {
public:
    /// Whether single items may be requested in any order: ArduPilot.
    void set_lone(bool lone) noexcept { lone_ = lone; }
    /// Any frame of the autopilot: call this before its content is passed on.
    void heard(TimePoint now) noexcept;
    void current(const MissionProgress& progress, TimePoint now) noexcept;
    /// MISSION_COUNT for us; `id` 0: not given.
    void count(std::uint16_t count, std::uint32_t id, TimePoint now) noexcept;
    /// MISSION_ITEM_INT for us, with its params 1 and 2; false unless it is the requested one.
    bool item(std::uint16_t sequence, const MissionItem& item, float param1, float param2, TimePoint now) noexcept;
    /// MISSION_ACK for us: other than accepted (0) ends the transfer.
    void refused(std::uint8_t result, TimePoint now) noexcept;
    /// Another system's transfer is visible. `ended`: by its MISSION_ACK; `upload`: it may have changed the mission.
    void others(bool upload, bool ended, TimePoint now) noexcept;
    /// The autopilot reports that it restarted its current item.
    void suspect() noexcept { check_due_ = true; }

    /// The message to send now; `wanted()` is the requested item.
    [[nodiscard]] MissionStep next(TimePoint now) noexcept;
    [[nodiscard]] std::uint16_t wanted() const noexcept { return wanted_; }

    /// The navigation item being flown: the current one, or the first after it if that is a DO_ or condition item. Null
    /// while unknown, when the mission is complete, and for ArduPilot's item 0, which is home.
    [[nodiscard]] const MissionItem* goal() const noexcept { return goal_.known ? &goal_ : nullptr; }
    /// Increases whenever another item is flown, or the same number has another place.
    [[nodiscard]] std::uint32_t version() const noexcept { return version_; }
    [[nodiscard]] std::uint16_t sequence() const noexcept { return progress_.sequence; }

    void forget() noexcept { *this = {}; }

private:
    enum class State : std::uint8_t { idle, await_count, ask_item, await_item };

    [[nodiscard]] MissionStep begin(TimePoint now) noexcept;
    [[nodiscard]] MissionStep repeat(TimePoint now) noexcept;
    void begin_items(std::uint16_t count, std::uint32_t id) noexcept;
    void compare(const MissionItem& item, TimePoint now) noexcept;
    void store(std::uint16_t sequence, MissionItem item, float param1, float param2) noexcept;
    void end(MissionStep step, TimePoint now) noexcept;
    void give_up(Seconds rest, TimePoint now) noexcept;
    void invalidate(TimePoint now) noexcept;
    void drop() noexcept;
    void find_goal() noexcept;
    [[nodiscard]] bool is_kept(std::uint16_t sequence) const noexcept;
    [[nodiscard]] const MissionItem* kept(std::size_t sequence) const noexcept;
    [[nodiscard]] bool wants_fetch(TimePoint now) const noexcept;
    [[nodiscard]] bool wants_check(TimePoint now) const noexcept;

    State state_ = State::idle;
    bool lone_ = false;
    bool checks_ = false;  ///< the transfer under way compares the current item only
    bool has_current_ = false;
    bool stale_ = true;  ///< to be read as soon as possible
    bool check_due_ = false;
    bool is_verified_ = false;  ///< the copy of the current item equals the autopilot's
    bool is_partner_ = false;   ///< the autopilot accepts us as the partner of its last transfer
    MissionStep end_step_ = MissionStep::none;
    int ends_ = 0;  ///< MISSION_ACKs still to be sent
    int tries_ = 0;
    TimePoint asked_;
    TimePoint end_at_;
    TimePoint quiet_until_;
    TimePoint rest_until_;
    TimePoint heard_;
    TimePoint read_;  ///< when the mission was last read or compared

    MissionProgress progress_;
    std::uint16_t read_total_ = 0;  ///< announced when the copy was begun
    std::uint32_t read_id_ = 0;
    std::uint16_t count_ = 0;
    std::uint32_t id_ = 0;     ///< by MISSION_COUNT
    std::uint16_t first_ = 0;  ///< sequence number of items_[0]
    std::uint16_t end_ = 0;    ///< one past the last kept sequence number
    std::uint16_t wanted_ = 0;
    float speed_ = 0.0F;  ///< set by the items read so far [m/s]
    std::uint32_t version_ = 0;
    std::uint16_t goal_sequence_ = 0;
    MissionItem goal_;
    std::uint16_t last_sequence_ = 0;  ///< of the last known goal
    MissionItem last_goal_;
    std::array<MissionItem, kMaxMissionItems> items_{};
};

}  // namespace jink::link::mavlink
