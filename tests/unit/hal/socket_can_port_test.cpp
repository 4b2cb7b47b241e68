// SPDX-License-Identifier: BSD-3-Clause
// The SocketCAN port without a kernel that has CAN: its socket is one end of a pair of packet sockets, and the test is
// the bus at the other end. Frames and error frames have the kernel's layout (linux/can.h, linux/can/error.h).
#include <array>

#include <sys/syscall.h>
#include <sys/uio.h>

#include "tests/unit/hal/socket_can_bench.hpp"

namespace jink::hal::test {

FakeCan* fake_can = nullptr;

namespace {

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
    ASSERT_EQ(::send(kernel.bus_end, &raw, CAN_MTU, 0), static_cast<ssize_t>(CAN_MTU));
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
    ASSERT_EQ(::recv(kernel.bus_end, &sent, sizeof sent, MSG_DONTWAIT), static_cast<ssize_t>(CAN_MTU));
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
    missing_error = ENODEV;
    port.service(2);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_FALSE(port.send({}));
    missing_error = 0;
    port.service(kRetry);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().downs, 2U);
    EXPECT_EQ(port.health().ups, 2U);
}

}  // namespace
}  // namespace jink::hal::test

// Replace the C library's functions for everything linked into this program.
extern "C" int socket(int domain, int type, int protocol) noexcept
{
    jink::hal::test::FakeCan* const fake = jink::hal::test::fake_can;
    if (domain != PF_CAN || fake == nullptr) {
        return static_cast<int>(::syscall(SYS_socket, domain, type, protocol));
    }
    if (fake->socket_error != 0) {
        errno = fake->socket_error;
        return -1;
    }
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) {
        return -1;
    }
    if (fake->bus_end >= 0) {
        ::close(fake->bus_end);
    }
    fake->bus_end = ends[1];
    ++fake->opened;
    return ends[0];
}

extern "C" int setsockopt(int descriptor, int level, int option, const void* value, socklen_t size) noexcept
{
    jink::hal::test::FakeCan* const fake = jink::hal::test::fake_can;
    if (fake == nullptr || (level != SOL_CAN_RAW && level != SOL_SOCKET)) {
        return static_cast<int>(::syscall(SYS_setsockopt, descriptor, level, option, value, size));
    }
    if (option == fake->refused_option) {
        errno = EINVAL;
        return -1;
    }
    if (level == SOL_CAN_RAW && option == CAN_RAW_ERR_FILTER) {
        fake->error_mask = *static_cast<const can_err_mask_t*>(value);
    } else if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
        const auto* const filters = static_cast<const can_filter*>(value);
        fake->filters.assign(filters, filters + size / sizeof(can_filter));
    } else if (level == SOL_CAN_RAW && option == CAN_RAW_FD_FRAMES) {
        fake->fd_frames = *static_cast<const int*>(value) == 1;
    } else if (level == SOL_SOCKET && option == SO_RXQ_OVFL) {
        fake->counts_drops = *static_cast<const int*>(value) == 1;
    } else if (level == SOL_SOCKET && option == SO_RCVBUF) {
        fake->receive_buffer = *static_cast<const int*>(value);
    }
    return 0;
}

extern "C" int bind(int descriptor, const sockaddr* address, socklen_t size) noexcept
{
    jink::hal::test::FakeCan* const fake = jink::hal::test::fake_can;
    if (fake == nullptr || address->sa_family != AF_CAN) {
        return static_cast<int>(::syscall(SYS_bind, descriptor, address, size));
    }
    if (fake->bind_error != 0) {
        errno = fake->bind_error;
        return -1;
    }
    fake->bound_to = reinterpret_cast<const sockaddr_can*>(address)->can_ifindex;
    return 0;
}

extern "C" ssize_t recvmsg(int descriptor, msghdr* message, int flags)
{
    jink::hal::test::FakeCan* const fake = jink::hal::test::fake_can;
    if (fake != nullptr && fake->read_error != 0) {
        errno = fake->read_error;
        return -1;
    }
    void* const control = message->msg_control;
    const std::size_t room = message->msg_controllen;
    const auto got = static_cast<ssize_t>(::syscall(SYS_recvmsg, descriptor, message, flags));
    if (fake != nullptr && fake->ancillary && got >= 0 && room >= CMSG_SPACE(sizeof(std::uint32_t))) {
        message->msg_control = control;
        message->msg_controllen = CMSG_SPACE(sizeof(std::uint32_t));
        cmsghdr* const header = CMSG_FIRSTHDR(message);
        header->cmsg_level = fake->ancillary->level;
        header->cmsg_type = fake->ancillary->type;
        header->cmsg_len = CMSG_LEN(sizeof(std::uint32_t));
        std::memcpy(CMSG_DATA(header), &fake->ancillary->value, sizeof(std::uint32_t));
    }
    return got;
}
