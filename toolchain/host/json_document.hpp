// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace jink::host {

/// The text of a JSON file, for refusals that name line and column.
struct JsonDocument {
    std::string file;  ///< its name
    std::string text;

    /// @throws BadFlight "file:line:column: what", about the byte `at`
    [[noreturn]] void refuse(std::size_t at, const std::string& what) const;
    /// The first byte of the value at a path such as "flights[2].series.t[5]", or of the innermost one around it that
    /// is there. The text is JSON. O(size).
    [[nodiscard]] std::size_t find(std::string_view path) const;
    /// Refuses what is not JSON, a key that comes twice in an object, and a number beyond double precision. O(size).
    [[nodiscard]] nlohmann::json parse() const;
};

}  // namespace jink::host
