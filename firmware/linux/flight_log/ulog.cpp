// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/ulog.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace jink::ulog {
namespace {

/// Names of keys are 255 bytes at most: the length is a byte.
constexpr std::size_t kMaxKey = 255;

template <class T>
std::span<const std::byte> bytes_of(const T& value)
{
    return std::as_bytes(std::span(&value, 1));
}

std::string keyed_by(std::string_view type, std::string_view name)
{
    return std::string(type) + " " + std::string(name);
}

}  // namespace

void Messages::put(std::string_view text) { append(std::as_bytes(std::span(text))); }

void Messages::file_header(std::uint64_t started)
{
    put(kMagicAndVersion);
    put(started);
}

void Messages::flag_bits(std::uint8_t compatible)
{
    std::array<std::uint8_t, kFlagBytes> flags{};
    flags[0] = compatible;
    put(static_cast<std::uint16_t>(flags.size()));
    put(Type::flag_bits);
    put(flags);
}

void Messages::format(std::string_view format)
{
    put(static_cast<std::uint16_t>(format.size()));
    put(Type::format);
    put(format);
}

void Messages::keyed(Type type, std::string_view key, std::span<const std::byte> value, bool is_default)
{
    key = key.substr(0, kMaxKey);
    const std::size_t more = is_default ? 2 : 1;
    value = value.first(std::min(value.size(), kMaxContent - more - key.size()));
    put(static_cast<std::uint16_t>(more + key.size() + value.size()));
    put(type);
    if (is_default) {
        put(kDefaultOfSetup);
    }
    put(static_cast<std::uint8_t>(key.size()));
    put(key);
    append(value);
}

void Messages::info(std::string_view name, std::string_view text)
{
    keyed(Type::info, keyed_by("char[" + std::to_string(text.size()) + "]", name), std::as_bytes(std::span(text)));
}

void Messages::info(std::string_view name, std::uint32_t value)
{
    keyed(Type::info, keyed_by("uint32_t", name), bytes_of(value));
}

void Messages::parameter(std::string_view name, float value)
{
    keyed(Type::parameter, keyed_by("float", name), bytes_of(value));
}

void Messages::parameter(std::string_view name, std::int32_t value)
{
    keyed(Type::parameter, keyed_by("int32_t", name), bytes_of(value));
}

void Messages::parameter_default(std::string_view name, float value)
{
    keyed(Type::parameter_default, keyed_by("float", name), bytes_of(value), true);
}

void Messages::parameter_default(std::string_view name, std::int32_t value)
{
    keyed(Type::parameter_default, keyed_by("int32_t", name), bytes_of(value), true);
}

void Messages::subscription(std::uint16_t id, std::string_view name)
{
    put(static_cast<std::uint16_t>(3 + name.size()));
    put(Type::subscription);
    put(std::uint8_t{0});
    put(id);
    put(name);
}

}  // namespace jink::ulog
