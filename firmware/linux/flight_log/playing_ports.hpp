// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "firmware/linux/flight_log/hal_record.hpp"
#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::flightlog {

/// The record of the step that is replayed. Ports take their entries from it; the first call that differs from the
/// record is kept, and from then on all ports are silent.
class Tape {
public:
    void load(std::span<const std::byte> record) noexcept { reader_ = EntryReader(record); }
    [[nodiscard]] EntryReader& reader() noexcept { return reader_; }
    /// The next entry, if it is of this kind and port: its content is read next.
    [[nodiscard]] bool take(Entry kind, Port port) noexcept;
    /// The same for a change of health; counts the calls before it.
    [[nodiscard]] bool take_health(Port port) noexcept;
    void differ(std::string what);
    /// After a step: everything of the record was used.
    void finish();

    /// Empty: none.
    [[nodiscard]] const std::string& difference() const noexcept { return difference_; }
    [[nodiscard]] bool has_lost_key() const noexcept { return lost_key_; }
    [[nodiscard]] std::uint64_t bytes_compared() const noexcept { return bytes_compared_; }
    void compared(std::size_t bytes) noexcept { bytes_compared_ += bytes; }

private:
    EntryReader reader_;
    std::string difference_;
    bool lost_key_ = false;
    std::uint64_t bytes_compared_ = 0;
    std::array<std::uint32_t, kPorts> same_{};
};

class PlayingSerialPort final : public hal::SerialPort {
public:
    PlayingSerialPort(Tape& tape, Port which) noexcept : tape_(tape), which_(which) {}

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
    [[nodiscard]] hal::PortHealth health() const noexcept override;

private:
    Tape& tape_;
    Port which_;
    mutable hal::PortHealth health_;
};

class PlayingCanPort final : public hal::CanPort {
public:
    explicit PlayingCanPort(Tape& tape) noexcept : tape_(tape) {}

    [[nodiscard]] bool receive(hal::CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const hal::CanFrame& frame) noexcept override;
    [[nodiscard]] hal::CanHealth health() const noexcept override;

private:
    Tape& tape_;
    mutable hal::CanHealth health_;
};

}  // namespace jink::flightlog
