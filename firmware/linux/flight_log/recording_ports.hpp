// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "firmware/link/mavlink/frame.hpp"
#include "firmware/linux/flight_log/hal_record.hpp"
#include "firmware/linux/flight_log/sent_texts.hpp"
#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::flightlog {

/// Finds SETUP_SIGNING (message 256) in received bytes and overwrites its payload, which holds a signing key, with
/// zeros. Every byte that could begin such a frame counts, whatever the receiver makes of it; the frame may be split
/// over reads. O(bytes).
class KeyEraser {
public:
    /// @return whether anything was overwritten
    [[nodiscard]] bool erase(std::span<std::byte> bytes) noexcept;

private:
    /// Version 1 cannot carry this message.
    static constexpr std::size_t kHeader = link::mavlink::kHeaderV2;
    static constexpr std::size_t kTail = kHeader - 1;

    std::array<std::byte, kTail> tail_{};  ///< of the reads before
    bool may_go_on_ = false;               ///< a frame may begin in the tail
    std::size_t secret_ = 0;               ///< bytes of the present frame still to be overwritten
};

/// Records calls between `begin` and `end` of a step; other calls pass unrecorded.
class HalRecorder {
public:
    /// @param capacity  of one record [bytes]; a longer record is lost as a whole
    explicit HalRecorder(std::size_t capacity) : entries_(capacity) {}

    /// Of the next record, at any time.
    void areas(std::span<const app::Constraint> areas, TimePoint now) noexcept;
    void stored(std::uint32_t generation) noexcept;

    void begin(TimePoint now) noexcept;
    void begin_shut_down(TimePoint now) noexcept;
    /// @return the record, valid until the next call
    [[nodiscard]] const EntryWriter& end() noexcept;
    /// Forgets the record that `end` returned.
    void clear() noexcept { entries_.clear(); }

    void read(Port port, std::span<const std::byte> bytes) noexcept;
    void write(Port port, std::span<const std::byte> offered, std::size_t accepted) noexcept;
    /// @param port  a serial one
    void health(Port port, const hal::PortHealth& health) noexcept;
    void health(const hal::CanHealth& health) noexcept;
    void received(const hal::CanFrame* frame) noexcept;
    void sent(const hal::CanFrame& frame, bool accepted) noexcept;
    [[nodiscard]] bool is_recording() const noexcept { return recording_; }
    /// STATUSTEXTs of the step, to be cleared by the reader.
    [[nodiscard]] SentTexts& texts() noexcept { return texts_; }

private:
    template <class H>
    void note_health(Port port, H& last, const H& now) noexcept;
    void erase_keys(KeyEraser& eraser, std::span<const std::byte> bytes, std::size_t behind) noexcept;

    static constexpr std::size_t kNodes = 128;
    /// MAVLink that comes through the bus from one node.
    struct Tunnel {
        KeyEraser eraser;
        std::size_t head = 0;  ///< bytes of the present transfer that still come before those of MAVLink
    };

    EntryWriter entries_;
    bool recording_ = false;
    KeyEraser eraser_;
    std::array<Tunnel, kNodes> tunnels_;  ///< by the sender's node id
    SentTexts texts_;
    hal::PortHealth line_health_;
    hal::PortHealth cloud_health_;
    hal::CanHealth can_health_;
    std::array<std::uint32_t, kPorts> same_{};  ///< health calls without a difference since the last entry
};

/// Sits between a serial port and its reader.
class RecordingSerialPort final : public hal::SerialPort {
public:
    /// @param port, recorder  outlive this
    RecordingSerialPort(hal::SerialPort& port, HalRecorder& recorder, Port which) noexcept
        : port_(port), recorder_(recorder), which_(which)
    {
    }
    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
    [[nodiscard]] hal::PortHealth health() const noexcept override;

private:
    hal::SerialPort& port_;
    HalRecorder& recorder_;
    Port which_;
};

/// The same for a CAN controller.
class RecordingCanPort final : public hal::CanPort {
public:
    RecordingCanPort(hal::CanPort& port, HalRecorder& recorder) noexcept : port_(port), recorder_(recorder) {}

    [[nodiscard]] bool receive(hal::CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const hal::CanFrame& frame) noexcept override;
    [[nodiscard]] hal::CanHealth health() const noexcept override;

private:
    hal::CanPort& port_;
    HalRecorder& recorder_;
};

}  // namespace jink::flightlog
