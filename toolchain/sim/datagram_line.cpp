// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/datagram_line.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace jink::sim {
namespace {

/// Seven datagrams of a millisecond each, as the kernel counts their memory [B].
constexpr std::uint64_t kMaxWaiting = 7 * 768;

sockaddr_in local(std::uint16_t port)
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

std::uint16_t bind_any(int socket)
{
    sockaddr_in address = local(0);
    socklen_t size = sizeof address;
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
        throw std::runtime_error("no port for datagrams");
    }
    return ntohs(address.sin_port);
}

}  // namespace

DatagramLine::DatagramLine() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0))
{
    const int other = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    own_port_ = bind_any(socket_);
    other_port_ = bind_any(other);
    ::close(other);  // the emulator's
    const sockaddr_in address = local(other_port_);
    table_ = ::open("/proc/net/udp", O_RDONLY | O_CLOEXEC);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || table_ < 0) {
        throw std::runtime_error("no line of datagrams");
    }
    // The board sends every byte in a separate datagram. The buffer holds seconds of datagrams if the system permits
    // the size, else 5 ms.
    const int room = 32 << 20;
    if (::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room) != 0) {
        static_cast<void>(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room));
    }
    timeval patience{0, 50'000};
    static_cast<void>(::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience));
    listener_ = std::thread([this] { listen(); });
}

DatagramLine::~DatagramLine()
{
    over_ = true;
    listener_.join();
    ::close(socket_);
    ::close(table_);
}

std::vector<std::string> DatagramLine::options() const
{
    std::ostringstream device;
    device << "udp,id=line,mux=on,host=127.0.0.1,port=" << own_port_
           << ",localaddr=127.0.0.1,localport=" << other_port_;
    // The multiplexer's escape character is outside the byte range: all bytes belong to the board.
    return {"-echr", "0x100", "-chardev", device.str(), "-serial", "chardev:line"};
}

void DatagramLine::listen()
{
    constexpr std::size_t kAtOnce = 256;
    constexpr std::size_t kLongest = 64;
    std::array<std::array<std::byte, kLongest>, kAtOnce> bytes{};
    std::array<iovec, kAtOnce> places{};
    std::array<mmsghdr, kAtOnce> messages{};
    for (std::size_t i = 0; i < kAtOnce; ++i) {
        places[i] = {bytes[i].data(), kLongest};
        messages[i].msg_hdr.msg_iov = &places[i];
        messages[i].msg_hdr.msg_iovlen = 1;
    }
    while (!over_) {
        const int n = ::recvmmsg(socket_, messages.data(), kAtOnce, MSG_WAITFORONE, nullptr);
        if (n > 0) {
            const std::lock_guard lock(mutex_);
            for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
                heard_.insert(heard_.end(), bytes[i].begin(), bytes[i].begin() + messages[i].msg_len);
            }
        }
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
}

DatagramLine::State DatagramLine::state_of(std::uint16_t port) const
{
    std::string text;
    std::array<char, 4096> part{};
    off_t at = 0;
    for (ssize_t n = 0; (n = ::pread(table_, part.data(), part.size(), at)) > 0; at += n) {
        text.append(part.data(), static_cast<std::size_t>(n));
    }
    std::array<char, 16> wanted{};
    std::snprintf(wanted.data(), wanted.size(), "0100007F:%04X", unsigned{port});
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        // sl local remote st tx:rx tr:when retrnsmt uid timeout inode ref pointer drops
        std::istringstream words(line);
        std::array<std::string, 13> word;
        for (std::string& w : word) {
            words >> w;
        }
        if (word[1] == wanted.data()) {
            return {std::stoull(word[4].substr(word[4].find(':') + 1), nullptr, 16), std::stoull(word[12])};
        }
    }
    throw std::runtime_error("the line of datagrams is gone");
}

bool DatagramLine::may_send() const { return state_of(other_port_).waiting < kMaxWaiting; }

void DatagramLine::send(std::span<const std::byte> bytes)
{
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), 0);
    refused_ += n == static_cast<ssize_t>(bytes.size()) ? 0U : 1U;
}

std::vector<std::byte> DatagramLine::take()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(heard_, {});
}

std::uint64_t DatagramLine::dropped() const
{
    return refused_ + state_of(own_port_).dropped + state_of(other_port_).dropped;
}

}  // namespace jink::sim
