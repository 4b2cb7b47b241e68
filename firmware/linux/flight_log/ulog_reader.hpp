// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/linux/flight_log/ulog.hpp"

// Reader's side of ULog. Takes cut and damaged files: everything before the damage is delivered, then the damage is
// named. Memory is bounded: a message is 64 KiB at most, and definitions are limited in number.

namespace jink::ulog {

/// One field of a format.
struct Field {
    std::string type;  ///< a basic type
    std::string name;
    std::size_t count = 1;  ///< above 1: an array
    std::size_t offset = 0;
};

/// A format of basic types; nested formats are refused.
struct Format {
    std::string name;
    std::vector<Field> fields;
    std::size_t size = 0;  ///< of a message [bytes], without padding at its end
};

/// Nothing where the text is malformed, larger than a message, or nested.
[[nodiscard]] std::optional<Format> parse_format(std::string_view text);

/// A value of 'I', 'P' or 'Q': "type name" and the bytes.
struct Keyed {
    std::string type;
    std::string name;
    std::vector<std::byte> value;

    [[nodiscard]] std::string text() const;             ///< of char[n]
    [[nodiscard]] std::optional<float> number() const;  ///< of float or int32_t
};

struct Message {
    Type type{};
    std::span<const std::byte> content;  ///< valid until the next read
    std::uint64_t offset = 0;            ///< in the file [bytes]
};

/// Why the reading ended.
enum class End : std::uint8_t {
    none,        ///< it goes on
    complete,    ///< after a whole message
    cut,         ///< within a message: a stop without notice
    not_ulog,    ///< wrong magic
    refused,     ///< incompatible flags that this reader does not know
    damaged,     ///< a message that cannot be
    too_many,    ///< more definitions than a log has
    unreadable,  ///< the file system reports an error
};
[[nodiscard]] std::string_view to_string(End end) noexcept;

/// Messages of one file in their order. Definitions are collected on the way; data are checked against them: a message
/// of an unknown topic, or of another size than its format, is damage. Messages of unknown types are passed over by
/// their length.
class Reader {
public:
    /// Definitions of each kind that are kept at most.
    static constexpr std::size_t kMaxDefinitions = 4096;

    /// @param in  outlives this
    explicit Reader(std::istream& in);

    /// The next message; nothing at the end.
    [[nodiscard]] std::optional<Message> next();
    [[nodiscard]] End end() const noexcept { return end_; }
    /// Where the first unread byte is.
    [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }
    [[nodiscard]] std::uint64_t started() const noexcept { return started_; }

    [[nodiscard]] const std::map<std::string, Format>& formats() const noexcept { return formats_; }
    /// Format of a topic's id; nullptr: none.
    [[nodiscard]] const Format* topic(std::uint16_t id) const noexcept;
    [[nodiscard]] const std::map<std::string, Keyed>& infos() const noexcept { return infos_; }
    /// Those of the definitions: later changes are messages of the data.
    [[nodiscard]] const std::map<std::string, Keyed>& parameters() const noexcept { return parameters_; }
    [[nodiscard]] const std::map<std::string, Keyed>& defaults() const noexcept { return defaults_; }
    /// Text of an information message; empty: there is none.
    [[nodiscard]] std::string info(const std::string& name) const;

private:
    void read_header();
    [[nodiscard]] bool take(const Message& message);
    [[nodiscard]] bool take_flags(std::span<const std::byte> content);
    [[nodiscard]] bool take_format(std::span<const std::byte> content);
    [[nodiscard]] bool take_subscription(std::span<const std::byte> content);
    [[nodiscard]] bool take_keyed(std::span<const std::byte> content, std::map<std::string, Keyed>& into);
    [[nodiscard]] bool fail(End end);
    [[nodiscard]] bool read_bytes(std::size_t n);

    std::istream& in_;
    std::vector<std::byte> buffer_;
    std::uint64_t offset_ = 0;
    std::uint64_t started_ = 0;
    End end_ = End::none;
    bool in_data_ = false;
    std::map<std::string, Format> formats_;
    std::map<std::uint16_t, std::string> topics_;
    std::map<std::string, Keyed> infos_;
    std::map<std::string, Keyed> parameters_;
    std::map<std::string, Keyed> defaults_;
};

[[nodiscard]] std::string text_of(std::span<const std::byte> bytes);

/// 'I', 'P' and 'Q' in the data.
[[nodiscard]] std::optional<Keyed> parse_keyed(std::span<const std::byte> content, Type type);

/// A number at the start of `bytes`, which has as many.
template <class T>
[[nodiscard]] T read_number(std::span<const std::byte> bytes) noexcept
{
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

/// With its header. @param message  the header at least
[[nodiscard]] inline std::size_t size_of_message(std::span<const std::byte> message) noexcept
{
    return kMessageHeader + read_number<std::uint16_t>(message);
}

}  // namespace jink::ulog
