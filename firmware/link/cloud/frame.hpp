// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

// The compact frame in which a LiDAR's driver sends its scans over a dedicated line. A scan is sent in parts, one part
// per frame; little-endian, offsets in bytes:
//
//    0  u8[2]  0x6A 0xC7
//    2  u8     version, 1
//    3  u8     sensor
//    4  u16    running number of the frame
//    6  u16    number of the scan
//    8  u16    part, 0 .. parts - 1
//   10  u16    parts of the scan, 1 .. kMaxParts
//   12  u16    points in this frame, 0 .. kMaxPoints
//   14  u16    range up to which a ray without a return is empty [cm], > 0
//   16  u32    stamp of the scan on the sender's clock [ms]
//   20  i16    roll of the sensor's platform at the stamp, right side down [1e-4 rad], within half a turn
//   22  i16    pitch, nose up [1e-4 rad], within a quarter turn
//   24  u16    pitch between rays of a row [1e-5 rad]; 0: not given
//   26  u16    pitch between rows [1e-5 rad]; 0: not given
//   28  u32    points of the whole scan
//   32  u16    checksum of bytes 2 .. 31
//   34  points, 6 bytes each:
//              i16 azimuth, from the nose to the left [1e-4 rad], within half a turn
//              i16 elevation, upwards [1e-4 rad], within a quarter turn
//              u16 range [cm]; 0: the ray is not valid; 65535: no return
//    n  u16    checksum of all bytes from 2 on
//
// Azimuth and elevation are in the platform's frame, whose axes are the vehicle's; roll and pitch rotate them to level.
// Both checksums are CRC-16/MCRF4XX, as in MAVLink. The header has its own checksum, so that a wrong length is detected
// before the receiver waits for the bytes.

namespace jink::link::cloud {

inline constexpr std::array<std::byte, 2> kSync{std::byte{0x6A}, std::byte{0xC7}};
inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::size_t kHeaderSize = 34;
inline constexpr std::size_t kPointSize = 6;
inline constexpr std::size_t kChecksumSize = 2;
/// Points in one frame: headers take 5 % of the line, and one wrong bit loses 0.1 % of 10^5 points.
inline constexpr std::size_t kMaxPoints = 120;
inline constexpr std::size_t kMaxFrame = kHeaderSize + kMaxPoints * kPointSize + kChecksumSize;
/// Parts of one scan: 122 880 points. A receiver stores one bit for each part.
inline constexpr std::size_t kMaxParts = 1024;

inline constexpr std::uint16_t kInvalidRange = 0;
inline constexpr std::uint16_t kNothingRange = 65535;
/// Half and quarter turn in wire units.
inline constexpr std::int16_t kHalfTurn = 31416;
inline constexpr std::int16_t kQuarterTurn = 15708;
inline constexpr float kAngleUnit = 1e-4F;  // [rad]
inline constexpr float kPitchUnit = 1e-5F;  // [rad]
inline constexpr float kRangeUnit = 0.01F;  // [m]

/// Header of a frame, in wire units.
struct Part {
    std::uint8_t sensor = 0;
    std::uint16_t sequence = 0;
    std::uint16_t scan = 0;
    std::uint16_t part = 0;
    std::uint16_t parts = 1;
    std::uint16_t points = 0;
    std::uint16_t max_range = 0;
    std::uint32_t stamp_ms = 0;
    std::int16_t roll = 0;
    std::int16_t pitch = 0;
    std::uint16_t ray_pitch_level = 0;
    std::uint16_t ray_pitch_vertical = 0;
    std::uint32_t scan_points = 0;
};

struct RawPoint {
    std::int16_t azimuth = 0;
    std::int16_t elevation = 0;
    std::uint16_t range = 0;
};

[[nodiscard]] constexpr std::size_t frame_size(std::size_t points) noexcept
{
    return kHeaderSize + points * kPointSize + kChecksumSize;
}

/// Whether parts, points and angles of a header are within their bounds.
[[nodiscard]] bool is_plausible(const Part& part) noexcept;

/// Writes one frame; part.points is set to points.size().
/// @return bytes written; 0 if there are more than kMaxPoints points or `out` is too small. O(points).
[[nodiscard]] std::size_t write_frame(Part part, std::span<const RawPoint> points, std::span<std::byte> out) noexcept;

/// Header of a possible frame.
/// @param bytes  from the start bytes on, kHeaderSize or more
/// @return nothing if the header's checksum is wrong. O(1).
[[nodiscard]] std::optional<Part> read_header(std::span<const std::byte> bytes) noexcept;

/// Whether the checksum at the end of a whole frame is correct. O(frame).
[[nodiscard]] bool checksum_holds(std::span<const std::byte> frame) noexcept;

/// Point `i` of a whole frame. O(1).
[[nodiscard]] RawPoint read_point(std::span<const std::byte> frame, std::size_t i) noexcept;

}  // namespace jink::link::cloud
