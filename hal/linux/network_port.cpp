// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/network_port.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace jink::hal {
namespace {

NetworkStatus cause_of(int error) noexcept
{
    switch (error) {
    case EADDRINUSE: return NetworkStatus::in_use;
    case EADDRNOTAVAIL:
    case ENETUNREACH:
    case EHOSTUNREACH:
    case ENETDOWN: return NetworkStatus::not_here;
    case ECONNREFUSED: return NetworkStatus::nobody;
    case EACCES:
    case EPERM: return NetworkStatus::access_denied;
    default: return NetworkStatus::failed;
    }
}

/// The generic view that the system's calls take.
sockaddr* view(NetworkAddress& address) noexcept { return reinterpret_cast<sockaddr*>(&address.storage); }

/// Nobody receives at the other end, at present: no fault of this port.
bool is_nobody_there(int error) noexcept { return error == ECONNREFUSED; }
bool is_full(int error) noexcept { return error == EAGAIN || error == EWOULDBLOCK || error == ENOBUFS; }

void set(int descriptor, int level, int option, int value) noexcept
{
    static_cast<void>(::setsockopt(descriptor, level, option, &value, sizeof value));
}

}  // namespace

bool operator==(const NetworkAddress& a, const NetworkAddress& b) noexcept
{
    if (a.storage.ss_family != b.storage.ss_family) {
        return false;
    }
    if (a.storage.ss_family == AF_INET) {
        const auto& x = reinterpret_cast<const sockaddr_in&>(a.storage);
        const auto& y = reinterpret_cast<const sockaddr_in&>(b.storage);
        return x.sin_port == y.sin_port && x.sin_addr.s_addr == y.sin_addr.s_addr;
    }
    const auto& x = reinterpret_cast<const sockaddr_in6&>(a.storage);
    const auto& y = reinterpret_cast<const sockaddr_in6&>(b.storage);
    return x.sin6_port == y.sin6_port && x.sin6_scope_id == y.sin6_scope_id &&
           std::memcmp(&x.sin6_addr, &y.sin6_addr, sizeof x.sin6_addr) == 0;
}

NetworkPort::~NetworkPort() { release(); }

NetworkStatus NetworkPort::open(NetworkKind kind, const NetworkAddress& address, std::int64_t retry_period_us) noexcept
{
    close();
    const sa_family_t family = address.storage.ss_family;
    if ((family != AF_INET && family != AF_INET6) || address.length == 0 || address.length > sizeof address.storage) {
        return NetworkStatus::bad_address;
    }
    kind_ = kind;
    address_ = address;
    retry_period_us_ = retry_period_us;
    attempt_at_once_ = true;
    was_open_ = false;
    health_.state = PortState::lost;
    return try_open();
}

void NetworkPort::close() noexcept
{
    release();
    health_.state = PortState::closed;
}

NetworkStatus NetworkPort::try_open() noexcept
{
    began_us_ = kNotYet;
    const int type = kind_ == NetworkKind::tcp ? SOCK_STREAM : SOCK_DGRAM;
    descriptor_ = ::socket(address_.storage.ss_family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    int result = descriptor_ < 0 ? -1 : 0;
    if (result == 0 && kind_ == NetworkKind::udp_listen) {
        result = ::bind(descriptor_, view(address_), address_.length);
    } else if (result == 0) {
        if (kind_ == NetworkKind::tcp) {
            set(descriptor_, IPPROTO_TCP, TCP_NODELAY, 1);
            set(descriptor_, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(kPeerSilence / 1000));
        }
        result = ::connect(descriptor_, view(address_), address_.length);
        if (result != 0 && errno == EINPROGRESS) {
            connecting_ = true;
            return NetworkStatus::ok;
        }
    }
    if (result != 0) {
        const NetworkStatus cause = cause_of(errno);
        ++health_.open_failures;
        release();
        return cause;
    }
    if (kind_ != NetworkKind::udp_listen) {
        become_open();
    }
    return NetworkStatus::ok;
}

void NetworkPort::complete_connection() noexcept
{
    began_us_ = began_us_ == kNotYet ? now_us_ : began_us_;
    pollfd waiting{descriptor_, POLLOUT, 0};
    int error = 0;
    if (::poll(&waiting, 1, 0) <= 0) {
        error = now_us_ - began_us_ > kPeerSilence ? ETIMEDOUT : EINPROGRESS;
    } else {
        socklen_t length = sizeof error;
        if (::getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &length) != 0) {
            error = errno;
        }
    }
    if (error == 0) {
        connecting_ = false;
        become_open();
    } else if (error != EINPROGRESS) {
        ++health_.open_failures;
        release();
    }
}

void NetworkPort::service(std::int64_t now_us) noexcept
{
    now_us_ = now_us;
    if (health_.state == PortState::closed) {
        return;
    }
    if (connecting_) {
        complete_connection();
    } else if (descriptor_ >= 0 && kind_ != NetworkKind::tcp && begin_ == end_) {
        take_datagram();
    }
    if (descriptor_ >= 0 || (!attempt_at_once_ && now_us < next_attempt_us_)) {
        return;
    }
    attempt_at_once_ = false;
    next_attempt_us_ = now_us + retry_period_us_;
    static_cast<void>(try_open());
}

bool NetworkPort::is_from_other_side(const NetworkAddress& sender) noexcept
{
    if (kind_ == NetworkKind::udp_send) {
        return true;  // the system lets nobody else through
    }
    if (peer_.length != 0 && sender == peer_) {
        return true;
    }
    if (peer_.length != 0) {
        if (now_us_ - heard_us_ <= kPeerSilence) {
            return false;
        }
        ++health_.disconnects;
        health_.state = PortState::lost;
    }
    peer_ = sender;
    become_open();
    return true;
}

/// The next datagram of the other side, if there is one.
void NetworkPort::take_datagram() noexcept
{
    begin_ = end_ = 0;
    for (int i = 0; i < kDatagramsPerCall && descriptor_ >= 0; ++i) {
        NetworkAddress sender;
        sender.length = sizeof sender.storage;
        const ssize_t got =
            ::recvfrom(descriptor_, datagram_.data(), datagram_.size(), 0, view(sender), &sender.length);
        if (got < 0 && (errno == EINTR || is_nobody_there(errno))) {
            continue;
        }
        if (got < 0) {
            if (!is_full(errno)) {
                ++health_.read_errors;
                lose();
            }
            return;
        }
        if (!is_from_other_side(sender)) {
            ++health_.line_errors;
            continue;
        }
        heard_us_ = now_us_;
        if (got > 0) {
            end_ = static_cast<std::size_t>(got);
            return;
        }
    }
}

std::size_t NetworkPort::read_datagrams(std::span<std::byte> into) noexcept
{
    std::size_t count = 0;
    while (count < into.size()) {
        if (begin_ == end_) {
            take_datagram();
        }
        if (begin_ == end_) {
            break;
        }
        const std::size_t part = std::min(end_ - begin_, into.size() - count);
        std::copy_n(datagram_.begin() + static_cast<std::ptrdiff_t>(begin_), part,
                    into.begin() + static_cast<std::ptrdiff_t>(count));
        begin_ += part;
        count += part;
    }
    return count;
}

std::size_t NetworkPort::read_stream(std::span<std::byte> into) noexcept
{
    std::size_t count = 0;
    while (health_.state == PortState::open && count < into.size()) {
        const ssize_t got = ::recv(descriptor_, into.data() + count, into.size() - count, 0);
        if (got > 0) {
            count += static_cast<std::size_t>(got);
        } else if (got < 0 && is_full(errno)) {
            break;
        } else if (got == 0 || errno != EINTR) {
            health_.read_errors += got < 0 ? 1U : 0U;
            lose();
        }
    }
    return count;
}

std::size_t NetworkPort::read(std::span<std::byte> into) noexcept
{
    const std::size_t count = kind_ == NetworkKind::tcp ? read_stream(into) : read_datagrams(into);
    health_.bytes_in += count;
    return count;
}

/// False where nothing more is accepted now.
bool NetworkPort::send_part(std::span<const std::byte> part, std::size_t& sent) noexcept
{
    const bool to_peer = kind_ == NetworkKind::udp_listen;
    const ssize_t put = ::sendto(descriptor_, part.data(), part.size(), MSG_NOSIGNAL, to_peer ? view(peer_) : nullptr,
                                 to_peer ? peer_.length : 0);
    if (put >= 0) {
        sent += static_cast<std::size_t>(put);
        return true;
    }
    if (errno == EINTR || is_full(errno)) {
        return errno == EINTR;
    }
    if (kind_ != NetworkKind::tcp && is_nobody_there(errno)) {
        sent += part.size();  // as on a wire without anybody at its end
        return true;
    }
    ++health_.write_errors;
    lose();
    return false;
}

std::size_t NetworkPort::write(std::span<const std::byte> from) noexcept
{
    std::size_t count = 0;
    while (health_.state == PortState::open && count < from.size()) {
        const std::span<const std::byte> rest = from.subspan(count);
        if (!send_part(rest.first(std::min(rest.size(), kSentAtOnce)), count)) {
            break;
        }
    }
    health_.bytes_out += count;
    health_.bytes_refused += from.size() - count;
    return count;
}

std::size_t NetworkPort::unsent() const noexcept
{
    int held = 0;
    const bool known = descriptor_ >= 0 && ::ioctl(descriptor_, TIOCOUTQ, &held) == 0 && held > 0;
    return known ? static_cast<std::size_t>(held) : 0;
}

NetworkAddress NetworkPort::local_address() const noexcept
{
    NetworkAddress address;
    address.length = sizeof address.storage;
    if (descriptor_ < 0 || ::getsockname(descriptor_, view(address), &address.length) != 0) {
        address.length = 0;
    }
    return address;
}

void NetworkPort::become_open() noexcept
{
    health_.reconnects += was_open_ ? 1U : 0U;
    was_open_ = true;
    heard_us_ = now_us_;
    health_.state = PortState::open;
}

void NetworkPort::release() noexcept
{
    if (descriptor_ >= 0) {
        static_cast<void>(::close(descriptor_));
        descriptor_ = -1;
    }
    connecting_ = false;
    peer_.length = 0;
    begin_ = end_ = 0;
}

void NetworkPort::lose() noexcept
{
    release();
    health_.disconnects += health_.state == PortState::open ? 1U : 0U;
    health_.state = PortState::lost;
    attempt_at_once_ = true;
}

}  // namespace jink::hal
