// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

// What the live page's server understands of HTTP/1.1 (RFC 9110, RFC 9112): GET of two names, nothing else.

namespace jink::livepage {

/// Status codes that are answered; RFC 9110 section 15.
enum class HttpStatus : std::uint16_t {
    ok = 200,
    bad_request = 400,
    not_found = 404,
    not_allowed = 405,  ///< a method other than GET
    misdirected = 421,  ///< Host names another machine: DNS rebinding
    too_large = 431,    ///< the head is longer than kMaxHead
    unavailable = 503,  ///< all places are taken
};

enum class Resource : std::uint8_t { page, events };

struct HttpRequest {
    HttpStatus status = HttpStatus::bad_request;
    Resource resource = Resource::page;  ///< where status is ok
};

/// Of a request's line and fields, with the empty line behind them [bytes].
inline constexpr std::size_t kMaxHead = 8U * 1024U;

/// Bytes of the head at the beginning of `text`, with its empty line; 0: it is not complete.
[[nodiscard]] std::size_t head_length(std::string_view text) noexcept;

/// Judges a complete head.
///
/// @param loopback  the address that is served; empty: not on loopback. On loopback Host has to be this address,
///                  localhost, 127.0.0.1 or [::1], with any port: a name that an attacker's DNS points to this machine
///                  is refused
/// O(length).
[[nodiscard]] HttpRequest read_request(std::string_view head, std::string_view loopback) noexcept;

/// "404 Not Found"
[[nodiscard]] std::string_view text_of(HttpStatus status) noexcept;

}  // namespace jink::livepage
