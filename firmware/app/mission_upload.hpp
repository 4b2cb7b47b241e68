// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/crc.hpp"
#include "core/path/trajectory_generator.hpp"
#include "firmware/link/mission/messages.hpp"

namespace jink::app {

/// Takes a task part by part into the generator's path, and starts it when all of it is there and its checksum holds:
/// as a whole or not at all. What is flown meanwhile goes on.
///
/// Parts come in order, each answered with the part that is awaited next; a part that was taken already is answered
/// again and changes nothing, so whoever sends needs no more than to repeat what was not answered. Another task is
/// refused while one is being uploaded, until that has been silent for kSilence. A task that is to be flown once more
/// needs another number: the same again is a part that was taken already. 300 bytes.
class MissionUpload {
public:
    static constexpr Seconds kSilence = 5.0F;

    explicit MissionUpload(path::TrajectoryGenerator& generator) noexcept : generator_(generator) {}

    /// O(points of the part).
    [[nodiscard]] link::mission::TaskAck take(const link::mission::TaskUpload& part, TimePoint now) noexcept;

    [[nodiscard]] bool is_open() const noexcept { return open_; }
    /// Task that was accepted last; 0: none.
    [[nodiscard]] std::uint32_t task() const noexcept { return task_; }

private:
    using TaskStatus = link::mission::TaskStatus;

    [[nodiscard]] TaskStatus judge(const link::mission::TaskUpload& part, TimePoint now) noexcept;
    [[nodiscard]] TaskStatus open(const link::mission::TaskUpload& part) noexcept;
    [[nodiscard]] TaskStatus add_points(const link::mission::TaskUpload& part) noexcept;
    [[nodiscard]] TaskStatus finish(TimePoint now) noexcept;
    [[nodiscard]] TaskStatus fail(TaskStatus why) noexcept;

    path::TrajectoryGenerator& generator_;
    bool open_ = false;
    link::mission::TaskUpload first_;  ///< of the upload that is open
    std::uint16_t next_ = 0;
    Crc crc_;
    TimePoint last_part_;
    bool has_task_ = false;
    std::uint32_t task_ = 0;
    std::uint16_t task_parts_ = 0;
    std::uint32_t task_crc_ = 0;
};

}  // namespace jink::app
