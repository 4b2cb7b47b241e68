// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/log_summary.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <istream>
#include <ostream>

#include "firmware/linux/flight_log/topics.hpp"

namespace jink::host {
namespace {

constexpr double kMicro = 1e-6;
constexpr std::size_t kMaxLines = 10'000;  ///< of texts that are kept

double seconds_at(std::span<const std::byte> bytes)
{
    return static_cast<double>(ulog::read_number<std::uint64_t>(bytes)) * kMicro;
}

void note_step(std::span<const std::byte> content, LogSummary& summary)
{
    flightlog::StepTopic step;
    std::memcpy(static_cast<void*>(&step), content.data(), std::min(content.size(), sizeof step));
    ++summary.steps;
    summary.decisions += step.new_manoeuvre ? 1U : 0U;
    summary.longest_step = std::max(summary.longest_step, step.duration_us);
    summary.mean_step += (static_cast<double>(step.duration_us) - summary.mean_step) / summary.steps;
}

void note_counters(const ulog::Format& format, std::span<const std::byte> content, LogSummary& summary)
{
    for (const ulog::Field& field : format.fields) {
        if (field.type == "uint32_t" && field.count == 1) {
            const auto value = ulog::read_number<std::uint32_t>(content.subspan(field.offset));
            if (value != 0) {
                summary.counters[format.name.substr(5) + "." + field.name] = value;
            }
        }
    }
}

void note_data(const ulog::Format& format, std::span<const std::byte> content, LogSummary& summary)
{
    const double time = seconds_at(content);
    summary.first = summary.topics.empty() ? time : std::min(summary.first, time);
    summary.duration = std::max(summary.duration, time - summary.first);
    ++summary.topics[format.name];
    if (format.name == "jink_step" && format.size == flightlog::kBytesOf<flightlog::StepTopic>) {
        note_step(content, summary);
    } else if (format.name.ends_with("_counters") || format.name == "jink_log" || format.name == "jink_stream") {
        note_counters(format, content, summary);
    }
}

void note_text(std::span<const std::byte> content, LogSummary& summary)
{
    if (summary.lines.size() < kMaxLines) {
        summary.lines.push_back(
            {seconds_at(content.subspan(1)), log_level(content[0]), log_text(ulog::text_of(content.subspan(9)))});
    }
}

}  // namespace

std::string log_text(std::string_view text)
{
    std::string out(text);
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
}

char log_level(std::byte level)
{
    const char digit = static_cast<char>(level);
    return digit >= '0' && digit <= '7' ? digit : '?';
}

LogSummary summarise_log(std::istream& in)
{
    LogSummary summary;
    ulog::Reader log(in);
    while (const auto message = log.next()) {
        ++summary.messages;
        const std::span<const std::byte> content = message->content;
        switch (message->type) {
        case ulog::Type::data:
            note_data(*log.topic(ulog::read_number<std::uint16_t>(content)), content.subspan(2), summary);
            break;
        case ulog::Type::text: note_text(content, summary); break;
        case ulog::Type::dropout:
            ++summary.dropouts;
            summary.dropout_time += static_cast<double>(ulog::read_number<std::uint16_t>(content)) * 1e-3;
            break;
        case ulog::Type::parameter:
            if (const auto keyed = ulog::parse_keyed(content, message->type); keyed && !summary.topics.empty()) {
                summary.parameters_changed.push_back(log_text(keyed->name) + " = " +
                                                     log_value(keyed->type, keyed->value));
            }
            break;
        default: break;
        }
    }
    for (const auto& [name, info] : log.infos()) {
        summary.infos[name] = info.type == "char" ? log_text(info.text()) : log_value(info.type, info.value);
    }
    summary.end = log.end();
    summary.end_offset = log.offset();
    return summary;
}

void print_log_summary(const std::string& name, const LogSummary& s, std::ostream& out)
{
    const auto info = [&](const char* key) {
        const auto found = s.infos.find(key);
        return found == s.infos.end() ? std::string("?") : found->second;
    };
    std::array<char, 300> text{};
    const auto print = [&](const char* format, auto... values) {
        std::snprintf(text.data(), text.size(), format, values...);
        out << text.data();
    };
    out << name << ": " << info("sys_name") << " " << info("ver_sw") << ", run " << info("jink_run") << ", file "
        << info("jink_file") << "\n";
    print("  duration %.1f s, %u steps, ", s.duration, s.steps);
    if (s.longest_step > 0) {
        print("step mean %.1f us, max %u us\n", s.mean_step, s.longest_step);
    } else {
        out << "their durations were not measured\n";
    }
    print("  %" PRIu64 " messages, %" PRIu64 " dropouts of %.1f s\n", s.messages, s.dropouts, s.dropout_time);
    out << "  end: " << ulog::to_string(s.end) << ", " << s.end_offset << " bytes read\n";
    out << "  set-up:";
    for (const char* key : {"jink_system_id", "jink_clock_mhz", "jink_bus", "jink_cloud_line", "jink_cloud_logged",
                            "jink_map", "jink_signed"}) {
        out << " " << std::string(key).substr(5) << " " << info(key);
    }
    out << "\n  topics:";
    for (const auto& [topic, count] : s.topics) {
        out << " " << topic << " " << count;
    }
    out << "\n  decisions: " << s.decisions << "\n";
    for (const LogSummary::Line& line : s.lines) {
        print("  %10.2f s  %c  ", line.time - s.first, line.level);
        out << line.text << "\n";
    }
    for (const std::string& parameter : s.parameters_changed) {
        out << "  parameter changed: " << parameter << "\n";
    }
    out << "  counters:";
    for (const auto& [counter, value] : s.counters) {
        out << " " << counter << " " << value;
    }
    out << "\n";
}

}  // namespace jink::host
