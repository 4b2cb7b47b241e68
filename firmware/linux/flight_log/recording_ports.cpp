// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/recording_ports.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace jink::flightlog {
namespace {

constexpr std::size_t kLength = 1;     ///< of the payload
constexpr std::size_t kFlags = 2;      ///< incompatible ones: 1, signed, is the only one there is
constexpr std::size_t kMessageId = 7;  ///< three bytes
constexpr std::size_t kMaxPayload = 42;

/// @param header  ten bytes
bool is_setup_signing(const std::byte* header)
{
    return header[kMessageId] == std::byte{0} &&  // first: few other frames get further
           header[0] == link::mavlink::kStartV2 && static_cast<std::size_t>(header[kLength]) <= kMaxPayload &&
           static_cast<unsigned>(header[kFlags]) <= 1U && header[kMessageId + 1] == std::byte{1} &&
           header[kMessageId + 2] == std::byte{0};
}

constexpr std::uint32_t kNodeMask = 0x7F;

constexpr std::size_t kStateBytes = 1;  ///< of the transfer, behind the data of each frame

/// The data of a frame of a DroneCAN tunnel (uavcan.tunnel.Targetted and Broadcast); empty for others.
/// @param head  bytes of the transfer before those that are tunnelled: set by the first frame, less by those skipped
std::span<const std::byte> tunnelled(const hal::CanFrame& frame, std::size_t& head)
{
    constexpr std::uint32_t kService = 0x80;
    constexpr std::uint32_t kTargetted = 3001;
    constexpr std::uint32_t kBroadcast = 2010;
    constexpr unsigned kStart = 0x80;
    constexpr unsigned kEnd = 0x40;
    const std::uint32_t type = frame.id >> 8U & 0xFFFFU;
    const std::size_t length = std::min<std::size_t>(frame.length, frame.data.size());
    if (!frame.extended || (frame.id & kService) != 0 || (type != kTargetted && type != kBroadcast) ||
        length < kStateBytes) {
        return {};
    }
    const auto state = static_cast<unsigned>(frame.data[length - 1]);
    if ((state & kStart) != 0) {  // a checksum where there are several frames; then protocol, target, port, baud rate
        head = ((state & kEnd) != 0 ? 0U : 2U) + (type == kTargetted ? 6U : 2U);
    }
    const std::size_t skipped = std::min(head, length - kStateBytes);
    head -= skipped;
    return std::span(frame.data).subspan(skipped, length - kStateBytes - skipped);
}

}  // namespace

bool KeyEraser::erase(std::span<std::byte> bytes) noexcept
{
    bool erased = false;
    const std::size_t rest = std::exchange(secret_, 0);
    const auto wipe = [&](std::size_t from, std::size_t length) {
        const std::size_t to = std::min(from + length, bytes.size());
        if (from < to) {
            std::memset(bytes.data() + from, 0, to - from);
            erased = true;
        }
        secret_ = std::max(secret_, from + length - std::min(from + length, bytes.size()));
    };
    // Headers are searched in what was received, also in what another header makes a payload: a frame that was cut may
    // be followed by the one that the receiver takes.
    const std::size_t head = std::min(bytes.size(), kTail);
    const bool is_joined = may_go_on_ || bytes.size() < kTail;
    std::array<std::byte, 2 * kTail> joint;  // NOLINT(cppcoreguidelines-pro-type-member-init): set where it is read
    if (is_joined) {
        std::copy(tail_.begin(), tail_.end(), joint.begin());
        std::copy_n(bytes.begin(), head, joint.begin() + kTail);
        std::copy_n(joint.begin() + static_cast<std::ptrdiff_t>(head), kTail, tail_.begin());
    }
    if (bytes.size() >= kTail) {
        std::memcpy(tail_.data(), bytes.data() + bytes.size() - kTail, kTail);
    }
    may_go_on_ = bytes.size() < kTail;
    // Frames that begin in this read, the last one first: what is overwritten lies behind the headers still to be read.
    const std::byte* end = bytes.data() + bytes.size();
    while (const void* const found = ::memrchr(bytes.data(), static_cast<int>(link::mavlink::kStartV2),
                                               static_cast<std::size_t>(end - bytes.data()))) {
        end = static_cast<const std::byte*>(found);
        const auto at = static_cast<std::size_t>(end - bytes.data());
        if (bytes.size() - at < kHeader) {
            may_go_on_ = true;  // in the tail
        } else if (is_setup_signing(end)) {
            wipe(at + kHeader, static_cast<std::size_t>(end[kLength]) + link::mavlink::kChecksumSize);
        }
    }
    for (std::size_t i = 0; is_joined && i + kHeader <= kTail + head; ++i) {  // frames that began in the reads before
        if (is_setup_signing(joint.data() + i)) {
            wipe(i + kHeader - kTail, static_cast<std::size_t>(joint[i + kLength]) + link::mavlink::kChecksumSize);
        }
    }
    if (rest > 0) {
        wipe(0, rest);
    }
    return erased;
}

void HalRecorder::areas(std::span<const app::Constraint> areas, TimePoint now) noexcept
{
    entries_.entry(Entry::areas);
    entries_.put(now.us);
    entries_.count(areas.size());
    for (const app::Constraint& area : areas) {
        entries_.area(area);
    }
}

void HalRecorder::stored(std::uint32_t generation) noexcept
{
    entries_.entry(Entry::stored);
    entries_.put(generation);
}

void HalRecorder::begin(TimePoint now) noexcept
{
    entries_.entry(Entry::begin);
    entries_.put(now.us);
    recording_ = true;
}

void HalRecorder::begin_shut_down(TimePoint now) noexcept
{
    entries_.entry(Entry::shut_down);
    entries_.put(now.us);
    recording_ = true;
}

const EntryWriter& HalRecorder::end() noexcept
{
    recording_ = false;
    return entries_;
}

void HalRecorder::read(Port port, std::span<const std::byte> bytes) noexcept
{
    entries_.entry(Entry::read, port, bytes.size());
    entries_.bytes(bytes);
    same_[static_cast<std::size_t>(port)] = 0;
    if (port == Port::line && !bytes.empty()) {
        erase_keys(eraser_, bytes, 0);
    }
}

/// Searches bytes that were recorded last but for `behind` bytes.
void HalRecorder::erase_keys(KeyEraser& eraser, std::span<const std::byte> bytes, std::size_t behind) noexcept
{
    if (!entries_.overflowed()) {
        if (eraser.erase(entries_.newest(bytes.size() + behind).first(bytes.size()))) {
            entries_.entry(Entry::key_removed);
        }
        return;
    }
    std::array<std::byte, 256> lost{};  // a frame may go on in the next record: the eraser sees all bytes
    for (std::size_t n = 0; !bytes.empty(); bytes = bytes.subspan(n)) {
        n = std::min(bytes.size(), lost.size());
        std::copy_n(bytes.begin(), n, lost.begin());
        static_cast<void>(eraser.erase(std::span(lost).first(n)));
    }
}

void HalRecorder::write(Port port, std::span<const std::byte> offered, std::size_t accepted) noexcept
{
    entries_.entry(Entry::write, port, accepted);
    entries_.count(offered.size());
    entries_.bytes(offered);
    same_[static_cast<std::size_t>(port)] = 0;
    if (port == Port::line) {
        texts_.note(offered, accepted);
    }
}

template <class H>
void HalRecorder::note_health(Port port, H& last, const H& now) noexcept
{
    std::uint32_t& same = same_[static_cast<std::size_t>(port)];
    const unsigned differs = differences(last, now);
    if (differs == 0) {
        ++same;
        return;
    }
    entries_.entry(Entry::health, port, same);
    entries_.health(differs, last, now);
    last = now;
    same = 0;
}

void HalRecorder::health(Port port, const hal::PortHealth& health) noexcept
{
    note_health(port, port == Port::line ? line_health_ : cloud_health_, health);
}

void HalRecorder::health(const hal::CanHealth& health) noexcept { note_health(Port::can, can_health_, health); }

void HalRecorder::received(const hal::CanFrame* frame) noexcept
{
    entries_.entry(frame != nullptr ? Entry::can_frame : Entry::can_nothing, Port::can);
    same_[static_cast<std::size_t>(Port::can)] = 0;
    if (frame != nullptr) {
        entries_.frame(*frame);
        Tunnel& tunnel = tunnels_[frame->id & kNodeMask];
        const std::span<const std::byte> bytes = tunnelled(*frame, tunnel.head);
        if (!bytes.empty()) {
            erase_keys(tunnel.eraser, bytes, kStateBytes);
        }
    }
}

void HalRecorder::sent(const hal::CanFrame& frame, bool accepted) noexcept
{
    entries_.entry(accepted ? Entry::can_sent : Entry::can_refused, Port::can);
    entries_.frame(frame);
    same_[static_cast<std::size_t>(Port::can)] = 0;
}

std::size_t RecordingSerialPort::read(std::span<std::byte> into) noexcept
{
    const std::size_t n = port_.read(into);
    if (recorder_.is_recording()) {
        recorder_.read(which_, into.first(n));
    }
    return n;
}

std::size_t RecordingSerialPort::write(std::span<const std::byte> from) noexcept
{
    const std::size_t n = port_.write(from);
    if (recorder_.is_recording()) {
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
