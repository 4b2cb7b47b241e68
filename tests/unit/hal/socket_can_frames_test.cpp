// SPDX-License-Identifier: BSD-3-Clause
// Frames and error frames of the SocketCAN port: accepted, refused, counted.
#include <algorithm>
#include <array>
#include <functional>

#include "tests/unit/hal/socket_can_bench.hpp"

namespace jink::hal::test {
namespace {

TEST_F(SocketCan, FramesOfAClassicBusArriveAsSent)
{
    open();
    can_frame raw{};
    CanFrame frame;
    raw.can_id = 0x7FF;
    raw.can_dlc = 8;
    std::fill(std::begin(raw.data), std::end(raw.data), std::uint8_t{0xA5});
    put(&raw, CAN_MTU);
    ASSERT_TRUE(port.receive(frame));
    EXPECT_FALSE(frame.extended);
    EXPECT_FALSE(frame.remote);
    EXPECT_FALSE(frame.fd);
    EXPECT_FALSE(frame.bit_rate_switch);
    EXPECT_EQ(frame.id, 0x7FFU);
    EXPECT_EQ(frame.length, 8U);
    EXPECT_EQ(std::to_integer<int>(frame.data[7]), 0xA5);

    raw = {};
    raw.can_id = 0x12 | CAN_RTR_FLAG;
    raw.can_dlc = 2;
    put(&raw, CAN_MTU);
    ASSERT_TRUE(port.receive(frame));
    EXPECT_TRUE(frame.remote);
    EXPECT_EQ(frame.id, 0x12U);
    EXPECT_EQ(frame.data[7], std::byte{0}) << "nothing of the frame before";

    // Bits that a standard id does not have are no part of it; a length that no classic frame has is cut.
    raw.can_id = 0x1ABCD7FF & ~(CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_ERR_FLAG);
    raw.can_dlc = 15;
    raw.__pad = CANFD_BRS;  // where a frame of CAN FD has its flags
    put(&raw, CAN_MTU);
    ASSERT_TRUE(port.receive(frame));
    EXPECT_EQ(frame.id, 0x7FFU);
    EXPECT_EQ(frame.length, CanFrame::kClassicBytes);
    EXPECT_FALSE(frame.bit_rate_switch);
    EXPECT_EQ(port.health().frames_in, 3U);
}

TEST_F(SocketCan, FramesOfAnFdBusArriveAsSent)
{
    open_fd();
    CanFrame frame;
    canfd_frame raw{};
    raw.can_id = 0x1ABCDEF0 | CAN_EFF_FLAG;
    raw.len = 64;
    raw.flags = CANFD_BRS;
    raw.data[63] = 7;
    put(&raw, CANFD_MTU);
    ASSERT_TRUE(port.receive(frame));
    EXPECT_TRUE(frame.fd);
    EXPECT_TRUE(frame.extended);
    EXPECT_TRUE(frame.bit_rate_switch);
    EXPECT_EQ(frame.id, 0x1ABCDEF0U);
    EXPECT_EQ(frame.length, 64U);
    EXPECT_EQ(std::to_integer<int>(frame.data[63]), 7);
    raw.flags = CANFD_ESI;
    raw.len = 255;
    put(&raw, CANFD_MTU);
    ASSERT_TRUE(port.receive(frame));
    EXPECT_FALSE(frame.bit_rate_switch);
    EXPECT_EQ(frame.length, CanFrame::kFdBytes);
}

TEST_F(SocketCan, PacketsThatAreNoFrameAreCountedAndPassedOver)
{
    open();
    std::array<std::uint8_t, 71> raw{};
    put(raw.data(), 0);
    errno = EAGAIN;  // of an earlier call
    put(raw.data(), CAN_MTU - 1);
    put(raw.data(), CAN_MTU + 1);
    put(raw.data(), 71);
    put(raw.data(), CAN_MTU);
    CanFrame frame;
    EXPECT_TRUE(port.receive(frame));
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.health().read_errors, 4U);
    EXPECT_EQ(port.health().frames_in, 1U);
}

TEST_F(SocketCan, SentFramesHaveTheKernelsLayout)
{
    open_fd();
    CanFrame frame;
    frame.id = 0x123;
    frame.remote = true;
    frame.length = 4;
    frame.data.fill(std::byte{0xFF});
    ASSERT_TRUE(port.send(frame));
    canfd_frame raw{};
    ASSERT_EQ(::recv(kernel.bus_end, &raw, sizeof raw, MSG_DONTWAIT), static_cast<ssize_t>(CAN_MTU));
    EXPECT_EQ(raw.can_id, 0x123U | CAN_RTR_FLAG);
    EXPECT_EQ(raw.len, 4U);
    EXPECT_EQ(raw.flags, 0U);
    EXPECT_EQ(raw.data[0], 0U) << "a request has no data";

    frame = {};
    frame.id = 0x1FFFFFFF;
    frame.extended = true;
    frame.fd = true;
    frame.length = 12;
    frame.data[11] = std::byte{9};
    ASSERT_TRUE(port.send(frame));
    ASSERT_EQ(::recv(kernel.bus_end, &raw, sizeof raw, MSG_DONTWAIT), static_cast<ssize_t>(CANFD_MTU));
    EXPECT_EQ(raw.can_id, 0x1FFFFFFFU | CAN_EFF_FLAG);
    EXPECT_EQ(raw.len, 12U);
    EXPECT_EQ(raw.flags & CANFD_BRS, 0);
    EXPECT_EQ(raw.data[11], 9U);
    frame.bit_rate_switch = true;
    ASSERT_TRUE(port.send(frame));
    ASSERT_EQ(::recv(kernel.bus_end, &raw, sizeof raw, MSG_DONTWAIT), static_cast<ssize_t>(CANFD_MTU));
    EXPECT_EQ(raw.flags & CANFD_BRS, CANFD_BRS);
    EXPECT_EQ(port.health().frames_out, 3U);
}

TEST_F(SocketCan, FramesThatNoBusCarriesAreCountedAsBad)
{
    open();
    const std::array<std::function<void(CanFrame&)>, 6> wrongs{
        [](CanFrame& f) { f.id = 0x800; },
        [](CanFrame& f) { f.extended = true, f.id = 0x20000000; },
        [](CanFrame& f) { f.length = 9; },
        [](CanFrame& f) { f.bit_rate_switch = true; },
        [](CanFrame& f) { f.fd = true; },  // on a classic bus
        [](CanFrame& f) { f.fd = f.remote = true; },
    };
    for (const auto& wrong : wrongs) {
        CanFrame frame;
        wrong(frame);
        EXPECT_FALSE(port.send(frame));
    }
    EXPECT_EQ(port.health().frames_bad, wrongs.size());
    EXPECT_EQ(port.health().frames_refused, 0U);
    EXPECT_EQ(on_the_bus(), 0U);
    CanFrame highest;
    highest.id = 0x7FF;
    highest.length = 8;
    EXPECT_TRUE(port.send(highest));
    open_fd();
    EXPECT_TRUE(port.send(highest)) << "a classic frame on a bus that does FD";
    highest.fd = true;
    highest.length = 64;
    EXPECT_TRUE(port.send(highest));
    EXPECT_EQ(port.health().frames_bad, wrongs.size());
}

TEST_F(SocketCan, WhatTheKernelCannotTakeNowIsRefusedAndNoError)
{
    open();
    int error = 0;
    const WriteHook hook([&](int descriptor, const void*, std::size_t) -> std::optional<ssize_t> {
        if (descriptor != port.descriptor()) {
            return std::nullopt;
        }
        errno = error;
        return -1;
    });
    std::uint64_t refused = 0;
    for (const int now : {EAGAIN, ENOBUFS, EINTR}) {
        error = now;
        EXPECT_FALSE(port.send({}));
        EXPECT_EQ(port.health().frames_refused, ++refused);
        EXPECT_EQ(port.health().write_errors, 0U);
        EXPECT_EQ(port.health().state, CanState::active);
    }
    error = EINVAL;
    EXPECT_FALSE(port.send({}));
    EXPECT_EQ(port.health().write_errors, 1U);
    EXPECT_EQ(port.health().state, CanState::active);
    error = ENETDOWN;
    EXPECT_FALSE(port.send({}));
    EXPECT_EQ(port.health().write_errors, 2U);
    EXPECT_EQ(port.health().frames_refused, ++ ++refused);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_NE(port.descriptor(), -1) << "it may come up again";
    error = ENODEV;
    EXPECT_FALSE(port.send({}));
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.health().downs, 1U);
    EXPECT_EQ(port.health().frames_out, 0U);
}

TEST_F(SocketCan, AFrameTakenInPartIsNotSent)
{
    open();
    const WriteHook hook([&](int descriptor, const void*, std::size_t size) -> std::optional<ssize_t> {
        return descriptor == port.descriptor() ? std::optional<ssize_t>(size - 1) : std::nullopt;
    });
    EXPECT_FALSE(port.send({}));
    EXPECT_EQ(port.health().frames_out, 0U);
    EXPECT_EQ(port.health().frames_refused, 1U);
}

TEST_F(SocketCan, AReadThatFailsIsCountedAndNothingToReadIsNot)
{
    open();
    CanFrame frame;
    for (const int nothing : {EAGAIN, EINTR}) {
        kernel.read_error = nothing;
        EXPECT_FALSE(port.receive(frame));
        EXPECT_EQ(port.health().read_errors, 0U);
    }
    kernel.read_error = EIO;
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.health().read_errors, 1U);
    EXPECT_EQ(port.health().state, CanState::active);
    kernel.read_error = ENETDOWN;
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.health().read_errors, 2U);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_NE(port.descriptor(), -1);
    kernel.read_error = ENXIO;
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.health().downs, 1U);
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.health().read_errors, 3U) << "a port without a socket reads nothing";
}

TEST_F(SocketCan, DropsAreCountedExactlyAcrossTheWrap)
{
    open();
    can_frame raw{};
    CanFrame frame;
    const auto receive_with = [&](std::uint32_t dropped) {
        put(&raw, CAN_MTU);
        kernel.ancillary = {{SOL_SOCKET, SO_RXQ_OVFL, dropped}};
        EXPECT_TRUE(port.receive(frame));
        return port.health().overruns;
    };
    EXPECT_EQ(receive_with(0), 0U);
    EXPECT_EQ(receive_with(5), 5U);
    EXPECT_EQ(receive_with(5), 5U);
    EXPECT_EQ(receive_with(0xFFFFFFFFU), 0xFFFFFFFFULL);
    EXPECT_EQ(receive_with(2), 0x100000002ULL);
    // Other ancillary data contains no drop counter.
    for (const auto& [level, type] : {std::pair(SOL_SOCKET, SO_TIMESTAMP), std::pair(SOL_CAN_RAW, SO_RXQ_OVFL)}) {
        kernel.ancillary = {{level, type, 77}};
        put(&raw, CAN_MTU);
        EXPECT_TRUE(port.receive(frame));
        EXPECT_EQ(port.health().overruns, 0x100000002ULL);
    }
    // A new socket counts from zero.
    open();
    EXPECT_EQ(receive_with(3), 0x100000005ULL);
}

TEST_F(SocketCan, ErrorFramesDoNotHoldUpTheStepForEver)
{
    open();
    can_frame raw{};
    CanFrame frame;
    for (int i = 0; i < SocketCanPort::kErrorFramesPerCall - 1; ++i) {
        put_error(CAN_ERR_ACK);
    }
    put(&raw, CAN_MTU);
    EXPECT_TRUE(port.receive(frame)) << "behind one less than are worked off";
    for (int i = 0; i < SocketCanPort::kErrorFramesPerCall; ++i) {
        put_error(CAN_ERR_ACK);
    }
    put(&raw, CAN_MTU);
    EXPECT_FALSE(port.receive(frame));
    EXPECT_EQ(port.health().bus_errors, 2U * SocketCanPort::kErrorFramesPerCall - 1U);
    EXPECT_TRUE(port.receive(frame));
}

TEST_F(SocketCan, EachErrorOfTheBusCountsOnce)
{
    open();
    std::uint64_t n = 0;
    for (const std::uint32_t error :
         {CAN_ERR_PROT, CAN_ERR_TRX, CAN_ERR_ACK, CAN_ERR_BUSERROR, CAN_ERR_TX_TIMEOUT, CAN_ERR_PROT | CAN_ERR_ACK}) {
        error_frame(error);
        EXPECT_EQ(port.health().bus_errors, ++n);
    }
    error_frame(CAN_ERR_LOSTARB);
    error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING);
    EXPECT_EQ(port.health().bus_errors, n);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().overruns, 0U);
}

TEST_F(SocketCan, StatesOfTheControllerAreReportedApart)
{
    open();
    for (const std::uint8_t passive : {CAN_ERR_CRTL_RX_PASSIVE, CAN_ERR_CRTL_TX_PASSIVE}) {
        error_frame(CAN_ERR_CRTL, passive);
        EXPECT_EQ(port.health().state, CanState::error_passive);
        error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING);
        EXPECT_EQ(port.health().state, CanState::error_passive) << "a warning does not end it";
        error_frame(0, CAN_ERR_CRTL_ACTIVE);
        EXPECT_EQ(port.health().state, CanState::error_passive) << "not about the controller";
        port.service(0);
        EXPECT_EQ(port.health().state, CanState::error_passive) << "nor does an interface that is up";
        error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
        EXPECT_EQ(port.health().state, CanState::active);
    }
    EXPECT_EQ(port.health().bus_offs, 0U);
    EXPECT_EQ(port.health().restarts, 0U);
    error_frame(CAN_ERR_BUSOFF | CAN_ERR_CRTL | CAN_ERR_BUSERROR, CAN_ERR_CRTL_TX_PASSIVE);
    EXPECT_EQ(port.health().state, CanState::bus_off) << "bus off outweighs what else the frame says";
    EXPECT_EQ(port.health().bus_errors, 1U);
    error_frame(CAN_ERR_BUSOFF);
    EXPECT_EQ(port.health().bus_offs, 1U) << "still the same";
    EXPECT_EQ(port.health().downs, 0U);
    error_frame(CAN_ERR_LOSTARB);
    EXPECT_EQ(port.health().state, CanState::bus_off);
    EXPECT_EQ(port.health().restarts, 0U);
    error_frame(CAN_ERR_RESTARTED);
    error_frame(CAN_ERR_BUSOFF);
    EXPECT_EQ(port.health().bus_offs, 2U);
    EXPECT_EQ(port.health().ups, 0U) << "the interface was never away";
    up = false;
    port.service(0);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.health().downs, 1U);
    EXPECT_EQ(port.health().bus_offs, 2U);
    up = true;
    port.service(1);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().ups, 1U);
}

}  // namespace
}  // namespace jink::hal::test
