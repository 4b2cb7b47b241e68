// SPDX-License-Identifier: BSD-3-Clause
// jinkd whose line to the autopilot is a network.
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>

#include "tests/daemon/harness.hpp"

namespace jink::test {
namespace {

/// The autopilot's end: a socket of this machine, of any free port.
class NetworkAutopilot {
public:
    explicit NetworkAutopilot(bool tcp) : tcp_(tcp), socket_(socket(AF_INET, tcp ? SOCK_STREAM : SOCK_DGRAM, 0))
    {
        sockaddr_in own{};
        own.sin_family = AF_INET;
        own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t length = sizeof own;
        EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&own), length), 0);
        EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &length), 0);
        port_ = ntohs(own.sin_port);
        if (tcp) {
            EXPECT_EQ(listen(socket_, 1), 0);
        }
    }
    ~NetworkAutopilot()
    {
        close(socket_);
        hang_up();
    }
    NetworkAutopilot(const NetworkAutopilot&) = delete;
    NetworkAutopilot& operator=(const NetworkAutopilot&) = delete;

    [[nodiscard]] std::string port() const { return std::to_string(port_); }
    /// UDP: sends to this port of this machine from now on.
    void talk_to(std::uint16_t port) const
    {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    }
    /// UDP: waits for a datagram, and talks to its sender from then on.
    [[nodiscard]] bool answers_whom_it_hears() const
    {
        pollfd waiting{socket_, POLLIN, 0};
        sockaddr_in from{};
        socklen_t length = sizeof from;
        std::array<std::byte, 1> first{};
        if (poll(&waiting, 1, static_cast<int>(kPatience.count())) <= 0 ||
            recvfrom(socket_, first.data(), first.size(), 0, reinterpret_cast<sockaddr*>(&from), &length) <= 0) {
            return false;
        }
        talk_to(ntohs(from.sin_port));
        return true;
    }
    void hang_up()
    {
        if (line_ >= 0) {
            close(line_);
            line_ = -1;
        }
    }
    void accept_line()
    {
        pollfd waiting{socket_, POLLIN, 0};
        ASSERT_GT(poll(&waiting, 1, static_cast<int>(kPatience.count())), 0);
        line_ = accept(socket_, nullptr, nullptr);
    }
    /// An ArduCopter's, once a second in life.
    void send_heartbeat()
    {
        Heartbeat h;
        h.type = 2;
        h.autopilot = 3;
        h.base_mode = 217;
        h.custom_mode = 3;
        h.system_status = 4;
        std::array<std::byte, kMaxFrame> frame{};
        const std::size_t n = encode(h, Header{1, 1, sequence_++}, frame);
        static_cast<void>(send(descriptor(), frame.data(), n, MSG_NOSIGNAL | MSG_DONTWAIT));
    }
    /// Sends HEARTBEATs until one of jinkd's comes.
    bool is_answered()
    {
        const auto end = Clock::now() + kPatience;
        while (Clock::now() < end) {
            send_heartbeat();
            pollfd waiting{descriptor(), POLLIN, 0};
            poll(&waiting, 1, 100);
            std::array<std::byte, 65536> bytes{};
            const ssize_t n = recv(descriptor(), bytes.data(), bytes.size(), MSG_DONTWAIT);
            std::span<const std::byte> input(bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
            while (const auto frame = parser_.next(input)) {
                Heartbeat h;
                if (decode(*frame, h) && frame->header.component_id == 196) {
                    return true;
                }
            }
        }
        return false;
    }

private:
    [[nodiscard]] int descriptor() const { return tcp_ ? line_ : socket_; }

    bool tcp_;
    int socket_;
    int line_ = -1;
    std::uint16_t port_ = 0;
    std::uint8_t sequence_ = 0;
    Parser parser_;
};

/// A UDP port that is free at present.
std::uint16_t free_port()
{
    const NetworkAutopilot brief(false);
    return static_cast<std::uint16_t>(std::stoi(brief.port()));
}

TEST(DaemonNetwork, ListensOnUdpAndAnswers)
{
    const Scratch scratch;
    const std::uint16_t port = free_port();
    Daemon daemon({"--link", "udp:" + std::to_string(port)}, scratch / "out");
    NetworkAutopilot autopilot(false);
    autopilot.talk_to(port);
    EXPECT_TRUE(autopilot.is_answered()) << text_of(scratch / "out");
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(DaemonNetwork, SendsOverUdp)
{
    const Scratch scratch;
    NetworkAutopilot autopilot(false);
    Daemon daemon({"--link", "udpout:127.0.0.1:" + autopilot.port()}, scratch / "out");
    EXPECT_TRUE(autopilot.answers_whom_it_hears()) << text_of(scratch / "out");
    EXPECT_TRUE(autopilot.is_answered()) << text_of(scratch / "out");
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(DaemonNetwork, ConnectsByTcpAndAgainAfterTheOtherSideHungUp)
{
    const Scratch scratch;
    NetworkAutopilot autopilot(true);
    Daemon daemon({"--link", "tcp:localhost:" + autopilot.port()}, scratch / "out");
    autopilot.accept_line();
    EXPECT_TRUE(autopilot.is_answered()) << text_of(scratch / "out");
    autopilot.hang_up();
    autopilot.accept_line();
    EXPECT_TRUE(autopilot.is_answered()) << text_of(scratch / "out");
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(DaemonNetwork, RefusesWhatNamesNoLineAndSaysWhy)
{
    const Scratch scratch;
    struct Case {
        std::vector<std::string> arguments;
        std::string says;
    };
    const std::vector<Case> cases{
        {{"--link", "udp:0"}, "the port has to be a number from 1 to 65535"},
        {{"--link", "udp:70000"}, "the port has to be a number from 1 to 65535"},
        {{"--link", "udp:14540x"}, "the port has to be a number from 1 to 65535"},
        {{"--link", "udp:"}, "the port has to be a number from 1 to 65535"},
        {{"--link", "tcp:5760"}, "an address is missing"},
        {{"--link", "udpout:14540"}, "an address is missing"},
        {{"--link", "udp::14540"}, "an address is missing"},
        {{"--link", "tcp:::1:5760"}, "an IPv6 address has to stand in brackets"},
        {{"--link", "tcp:autopilot.example:5760"}, "is no address of numbers"},
        {{"--link", "tcp:127.0.0.300:5760"}, "is no address of numbers"},
        {{"--link", "/dev/ttyS0"}, "expected udp:[ADDRESS:]PORT"},
        {{"--link", "serial:"}, "expected DEV[:BAUD]"},
        {{"--link", ""}, "--link: a value is needed"},
        {{"--serial", ""}, "--serial: a value is needed"},
        {{"--link", "udp:14540", "--map", ""}, "--map: a value is needed"},
        {{"--link", "udp:14540", "--airspace="}, "--airspace: 1 required TEXT missing"},
        {{"--link", "udp:14540", "--signing-key", ""}, "--signing-key: a value is needed"},
        {{"--link", "udp:14540", "--status-period", "nan"}, "--status-period"},
        {{"--serial", "udp:14540"}, "--link udp:14540"},
        {{}, "--serial, --link or --can is needed"},
    };
    for (const Case& c : cases) {
        Daemon daemon(c.arguments, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << c.says;
        EXPECT_NE(text_of(scratch / "out").find(c.says), std::string::npos) << text_of(scratch / "out");
    }
    Daemon both({"--link", "udp:14540", "--serial", "/dev/null"}, scratch / "out");
    EXPECT_EQ(both.wait(kPatience), 2);
    EXPECT_NE(text_of(scratch / "out").find("excludes"), std::string::npos) << text_of(scratch / "out");
    Daemon version({"--version"}, scratch / "out");
    EXPECT_EQ(version.wait(kPatience), 0);
    EXPECT_TRUE(text_of(scratch / "out").starts_with("jinkd ")) << text_of(scratch / "out");
}

}  // namespace
}  // namespace jink::test
