// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/json_text.hpp"

#include <cmath>

namespace jink::livepage {

void add_number(std::string& out, double value, int decimals)
{
    if (std::abs(value) <= flightlog::kMaxShown) {
        add(out, "%.*f", decimals, value);
    } else {
        out += "null";
    }
}

void add_vector(std::string& out, const flightlog::Xyz& position, const flightlog::Xyz& velocity, double seconds)
{
    for (std::size_t k = 0; k < 3; ++k) {
        out += k == 0 ? '[' : ',';
        add_number(out, static_cast<double>(position[k]) + seconds * static_cast<double>(velocity[k]));
    }
    out += ']';
}

void add_columns(std::string& out, const flightlog::Columns3& points)
{
    constexpr int kCentimetres = 2;
    const char* bracket = "[[";
    for (const std::vector<double>* column : {&points.x, &points.y, &points.z}) {
        out += bracket;
        for (std::size_t i = 0; i < column->size(); ++i) {
            out += i == 0 ? "" : ",";
            add_number(out, (*column)[i], kCentimetres);
        }
        bracket = "],[";
    }
    out += "]]";
}

void add_string(std::string& out, std::string_view text)
{
    out += '"';
    for (const char c : text.substr(0, text.find('\0'))) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += byte >= 0x20U && byte < 0x7FU ? c : '?';
    }
    out += '"';
}

void add_name(std::string& out, const char* key, std::string_view name)
{
    add(out, ",\"%s\":", key);
    add_string(out, name);
}

}  // namespace jink::livepage
