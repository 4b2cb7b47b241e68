// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

// Writer's side of ULog, PX4's log format (docs.px4.io, "ULog File Format"): a file header, then messages of two bytes
// of length, a byte of type and the content. All numbers little-endian. Without allocation: for images too.

namespace jink::ulog {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are in memory");

enum class Type : std::uint8_t {
    flag_bits = 'B',
    format = 'F',
    info = 'I',
    info_multiple = 'M',
    parameter = 'P',
    parameter_default = 'Q',
    subscription = 'A',
    unsubscription = 'R',
    data = 'D',
    text = 'L',
    tagged_text = 'C',
    sync = 'S',
    dropout = 'O',
};

/// Levels of a logged string, as in the Linux kernel.
enum class Level : std::uint8_t { emergency = '0', alert, critical, error, warning, notice, info, debug };

inline constexpr std::size_t kFileHeader = 16;
inline constexpr std::array<std::uint8_t, 8> kMagicAndVersion{'U', 'L', 'o', 'g', 0x01, 0x12, 0x35, 1};
inline constexpr std::size_t kFlagBytes = 40;  ///< content of the flag bits
inline constexpr std::size_t kMessageHeader = 3;
inline constexpr std::size_t kMaxContent = 65535;
inline constexpr std::size_t kDataHeader = 5;  ///< message header and the topic's id

inline constexpr std::uint8_t kDefaultParameters = 1;  ///< of the compatible flags
inline constexpr std::uint8_t kDefaultOfSetup = 2;     ///< default_types of 'Q': of the present configuration

/// Size of one value of a basic type [bytes]; 0: no basic type.
[[nodiscard]] constexpr std::size_t size_of_type(std::string_view type) noexcept
{
    if (type == "int8_t" || type == "uint8_t" || type == "bool" || type == "char") {
        return 1;
    }
    if (type == "int16_t" || type == "uint16_t") {
        return 2;
    }
    if (type == "int32_t" || type == "uint32_t" || type == "float") {
        return 4;
    }
    return type == "int64_t" || type == "uint64_t" || type == "double" ? 8 : 0;
}

/// Bytes of one message of a format `name:type field;type[n] field;`, basic types alone; 0: malformed.
[[nodiscard]] constexpr std::size_t size_of_format(std::string_view format) noexcept
{
    std::size_t sum = 0;
    std::string_view rest = format.substr(std::min(format.find(':'), format.size() - 1) + 1);
    while (!rest.empty()) {
        const std::string_view field = rest.substr(0, rest.find(';'));
        const std::string_view type = field.substr(0, field.find(' '));
        std::size_t count = 1;
        if (const std::size_t at = type.find('['); at != std::string_view::npos) {
            count = 0;
            for (const char c : type.substr(at + 1, type.find(']') - at - 1)) {
                count = 10 * count + static_cast<std::size_t>(c - '0');
            }
        }
        const std::size_t size = size_of_type(type.substr(0, type.find('[')));
        if (size == 0 || count == 0 || field.size() == rest.size()) {
            return 0;
        }
        sum += size * count;
        rest.remove_prefix(field.size() + 1);
    }
    return sum;
}

/// Composes one message in a buffer, without allocation. What does not fit is cut.
class Composer {
public:
    explicit Composer(std::span<std::byte> buffer) noexcept : buffer_(buffer) {}

    Composer& begin(Type type) noexcept
    {
        size_ = kMessageHeader;
        buffer_[2] = static_cast<std::byte>(type);
        return *this;
    }
    template <class T>
    Composer& put(T value) noexcept
    {
        return put_bytes(std::as_bytes(std::span(&value, 1)));
    }
    Composer& put_bytes(std::span<const std::byte> bytes) noexcept
    {
        if (bytes.size() > buffer_.size() - size_) {
            bytes = bytes.first(buffer_.size() - size_);
        }
        std::memcpy(buffer_.data() + size_, bytes.data(), bytes.size());
        size_ += bytes.size();
        return *this;
    }
    Composer& put_text(std::string_view text) noexcept { return put_bytes(std::as_bytes(std::span(text))); }
    /// The next n bytes, which the caller writes; fewer where they do not fit.
    [[nodiscard]] std::span<std::byte> room(std::size_t n) noexcept
    {
        n = std::min(n, buffer_.size() - size_);
        size_ += n;
        return buffer_.subspan(size_ - n, n);
    }
    /// The whole message.
    [[nodiscard]] std::span<const std::byte> end() noexcept
    {
        const auto content = static_cast<std::uint16_t>(size_ - kMessageHeader);
        std::memcpy(buffer_.data(), &content, sizeof content);
        return buffer_.first(size_);
    }

private:
    std::span<std::byte> buffer_;
    std::size_t size_ = kMessageHeader;
};

}  // namespace jink::ulog
