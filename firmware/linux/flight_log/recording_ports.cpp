// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/recording_ports.hpp"

namespace jink::flightlog {
void HalRecorder::areas(std::span<const app::Constraint> areas, TimePoint now) noexcept
{
    if (!is_wanted_) {
        return;
    }
    entries_.entry(Entry::areas);
    entries_.put(now.us);
    entries_.count(areas.size());
    for (const app::Constraint& area : areas) {
        entries_.area(area);
    }
}

void HalRecorder::stored(std::uint32_t generation) noexcept
{
    if (is_wanted_) {
        entries_.entry(Entry::stored);
        entries_.put(generation);
    }
}

void HalRecorder::write(Port port, std::span<const std::byte> offered, std::size_t accepted) noexcept
{
    if (recording_) {
        entries_.entry(Entry::write, port, accepted);
        entries_.count(offered.size());
        entries_.bytes(offered);
        count_write(health_of(port), offered.size(), accepted);
        same_[static_cast<std::size_t>(port)] = 0;
    }
    if (port == Port::line) {
        texts_.note(offered, accepted);
    }
}

template <class H>
void HalRecorder::note_health(Port port, H& expected, const H& now) noexcept
{
    std::uint32_t& same = same_[static_cast<std::size_t>(port)];
    entries_.entry(Entry::health, port, same);
    entries_.health(differences(expected, now), expected, now);
    expected = now;
    same = 0;
}

void HalRecorder::received(const hal::CanFrame* frame) noexcept
{
    entries_.entry(frame != nullptr ? Entry::can_frame : Entry::can_nothing, Port::can);
    same_[static_cast<std::size_t>(Port::can)] = 0;
    if (frame != nullptr) {
        entries_.frame(*frame);
        count_received(can_health_);
    }
}

void HalRecorder::sent(const hal::CanFrame& frame, bool accepted) noexcept
{
    entries_.entry(accepted ? Entry::can_sent : Entry::can_refused, Port::can);
    entries_.frame(frame);
    count_sent(can_health_, accepted);
    same_[static_cast<std::size_t>(Port::can)] = 0;
}

std::size_t RecordingSerialPort::read(std::span<std::byte> into) noexcept
{
    const std::size_t n = port_.read(into);
    if (recorder_.is_recording()) [[likely]] {
        recorder_.read(which_, into.first(n));
    }
    return n;
}

std::size_t RecordingSerialPort::write(std::span<const std::byte> from) noexcept
{
    const std::size_t n = port_.write(from);
    if (recorder_.is_in_step()) {
        recorder_.write(which_, from, n);
    }
    return n;
}

hal::PortHealth RecordingSerialPort::health() const noexcept
{
    const hal::PortHealth health = port_.health();
    if (recorder_.is_recording()) {
        recorder_.health(which_, health);
    }
    return health;
}

bool RecordingCanPort::receive(hal::CanFrame& frame) noexcept
{
    const bool received = port_.receive(frame);
    if (recorder_.is_recording()) {
        recorder_.received(received ? &frame : nullptr);
    }
    return received;
}

bool RecordingCanPort::send(const hal::CanFrame& frame) noexcept
{
    const bool accepted = port_.send(frame);
    if (recorder_.is_recording()) {
        recorder_.sent(frame, accepted);
    }
    return accepted;
}

hal::CanHealth RecordingCanPort::health() const noexcept
{
    const hal::CanHealth health = port_.health();
    if (recorder_.is_recording()) {
        recorder_.health(health);
    }
    return health;
}

}  // namespace jink::flightlog
