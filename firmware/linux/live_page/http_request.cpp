// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/http_request.hpp"

#include <algorithm>
#include <array>

namespace jink::livepage {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kHeadEnd = "\r\n\r\n";

char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equal_without_case(std::string_view a, std::string_view b) noexcept
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

/// RFC 9110 section 5.6.2.
bool is_token(std::string_view text) noexcept
{
    constexpr std::string_view kOthers = "!#$%&'*+-.^_`|~";
    return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
        return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'z') || kOthers.find(c) != kOthers.npos;
    });
}

/// No control characters but tabs.
bool is_field_value(std::string_view text) noexcept
{
    return std::all_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte >= 0x20U && byte != 0x7FU) || c == '\t';
    });
}

std::string_view trimmed(std::string_view text) noexcept
{
    const std::size_t first = text.find_first_not_of(" \t");
    return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The next line, without its end; `rest` begins behind it. `rest` has at least one end of a line.
std::string_view take_line(std::string_view& rest) noexcept
{
    const std::size_t end = rest.find(kLineEnd);
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + kLineEnd.size());
    return line;
}

bool is_digits(std::string_view text) noexcept
{
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// localhost, 127.0.0.1, [::1] or `loopback`, with or without a port.
bool is_this_machine(std::string_view host, std::string_view loopback) noexcept
{
    const std::array<std::string_view, 4> names{"localhost", "127.0.0.1", "[::1]", loopback};
    return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
        const std::string_view rest = host.substr(std::min(name.size(), host.size()));
        return equal_without_case(host.substr(0, name.size()), name) &&
               (rest.empty() || (rest.front() == ':' && is_digits(rest.substr(1))));
    });
}

/// Fields until the empty line. False: malformed, or Host is missing or there twice (RFC 9112 section 3.2).
bool read_fields(std::string_view rest, std::string_view& host) noexcept
{
    std::size_t hosts = 0;
    for (std::string_view line = take_line(rest); !line.empty(); line = take_line(rest)) {
        const std::size_t colon = line.find(':');
        if (colon == line.npos || !is_token(line.substr(0, colon)) || !is_field_value(line)) {
            return false;
        }
        if (equal_without_case(line.substr(0, colon), "host")) {
            host = trimmed(line.substr(colon + 1));
            ++hosts;
        }
    }
    return hosts == 1;
}

}  // namespace

std::size_t head_length(std::string_view text) noexcept
{
    const std::size_t end = text.find(kHeadEnd);
    return end == text.npos ? 0 : end + kHeadEnd.size();
}

HttpRequest read_request(std::string_view head, std::string_view loopback) noexcept
{
    std::string_view rest = head;
    const std::string_view line = take_line(rest);
    const std::size_t first = line.find(' ');
    const std::size_t last = line.rfind(' ');
    if (first == line.npos || first == last) {
        return {HttpStatus::bad_request};
    }
    const std::string_view method = line.substr(0, first);
    const std::string_view target = line.substr(first + 1, last - first - 1);
    const std::string_view version = line.substr(last + 1);
    std::string_view host;
    if (!is_token(method) || target.empty() || target.find(' ') != target.npos || !is_field_value(line) ||
        (version != "HTTP/1.1" && version != "HTTP/1.0") || !read_fields(rest, host)) {
        return {HttpStatus::bad_request};
    }
    if (!loopback.empty() && !is_this_machine(host, loopback)) {
        return {HttpStatus::misdirected};
    }
    if (method != "GET") {
        return {HttpStatus::not_allowed};
    }
    if (target == "/") {
        return {HttpStatus::ok, Resource::page};
    }
    return target == "/events" ? HttpRequest{HttpStatus::ok, Resource::events} : HttpRequest{HttpStatus::not_found};
}

std::string_view text_of(HttpStatus status) noexcept
{
    switch (status) {
    case HttpStatus::ok: return "200 OK";
    case HttpStatus::bad_request: return "400 Bad Request";
    case HttpStatus::not_found: return "404 Not Found";
    case HttpStatus::not_allowed: return "405 Method Not Allowed";
    case HttpStatus::misdirected: return "421 Misdirected Request";
    case HttpStatus::too_large: return "431 Request Header Fields Too Large";
    case HttpStatus::unavailable: break;
    }
    return "503 Service Unavailable";
}

}  // namespace jink::livepage
