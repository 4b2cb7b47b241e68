// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/constraint_message.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/link/mavlink/codec.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kArea = 1;
constexpr std::uint8_t kAnswer = 2;
constexpr std::int64_t kMicrosPerMilli = 1000;
constexpr std::int64_t kMicrosPerSecond = 1'000'000;
constexpr float kMillimetres = 1000.0F;

struct AreaPayload {
    std::uint8_t version = kVersion;
    std::uint8_t kind = kArea;
    std::uint8_t set = 0;
    std::uint8_t index = 0;
    std::uint8_t count = 0;
    std::uint8_t frame = 0;
    std::uint16_t reserved = 0;
    std::uint32_t age = 0;   ///< [ms]
    std::uint32_t ends = 0;  ///< [s]
    std::int32_t north = 0;
    std::int32_t east = 0;
    float bottom = 0.0F;
    float top = 0.0F;
    float radius = 0.0F;
    float margin = 0.0F;
    float velocity_north = 0.0F;
    float velocity_east = 0.0F;
};
constexpr std::uint8_t kAreaSize = 48;
constexpr std::array<Field, 17> kAreaFields{{
    {offsetof(AreaPayload, version), 0, 1, FieldType::u8},
    {offsetof(AreaPayload, kind), 1, 1, FieldType::u8},
    {offsetof(AreaPayload, set), 2, 1, FieldType::u8},
    {offsetof(AreaPayload, index), 3, 1, FieldType::u8},
    {offsetof(AreaPayload, count), 4, 1, FieldType::u8},
    {offsetof(AreaPayload, frame), 5, 1, FieldType::u8},
    {offsetof(AreaPayload, reserved), 6, 1, FieldType::u16},
    {offsetof(AreaPayload, age), 8, 1, FieldType::u32},
    {offsetof(AreaPayload, ends), 12, 1, FieldType::u32},
    {offsetof(AreaPayload, north), 16, 1, FieldType::i32},
    {offsetof(AreaPayload, east), 20, 1, FieldType::i32},
    {offsetof(AreaPayload, bottom), 24, 1, FieldType::f32},
    {offsetof(AreaPayload, top), 28, 1, FieldType::f32},
    {offsetof(AreaPayload, radius), 32, 1, FieldType::f32},
    {offsetof(AreaPayload, margin), 36, 1, FieldType::f32},
    {offsetof(AreaPayload, velocity_north), 40, 1, FieldType::f32},
    {offsetof(AreaPayload, velocity_east), 44, 1, FieldType::f32},
}};

constexpr std::uint8_t kAnswerSize = 5;

AreaPayload unpacked(const Tunnel& message) noexcept
{
    std::array<std::byte, kMaxPayload> bytes{};
    const auto payload = std::as_bytes(std::span(message.payload));
    std::copy(payload.begin(), payload.end(), bytes.begin());
    AreaPayload area;
    unpack(bytes, kAreaFields, reinterpret_cast<std::byte*>(&area));
    return area;
}

}  // namespace

bool is_constraint_answer(const Tunnel& message) noexcept
{
    return message.payload_length > 1 && message.payload[1] == kAnswer;
}

bool read_constraint(const Tunnel& message, TimePoint now, ConstraintPart& part) noexcept
{
    const AreaPayload area = unpacked(message);
    part = {};
    part.set = message.payload_length > 2 ? area.set : std::uint8_t{0};
    part.index = message.payload_length > 3 ? area.index : std::uint8_t{0};
    const bool global = area.frame == static_cast<std::uint8_t>(ConstraintFrame::global);
    const bool is_indexed = area.index < area.count || (area.count == 0 && area.index == 0);
    if (message.payload_length != kAreaSize || area.version != kVersion || area.kind != kArea || !is_indexed ||
        (!global && area.frame != static_cast<std::uint8_t>(ConstraintFrame::local))) {
        return false;
    }
    part.count = area.count;
    Constraint& constraint = part.constraint;
    constraint.stamp = {now.us - std::int64_t{area.age} * kMicrosPerMilli};
    if (area.ends > 0) {
        constraint.ends = {constraint.stamp.us + std::int64_t{area.ends} * kMicrosPerSecond};
    }
    world::Cylinder& cylinder = constraint.cylinder;
    if (global) {
        constraint.about = GlobalPosition{area.north, area.east, 0};
    } else {
        cylinder.circle.centre = {static_cast<float>(area.east) / kMillimetres,
                                  static_cast<float>(area.north) / kMillimetres};
    }
    cylinder.circle.radius = area.radius;
    cylinder.velocity = {area.velocity_east, area.velocity_north};
    cylinder.bottom = area.bottom;
    cylinder.top = area.top;
    cylinder.margin = area.margin;
    return true;
}

Tunnel constraint_message(const ConstraintPart& part, TimePoint now) noexcept
{
    const Constraint& constraint = part.constraint;
    const world::Cylinder& cylinder = constraint.cylinder;
    AreaPayload area;
    area.set = part.set;
    area.index = part.index;
    area.count = part.count;
    area.age = static_cast<std::uint32_t>(std::max<std::int64_t>(0, (now.us - constraint.stamp.us) / kMicrosPerMilli));
    if (constraint.ends != Constraint{}.ends) {
        area.ends = static_cast<std::uint32_t>(
            std::max<std::int64_t>(1, (constraint.ends.us - constraint.stamp.us) / kMicrosPerSecond));
    }
    if (constraint.about) {
        area.frame = static_cast<std::uint8_t>(ConstraintFrame::global);
        area.north = constraint.about->lat;
        area.east = constraint.about->lon;
    } else {
        area.north = static_cast<std::int32_t>(std::lround(kMillimetres * cylinder.circle.centre.y()));
        area.east = static_cast<std::int32_t>(std::lround(kMillimetres * cylinder.circle.centre.x()));
    }
    area.bottom = cylinder.bottom;
    area.top = cylinder.top;
    area.radius = cylinder.circle.radius;
    area.margin = cylinder.margin;
    area.velocity_north = cylinder.velocity.y();
    area.velocity_east = cylinder.velocity.x();
    std::array<std::byte, kMaxPayload> bytes{};
    pack(reinterpret_cast<const std::byte*>(&area), kAreaFields, bytes);
    Tunnel message;
    message.payload_type = kConstraintPayload;
    message.payload_length = kAreaSize;
    const auto payload = std::as_writable_bytes(std::span(message.payload));
    std::copy_n(bytes.begin(), payload.size(), payload.begin());
    return message;
}

Tunnel constraint_answer(const ConstraintAnswer& answer) noexcept
{
    Tunnel message;
    message.payload_type = kConstraintPayload;
    message.payload_length = kAnswerSize;
    const std::array<std::uint8_t, kAnswerSize> payload{kVersion, kAnswer, answer.set, answer.index,
                                                        static_cast<std::uint8_t>(answer.result)};
    std::copy(payload.begin(), payload.end(), message.payload.begin());
    return message;
}

bool read_constraint_answer(const Tunnel& message, ConstraintAnswer& answer) noexcept
{
    if (message.payload_type != kConstraintPayload || message.payload_length != kAnswerSize ||
        message.payload[0] != kVersion || message.payload[1] != kAnswer ||
        message.payload[4] > static_cast<std::uint8_t>(ConstraintResult::too_many)) {
        return false;
    }
    answer = {message.payload[2], message.payload[3], static_cast<ConstraintResult>(message.payload[4])};
    return true;
}

}  // namespace jink::link::mavlink
