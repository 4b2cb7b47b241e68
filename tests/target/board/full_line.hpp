// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "toolchain/sim/plant.hpp"

namespace jink::target {

/// 921600 baud, ten bits a byte.
inline constexpr std::uint32_t kLineBytesPerSecond = 92'160;

/// Largest number of bytes in transit or unread: 33 ms of the line.
inline constexpr std::uint64_t kMaxUnread = 3'000;
/// Each of our TIMESYNC requests carries this plus the number of preceding bytes. The answer returns it.
inline constexpr std::int64_t kPlaceMark = std::int64_t{1} << 62;

/// 32 aircraft, successively on a collision course, all visible all the time.
[[nodiscard]] sim::Scenario crowd_for(double seconds);

/// The autopilot's end of a line without pauses: the simulator's autopilot in the crowd above, a range scan with
/// returns in all 72 sectors, many requests, and ODOMETRY in the remaining bytes. Whole frames, back to back, numbered
/// per sender without a gap.
///
/// Its time is that of the bytes on the line, so the board's load per step does not depend on the host's load. The
/// rates leave space in the board's inbox for a step that reads kMaxUnread bytes at once.
class FullLine {
public:
    struct Requests {
        std::uint32_t params = 0;
        std::uint32_t commands = 0;
        std::uint32_t timesyncs = 0;
        std::uint32_t own_timesyncs = 0;  ///< requests of the simulator's own autopilot
    };

    /// @param scenario  outlives it
    explicit FullLine(const sim::Scenario& scenario) : plant_(scenario) {}

    /// At least the next `n` bytes, whole frames.
    [[nodiscard]] std::span<const std::byte> ahead(std::size_t n);
    void take(std::size_t n);
    /// Bytes from the board.
    void deliver(std::span<const std::byte> bytes) { plant_.deliver(bytes); }

    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }  ///< made so far
    [[nodiscard]] std::uint32_t frames() const noexcept { return frames_; }
    [[nodiscard]] const Requests& requests() const noexcept { return requests_; }
    [[nodiscard]] const sim::Plant& plant() const noexcept { return plant_; }

private:
    void add_next();
    [[nodiscard]] bool due(double rate, std::uint32_t sent) const noexcept;
    void add_telemetry();
    void add_scan();
    void add_odometry();
    void add(std::span<const std::byte> frame);
    template <link::mavlink::Message M>
    void write(const M& message, sim::Sender sender)
    {
        std::array<std::byte, link::mavlink::kMaxFrame> frame{};
        const std::size_t n = link::mavlink::encode(message, {sender.system, sender.component, 0}, frame);
        add({frame.data(), n});
    }

    sim::Plant plant_;
    std::vector<std::byte> telemetry_;  ///< of the plant, whole frames
    std::vector<std::byte> waiting_;
    std::map<std::pair<std::byte, std::byte>, std::uint8_t> sequences_;
    std::uint64_t bytes_ = 0;
    std::uint32_t frames_ = 0;
    std::uint32_t scans_ = 0;
    Requests requests_;
};

}  // namespace jink::target
