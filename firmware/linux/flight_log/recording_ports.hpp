// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "firmware/linux/flight_log/hal_record.hpp"
#include "firmware/linux/flight_log/sent_texts.hpp"
#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::flightlog {

/// Records calls between `begin` and `end` of a step; other calls pass unrecorded.
///
/// Memory: of one record, the bytes before and behind it, and 1 KiB.
class HalRecorder {
public:
    /// @param capacity  of one record [bytes]; a longer record is lost as a whole. 0: nothing is recorded, and texts
    ///                  alone are noted
    /// @param before, behind  as of EntryWriter
    explicit HalRecorder(std::size_t capacity, std::size_t before = 0, std::size_t behind = 0)
        : entries_(capacity, before, behind), is_wanted_(capacity > 0)
    {
    }

    /// Of the next record, at any time.
    void areas(std::span<const app::Constraint> areas, TimePoint now) noexcept;
    void stored(std::uint32_t generation) noexcept;

    void begin(TimePoint now) noexcept { begin_entry(Entry::begin, now); }
    void begin_shut_down(TimePoint now) noexcept { begin_entry(Entry::shut_down, now); }
    /// @return the record, valid until the next call
    [[nodiscard]] EntryWriter& end() noexcept
    {
        recording_ = in_step_ = false;
        return entries_;
    }
    /// Forgets the record that `end` returned.
    void clear() noexcept { entries_.clear(); }

    void read(Port port, std::span<const std::byte> bytes) noexcept
    {
        entries_.entry(Entry::read, port, bytes.size());
        entries_.bytes(bytes);
        count_read(health_of(port), bytes.size());
        same_[static_cast<std::size_t>(port)] = 0;
    }
    void write(Port port, std::span<const std::byte> offered, std::size_t accepted) noexcept;
    /// @param port  a serial one
    void health(Port port, const hal::PortHealth& health) noexcept { compare_health(port, health_of(port), health); }
    void health(const hal::CanHealth& health) noexcept { compare_health(Port::can, can_health_, health); }
    void received(const hal::CanFrame* frame) noexcept;
    void sent(const hal::CanFrame& frame, bool accepted) noexcept;
    [[nodiscard]] bool is_recording() const noexcept { return recording_; }
    /// Between begin and end, recorded or not.
    [[nodiscard]] bool is_in_step() const noexcept { return in_step_; }
    /// STATUSTEXTs of the step, to be cleared by the reader.
    [[nodiscard]] SentTexts& texts() noexcept { return texts_; }

private:
    template <class H>
    void compare_health(Port port, H& expected, const H& now) noexcept
    {
        if (is_same(expected, now)) [[likely]] {
            ++same_[static_cast<std::size_t>(port)];
        } else {
            note_health(port, expected, now);
        }
    }
    void begin_entry(Entry kind, TimePoint now) noexcept
    {
        in_step_ = true;
        recording_ = is_wanted_;
        if (is_wanted_) {
            entries_.entry(kind);
            entries_.put(now.us);
        }
    }
    template <class H>
    [[gnu::noinline]] void note_health(Port port, H& expected, const H& now) noexcept;
    [[nodiscard]] hal::PortHealth& health_of(Port port) noexcept
    {
        return port == Port::line ? line_health_ : cloud_health_;
    }

    EntryWriter entries_;
    bool is_wanted_;
    bool in_step_ = false;
    bool recording_ = false;
    SentTexts texts_;
    // As a replay expects them: those of the last call, and what was read and written since.
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
