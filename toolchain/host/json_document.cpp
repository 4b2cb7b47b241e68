// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/json_document.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>

#include "firmware/linux/complaint.hpp"
#include "toolchain/host/flight_page.hpp"

namespace jink::host {
namespace {

using nlohmann::json;

/// Finds values in a text that is known to be JSON.
class Finder {
public:
    explicit Finder(std::string_view text) : text_(text) {}

    /// The first byte of the value at a path such as "flights[2].series.t[5]", or of the innermost one around it that
    /// is there. O(size).
    [[nodiscard]] std::size_t find(std::string_view path)
    {
        skip_blanks();
        std::size_t found = at_;
        for (std::size_t i = 0; i < path.size() && (now() == '{' || now() == '['); found = at_) {
            const bool is_index = path[i] == '[';
            i += is_index || path[i] == '.' ? 1U : 0U;
            const std::size_t end = std::min(path.find_first_of(is_index ? "]" : ".[", i), path.size());
            const std::string_view step = path.substr(i, end - i);
            if (is_index ? !enter_list(std::stoul(std::string(step))) : !enter_object(step)) {
                break;
            }
            i = end + (is_index ? 1U : 0U);
        }
        return found;
    }

private:
    [[nodiscard]] char now() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip_blanks() { at_ = std::min(text_.find_first_not_of(" \t\r\n\xef\xbb\xbf", at_), text_.size()); }
    void skip_string()
    {
        for (++at_; at_ < text_.size() && now() != '"'; ++at_) {
            at_ += now() == '\\' ? 1U : 0U;
        }
        ++at_;
    }
    void skip_value()
    {
        std::size_t depth = 0;
        do {
            if (now() == '"') {
                skip_string();
            } else if (now() == '{' || now() == '[') {
                ++depth;
                ++at_;
            } else if (now() == '}' || now() == ']') {
                --depth;
                ++at_;
            } else {
                at_ = std::min(text_.find_first_of(depth > 0 ? "{}[]\"" : " \t\r\n,}]", at_), text_.size());
            }
        } while (depth > 0 && at_ < text_.size());
    }
    /// Behind the comma that follows a value; false where the list or object ends instead.
    bool skip_comma()
    {
        skip_value();
        skip_blanks();
        const bool more = now() == ',';
        ++at_;
        skip_blanks();
        return more;
    }
    bool enter_list(std::size_t index)
    {
        ++at_;
        skip_blanks();
        for (std::size_t i = 0; i < index; ++i) {
            if (!skip_comma()) {
                return false;
            }
        }
        return now() != ']';
    }
    bool enter_object(std::string_view key)
    {
        ++at_;
        skip_blanks();
        while (now() == '"') {
            const std::size_t from = at_ + 1;
            skip_string();
            const bool found = text_.substr(from, at_ - 1 - from) == key;
            skip_blanks();
            ++at_;  // the colon
            skip_blanks();
            if (found) {
                return true;
            }
            if (!skip_comma()) {
                break;
            }
        }
        return false;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

void JsonDocument::refuse(std::size_t at, const std::string& what) const
{
    const std::string_view before = std::string_view(text).substr(0, at);
    const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    const std::size_t begin = before.rfind('\n') + 1;  // npos + 1 is 0
    throw BadFlight(files::to_string({lines + 1, before.size() - begin + 1, what, file}));
}

std::size_t JsonDocument::find(std::string_view path) const { return Finder(text).find(path); }

json JsonDocument::parse() const
{
    std::istringstream in(text);
    const auto read = [&] {  // bytes so far
        in.clear();
        return static_cast<std::size_t>(in.tellg());
    };
    std::vector<std::set<std::string>> keys;  // of each object that is open
    const auto note = [&](int, json::parse_event_t event, const json& parsed) {
        if (event == json::parse_event_t::object_start) {
            keys.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys.pop_back();
        } else if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
            const std::size_t end = read();
            refuse(text.rfind('"', end - 2), "key " + files::in_quotes(parsed.get<std::string>()) + " comes twice");
        }
        return true;
    };
    try {
        return json::parse(in, note);
    } catch (const json::parse_error& error) {
        // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ..."
        constexpr std::size_t kLongest = 200;
        const std::string said = error.what();
        const std::size_t at = said.find(": ");
        refuse(std::max<std::size_t>(error.byte, 1) - 1,
               "is not JSON: " + said.substr(at == std::string::npos ? 0 : at + 2, kLongest));
    } catch (const json::exception&) {
        const std::size_t end = text.find_last_of("0123456789", read() - 1);
        const std::size_t before = text.find_last_not_of("0123456789+-.eE", end);
        refuse(before + 1, "expected a number that double precision holds");
    }
}

}  // namespace jink::host
