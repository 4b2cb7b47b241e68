// SPDX-License-Identifier: BSD-3-Clause
// UDP and TCP in place of a serial line, against sockets of the system.
#include "hal/linux/network_port.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <unistd.h>

namespace jink::hal {
namespace {

constexpr std::int64_t kNetworkRetry = 500'000;
constexpr std::int64_t kTickTime = 20'000;
/// How long a test that fails anyway waits for the system.
constexpr int kNetworkPatienceMs = 10'000;

using Bytes = std::vector<std::byte>;

Bytes noise(std::size_t size, std::uint32_t seed)
{
    std::mt19937 random(seed);
    Bytes bytes(size);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random() & 0xFFU); });
    return bytes;
}

NetworkAddress loopback(std::uint16_t port)
{
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    NetworkAddress address;
    std::memcpy(&address.storage, &v4, sizeof v4);
    address.length = sizeof v4;
    return address;
}

NetworkAddress loopback_v6(std::uint16_t port)
{
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    v6.sin6_addr = in6addr_loopback;
    NetworkAddress address;
    std::memcpy(&address.storage, &v6, sizeof v6);
    address.length = sizeof v6;
    return address;
}

const sockaddr* as_socket(const NetworkAddress& a) { return reinterpret_cast<const sockaddr*>(&a.storage); }

/// The other side: a plain socket.
class Socket {
public:
    explicit Socket(__socket_type type, const NetworkAddress& own = loopback(0))
        : descriptor_(::socket(own.storage.ss_family, type | SOCK_CLOEXEC, 0))
    {
        const int yes = 1;
        ::setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        EXPECT_EQ(::bind(descriptor_, as_socket(own), own.length), 0);
    }
    explicit Socket(int descriptor) : descriptor_(descriptor) {}
    ~Socket() { ::close(descriptor_); }
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;

    [[nodiscard]] NetworkAddress address() const
    {
        NetworkAddress address;
        address.length = sizeof address.storage;
        EXPECT_EQ(::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address.storage), &address.length), 0);
        return address;
    }
    void send_to(const NetworkAddress& to, const Bytes& bytes) const
    {
        EXPECT_EQ(::sendto(descriptor_, bytes.data(), bytes.size(), 0, as_socket(to), to.length),
                  static_cast<ssize_t>(bytes.size()));
    }
    /// The next datagram or piece of a stream; empty: none came.
    [[nodiscard]] Bytes receive(int patience_ms = kNetworkPatienceMs) const
    {
        pollfd waiting{descriptor_, POLLIN, 0};
        if (::poll(&waiting, 1, patience_ms) <= 0) {
            return {};
        }
        Bytes bytes(65536);
        const ssize_t got = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
        bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
        return bytes;
    }
    [[nodiscard]] std::unique_ptr<Socket> accept() const
    {
        pollfd waiting{descriptor_, POLLIN, 0};
        EXPECT_GT(::poll(&waiting, 1, kNetworkPatienceMs), 0);
        return std::make_unique<Socket>(::accept(descriptor_, nullptr, nullptr));
    }
    [[nodiscard]] int descriptor() const { return descriptor_; }

private:
    int descriptor_;
};

class NetworkPorts : public testing::Test {
protected:
    /// Ticks until the port is in a state; false: not in time.
    bool comes_to(PortState state)
    {
        for (int i = 0; i < kNetworkPatienceMs && port.health().state != state; ++i) {
            now += kTickTime;
            port.service(now);
            ::poll(nullptr, 0, port.health().state == state ? 0 : 1);
        }
        return port.health().state == state;
    }
    Bytes read_some(std::size_t wanted)
    {
        Bytes all(wanted);
        std::size_t count = 0;
        while (count < wanted) {
            pollfd waiting{port.descriptor(), POLLIN, 0};
            // Odd spans: what is left of a datagram comes with the next read.
            const std::size_t got = port.read(std::span(all).subspan(count, std::min<std::size_t>(wanted - count, 37)));
            count += got;
            if (got == 0 && ::poll(&waiting, 1, kNetworkPatienceMs) <= 0) {
                break;
            }
        }
        all.resize(count);
        return all;
    }

    std::int64_t now = 1'000'000'000;
    NetworkPort port;
};

TEST_F(NetworkPorts, UdpAnswersWhomItHearsFirst)
{
    ASSERT_EQ(port.open(NetworkKind::udp_listen, loopback(0), kNetworkRetry), NetworkStatus::ok);
    port.service(now);
    EXPECT_EQ(port.health().state, PortState::lost) << "nobody is there yet";
    EXPECT_EQ(port.write(noise(10, 1)), 0U);
    EXPECT_EQ(port.health().bytes_refused, 10U);

    const Socket autopilot(SOCK_DGRAM);
    const Bytes sent = noise(500, 2);
    autopilot.send_to(port.local_address(), sent);
    ASSERT_TRUE(comes_to(PortState::open));
    EXPECT_EQ(read_some(sent.size()), sent);
    const Bytes answer = noise(280, 3);
    EXPECT_EQ(port.write(answer), answer.size());
    EXPECT_EQ(autopilot.receive(), answer);
    EXPECT_EQ(port.health().bytes_in, 500U);
    EXPECT_EQ(port.health().bytes_out, 280U);
    EXPECT_EQ(port.health().disconnects, 0U);
    EXPECT_EQ(port.health().reconnects, 0U);
}

TEST_F(NetworkPorts, UdpHearsNobodyElseUntilTheOtherSideIsSilent)
{
    ASSERT_EQ(port.open(NetworkKind::udp_listen, loopback(0), kNetworkRetry), NetworkStatus::ok);
    const Socket autopilot(SOCK_DGRAM);
    const Socket stranger(SOCK_DGRAM);
    autopilot.send_to(port.local_address(), noise(20, 1));
    ASSERT_TRUE(comes_to(PortState::open));
    static_cast<void>(read_some(20));

    stranger.send_to(port.local_address(), noise(30, 2));
    autopilot.send_to(port.local_address(), noise(40, 3));
    EXPECT_EQ(read_some(40), noise(40, 3));
    EXPECT_EQ(port.health().line_errors, 1U);
    EXPECT_EQ(port.write(noise(5, 4)), 5U);
    EXPECT_EQ(autopilot.receive(), noise(5, 4));

    // The autopilot began anew, at another port.
    now += NetworkPort::kPeerSilence + kTickTime;
    port.service(now);
    stranger.send_to(port.local_address(), noise(50, 5));
    EXPECT_EQ(read_some(50), noise(50, 5));
    EXPECT_EQ(port.health().disconnects, 1U);
    EXPECT_EQ(port.health().reconnects, 1U);
    EXPECT_EQ(port.write(noise(6, 6)), 6U);
    EXPECT_EQ(stranger.receive(), noise(6, 6));
}

/// A flood of others ends each call, and does not end the line.
TEST_F(NetworkPorts, AFloodOfOthersIsDroppedAndCounted)
{
    ASSERT_EQ(port.open(NetworkKind::udp_listen, loopback(0), kNetworkRetry), NetworkStatus::ok);
    const Socket autopilot(SOCK_DGRAM);
    const Socket stranger(SOCK_DGRAM);
    autopilot.send_to(port.local_address(), noise(1, 1));
    ASSERT_TRUE(comes_to(PortState::open));
    static_cast<void>(read_some(1));
    constexpr int kFlood = 100;  // what the system's buffer holds in any case
    for (int i = 0; i < kFlood; ++i) {
        stranger.send_to(port.local_address(), noise(100, 2));
    }
    autopilot.send_to(port.local_address(), noise(7, 3));
    EXPECT_EQ(read_some(7), noise(7, 3));
    EXPECT_EQ(port.health().line_errors, static_cast<std::uint64_t>(kFlood));
}

TEST_F(NetworkPorts, UdpSendsInDatagramsThatFitAndTakesTheLargest)
{
    const Socket autopilot(SOCK_DGRAM);
    ASSERT_EQ(port.open(NetworkKind::udp_send, autopilot.address(), kNetworkRetry), NetworkStatus::ok);
    EXPECT_EQ(port.health().state, PortState::open);
    const Bytes much = noise(5000, 1);
    EXPECT_EQ(port.write(much), much.size());
    Bytes all;
    while (all.size() < much.size()) {
        const Bytes part = autopilot.receive();
        ASSERT_FALSE(part.empty());
        EXPECT_LE(part.size(), NetworkPort::kSentAtOnce);
        all.insert(all.end(), part.begin(), part.end());
    }
    EXPECT_EQ(all, much);
    const Bytes largest = noise(65507, 2);
    autopilot.send_to(port.local_address(), largest);
    EXPECT_EQ(read_some(largest.size()), largest);
}

TEST_F(NetworkPorts, UdpGoesOnWhereNobodyReceives)
{
    NetworkAddress gone;
    {
        const Socket autopilot(SOCK_DGRAM);
        gone = autopilot.address();
    }
    ASSERT_EQ(port.open(NetworkKind::udp_send, gone, kNetworkRetry), NetworkStatus::ok);
    for (int i = 0; i < 20; ++i) {
        now += kTickTime;
        port.service(now);
        EXPECT_EQ(port.write(noise(30, 1)), 30U) << "as on a wire";
        std::array<std::byte, 10> into{};
        EXPECT_EQ(port.read(into), 0U);
    }
    EXPECT_EQ(port.health().state, PortState::open);
    const Socket back(SOCK_DGRAM, gone);
    static_cast<void>(port.write(noise(30, 2)));  // what is known of the last one may take this one with it
    static_cast<void>(port.write(noise(31, 3)));
    EXPECT_FALSE(back.receive().empty());
    back.send_to(port.local_address(), noise(12, 4));
    EXPECT_EQ(read_some(12), noise(12, 4));
}

TEST_F(NetworkPorts, TcpConnectsAndConnectsAgain)
{
    auto listener = std::make_unique<Socket>(SOCK_STREAM);
    const NetworkAddress address = listener->address();
    ASSERT_EQ(::listen(listener->descriptor(), 1), 0);
    ASSERT_EQ(port.open(NetworkKind::tcp, address, kNetworkRetry), NetworkStatus::ok);
    ASSERT_TRUE(comes_to(PortState::open));
    {
        const auto autopilot = listener->accept();
        const Bytes sent = noise(3000, 1);
        ASSERT_EQ(::send(autopilot->descriptor(), sent.data(), sent.size(), 0), 3000);
        EXPECT_EQ(read_some(sent.size()), sent);
        EXPECT_EQ(port.write(noise(300, 2)), 300U);
        EXPECT_EQ(autopilot->receive(), noise(300, 2));
    }
    listener.reset();
    std::array<std::byte, 10> into{};
    for (int i = 0; i < kNetworkPatienceMs && port.health().state == PortState::open; ++i) {
        EXPECT_EQ(port.read(into), 0U);
        ::poll(nullptr, 0, 1);
    }
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.write(noise(9, 3)), 0U);
    for (int i = 0; i < 100; ++i) {
        now += kTickTime;
        port.service(now);
    }
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_GE(port.health().open_failures, 3U) << "once per retry period";
    EXPECT_LE(port.health().open_failures, 6U);

    const Socket again(SOCK_STREAM, address);
    ASSERT_EQ(::listen(again.descriptor(), 1), 0);
    ASSERT_TRUE(comes_to(PortState::open));
    const auto autopilot = again.accept();
    EXPECT_EQ(port.write(noise(40, 4)), 40U);
    EXPECT_EQ(autopilot->receive(), noise(40, 4));
    EXPECT_EQ(port.health().disconnects, 1U);
    EXPECT_EQ(port.health().reconnects, 1U);
}

TEST_F(NetworkPorts, TcpAcceptsWhatFitsAndNeverWaits)
{
    const Socket listener(SOCK_STREAM);
    ASSERT_EQ(::listen(listener.descriptor(), 1), 0);
    ASSERT_EQ(port.open(NetworkKind::tcp, listener.address(), kNetworkRetry), NetworkStatus::ok);
    ASSERT_TRUE(comes_to(PortState::open));
    const auto autopilot = listener.accept();
    constexpr std::size_t kPeriod = 251;
    Bytes much(1U << 20U);
    for (std::size_t i = 0; i < much.size(); ++i) {
        much[i] = static_cast<std::byte>(i % kPeriod);
    }
    std::size_t accepted = 0;
    std::size_t last = 1;
    for (int i = 0; i < 1000 && last > 0; ++i) {
        last = port.write(std::span(much).subspan(accepted % kPeriod));
        accepted += last;
    }
    EXPECT_EQ(last, 0U) << "nobody reads";
    EXPECT_GT(port.unsent(), 0U);
    EXPECT_EQ(port.health().bytes_out, accepted);
    EXPECT_EQ(port.health().state, PortState::open);
    std::size_t arrived = 0;
    while (arrived < accepted) {
        const Bytes part = autopilot->receive();
        ASSERT_FALSE(part.empty());
        for (const std::byte b : part) {
            ASSERT_EQ(b, static_cast<std::byte>(arrived % kPeriod)) << "no gap, nothing twice";
            ++arrived;
        }
    }
    EXPECT_EQ(arrived, accepted);
}

TEST_F(NetworkPorts, SaysWhyAnAddressCannotBeUsed)
{
    EXPECT_EQ(port.open(NetworkKind::tcp, NetworkAddress{}, kNetworkRetry), NetworkStatus::bad_address);
    EXPECT_EQ(port.health().state, PortState::closed);
    port.service(now);
    EXPECT_EQ(port.descriptor(), -1);

    auto taken = std::make_unique<Socket>(SOCK_DGRAM);
    const NetworkAddress address = taken->address();
    EXPECT_EQ(port.open(NetworkKind::udp_listen, address, kNetworkRetry), NetworkStatus::in_use);
    EXPECT_EQ(port.health().state, PortState::lost);
    taken.reset();
    port.service(now);
    const Socket autopilot(SOCK_DGRAM);
    autopilot.send_to(address, noise(3, 1));
    EXPECT_TRUE(comes_to(PortState::open)) << "it goes on trying";

    NetworkAddress elsewhere = loopback(0);
    reinterpret_cast<sockaddr_in&>(elsewhere.storage).sin_addr.s_addr = htonl(0xC0000201U);  // 192.0.2.1, nobody's
    EXPECT_EQ(port.open(NetworkKind::udp_listen, elsewhere, kNetworkRetry), NetworkStatus::not_here);
    port.close();
    EXPECT_EQ(port.health().state, PortState::closed);
}

TEST_F(NetworkPorts, SpeaksIpVersion6)
{
    const int probe = ::socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const NetworkAddress own = loopback_v6(0);
    const bool has_v6 = probe >= 0 && ::bind(probe, as_socket(own), own.length) == 0;
    ::close(probe);
    if (!has_v6) {
        GTEST_SKIP() << "this machine has no IPv6";
    }
    ASSERT_EQ(port.open(NetworkKind::udp_listen, own, kNetworkRetry), NetworkStatus::ok);
    const Socket autopilot(SOCK_DGRAM, loopback_v6(0));
    autopilot.send_to(port.local_address(), noise(11, 1));
    ASSERT_TRUE(comes_to(PortState::open));
    EXPECT_EQ(read_some(11), noise(11, 1));
    EXPECT_EQ(port.write(noise(12, 2)), 12U);
    EXPECT_EQ(autopilot.receive(), noise(12, 2));
}

}  // namespace
}  // namespace jink::hal
