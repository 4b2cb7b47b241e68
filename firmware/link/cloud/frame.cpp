// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/cloud/frame.hpp"

#include <algorithm>

#include "firmware/link/mavlink/checksum.hpp"

namespace jink::link::cloud {
namespace {

constexpr std::size_t kHeaderChecksum = kHeaderSize - kChecksumSize;

[[nodiscard]] std::uint16_t u16_at(std::span<const std::byte> bytes, std::size_t at) noexcept
{
    return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) | std::to_integer<unsigned>(bytes[at + 1])
                                                                                 << 8U);
}

[[nodiscard]] std::uint32_t u32_at(std::span<const std::byte> bytes, std::size_t at) noexcept
{
    return u16_at(bytes, at) | static_cast<std::uint32_t>(u16_at(bytes, at + 2)) << 16U;
}

void put_u16(std::span<std::byte> bytes, std::size_t at, std::uint32_t value) noexcept
{
    bytes[at] = static_cast<std::byte>(value & 0xFFU);
    bytes[at + 1] = static_cast<std::byte>(value >> 8U & 0xFFU);
}

void put_u32(std::span<std::byte> bytes, std::size_t at, std::uint32_t value) noexcept
{
    put_u16(bytes, at, value);
    put_u16(bytes, at + 2, value >> 16U);
}

void put_i16(std::span<std::byte> bytes, std::size_t at, std::int16_t value) noexcept
{
    put_u16(bytes, at, static_cast<std::uint16_t>(value));
}

/// Checksum of bytes 2 .. end - 1; the start bytes are the same in every frame.
[[nodiscard]] std::uint16_t checksum_to(std::span<const std::byte> bytes, std::size_t end) noexcept
{
    mavlink::Checksum checksum;
    checksum.add(bytes.subspan(kSync.size(), end - kSync.size()));
    return checksum.value();
}

[[nodiscard]] bool is_within(std::int16_t value, std::int16_t most) noexcept { return value >= -most && value <= most; }

}  // namespace

bool is_plausible(const Part& part) noexcept
{
    return part.parts >= 1 && part.parts <= kMaxParts && part.part < part.parts && part.points <= kMaxPoints &&
           part.points <= part.scan_points && part.scan_points <= part.parts * kMaxPoints && part.max_range > 0 &&
           part.max_range < kNothingRange && is_within(part.roll, kHalfTurn) && is_within(part.pitch, kQuarterTurn);
}

std::size_t write_frame(Part part, std::span<const RawPoint> points, std::span<std::byte> out) noexcept
{
    const std::size_t size = frame_size(points.size());
    if (points.size() > kMaxPoints || out.size() < size) {
        return 0;
    }
    part.points = static_cast<std::uint16_t>(points.size());
    std::copy(kSync.begin(), kSync.end(), out.begin());
    out[2] = std::byte{kVersion};
    out[3] = std::byte{part.sensor};
    put_u16(out, 4, part.sequence);
    put_u16(out, 6, part.scan);
    put_u16(out, 8, part.part);
    put_u16(out, 10, part.parts);
    put_u16(out, 12, part.points);
    put_u16(out, 14, part.max_range);
    put_u32(out, 16, part.stamp_ms);
    put_i16(out, 20, part.roll);
    put_i16(out, 22, part.pitch);
    put_u16(out, 24, part.ray_pitch_level);
    put_u16(out, 26, part.ray_pitch_vertical);
    put_u32(out, 28, part.scan_points);
    put_u16(out, kHeaderChecksum, checksum_to(out, kHeaderChecksum));
    std::size_t at = kHeaderSize;
    for (const RawPoint& point : points) {
        put_i16(out, at, point.azimuth);
        put_i16(out, at + 2, point.elevation);
        put_u16(out, at + 4, point.range);
        at += kPointSize;
    }
    put_u16(out, at, checksum_to(out, at));
    return size;
}

std::optional<Part> read_header(std::span<const std::byte> bytes) noexcept
{
    if (u16_at(bytes, kHeaderChecksum) != checksum_to(bytes, kHeaderChecksum)) {
        return std::nullopt;
    }
    Part part;
    part.sensor = std::to_integer<std::uint8_t>(bytes[3]);
    part.sequence = u16_at(bytes, 4);
    part.scan = u16_at(bytes, 6);
    part.part = u16_at(bytes, 8);
    part.parts = u16_at(bytes, 10);
    part.points = u16_at(bytes, 12);
    part.max_range = u16_at(bytes, 14);
    part.stamp_ms = u32_at(bytes, 16);
    part.roll = static_cast<std::int16_t>(u16_at(bytes, 20));
    part.pitch = static_cast<std::int16_t>(u16_at(bytes, 22));
    part.ray_pitch_level = u16_at(bytes, 24);
    part.ray_pitch_vertical = u16_at(bytes, 26);
    part.scan_points = u32_at(bytes, 28);
    return part;
}

bool checksum_holds(std::span<const std::byte> frame) noexcept
{
    const std::size_t end = frame.size() - kChecksumSize;
    return u16_at(frame, end) == checksum_to(frame, end);
}

RawPoint read_point(std::span<const std::byte> frame, std::size_t i) noexcept
{
    const std::size_t at = kHeaderSize + i * kPointSize;
    return {static_cast<std::int16_t>(u16_at(frame, at)), static_cast<std::int16_t>(u16_at(frame, at + 2)),
            u16_at(frame, at + 4)};
}

}  // namespace jink::link::cloud
