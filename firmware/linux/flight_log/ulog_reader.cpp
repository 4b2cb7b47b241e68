// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/ulog_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace jink::ulog {
namespace {

constexpr std::array<std::uint8_t, 7> kMagic{'U', 'L', 'o', 'g', 0x01, 0x12, 0x35};

bool is_name(std::string_view text, std::string_view more)
{
    return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || more.find(c) != std::string_view::npos;
    });
}

/// "type name" or "type[n] name".
std::optional<Field> parse_field(std::string_view text)
{
    const std::size_t space = text.find(' ');
    if (space == std::string_view::npos || !is_name(text.substr(space + 1), "-/")) {
        return std::nullopt;
    }
    Field field;
    field.name = text.substr(space + 1);
    std::string_view type = text.substr(0, space);
    if (const std::size_t at = type.find('['); at != std::string_view::npos) {
        const std::string_view number = type.substr(at + 1, type.size() - at - 2);
        if (type.back() != ']' || number.size() > 5 || number.empty() ||
            number.find_first_not_of("0123456789") != std::string_view::npos) {
            return std::nullopt;
        }
        field.count = 0;
        for (const char c : number) {
            field.count = 10 * field.count + static_cast<std::size_t>(c - '0');
        }
        type = type.substr(0, at);
    }
    field.type = type;
    return size_of_type(type) == 0 ? std::nullopt : std::optional(field);
}

}  // namespace

std::string text_of(std::span<const std::byte> bytes)
{
    std::string text(bytes.size(), '\0');
    std::memcpy(text.data(), bytes.data(), bytes.size());
    return text;
}

std::optional<Format> parse_format(std::string_view text)
{
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || !is_name(text.substr(0, colon), "-/")) {
        return std::nullopt;
    }
    Format format;
    format.name = text.substr(0, colon);
    std::string_view rest = text.substr(colon + 1);
    while (!rest.empty()) {
        const std::size_t end = rest.find(';');
        auto field = parse_field(rest.substr(0, end));
        if (end == std::string_view::npos || !field || field->count == 0) {
            return std::nullopt;
        }
        field->offset = format.size;
        format.size += size_of_type(field->type) * field->count;
        if (format.size > kMaxContent) {
            return std::nullopt;
        }
        format.fields.push_back(std::move(*field));
        rest.remove_prefix(end + 1);
    }
    while (!format.fields.empty() && format.fields.back().name.starts_with("_padding")) {
        format.size = format.fields.back().offset;
        format.fields.pop_back();
    }
    return format.fields.empty() ? std::nullopt : std::optional(std::move(format));
}

std::string Keyed::text() const { return type == "char" ? text_of(value) : std::string(); }

std::optional<float> Keyed::number() const
{
    if (value.size() != 4) {
        return std::nullopt;
    }
    if (type == "int32_t") {
        return static_cast<float>(read_number<std::int32_t>(value));
    }
    return type == "float" ? std::optional(read_number<float>(value)) : std::nullopt;
}

std::optional<Keyed> parse_keyed(std::span<const std::byte> content, Type type)
{
    const std::size_t before = type == Type::parameter_default || type == Type::info_multiple ? 2 : 1;
    if (content.size() < before) {
        return std::nullopt;
    }
    const auto length = static_cast<std::size_t>(content[before - 1]);
    if (content.size() < before + length) {
        return std::nullopt;
    }
    const auto field = parse_field(text_of(content.subspan(before, length)));
    const std::span<const std::byte> value = content.subspan(before + length);
    if (!field || value.size() != size_of_type(field->type) * field->count) {
        return std::nullopt;
    }
    return Keyed{field->type, field->name, {value.begin(), value.end()}};
}

std::string_view to_string(End end) noexcept
{
    switch (end) {
    case End::none: return "not at its end";
    case End::complete: return "complete";
    case End::cut: return "cut within a message";
    case End::not_ulog: return "not a ULog file";
    case End::refused: return "has features that this reader does not know";
    case End::damaged: return "damaged";
    case End::too_many: return "has too many definitions";
    case End::unreadable: return "cannot be read";
    }
    return "?";
}

Reader::Reader(std::istream& in) : in_(in) { read_header(); }

bool Reader::fail(End end)
{
    end_ = end;
    return false;
}

/// Reads n bytes more into the buffer. False at the end of the file.
bool Reader::read_bytes(std::size_t n)
{
    const std::size_t had = buffer_.size();
    buffer_.resize(had + n);
    in_.read(static_cast<char*>(static_cast<void*>(buffer_.data() + had)), static_cast<std::streamsize>(n));
    if (in_.bad()) {
        return fail(End::unreadable);
    }
    const auto got = static_cast<std::size_t>(in_.gcount());
    if (got < n) {
        return fail(had + got == 0 && offset_ > 0 ? End::complete : End::cut);
    }
    return true;
}

void Reader::read_header()
{
    if (!read_bytes(kFileHeader)) {
        end_ = end_ == End::unreadable ? end_ : End::not_ulog;
        return;
    }
    if (std::memcmp(buffer_.data(), kMagic.data(), kMagic.size()) != 0) {
        end_ = End::not_ulog;
        return;
    }
    started_ = read_number<std::uint64_t>(std::span(buffer_).subspan(8));
    offset_ = kFileHeader;
}

std::optional<Message> Reader::next()
{
    if (end_ != End::none) {
        return std::nullopt;
    }
    buffer_.clear();
    if (!read_bytes(kMessageHeader)) {
        return std::nullopt;
    }
    const auto size = read_number<std::uint16_t>(buffer_);
    const Message header{static_cast<Type>(buffer_[2]), {}, offset_};
    const auto letter = static_cast<unsigned char>(header.type);
    if (size == 0 || std::isalpha(letter) == 0) {
        end_ = End::damaged;
        return std::nullopt;
    }
    if (!read_bytes(size)) {
        return std::nullopt;
    }
    const Message message{header.type, std::span(buffer_).subspan(kMessageHeader), offset_};
    if (!take(message)) {
        return std::nullopt;
    }
    offset_ += kMessageHeader + size;
    return message;
}

bool Reader::take(const Message& message)
{
    const std::span<const std::byte> content = message.content;
    switch (message.type) {
    case Type::flag_bits: return take_flags(content);
    case Type::format: return take_format(content);
    case Type::subscription: in_data_ = true; return take_subscription(content);
    case Type::info: return take_keyed(content, infos_);
    case Type::parameter:
        return in_data_ ? parse_keyed(content, message.type).has_value() || fail(End::damaged)
                        : take_keyed(content, parameters_);
    case Type::parameter_default: {
        const auto keyed = parse_keyed(content, message.type);
        if (keyed && defaults_.size() < kMaxDefinitions) {
            defaults_.insert_or_assign(keyed->name, *keyed);
        }
        return keyed.has_value() || fail(End::damaged);
    }
    case Type::data: {
        const Format* const format = content.size() < 2 ? nullptr : topic(read_number<std::uint16_t>(content));
        return (format != nullptr && content.size() - 2 == format->size) || fail(End::damaged);
    }
    case Type::text: in_data_ = true; return content.size() >= 9 || fail(End::damaged);
    case Type::dropout: return content.size() == 2 || fail(End::damaged);
    case Type::info_multiple:
    case Type::unsubscription:
    case Type::tagged_text:
    case Type::sync: break;
    }
    return true;  // also an unknown type
}

bool Reader::take_flags(std::span<const std::byte> content)
{
    if (content.size() < kFlagBytes) {
        return fail(End::damaged);
    }
    const auto is_set = [](std::byte b) { return b != std::byte{0}; };
    // Appended data is never written by jink, and not read.
    return std::none_of(content.begin() + 8, content.begin() + 16, is_set) || fail(End::refused);
}

bool Reader::take_format(std::span<const std::byte> content)
{
    auto format = parse_format(text_of(content));
    if (!format) {
        return fail(End::damaged);
    }
    if (formats_.size() >= kMaxDefinitions) {
        return fail(End::too_many);
    }
    std::string name = format->name;
    formats_.insert_or_assign(std::move(name), std::move(*format));
    return true;
}

bool Reader::take_subscription(std::span<const std::byte> content)
{
    if (content.size() < 4) {
        return fail(End::damaged);
    }
    const std::string name = text_of(content.subspan(3));
    const auto format = formats_.find(name);
    if (format == formats_.end() || format->second.fields.front().name != "timestamp" ||
        format->second.fields.front().type != "uint64_t" || format->second.fields.front().count != 1) {
        return fail(End::damaged);
    }
    topics_.insert_or_assign(read_number<std::uint16_t>(content.subspan(1)), name);  // 65536 at most
    return true;
}

bool Reader::take_keyed(std::span<const std::byte> content, std::map<std::string, Keyed>& into)
{
    auto keyed = parse_keyed(content, Type::info);
    if (!keyed) {
        return fail(End::damaged);
    }
    if (into.size() >= kMaxDefinitions) {
        return fail(End::too_many);
    }
    std::string name = keyed->name;
    into.insert_or_assign(std::move(name), std::move(*keyed));
    return true;
}

const Format* Reader::topic(std::uint16_t id) const noexcept
{
    const auto name = topics_.find(id);
    if (name == topics_.end()) {
        return nullptr;
    }
    const auto format = formats_.find(name->second);
    return format == formats_.end() ? nullptr : &format->second;
}

std::string Reader::info(const std::string& name) const
{
    const auto found = infos_.find(name);
    return found == infos_.end() ? std::string() : found->second.text();
}

}  // namespace jink::ulog
