// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace jink::livepage {
namespace {

/// The system's part of what waits for a client [bytes]: small, so that a slow client is found.
constexpr int kSendBuffer = 16 * 1024;
/// Connections that the system keeps until they are accepted: a burst is answered, with 503 where it has to be.
constexpr int kBacklog = 64;
/// What a client may send behind its request [bytes].
constexpr std::size_t kMaxDiscarded = std::size_t{64} * 1024;

/// The page is one file with its program and style in it, as the viewer of jink report.
constexpr std::string_view kFields =
    "Cache-Control: no-store\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
    "Connection: close\r\n";

/// An address of loopback as Host names it; empty: another address.
std::string loopback_of(const hal::NetworkAddress& address)
{
    if (address.storage.ss_family == AF_INET) {
        sockaddr_in v4{};
        std::memcpy(&v4, &address.storage, sizeof v4);
        std::array<char, INET_ADDRSTRLEN> text{};
        const bool is_loopback = ntohl(v4.sin_addr.s_addr) >> 24U == 127U;
        return is_loopback && ::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size()) != nullptr ? text.data()
                                                                                                      : "";
    }
    sockaddr_in6 v6{};
    std::memcpy(&v6, &address.storage, sizeof v6);
    return IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr) ? "[::1]" : "";
}

std::string head_of(HttpStatus status, std::string_view type, std::size_t length)
{
    std::string text = "HTTP/1.1 ";
    text += text_of(status);
    text += "\r\nContent-Type: ";
    text += type;
    text += "\r\n";
    if (length > 0) {
        text += "Content-Length: " + std::to_string(length) + "\r\n";
    }
    text += status == HttpStatus::not_allowed ? "Allow: GET\r\n" : "";
    text += kFields;
    return text + "\r\n";
}

std::string event_of(std::string_view json)
{
    std::string text = "data: ";
    text += json;
    return text + "\n\n";
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

Server::~Server()
{
    for (const Client& client : clients_) {
        ::close(client.descriptor);
    }
    if (listener_ >= 0) {
        ::close(listener_);
    }
}

int Server::listen(const hal::NetworkAddress& address)
{
    constexpr int kOn = 1;
    listener_ = ::socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (listener_ < 0) {
        return errno;
    }
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &kOn, sizeof kOn);
    ::setsockopt(listener_, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);  // accepted ones inherit it
    if (address.storage.ss_family == AF_INET6) {
        ::setsockopt(listener_, IPPROTO_IPV6, IPV6_V6ONLY, &kOn, sizeof kOn);
    }
    // The interface of the system's sockets. NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    const auto* const own = reinterpret_cast<const sockaddr*>(&address.storage);
    if (::bind(listener_, own, address.length) != 0 || ::listen(listener_, kBacklog) != 0) {
        return errno;
    }
    loopback_ = loopback_of(address);
    clients_.reserve(kMaxClients);
    return 0;
}

void Server::pass(std::int64_t now_us, std::int64_t until_us, const Snapshot& snapshot)
{
    std::array<pollfd, kMaxClients + 1> waiting{};
    waiting[0] = {listener_, POLLIN, 0};
    for (std::size_t i = 0; i < clients_.size(); ++i) {
        const bool has_out = !clients_[i].out.empty() || !clients_[i].body.empty();
        waiting[i + 1] = {clients_[i].descriptor, static_cast<short>(has_out ? POLLIN | POLLOUT : POLLIN), 0};
    }
    const auto ms = static_cast<int>(std::clamp<std::int64_t>((until_us - now_us) / 1000, 0, 100));
    if (::poll(waiting.data(), clients_.size() + 1, ms) < 0) {
        return;
    }
    for (std::size_t i = 0; i < clients_.size(); ++i) {
        const short events = waiting[i + 1].revents;
        if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) {
            read(clients_[i], now_us, snapshot);
        }
        write(clients_[i], now_us);
        check_time(clients_[i], now_us);
    }
    remove_gone();
    if (waiting[0].revents != 0) {
        accept_all(now_us);
    }
}

void Server::send(std::string_view json, std::int64_t now_us)
{
    for (Client& client : clients_) {
        if (client.state != State::hearing) {
            continue;
        }
        client.out += event_of(json);
        write(client, now_us);
        if (client.out.size() > kMaxWaiting) {
            drop(client, true);
        }
    }
    remove_gone();
}

void Server::accept_all(std::int64_t now_us)
{
    for (std::size_t i = 0; i < kMaxClients; ++i) {
        const int descriptor = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (descriptor < 0) {
            return;
        }
        if (clients_.size() < kMaxClients) {
            Client& client = clients_.emplace_back();
            client.descriptor = descriptor;
            client.deadline_us = now_us + kHeadTime;
            continue;
        }
        const std::string text = head_of(HttpStatus::unavailable, "text/plain", 0);
        static_cast<void>(::send(descriptor, text.data(), text.size(), MSG_NOSIGNAL));
        ::close(descriptor);
        ++counts_.refused;
    }
}

void Server::read(Client& client, std::int64_t now_us, const Snapshot& snapshot)
{
    std::array<char, 4096> bytes{};
    const ssize_t n = ::recv(client.descriptor, bytes.data(), bytes.size(), 0);
    if (n < 0 && would_block(errno)) {
        return;
    }
    if (n <= 0) {
        // The other side's end of a request alone: the answer still goes out.
        if (n < 0 || client.state != State::answering) {
            drop(client, false);
        }
        return;
    }
    const auto size = static_cast<std::size_t>(n);
    if (client.state == State::reading) {
        client.in.append(bytes.data(), size);
        read_head(client, now_us, snapshot);
        return;
    }
    client.discarded += size;
    if (client.state == State::hearing || client.discarded > kMaxDiscarded) {
        drop(client, true);
    }
}

void Server::read_head(Client& client, std::int64_t now_us, const Snapshot& snapshot)
{
    const std::size_t length = head_length(client.in);
    if (length > kMaxHead || (length == 0 && client.in.size() >= kMaxHead)) {
        answer(client, HttpStatus::too_large, now_us);
        return;
    }
    if (length == 0) {
        return;
    }
    const HttpRequest request = read_request(std::string_view(client.in).substr(0, length), loopback_);
    if (request.status == HttpStatus::ok && request.resource == Resource::events) {
        begin_events(client, now_us, snapshot);
    } else {
        answer(client, request.status, now_us);
    }
}

void Server::answer(Client& client, HttpStatus status, std::int64_t now_us)
{
    client.in.clear();
    client.state = State::answering;
    client.deadline_us = now_us + kAnswerTime;
    if (status == HttpStatus::ok) {
        client.out = head_of(status, "text/html; charset=utf-8", page_.size());
        client.body = page_;
        return;
    }
    ++counts_.refused;
    const std::string text = std::string(text_of(status)) + "\n";
    client.out = head_of(status, "text/plain; charset=utf-8", text.size()) + text;
}

void Server::begin_events(Client& client, std::int64_t now_us, const Snapshot& snapshot)
{
    client.in.clear();
    client.state = State::hearing;
    client.deadline_us = now_us + kStallTime;
    client.out = head_of(HttpStatus::ok, "text/event-stream", 0) + "retry: 1000\n\n";
    ++counts_.clients;
    if (snapshot.has_step()) {
        client.out += event_of(snapshot.json(true, counts_));
    }
}

/// Sends what the system takes.
void Server::write(Client& client, std::int64_t now_us)
{
    while (client.state != State::gone && (!client.out.empty() || !client.body.empty())) {
        const std::string_view part = client.out.empty() ? client.body : std::string_view(client.out);
        const ssize_t n = ::send(client.descriptor, part.data(), part.size(), MSG_NOSIGNAL);
        if (n < 0) {
            if (!would_block(errno)) {
                drop(client, false);
            }
            return;
        }
        const auto sent = static_cast<std::size_t>(n);
        if (client.out.empty()) {
            client.body.remove_prefix(sent);
        } else {
            client.out.erase(0, sent);
        }
        client.deadline_us = client.state == State::hearing ? now_us + kStallTime : client.deadline_us;
    }
    if (client.state == State::answering) {
        ::shutdown(client.descriptor, SHUT_WR);
        client.state = State::lingering;
        client.deadline_us = now_us + kLingerTime;
    }
}

void Server::check_time(Client& client, std::int64_t now_us) noexcept
{
    const bool waits = client.state != State::hearing || !client.out.empty();
    if (client.state != State::gone && waits && now_us > client.deadline_us) {
        drop(client, client.state != State::lingering);
    }
    client.deadline_us = waits ? client.deadline_us : now_us + kStallTime;
}

void Server::drop(Client& client, bool is_slow) noexcept
{
    if (client.state == State::gone) {
        return;
    }
    counts_.clients -= client.state == State::hearing ? 1U : 0U;
    counts_.slow += is_slow ? 1U : 0U;
    client.state = State::gone;
}

void Server::remove_gone()
{
    std::erase_if(clients_, [](const Client& client) {
        if (client.state == State::gone) {
            ::close(client.descriptor);
        }
        return client.state == State::gone;
    });
}

}  // namespace jink::livepage
