// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "firmware/linux/flight_log/key_eraser.hpp"
#include "firmware/linux/flight_log/topics.hpp"
#include "hal/can_port.hpp"

namespace jink::flightlog {

/// Overwrites signing keys in the records of a log before they reach a file: in what was read on the MAVLink line and
/// in what came through the tunnel of a bus. The entry that held a part of a key is marked (kKeyOverwritten).
///
/// Messages may be missing: the sequence of the parts tells. What follows a gap is treated as the middle of a frame
/// with a key, and the parts of a record that is not whole are overwritten. Memory: the largest record, 1 MiB at most,
/// and 40 KiB. Not for the control loop: allocates.
class KeyFilter {
public:
    /// @param messages  whole ones, in the order of the log: those not passed by the call before, and new ones behind
    /// @return bytes of the first messages, in which no key is left. The rest are parts of a record that goes on.
    [[nodiscard]] std::size_t pass(std::span<std::byte> messages);

private:
    static constexpr std::uint32_t kNodes = 128;
    /// Streams of MAVLink through the bus that are followed at once. If there are more, all begin anew as after a gap.
    static constexpr std::size_t kStreams = 512;
    /// Where a transfer goes whose first frame is not in the log. Others: target and serial port, or channel.
    static constexpr std::uint32_t kUnknownPlace = 0x10000;
    /// The present transfer of a tunnel, of one node and type.
    struct Transfer {
        std::size_t head = 0;  ///< bytes that still come before those of MAVLink
        std::uint32_t place = kUnknownPlace;
    };
    struct Part {
        HalHead head;
        std::size_t size = 0;           ///< of the message [bytes]
        std::span<std::byte> capacity;  ///< behind the head
        [[nodiscard]] bool continues() const noexcept { return (head.flags & HalHead::kContinues) != 0; }
        [[nodiscard]] bool goes_on() const noexcept { return (head.flags & HalHead::kGoesOn) != 0; }
        [[nodiscard]] std::span<std::byte> bytes() const noexcept { return capacity.first(head.length); }
    };

    [[nodiscard]] static std::optional<Part> part_of(std::span<std::byte> message);
    [[nodiscard]] bool collect(std::span<std::byte> messages, const Part& first, bool& is_whole);
    [[nodiscard]] bool erase_in_parts();
    [[nodiscard]] bool erase(std::span<std::byte> record);
    void erase_in_read(std::span<std::byte> bytes, KeyEraser& eraser, std::byte& entry);
    void erase_in_frame(const hal::CanFrame& frame, std::span<std::byte> data, std::byte& entry);
    [[nodiscard]] KeyEraser& eraser_of(std::uint32_t sender, std::uint32_t place);
    void forget();
    void forget_streams();

    KeyEraser line_;
    std::array<Transfer, 2 * kNodes> transfers_;  ///< by the sender's node id and the type
    std::map<std::uint32_t, KeyEraser> streams_;  ///< by sender and place
    bool is_incomplete_ = false;                  ///< a stream that is seen first may have begun in a gap
    std::uint32_t next_ = 0;                      ///< sequence of the part to come
    std::vector<Part> parts_;                     ///< of the present record
    std::vector<std::byte> record_;               ///< whose parts are joined
};

}  // namespace jink::flightlog
