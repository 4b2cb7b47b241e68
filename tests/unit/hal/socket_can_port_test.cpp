// SPDX-License-Identifier: BSD-3-Clause
// The SocketCAN port without a kernel that has CAN: its socket is one end of a pair of packet sockets, and the test is
// the bus at the other end. Frames and error frames have the kernel's layout (linux/can.h, linux/can/error.h).
#include "hal/linux/socket_can_port.hpp"

#include <cerrno>
#include <cstring>
#include <optional>

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/unit/hal/ioctl_hook.hpp"

namespace jink::hal::test {

int bus_end = -1;  ///< set when the port opens its socket
bool can_is_faked = false;

namespace {

constexpr std::int64_t kRetry = 100'000;

class SocketCan : public testing::Test {
protected:
    SocketCan() { can_is_faked = true; }
    ~SocketCan() override
    {
        can_is_faked = false;
        if (bus_end >= 0) {
            ::close(bus_end);
            bus_end = -1;
        }
    }
    SocketCan(const SocketCan&) = delete;
    SocketCan& operator=(const SocketCan&) = delete;

    bool up = true;
    bool there = true;
    IoctlHook hook{[this](int, unsigned long request, void* argument) -> std::optional<int> {
        auto* const interface = static_cast<ifreq*>(argument);
        if (request != SIOCGIFINDEX && request != SIOCGIFHWADDR && request != SIOCGIFFLAGS) {
            return std::nullopt;
        }
        if (!there) {
            errno = ENODEV;
            return -1;
        }
        switch (request) {
        case SIOCGIFINDEX: interface->ifr_ifindex = 3; break;
        case SIOCGIFHWADDR: interface->ifr_hwaddr.sa_family = ARPHRD_CAN; break;
        default: interface->ifr_flags = static_cast<short>(up ? IFF_UP : 0); break;
        }
        return 0;
    }};
    SocketCanPort port;

    void open() { ASSERT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::ok); }
    /// Something from the controller, worked off by the port.
    void error_frame(std::uint32_t id, std::uint8_t controller = 0)
    {
        can_frame raw{};
        raw.can_id = id | CAN_ERR_FLAG;
        raw.can_dlc = CAN_ERR_DLC;
        raw.data[1] = controller;
        ASSERT_EQ(::write(bus_end, &raw, CAN_MTU), static_cast<ssize_t>(CAN_MTU));
        CanFrame frame;
        EXPECT_FALSE(port.receive(frame)) << "an error frame is no frame";
    }
    /// Frames that have reached the bus.
    [[nodiscard]] static std::size_t on_the_bus()
    {
        std::size_t n = 0;
        can_frame raw{};
        while (::recv(bus_end, &raw, sizeof raw, MSG_DONTWAIT) > 0) {
            ++n;
        }
        return n;
    }
};

TEST_F(SocketCan, SendsNothingWhileTheControllerIsOffTheBus)
{
    open();
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_TRUE(port.send({}));
    EXPECT_EQ(on_the_bus(), 1U);
    error_frame(CAN_ERR_BUSOFF);
    EXPECT_EQ(port.health().state, CanState::bus_off);
    EXPECT_EQ(port.health().bus_offs, 1U);
    port.service(0);
    EXPECT_EQ(port.health().state, CanState::bus_off) << "an interface stays up while its controller is off the bus";
    EXPECT_FALSE(port.send({}));
    EXPECT_EQ(on_the_bus(), 0U);
    EXPECT_EQ(port.health().frames_refused, 1U);
    error_frame(CAN_ERR_RESTARTED);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().restarts, 1U);
    EXPECT_TRUE(port.send({}));
    EXPECT_EQ(on_the_bus(), 1U);
    EXPECT_EQ(port.health().frames_out, 2U);
}

TEST_F(SocketCan, ErrorFramesBecomeStatesAndCounters)
{
    open();
    error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    EXPECT_EQ(port.health().state, CanState::error_passive);
    EXPECT_TRUE(port.send({})) << "a passive controller still takes part";
    error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    EXPECT_EQ(port.health().state, CanState::active);
    error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
    EXPECT_EQ(port.health().overruns, 1U);
    error_frame(CAN_ERR_ACK);
    error_frame(CAN_ERR_PROT);
    EXPECT_EQ(port.health().bus_errors, 2U);
    EXPECT_EQ(port.health().frames_in, 0U);
}

TEST_F(SocketCan, FramesComeAsTheKernelHasThem)
{
    open();
    can_frame raw{};
    raw.can_id = 0x1855962AU | CAN_EFF_FLAG;
    raw.can_dlc = 3;
    raw.data[0] = 1;
    raw.data[2] = 9;
    ASSERT_EQ(::write(bus_end, &raw, CAN_MTU), static_cast<ssize_t>(CAN_MTU));
    CanFrame frame;
    ASSERT_TRUE(port.receive(frame));
    EXPECT_TRUE(frame.extended);
    EXPECT_EQ(frame.id, 0x1855962AU);
    EXPECT_EQ(frame.length, 3U);
    EXPECT_EQ(std::to_integer<int>(frame.data[2]), 9);
    EXPECT_EQ(port.health().frames_in, 1U);

    frame.remote = false;
    ASSERT_TRUE(port.send(frame));
    can_frame sent{};
    ASSERT_EQ(::recv(bus_end, &sent, sizeof sent, MSG_DONTWAIT), static_cast<ssize_t>(CAN_MTU));
    EXPECT_EQ(sent.can_id, raw.can_id);
    EXPECT_EQ(sent.can_dlc, 3);
    EXPECT_EQ(std::memcmp(sent.data, raw.data, 3), 0);
}

TEST_F(SocketCan, AnInterfaceThatGoesAndComesIsFollowed)
{
    open();
    up = false;
    port.service(0);
    EXPECT_EQ(port.health().state, CanState::down);
    up = true;
    port.service(1);
    EXPECT_EQ(port.health().state, CanState::active);
    there = false;
    port.service(2);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_FALSE(port.send({}));
    there = true;
    port.service(kRetry);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().downs, 2U);
    EXPECT_EQ(port.health().ups, 2U);
}

}  // namespace

}  // namespace jink::hal::test

// Stand in front of the C library's functions for everything that is linked into this program.
extern "C" int socket(int domain, int type, int protocol) noexcept
{
    if (domain != PF_CAN || !jink::hal::test::can_is_faked) {
        return static_cast<int>(::syscall(SYS_socket, domain, type, protocol));
    }
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) {
        return -1;
    }
    if (jink::hal::test::bus_end >= 0) {
        ::close(jink::hal::test::bus_end);
    }
    jink::hal::test::bus_end = ends[1];
    return ends[0];
}

extern "C" int setsockopt(int descriptor, int level, int option, const void* value, socklen_t size) noexcept
{
    if (level == SOL_CAN_RAW && jink::hal::test::can_is_faked) {
        return 0;
    }
    return static_cast<int>(::syscall(SYS_setsockopt, descriptor, level, option, value, size));
}

extern "C" int bind(int descriptor, const sockaddr* address, socklen_t size) noexcept
{
    if (address->sa_family == AF_CAN && jink::hal::test::can_is_faked) {
        return 0;
    }
    return static_cast<int>(::syscall(SYS_bind, descriptor, address, size));
}
