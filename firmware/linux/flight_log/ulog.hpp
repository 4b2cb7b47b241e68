// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "firmware/flight_log/ulog.hpp"

namespace jink::ulog {

/// The definitions of a file, or any other messages that are not composed in the loop: allocates.
class Messages {
public:
    /// @param started  when the logging started [us]
    void file_header(std::uint64_t started);
    void flag_bits(std::uint8_t compatible);
    void format(std::string_view format);
    void info(std::string_view name, std::string_view text);
    void info(std::string_view name, std::uint32_t value);
    void parameter(std::string_view name, float value);
    void parameter(std::string_view name, std::int32_t value);
    void parameter_default(std::string_view name, float value);
    void parameter_default(std::string_view name, std::int32_t value);
    void subscription(std::uint16_t id, std::string_view name);

    [[nodiscard]] const std::vector<std::byte>& bytes() const noexcept { return bytes_; }
    void append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

private:
    void keyed(Type type, std::string_view key, std::span<const std::byte> value, bool is_default = false);
    void put(std::string_view text);
    template <class T>
    void put(T value)
    {
        append(std::as_bytes(std::span(&value, 1)));
    }

    std::vector<std::byte> bytes_;
};

}  // namespace jink::ulog
