// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/key_filter.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/linux/flight_log/hal_parts.hpp"
#include "firmware/linux/flight_log/hal_record.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::flightlog {
namespace {

constexpr std::size_t kStateBytes = 1;  ///< of the transfer, behind the data of each frame

void overwrite(std::span<std::byte> bytes) { std::fill(bytes.begin(), bytes.end(), std::byte{0}); }

}  // namespace

/// Nothing for a message that is no part of a record. A part whose length cannot be has the length of its capacity.
std::optional<KeyFilter::Part> KeyFilter::part_of(std::span<std::byte> message)
{
    constexpr auto kFirst = static_cast<std::size_t>(TopicId::hal);
    if (message.size() < ulog::kDataHeader + HalHead::kBytes ||
        static_cast<ulog::Type>(message[2]) != ulog::Type::data) {
        return std::nullopt;
    }
    const std::size_t id = ulog::read_number<std::uint16_t>(message.subspan(ulog::kMessageHeader));
    if (id < kFirst || id >= kFirst + kHalSizes.size()) {
        return std::nullopt;
    }
    const std::span<std::byte> content = message.subspan(ulog::kDataHeader);
    Part part{ulog::read_number<HalHead>(content), message.size(), content.subspan(HalHead::kBytes)};
    part.head.length = static_cast<std::uint16_t>(std::min<std::size_t>(part.head.length, part.capacity.size()));
    return part;
}

/// Collects the parts of a record.
/// @param is_whole  set: whether they are all there
/// @return false: the record goes on in messages to come
bool KeyFilter::collect(std::span<std::byte> messages, const Part& first, bool& is_whole)
{
    parts_.assign(1, first);
    std::size_t bytes = first.head.length;
    is_whole = !first.goes_on();
    for (messages = messages.subspan(first.size); !is_whole; messages = messages.subspan(parts_.back().size)) {
        if (messages.empty()) {
            return false;
        }
        const auto part = part_of(messages.first(ulog::size_of_message(messages)));
        bytes += part ? part->head.length : 0U;
        if (!part || !part->continues() || part->head.sequence != parts_.back().head.sequence + 1 ||
            bytes > HalParts::kMaxRecord) {
            return true;
        }
        parts_.push_back(*part);
        is_whole = !part->goes_on();
    }
    return true;
}

std::size_t KeyFilter::pass(std::span<std::byte> messages)
{
    std::size_t passed = 0;
    while (passed < messages.size()) {
        const std::span<std::byte> rest = messages.subspan(passed);
        const std::size_t size = ulog::size_of_message(rest);
        const auto first = part_of(rest.first(size));
        if (!first) {
            passed += size;
            continue;
        }
        bool is_whole = false;
        if (!collect(rest, *first, is_whole)) {
            return passed;
        }
        if (first->head.sequence != next_) {
            forget();
        }
        if (first->continues() || !is_whole || !erase_in_parts()) {
            for (const Part& part : parts_) {
                overwrite(part.capacity);
            }
            forget();
        }
        next_ = parts_.back().head.sequence + 1;
        for (const Part& part : parts_) {
            passed += part.size;
        }
    }
    return passed;
}

/// Something of the input is missing.
void KeyFilter::forget()
{
    line_.forget();
    forget_streams();
}

void KeyFilter::forget_streams()
{
    streams_.clear();
    transfers_.fill({});
    is_incomplete_ = true;
}

/// @return false: the record is damaged
bool KeyFilter::erase_in_parts()
{
    if (parts_.size() == 1) {
        return erase(parts_.front().bytes());
    }
    record_.clear();
    for (const Part& part : parts_) {
        record_.insert(record_.end(), part.bytes().begin(), part.bytes().end());
    }
    const bool is_good = erase(record_);
    std::span<const std::byte> rest(record_);
    for (const Part& part : parts_) {
        std::memcpy(part.capacity.data(), rest.data(), part.head.length);
        rest = rest.subspan(part.head.length);
    }
    return is_good;
}

void KeyFilter::erase_in_read(std::span<std::byte> bytes, KeyEraser& eraser, std::byte& entry)
{
    if (!bytes.empty() && eraser.erase(bytes)) {
        entry |= kKeyOverwritten;
    }
}

KeyEraser& KeyFilter::eraser_of(std::uint32_t sender, std::uint32_t place)
{
    const auto stream_of = [&](std::uint32_t where) { return where << 8U | sender; };
    if (const auto found = streams_.find(stream_of(place)); found != streams_.end()) {
        return found->second;
    }
    if (streams_.size() >= kStreams) {
        forget_streams();
    }
    KeyEraser eraser;
    if (is_incomplete_) {
        eraser.forget();
    } else if (const auto before = streams_.find(stream_of(kUnknownPlace)); before != streams_.end()) {
        eraser = before->second;  // the log began within a transfer, which may be one of this stream
    }
    return streams_.emplace(stream_of(place), eraser).first->second;
}

/// Frames of a DroneCAN tunnel: uavcan.tunnel.Targetted and Broadcast. A receiver joins the frames of a node and type
/// to transfers, and takes the bytes of those with its own target and serial port.
void KeyFilter::erase_in_frame(const hal::CanFrame& frame, std::span<std::byte> data, std::byte& entry)
{
    constexpr std::uint32_t kService = 0x80;
    constexpr std::uint32_t kTargetted = 3001;
    constexpr std::uint32_t kBroadcast = 2010;
    constexpr unsigned kStart = 0x80;
    constexpr unsigned kEnd = 0x40;
    const std::uint32_t type = frame.id >> 8U & 0xFFFFU;
    const bool is_targetted = type == kTargetted;
    if (!frame.extended || (frame.id & kService) != 0 || (!is_targetted && type != kBroadcast) ||
        data.size() < kStateBytes) {
        return;
    }
    const std::uint32_t sender = frame.id % kNodes * 2 + (is_targetted ? 1U : 0U);
    Transfer& transfer = transfers_[sender];
    const auto state = static_cast<unsigned>(data.back());
    const std::span<std::byte> bytes = data.first(data.size() - kStateBytes);
    if ((state & kStart) != 0) {  // a checksum where there are several frames; then protocol, place, baud rate
        const std::size_t at = (state & kEnd) != 0 ? 1U : 3U;
        const std::size_t size = is_targetted ? 2U : 1U;
        if (bytes.size() < at + size) {
            forget_streams();
        } else {
            transfer.place = static_cast<std::uint32_t>(bytes[at]) << 8U |  // options follow in the last four bits
                             (is_targetted ? static_cast<std::uint32_t>(bytes[at + 1]) & 0xF0U : 0U);
            transfer.head = at + (is_targetted ? 5U : 1U);
        }
    }
    const std::size_t skipped = std::min(transfer.head, bytes.size());
    transfer.head -= skipped;
    erase_in_read(bytes.subspan(skipped), eraser_of(sender, transfer.place), entry);
}

/// @return false: the record is damaged
bool KeyFilter::erase(std::span<std::byte> record)
{
    EntryReader reader(record);
    const auto newest = [&](std::size_t n) { return record.subspan(record.size() - reader.left() - n, n); };
    while (!reader.empty() && reader.is_good()) {
        std::byte& entry = record[record.size() - reader.left()];
        const Entry kind = reader.kind();
        const Port port = reader.port();
        reader.pass();
        switch (kind) {
        case Entry::read: {
            const std::size_t n = reader.bytes(reader.count()).size();
            if (port == Port::line && reader.is_good()) {
                erase_in_read(newest(n), line_, entry);
            }
            break;
        }
        case Entry::can_frame: {
            const hal::CanFrame frame = reader.frame();
            if (reader.is_good()) {
                erase_in_frame(frame, newest(std::min<std::size_t>(frame.length, frame.data.size())), entry);
            }
            break;
        }
        default:
            if (!reader.pass_content(kind)) {
                return false;
            }
        }
    }
    return reader.is_good();
}

}  // namespace jink::flightlog
