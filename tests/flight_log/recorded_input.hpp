// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "firmware/linux/flight_log/flight_log.hpp"
#include "firmware/linux/flight_log/hal_parts.hpp"
#include "firmware/linux/flight_log/key_filter.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"

// Records of input without a co-processor: whole messages, which a test drops, splits and filters.

namespace jink::test {

using Bytes = std::vector<std::byte>;

/// Composes records with the real flight log and keeps their messages one by one.
class RecordedInput final : public flightlog::Output {
public:
    bool add(std::span<const std::byte> messages, std::uint32_t /*count*/,
             flightlog::Records /*records*/) noexcept override
    {
        while (!messages.empty()) {
            const std::size_t n = ulog::size_of_message(messages);
            messages_.emplace_back(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(n));
            messages = messages.subspan(n);
        }
        return true;
    }
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override { return {}; }

    /// One step, and a text behind its record.
    void step(const std::function<void(flightlog::HalRecorder&)>& calls)
    {
        log_.begin({++time_});
        calls(log_.recorder());
        log_.end_shut_down({time_});
    }
    /// One step with a read on the line.
    void read(std::span<const std::byte> bytes)
    {
        step([&](flightlog::HalRecorder& recorder) { recorder.read(flightlog::Port::line, bytes); });
    }
    [[nodiscard]] const std::vector<Bytes>& messages() const { return messages_; }

private:
    std::vector<Bytes> messages_;
    std::int64_t time_ = 0;
    flightlog::FlightLog log_{*this, {.record = 40'000}, app::Parameters().values()};
};

inline Bytes joined(std::span<const Bytes> messages)
{
    Bytes all;
    for (const Bytes& message : messages) {
        all.insert(all.end(), message.begin(), message.end());
    }
    return all;
}

/// What a filter passes of messages that come in groups of this many.
inline Bytes filtered(std::span<const Bytes> messages, std::size_t group = 1)
{
    flightlog::KeyFilter filter;
    Bytes all;
    std::size_t passed = 0;
    for (std::size_t i = 0; i < messages.size(); i += group) {
        const Bytes more = joined(messages.subspan(i, std::min(group, messages.size() - i)));
        all.insert(all.end(), more.begin(), more.end());
        passed += filter.pass(std::span(all).subspan(passed));
    }
    all.resize(passed);
    return all;
}

inline bool is_record(std::span<const std::byte> message)
{
    return static_cast<ulog::Type>(message[2]) == ulog::Type::data &&
           ulog::read_number<std::uint16_t>(message.subspan(3)) >= static_cast<unsigned>(flightlog::TopicId::hal);
}

/// Whole records among messages, up to the first gap.
inline std::vector<Bytes> records_of(std::span<const std::byte> messages)
{
    std::vector<Bytes> records;
    flightlog::HalParts parts;
    for (; !messages.empty(); messages = messages.subspan(ulog::size_of_message(messages))) {
        if (!is_record(messages)) {
            continue;
        }
        const auto taken =
            parts.take(messages.subspan(ulog::kDataHeader, ulog::size_of_message(messages) - ulog::kDataHeader));
        if (taken == flightlog::HalParts::Taken::record) {
            records.emplace_back(parts.record().begin(), parts.record().end());
        } else if (taken != flightlog::HalParts::Taken::part) {
            break;
        }
    }
    return records;
}

/// Bytes read on the line, as they are in records, and whether an entry is marked.
inline Bytes line_of(std::span<const Bytes> records, bool& is_marked)
{
    Bytes line;
    is_marked = false;
    for (const Bytes& record : records) {
        flightlog::EntryReader reader(record);
        while (!reader.empty()) {
            const flightlog::Entry kind = reader.kind();
            const bool is_of_line = reader.port() == flightlog::Port::line;
            is_marked = is_marked || reader.lost_key();
            reader.pass();
            if (kind == flightlog::Entry::read) {
                const std::span<const std::byte> bytes = reader.bytes(reader.count());
                line.insert(line.end(), bytes.begin(), is_of_line ? bytes.end() : bytes.begin());
            } else {
                EXPECT_TRUE(reader.pass_content(kind));
            }
        }
    }
    return line;
}

}  // namespace jink::test
