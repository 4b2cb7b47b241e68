// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace jink::sim {

/// Sender of a record's bytes.
enum class WireDirection : std::uint8_t { from_autopilot = 0, from_jink = 1 };

/// One piece of a recorded stream.
struct WireRecord {
    double time = 0.0;  ///< since the recording began [s]
    WireDirection direction = WireDirection::from_autopilot;
    std::vector<std::byte> bytes;
};

/// A recorded stream between an autopilot and jinkd, both directions.
struct WireFile {
    std::vector<WireRecord> records;  ///< in the order of the file; times do not decrease
    std::string fault;                ///< damage after the last record; empty: the file is complete
};

/// Longest pause between two records [s]. A longer pause is a damaged time stamp.
inline constexpr double kLongestWirePause = 600.0;
/// Largest record [bytes]; a datagram has 65535 at most.
inline constexpr std::uint32_t kLargestWireRecord = 1U << 17U;
/// Largest file once unpacked [bytes]: 9 hours of PX4's streams in the simulator.
inline constexpr std::size_t kLargestWireFile = std::size_t{1} << 30U;

/// Reads `<dBI` records, little-endian: seconds, direction, length; then that many bytes. Plain or packed by xz,
/// recognised by the first bytes, not by the name.
///
/// A truncated or damaged file gives the records before the damage and `fault`: a record cut off, a direction other
/// than 0 and 1, a time that is not finite, negative, earlier than the one before or more than kLongestWirePause later,
/// a length above kLargestWireRecord, damaged xz data, no record at all. O(bytes).
/// @throws std::runtime_error when the file cannot be opened or read
[[nodiscard]] WireFile read_wire_file(const std::filesystem::path& path);

/// The same for bytes in memory, packed or plain.
[[nodiscard]] WireFile read_wire(std::span<const std::byte> bytes);

}  // namespace jink::sim
