// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <utility>

#include "firmware/linux/param_store.hpp"
#include "toolchain/host/log_summary.hpp"

namespace jink::host {
namespace {

/// Arrays of bytes that are longer are one column.
constexpr std::size_t kMaxByteColumns = 8;

std::string number_text(double value, const char* format)
{
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

bool is_one_column(const ulog::Field& field)
{
    return field.type == "char" || (field.type == "uint8_t" && field.count > kMaxByteColumns);
}

std::string hex_text(std::span<const std::byte> bytes)
{
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    text.reserve(2 * bytes.size());
    for (const std::byte b : bytes) {
        text += kDigits[static_cast<std::size_t>(b) >> 4U];
        text += kDigits[static_cast<std::size_t>(b) & 0xFU];
    }
    return text;
}

std::string heading(const ulog::Format& format)
{
    std::string line;
    for (const ulog::Field& field : format.fields) {
        for (std::size_t i = 0; i < (is_one_column(field) ? 1 : field.count); ++i) {
            line += line.empty() ? "" : ",";
            line += field.name;
            line += field.count > 1 && !is_one_column(field) ? "[" + std::to_string(i) + "]" : "";
        }
    }
    return line + "\n";
}

std::string line_of(const ulog::Format& format, std::span<const std::byte> content)
{
    std::string line;
    for (const ulog::Field& field : format.fields) {
        const std::size_t size = ulog::size_of_type(field.type);
        const std::span<const std::byte> bytes = content.subspan(field.offset, size * field.count);
        line += field.offset == 0 ? "" : ",";
        if (is_one_column(field)) {
            line += hex_text(bytes);
            continue;
        }
        for (std::size_t i = 0; i < field.count; ++i) {
            line += i == 0 ? "" : ",";
            line += log_value(field.type, bytes.subspan(i * size, size));
        }
    }
    return line + "\n";
}

constexpr const char* kTexts = "texts";

/// One file per instance of a topic, written as a whole at the end.
class CsvFiles {
public:
    /// A topic, and which of its instances (multi_id).
    using Instance = std::pair<std::string, unsigned>;
    /// The logged texts, beside the topics.
    static Instance logged() { return {"", 0}; }

    void write(const Instance& of, const std::string& heading, const std::string& line)
    {
        std::string& text = texts_[of];
        if (text.empty()) {
            text = heading;
            names_[of] = of == logged() ? kTexts : name_of(of);
        }
        text += line;
        ++lines_;
    }
    std::uint64_t finish(const std::filesystem::path& folder) const
    {
        for (const auto& [of, text] : texts_) {
            const std::filesystem::path file = folder / (names_.at(of) + ".csv");
            if (const std::string wrong = files::replace_file(file.string(), text); !wrong.empty()) {
                throw std::runtime_error(file.string() + ": " + wrong);
            }
        }
        return lines_;
    }

private:
    /// A name that no other instance has: a/b and a_b are two topics, and a topic may be called texts.
    std::string name_of(const Instance& of)
    {
        std::string name = of.first;
        std::replace(name.begin(), name.end(), '/', '_');
        name += of.second == 0 ? "" : "_" + std::to_string(of.second);
        while (!taken_.insert(name).second) {
            name += "_";
        }
        return name;
    }

    std::map<Instance, std::string> texts_;
    std::map<Instance, std::string> names_;
    std::set<std::string> taken_{kTexts};
    std::uint64_t lines_ = 0;
};

}  // namespace

std::string log_value(std::string_view type, std::span<const std::byte> bytes)
{
    if (bytes.size() < ulog::size_of_type(type)) {
        return "?";
    }
    if (type == "uint64_t") {
        return std::to_string(ulog::read_number<std::uint64_t>(bytes));
    }
    if (type == "int64_t") {
        return std::to_string(ulog::read_number<std::int64_t>(bytes));
    }
    if (type == "float") {
        return number_text(static_cast<double>(ulog::read_number<float>(bytes)), "%.9g");
    }
    if (type == "double") {
        return number_text(ulog::read_number<double>(bytes), "%.17g");
    }
    if (type == "uint32_t") {
        return std::to_string(ulog::read_number<std::uint32_t>(bytes));
    }
    if (type == "int32_t") {
        return std::to_string(ulog::read_number<std::int32_t>(bytes));
    }
    if (type == "uint16_t") {
        return std::to_string(ulog::read_number<std::uint16_t>(bytes));
    }
    if (type == "int16_t") {
        return std::to_string(ulog::read_number<std::int16_t>(bytes));
    }
    if (type == "int8_t") {
        return std::to_string(ulog::read_number<std::int8_t>(bytes));
    }
    return std::to_string(ulog::read_number<std::uint8_t>(bytes));
}

std::uint64_t write_log_csv(ulog::Reader& log, const std::filesystem::path& folder)
{
    CsvFiles files;
    std::map<std::uint16_t, unsigned> instances;  // of each id of a topic
    while (const auto message = log.next()) {
        const std::span<const std::byte> content = message->content;
        if (message->type == ulog::Type::subscription) {
            instances[ulog::read_number<std::uint16_t>(content.subspan(1))] = static_cast<unsigned>(content[0]);
        } else if (message->type == ulog::Type::data) {
            const auto id = ulog::read_number<std::uint16_t>(content);
            const ulog::Format& format = *log.topic(id);
            files.write({format.name, instances[id]}, heading(format), line_of(format, content.subspan(2)));
        } else if (message->type == ulog::Type::text) {
            std::string text = log_text(ulog::text_of(content.subspan(9)));
            for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) {
                text.insert(at, "\"");
            }
            files.write(CsvFiles::logged(), "timestamp,level,text\n",
                        log_value("uint64_t", content.subspan(1)) + "," + log_level(content[0]) + ",\"" + text +
                            "\"\n");
        }
    }
    return files.finish(folder);
}

}  // namespace jink::host
