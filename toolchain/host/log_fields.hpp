// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::host {

/// The fields of one message, by name: logs of other versions are read as far as they have them.
class LogFields {
public:
    LogFields(const ulog::Format& format, std::span<const std::byte> content) : format_(format), content_(content) {}

    /// NaN without such a field.
    [[nodiscard]] double number(std::string_view name, std::size_t index = 0) const
    {
        for (const ulog::Field& field : format_.fields) {
            if (field.name == name && index < field.count) {
                return value(field.type, content_.subspan(field.offset + index * ulog::size_of_type(field.type)));
            }
        }
        return std::numeric_limits<double>::quiet_NaN();
    }
    /// 0 without such a field, or where it does not fit.
    [[nodiscard]] unsigned code(std::string_view name) const
    {
        const double found = number(name);
        return found >= 0.0 && found <= 4294967295.0 ? static_cast<unsigned>(found) : 0U;
    }
    [[nodiscard]] std::array<double, 3> vector(std::string_view name) const
    {
        return {number(name, 0), number(name, 1), number(name, 2)};
    }

private:
    template <class T>
    static double as(std::span<const std::byte> bytes)
    {
        return static_cast<double>(ulog::read_number<T>(bytes));
    }
    static double value(std::string_view type, std::span<const std::byte> bytes)
    {
        using Read = double (*)(std::span<const std::byte>);
        constexpr auto kTypes = std::to_array<std::pair<std::string_view, Read>>({
            {"float", as<float>},
            {"double", as<double>},
            {"uint64_t", as<std::uint64_t>},
            {"int64_t", as<std::int64_t>},
            {"uint32_t", as<std::uint32_t>},
            {"int32_t", as<std::int32_t>},
            {"uint16_t", as<std::uint16_t>},
            {"int16_t", as<std::int16_t>},
            {"int8_t", as<std::int8_t>},
        });
        for (const auto& [name, read] : kTypes) {
            if (type == name) {
                return read(bytes);
            }
        }
        return as<std::uint8_t>(bytes);  // also bool and char
    }

    const ulog::Format& format_;
    std::span<const std::byte> content_;
};

}  // namespace jink::host
