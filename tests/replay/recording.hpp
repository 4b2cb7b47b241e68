// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "toolchain/sim/replay.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::replay_test {

using sim::Vec;

/// A MAVLink 2 frame of a recording. Read by this test's own reader, not by the product's parser.
struct RawFrame {
    double time = 0.0;  ///< of the record that completes it [s]
    std::uint8_t system = 0;
    std::uint8_t component = 0;
    std::uint32_t message = 0;
    std::vector<std::byte> bytes;             ///< all of the frame
    std::array<std::uint8_t, 255> payload{};  ///< zeros behind the sent bytes
};

/// Frames of the autopilot's direction in their order. Bytes between frames are left out.
[[nodiscard]] std::vector<RawFrame> frames_of(const std::vector<sim::WireRecord>& records);

/// The vehicle's true position and velocity.
struct TruePoint {
    double time = 0.0;
    Vec position = Vec::Zero();  ///< about the origin of the autopilot's local frame, ENU [m]
    Vec velocity = Vec::Zero();  ///< [m/s]
};

/// A mode as reported by the recording's ground station.
struct SeenMode {
    double time = 0.0;
    std::string name;  ///< as mode_names.hpp has it
    bool armed = false;
};

struct Recording {
    std::string name;
    sim::WireFile wire;
    std::vector<RawFrame> frames;
    std::vector<TruePoint> truth;
    std::vector<SeenMode> modes;
    std::vector<double> changes;  ///< times of changes: modes, mission items, take-off

    /// Cubic between the two true points about `time`; nothing before the first and where a second is missing.
    [[nodiscard]] std::optional<TruePoint> truth_at(double time) const;
    /// Newest frame of this message by the autopilot up to `time`; nullptr: none.
    [[nodiscard]] const RawFrame* newest(std::uint32_t message, double time) const;
};

/// Names of all recordings.
[[nodiscard]] const std::vector<std::string>& recording_names();

/// A recording with the records of its ground station and simulator; read once. nullptr if the folder lacks it:
/// JINK_RECORDINGS names the folder, else JINK_RECORDINGS_DEFAULT of the build.
[[nodiscard]] const Recording* find_recording(const std::string& name);

/// The present code's belief in each second of a recording; replayed once.
[[nodiscard]] const std::vector<sim::Belief>& beliefs_of(const Recording& recording);

/// East, north and up of a place about an origin [m], both as on the wire (degE7, mm); in double, on PX4's sphere.
[[nodiscard]] Vec local_of(const std::array<double, 3>& place, const std::array<std::int32_t, 3>& origin);

/// Latitude, longitude and altitude at the start of a payload.
[[nodiscard]] std::array<std::int32_t, 3> place_in(const RawFrame& frame);

inline constexpr std::uint32_t kHeartbeatId = 0;
inline constexpr std::uint32_t kLocalPositionId = 32;
inline constexpr std::uint32_t kOriginId = 49;
inline constexpr std::uint32_t kHomeId = 242;
inline constexpr std::uint32_t kAdsbId = 246;

}  // namespace jink::replay_test
