// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/link/mavlink/field.hpp"

// What goes over the mission line: between a vehicle, those around it and whoever plans for them (G-ORCA 16). Positions
// and velocities are in the world frame that all of them share (ENU, m, m/s). Times are ages [ms] when the frame was
// made, so no clocks have to agree.
//
// Each message is a structure and a table of its fields, which lie in the payload in the order of the table without
// gaps, little-endian; the codec is MAVLink's pack and unpack.

namespace jink::link::mission {

using mavlink::Field;
using mavlink::FieldType;

enum class MessageType : std::uint8_t {
    task_upload = 1,      ///< in, event: part of a path; answered by task_ack
    task_ack = 2,         ///< out, event
    state_own = 3,        ///< in, stream: this vehicle, from its localisation
    state_neighbour = 4,  ///< in and out, stream: a vehicle says of itself
    command = 5,          ///< out, stream: what is flown (CMD_VEL)
    mission_report = 6,   ///< out, event: on a change, and again every second
    monitor_trip = 7,     ///< out, event: once a second until it is acknowledged
    trip_ack = 8,         ///< in, event
    config = 9,           ///< in, event: reads or sets a setting; answered by config_ack
    config_ack = 10,      ///< out, event
    map_info = 11,        ///< in: asks for it, whatever its fields say; out: the answer
};

/// Gives the fields their places, one behind the other.
template <std::size_t N>
[[nodiscard]] constexpr std::array<Field, N> laid_out(std::array<Field, N> fields) noexcept
{
    std::size_t at = 0;
    for (Field& field : fields) {
        field.wire_offset = static_cast<std::uint8_t>(at);
        at += field.count * mavlink::element_size(field.type);
    }
    return fields;
}
/// Bytes of a payload.
[[nodiscard]] constexpr std::size_t size_of(std::span<const Field> fields) noexcept
{
    std::size_t size = 0;
    for (const Field& field : fields) {
        size += field.count * mavlink::element_size(field.type);
    }
    return size;
}

/// Points of a path in one frame: 214 of 255 bytes.
inline constexpr std::size_t kPointsPerUpload = 12;
inline constexpr std::uint8_t kContinues = 1;  ///< TaskUpload::flags: goes on where the path ends that is flown
inline constexpr std::uint8_t kLast = 2;       ///< the path ends with this task

/// Part `part` of `parts` of a task. All fields but part, points and what they are about are the same in all parts.
struct TaskUpload {
    std::uint32_t task = 0;  ///< number of the task; another one for another path
    std::uint16_t part = 0;
    std::uint16_t parts = 1;
    std::uint32_t crc = 0;  ///< CRC-32 (IEEE 802.3) over all points: x, y, z, arrival of each, as they lie on the wire
    float cruise_speed = 1.0F;
    float time_limit = 0.0F;  ///< [s]; 0: none
    std::uint8_t flags = kLast;
    std::uint8_t points = 0;                                   ///< in this part, 1 .. kPointsPerUpload
    std::array<float, 3 * kPointsPerUpload> position{};        ///< x, y, z of each [m]
    std::array<std::uint32_t, kPointsPerUpload> arrival_ms{};  ///< since the start of the path, increasing

    static constexpr MessageType kType = MessageType::task_upload;
    static const std::array<Field, 10> kFields;
};
inline constexpr std::array<Field, 10> TaskUpload::kFields = laid_out<10>({{
    {offsetof(TaskUpload, task), 0, 1, FieldType::u32},
    {offsetof(TaskUpload, part), 0, 1, FieldType::u16},
    {offsetof(TaskUpload, parts), 0, 1, FieldType::u16},
    {offsetof(TaskUpload, crc), 0, 1, FieldType::u32},
    {offsetof(TaskUpload, cruise_speed), 0, 1, FieldType::f32},
    {offsetof(TaskUpload, time_limit), 0, 1, FieldType::f32},
    {offsetof(TaskUpload, flags), 0, 1, FieldType::u8},
    {offsetof(TaskUpload, points), 0, 1, FieldType::u8},
    {offsetof(TaskUpload, position), 0, 3 * kPointsPerUpload, FieldType::f32},
    {offsetof(TaskUpload, arrival_ms), 0, kPointsPerUpload, FieldType::u32},
}});

/// Why a part or a task is not taken.
enum class TaskStatus : std::uint8_t {
    accepted = 0,      ///< the whole task; it is flown
    more = 1,          ///< the part; `next` is awaited
    out_of_order = 2,  ///< the part is not `next`; send from there
    busy = 3,          ///< another task is being uploaded, or there is no room for a continuation yet
    inconsistent = 4,  ///< with the parts before, or numbers that cannot be
    bad_crc = 5,
    bad_point = 6,      ///< not finite, too far, or not later than the one before
    path_too_long = 7,  ///< PATH_TOO_LONG
    no_path = 8,        ///< fewer than two places
    gap = 9,            ///< a continuation that begins elsewhere
    queue_full = 10,    ///< more events at once than are taken; send again
};
struct TaskAck {
    std::uint32_t task = 0;
    std::uint16_t next = 0;   ///< part that is awaited
    std::uint8_t status = 0;  ///< TaskStatus

    static constexpr MessageType kType = MessageType::task_ack;
    static const std::array<Field, 3> kFields;
};
inline constexpr std::array<Field, 3> TaskAck::kFields = laid_out<3>({{
    {offsetof(TaskAck, task), 0, 1, FieldType::u32},
    {offsetof(TaskAck, next), 0, 1, FieldType::u16},
    {offsetof(TaskAck, status), 0, 1, FieldType::u8},
}});

struct StateOwn {
    std::uint16_t age_ms = 0;
    std::array<float, 3> position{};
    std::array<float, 3> velocity{};
    float yaw = 0.0F;  ///< [rad], counter-clockwise from east

    static constexpr MessageType kType = MessageType::state_own;
    static const std::array<Field, 4> kFields;
};
inline constexpr std::array<Field, 4> StateOwn::kFields = laid_out<4>({{
    {offsetof(StateOwn, age_ms), 0, 1, FieldType::u16},
    {offsetof(StateOwn, position), 0, 3, FieldType::f32},
    {offsetof(StateOwn, velocity), 0, 3, FieldType::f32},
    {offsetof(StateOwn, yaw), 0, 1, FieldType::f32},
}});

inline constexpr std::size_t kCommandsPerState = 8;
/// Of the vehicle that sends it.
struct StateNeighbour {
    std::uint16_t age_ms = 0;  ///< of position and velocity
    std::array<float, 3> position{};
    std::array<float, 3> velocity{};
    std::array<float, 3> preferred{};  ///< velocity that it would fly alone
    float radius_xy = 0.6F;            ///< its share of the required separations [m], > 0
    float radius_z = 0.3F;             ///< [m], > 0
    float max_speed = 1.5F;            ///< [m/s], > 0
    float max_acceleration = 2.0F;     ///< [m/s2], > 0
    float horizon = 10.0F;             ///< tau [s], > 0
    float act = 0.0F;                  ///< T_act [s], >= 0
    float lag = 0.0F;                  ///< T_v [s], >= 0
    std::uint8_t cooperative = 1;
    std::uint8_t commands = 0;  ///< how many follow, the oldest first
    std::array<std::uint16_t, kCommandsPerState> command_age_ms{};
    std::array<float, 3 * kCommandsPerState> command{};

    static constexpr MessageType kType = MessageType::state_neighbour;
    static const std::array<Field, 15> kFields;
};
inline constexpr std::array<Field, 15> StateNeighbour::kFields = laid_out<15>({{
    {offsetof(StateNeighbour, age_ms), 0, 1, FieldType::u16},
    {offsetof(StateNeighbour, position), 0, 3, FieldType::f32},
    {offsetof(StateNeighbour, velocity), 0, 3, FieldType::f32},
    {offsetof(StateNeighbour, preferred), 0, 3, FieldType::f32},
    {offsetof(StateNeighbour, radius_xy), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, radius_z), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, max_speed), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, max_acceleration), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, horizon), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, act), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, lag), 0, 1, FieldType::f32},
    {offsetof(StateNeighbour, cooperative), 0, 1, FieldType::u8},
    {offsetof(StateNeighbour, commands), 0, 1, FieldType::u8},
    {offsetof(StateNeighbour, command_age_ms), 0, kCommandsPerState, FieldType::u16},
    {offsetof(StateNeighbour, command), 0, 3 * kCommandsPerState, FieldType::f32},
}});

struct CommandSent {
    std::array<float, 3> velocity{};
    std::uint32_t status = 0;  ///< of the avoidance, its bits
    std::uint8_t level = 0;    ///< that was relaxed

    static constexpr MessageType kType = MessageType::command;
    static const std::array<Field, 3> kFields;
};
inline constexpr std::array<Field, 3> CommandSent::kFields = laid_out<3>({{
    {offsetof(CommandSent, velocity), 0, 3, FieldType::f32},
    {offsetof(CommandSent, status), 0, 1, FieldType::u32},
    {offsetof(CommandSent, level), 0, 1, FieldType::u8},
}});

struct MissionReport {
    std::uint32_t task = 0;
    float left = 0.0F;         ///< way to the end [m]
    float error = 0.0F;        ///< distance from the path [m]
    std::uint16_t faults = 0;  ///< of the protocol (app::MissionFault)
    std::uint8_t status = 0;   ///< path::GeneratorStatus
    std::uint16_t neighbours = 0;

    static constexpr MessageType kType = MessageType::mission_report;
    static const std::array<Field, 6> kFields;
};
inline constexpr std::array<Field, 6> MissionReport::kFields = laid_out<6>({{
    {offsetof(MissionReport, task), 0, 1, FieldType::u32},
    {offsetof(MissionReport, left), 0, 1, FieldType::f32},
    {offsetof(MissionReport, error), 0, 1, FieldType::f32},
    {offsetof(MissionReport, faults), 0, 1, FieldType::u16},
    {offsetof(MissionReport, status), 0, 1, FieldType::u8},
    {offsetof(MissionReport, neighbours), 0, 1, FieldType::u16},
}});

struct MonitorTrip {
    std::uint32_t age_ms = 0;
    std::uint16_t trip = 0;    ///< number of the trip since start
    std::uint8_t subject = 0;  ///< orca::Subject
    std::uint16_t id = 0;      ///< of the vehicle or piece
    float horizontal = 0.0F;   ///< [m]
    float vertical = 0.0F;     ///< [m]

    static constexpr MessageType kType = MessageType::monitor_trip;
    static const std::array<Field, 6> kFields;
};
inline constexpr std::array<Field, 6> MonitorTrip::kFields = laid_out<6>({{
    {offsetof(MonitorTrip, age_ms), 0, 1, FieldType::u32},
    {offsetof(MonitorTrip, trip), 0, 1, FieldType::u16},
    {offsetof(MonitorTrip, subject), 0, 1, FieldType::u8},
    {offsetof(MonitorTrip, id), 0, 1, FieldType::u16},
    {offsetof(MonitorTrip, horizontal), 0, 1, FieldType::f32},
    {offsetof(MonitorTrip, vertical), 0, 1, FieldType::f32},
}});

/// Acknowledges the trip of this number, and no later one.
struct TripAck {
    std::uint16_t trip = 0;

    static constexpr MessageType kType = MessageType::trip_ack;
    static const std::array<Field, 1> kFields;
};
inline constexpr std::array<Field, 1> TripAck::kFields = laid_out<1>({{
    {offsetof(TripAck, trip), 0, 1, FieldType::u16},
}});

enum class ConfigStatus : std::uint8_t {
    ok = 0,
    unknown_key = 1,
    out_of_range = 2,
    unsafe = 3,      ///< CONFIG_UNSAFE: it would break what the settings have to keep together
    queue_full = 4,  ///< more events at once than are taken; send again
};
struct Config {
    std::uint16_t key = 0;
    std::uint8_t set = 0;  ///< 0: read
    float value = 0.0F;

    static constexpr MessageType kType = MessageType::config;
    static const std::array<Field, 3> kFields;
};
inline constexpr std::array<Field, 3> Config::kFields = laid_out<3>({{
    {offsetof(Config, key), 0, 1, FieldType::u16},
    {offsetof(Config, set), 0, 1, FieldType::u8},
    {offsetof(Config, value), 0, 1, FieldType::f32},
}});
struct ConfigAck {
    std::uint16_t key = 0;
    std::uint8_t status = 0;  ///< ConfigStatus
    float value = 0.0F;       ///< in force; 0 where the key is not known

    static constexpr MessageType kType = MessageType::config_ack;
    static const std::array<Field, 3> kFields;
};
inline constexpr std::array<Field, 3> ConfigAck::kFields = laid_out<3>({{
    {offsetof(ConfigAck, key), 0, 1, FieldType::u16},
    {offsetof(ConfigAck, status), 0, 1, FieldType::u8},
    {offsetof(ConfigAck, value), 0, 1, FieldType::f32},
}});

/// Of the map that obstacles are avoided by; all 0 where there is none.
struct MapInfo {
    std::uint32_t crc = 0;
    std::uint16_t version = 0;
    std::uint16_t pieces = 0;

    static constexpr MessageType kType = MessageType::map_info;
    static const std::array<Field, 3> kFields;
};
inline constexpr std::array<Field, 3> MapInfo::kFields = laid_out<3>({{
    {offsetof(MapInfo, crc), 0, 1, FieldType::u32},
    {offsetof(MapInfo, version), 0, 1, FieldType::u16},
    {offsetof(MapInfo, pieces), 0, 1, FieldType::u16},
}});

/// Bytes of the payload of a message; 0: there is no such message. O(1).
[[nodiscard]] constexpr std::size_t payload_size(std::uint8_t type) noexcept
{
    constexpr std::array<std::size_t, 12> kSizes{0,
                                                 size_of(TaskUpload::kFields),
                                                 size_of(TaskAck::kFields),
                                                 size_of(StateOwn::kFields),
                                                 size_of(StateNeighbour::kFields),
                                                 size_of(CommandSent::kFields),
                                                 size_of(MissionReport::kFields),
                                                 size_of(MonitorTrip::kFields),
                                                 size_of(TripAck::kFields),
                                                 size_of(Config::kFields),
                                                 size_of(ConfigAck::kFields),
                                                 size_of(MapInfo::kFields)};
    return type < kSizes.size() ? kSizes[type] : 0;
}

}  // namespace jink::link::mission
