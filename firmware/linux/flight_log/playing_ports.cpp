// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/playing_ports.hpp"

#include <algorithm>
#include <string_view>

namespace jink::flightlog {
namespace {

const char* name_of(Entry kind)
{
    switch (kind) {
    case Entry::none: return "nothing more";
    case Entry::begin: return "a step's beginning";
    case Entry::read: return "a read";
    case Entry::write: return "a write";
    case Entry::health: return "a change of health";
    case Entry::can_frame: return "a received CAN frame";
    case Entry::can_nothing: return "an empty CAN queue";
    case Entry::can_sent: return "a sent CAN frame";
    case Entry::can_refused: return "a refused CAN frame";
    case Entry::areas: return "closed areas";
    case Entry::stored: return "stored parameters";
    case Entry::shut_down: return "the end";
    }
    return "an unknown entry";
}

const char* name_of(Port port)
{
    switch (port) {
    case Port::line: return "the MAVLink line";
    case Port::cloud: return "the cloud line";
    case Port::can: return "the CAN bus";
    }
    return "an unknown port";
}

std::string hex_of(std::span<const std::byte> bytes)
{
    constexpr std::size_t kShown = 12;
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::byte b : bytes.first(std::min(bytes.size(), kShown))) {
        text += kDigits[static_cast<std::size_t>(b) >> 4U];
        text += kDigits[static_cast<std::size_t>(b) & 0xFU];
        text += ' ';
    }
    return text + (bytes.size() > kShown ? "..." : "");
}

bool same_frame(const hal::CanFrame& a, const hal::CanFrame& b)
{
    return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.fd == b.fd &&
           a.bit_rate_switch == b.bit_rate_switch && a.length == b.length &&
           std::equal(a.data.begin(), a.data.begin() + std::min<std::size_t>(a.length, a.data.size()), b.data.begin());
}

}  // namespace

void Tape::differ(std::string what)
{
    if (difference_.empty()) {
        difference_ = std::move(what);
    }
}

bool Tape::take(Entry kind, Port port) noexcept
{
    if (!difference_.empty()) {
        return false;
    }
    lost_key_ = lost_key_ || reader_.lost_key();
    if (reader_.kind() != kind || reader_.port() != port) {
        differ(std::string(name_of(kind)) + " on " + name_of(port) + ", the log has " + name_of(reader_.kind()) +
               (reader_.empty() ? "" : std::string(" on ") + name_of(reader_.port())));
        return false;
    }
    reader_.pass();
    same_[static_cast<std::size_t>(port)] = 0;
    return true;
}

bool Tape::take_health(Port port) noexcept
{
    std::uint32_t& same = same_[static_cast<std::size_t>(port)];
    if (difference_.empty() && reader_.kind() == Entry::health && reader_.port() == port) {
        EntryReader ahead = reader_;
        ahead.pass();
        if (ahead.count() == same) {
            reader_ = ahead;
            same = 0;
            return true;
        }
    }
    ++same;
    return false;
}

void Tape::finish()
{
    if (!reader_.empty()) {
        differ(std::string("no further call, the log has ") + name_of(reader_.kind()) + " on " +
               name_of(reader_.port()));
    }
    if (!reader_.is_good()) {
        differ("the record is damaged");
    }
}

std::size_t PlayingSerialPort::read(std::span<std::byte> into) noexcept
{
    if (!tape_.take(Entry::read, which_)) {
        return 0;
    }
    const std::span<const std::byte> bytes = tape_.reader().bytes(tape_.reader().count());
    if (bytes.size() > into.size()) {
        tape_.differ("a read of " + std::to_string(into.size()) + " bytes, the log has " +
                     std::to_string(bytes.size()));
        return 0;
    }
    std::copy(bytes.begin(), bytes.end(), into.begin());
    count_read(health_, bytes.size());
    return bytes.size();
}

std::size_t PlayingSerialPort::write(std::span<const std::byte> from) noexcept
{
    if (!tape_.take(Entry::write, which_)) {
        return 0;
    }
    EntryReader& reader = tape_.reader();
    const std::uint64_t accepted = reader.count();
    const std::span<const std::byte> offered = reader.bytes(reader.count());
    if (!std::equal(from.begin(), from.end(), offered.begin(), offered.end()) || accepted > from.size()) {
        const auto at = static_cast<std::size_t>(
            std::mismatch(from.begin(), from.end(), offered.begin(), offered.end()).first - from.begin());
        tape_.differ("a write of " + std::to_string(from.size()) + " bytes on " + name_of(which_) + ", the log has " +
                     std::to_string(offered.size()) + "; from byte " + std::to_string(at) +
                     " on: " + hex_of(from.subspan(at)) + "in place of " + hex_of(offered.subspan(at)));
        return 0;
    }
    tape_.compared(from.size());
    count_write(health_, from.size(), static_cast<std::size_t>(accepted));
    return static_cast<std::size_t>(accepted);
}

hal::PortHealth PlayingSerialPort::health() const noexcept
{
    if (tape_.take_health(which_)) {
        tape_.reader().health(health_);
    }
    return health_;
}

bool PlayingCanPort::receive(hal::CanFrame& frame) noexcept
{
    if (tape_.reader().kind() == Entry::can_nothing) {
        static_cast<void>(tape_.take(Entry::can_nothing, Port::can));
        return false;
    }
    if (!tape_.take(Entry::can_frame, Port::can)) {
        return false;
    }
    frame = tape_.reader().frame();
    count_received(health_);
    return true;
}

bool PlayingCanPort::send(const hal::CanFrame& frame) noexcept
{
    const bool accepted = tape_.reader().kind() == Entry::can_sent;
    if (!tape_.take(accepted ? Entry::can_sent : Entry::can_refused, Port::can)) {
        return false;
    }
    const hal::CanFrame recorded = tape_.reader().frame();
    if (!same_frame(frame, recorded)) {
        tape_.differ(
            "another CAN frame: " +
            hex_of(std::span(frame.data).first(std::min<std::size_t>(frame.length, frame.data.size()))) +
            "in place of " +
            hex_of(std::span(recorded.data).first(std::min<std::size_t>(recorded.length, recorded.data.size()))));
        return false;
    }
    tape_.compared(frame.length);
    count_sent(health_, accepted);
    return accepted;
}

hal::CanHealth PlayingCanPort::health() const noexcept
{
    if (tape_.take_health(Port::can)) {
        tape_.reader().health(health_);
    }
    return health_;
}

}  // namespace jink::flightlog
