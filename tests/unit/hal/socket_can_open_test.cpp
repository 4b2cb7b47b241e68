// SPDX-License-Identifier: BSD-3-Clause
// How the SocketCAN port opens, why it does not, and how it comes back.
#include <array>
#include <string>
#include <vector>

#include <fcntl.h>

#include "tests/unit/hal/pty.hpp"
#include "tests/unit/hal/socket_can_bench.hpp"

namespace jink::hal::test {
namespace {

TEST_F(SocketCan, IsClosedAndHarmlessBeforeOpen)
{
    CanFrame frame;
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_FALSE(port.receive(frame));
    EXPECT_FALSE(port.send({}));
    port.service(0);
    EXPECT_EQ(kernel.opened, 0);
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.health().read_errors, 0U);
    EXPECT_EQ(port.health().write_errors, 0U);
    EXPECT_EQ(port.health().frames_refused, 1U);
}

TEST_F(SocketCan, RefusesUselessNamesForGood)
{
    EXPECT_EQ(port.open("", {}, kRetry), CanOpenStatus::bad_name);
    EXPECT_EQ(port.open_status(), CanOpenStatus::bad_name);
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.open(std::string(kMaxInterfaceName, 'x'), {}, kRetry), CanOpenStatus::bad_name);
    EXPECT_EQ(port.health().state, CanState::closed);
    port.service(10 * kRetry);
    EXPECT_EQ(kernel.opened, 0);
    const std::string longest(kMaxInterfaceName - 1, 'x');
    EXPECT_EQ(port.open(longest, {}, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(asked_about, longest);
}

TEST_F(SocketCan, AsksForASecondNameAlone)
{
    ASSERT_EQ(port.open("a-long-name", {}, kRetry), CanOpenStatus::ok);
    ASSERT_EQ(port.open("can1", {}, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(asked_about, "can1");
}

TEST_F(SocketCan, FiltersAreTheKernels)
{
    SocketCanOptions options;
    const std::array<CanFilter, 2> filters{{{0x123, 0x7F0, false}, {0x1855962A, 0x1FFFFF00, true}}};
    options.filters = filters;
    ASSERT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    // linux/can.h: bit 31 of id and mask says extended.
    ASSERT_EQ(kernel.filters.size(), 2U);
    EXPECT_EQ(kernel.filters[0].can_id, 0x123U);
    EXPECT_EQ(kernel.filters[0].can_mask, 0x800007F0U);
    EXPECT_EQ(kernel.filters[1].can_id, 0x9855962AU);
    EXPECT_EQ(kernel.filters[1].can_mask, 0x9FFFFF00U);
}

TEST_F(SocketCan, TakesAsManyFiltersAsItSays)
{
    const std::vector<CanFilter> many(kMaxCanFilters + 1);
    SocketCanOptions options;
    options.filters = many;
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::too_many_filters);
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(kernel.opened, 0);
    options.filters = std::span(many).first(kMaxCanFilters);
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(kernel.filters.size(), kMaxCanFilters);
}

TEST_F(SocketCan, WithoutFiltersEverythingPasses)
{
    kernel.refused_option = CAN_RAW_FILTER;  // would fail where it were set: an empty set of filters passes nothing
    open();
    EXPECT_TRUE(kernel.filters.empty());
}

TEST_F(SocketCan, AsksForErrorsDropsAndTheBufferGiven)
{
    open();
    EXPECT_EQ(kernel.error_mask, can_err_mask_t{CAN_ERR_MASK});
    EXPECT_TRUE(kernel.counts_drops);
    EXPECT_FALSE(kernel.receive_buffer.has_value());
    EXPECT_FALSE(kernel.fd_frames);
    EXPECT_EQ(kernel.bound_to, 3);
    SocketCanOptions options;
    options.receive_buffer = 65'536;
    ASSERT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(kernel.receive_buffer, 65'536);
}

TEST_F(SocketCan, ARefusedOptionFailsAndIsTriedAgain)
{
    SocketCanOptions options;
    const std::array<CanFilter, 1> filters{};
    options.filters = filters;
    options.receive_buffer = 1000;
    for (const int refused : std::array<int, 4>{CAN_RAW_ERR_FILTER, SO_RXQ_OVFL, CAN_RAW_FILTER, SO_RCVBUF}) {
        SCOPED_TRACE(refused);
        kernel.refused_option = refused;
        EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::failed);
        EXPECT_EQ(port.health().state, CanState::down);
        EXPECT_EQ(port.descriptor(), -1);
        kernel.refused_option = -1;
        port.service(0);
        EXPECT_EQ(port.health().state, CanState::active);
    }
}

TEST_F(SocketCan, TellsThatTheKernelHasNoCan)
{
    for (const int error : {EAFNOSUPPORT, EPROTONOSUPPORT}) {
        kernel.socket_error = error;
        EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::no_can);
        EXPECT_EQ(port.open_status(), CanOpenStatus::no_can);
        EXPECT_EQ(port.health().state, CanState::closed);
    }
    kernel.socket_error = 0;
    port.service(10 * kRetry);
    EXPECT_EQ(kernel.opened, 0) << "a closed port tries nothing";
}

TEST_F(SocketCan, TellsWhyASocketIsRefusedAndGoesOnTrying)
{
    const std::array<std::pair<int, CanOpenStatus>, 3> cases{{{EACCES, CanOpenStatus::access_denied},
                                                              {EPERM, CanOpenStatus::access_denied},
                                                              {EMFILE, CanOpenStatus::failed}}};
    for (const auto& [error, status] : cases) {
        kernel.socket_error = error;
        EXPECT_EQ(port.open("can0", {}, kRetry), status);
        EXPECT_EQ(port.health().state, CanState::down);
        EXPECT_EQ(port.descriptor(), -1);
    }
    kernel.socket_error = 0;
    port.service(0);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.open_status(), CanOpenStatus::ok);
}

TEST_F(SocketCan, TellsThatThereIsNoSuchInterface)
{
    for (const int error : {ENODEV, ENXIO}) {
        missing_error = error;
        EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::no_interface);
        EXPECT_EQ(port.health().state, CanState::down);
        EXPECT_EQ(port.descriptor(), -1);
        EXPECT_FALSE(port.send({}));
    }
    EXPECT_EQ(port.health().downs, 0U) << "what was never there has not gone away";
    missing_error = 0;
    unanswered = SIOCGIFINDEX;
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::failed);
    EXPECT_EQ(port.descriptor(), -1);
}

TEST_F(SocketCan, ASocketThatCannotBeBoundIsNotUsed)
{
    kernel.bind_error = ENODEV;  // deleted between the question and the binding
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::no_interface);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.descriptor(), -1);
}

TEST_F(SocketCan, RefusesWhatIsNoCanControllerForGood)
{
    hardware = ARPHRD_ETHER;
    EXPECT_EQ(port.open("eth0", {}, kRetry), CanOpenStatus::not_can);
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.descriptor(), -1);
    hardware = ARPHRD_CAN;
    unanswered = SIOCGIFHWADDR;
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::failed);
    EXPECT_EQ(port.health().state, CanState::down);
}

TEST_F(SocketCan, FdNeedsAnInterfaceThatIsSetUpForIt)
{
    SocketCanOptions options;
    options.fd = true;
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::no_fd);
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.descriptor(), -1);
    mtu = CANFD_MTU - 1;
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::no_fd);
    mtu = CANFD_MTU;
    kernel.refused_option = CAN_RAW_FD_FRAMES;
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::no_fd);
    kernel.refused_option = -1;
    unanswered = SIOCGIFMTU;
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::no_fd);
    unanswered = 0;
    EXPECT_FALSE(kernel.fd_frames);
    EXPECT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    EXPECT_TRUE(kernel.fd_frames);
}

TEST_F(SocketCan, AnInterfaceThatIsNotUpIsDownUntilItIs)
{
    up = false;
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_NE(port.descriptor(), -1) << "the socket is kept";
    const int kept = port.descriptor();
    port.service(0);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.health().downs, 0U);
    EXPECT_EQ(port.health().ups, 0U);
    up = true;
    port.service(1);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().ups, 1U);
    EXPECT_EQ(port.descriptor(), kept);
    EXPECT_EQ(kernel.opened, 1);
    unanswered = SIOCGIFFLAGS;
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::ok);
    EXPECT_EQ(port.health().state, CanState::down) << "not known to be up";
}

TEST_F(SocketCan, TriesOncePerPeriodWhileTheInterfaceIsMissing)
{
    missing_error = ENODEV;
    EXPECT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::no_interface);
    EXPECT_EQ(kernel.opened, 1);
    port.service(7);
    EXPECT_EQ(kernel.opened, 2);
    EXPECT_EQ(port.health().state, CanState::down);
    port.service(7 + kRetry - 1);
    EXPECT_EQ(kernel.opened, 2);
    missing_error = 0;
    index = 9;
    port.service(7 + kRetry);
    EXPECT_EQ(kernel.opened, 3);
    EXPECT_EQ(kernel.bound_to, 9);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().ups, 1U);
}

TEST_F(SocketCan, ADeletedInterfaceIsOpenedAgainByItsName)
{
    open();
    missing_error = ENODEV;
    port.service(1'000'000);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.descriptor(), -1);
    missing_error = 0;
    index = 4;
    up = false;
    port.service(1'000'001);  // another of its name, at once, and not up yet
    EXPECT_EQ(kernel.opened, 2);
    EXPECT_EQ(kernel.bound_to, 4);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.health().ups, 0U);
    up = true;
    port.service(1'000'002);
    EXPECT_EQ(port.health().state, CanState::active);
    EXPECT_EQ(port.health().ups, 1U);
    EXPECT_EQ(port.health().downs, 1U);
}

TEST_F(SocketCan, AFailureWhileTryingAgainKeepsItDown)
{
    open();
    missing_error = ENODEV;
    port.service(0);
    missing_error = 0;
    hardware = ARPHRD_ETHER;  // another interface has got the name
    port.service(1);
    EXPECT_EQ(port.open_status(), CanOpenStatus::not_can);
    EXPECT_EQ(port.health().state, CanState::down);
    EXPECT_EQ(port.health().ups, 0U);
    EXPECT_FALSE(port.send({}));
}

TEST_F(SocketCan, OpeningAnewForgetsTheFormerOne)
{
    open();
    const int former = port.descriptor();
    const std::array<CanFilter, 1> filters{};
    SocketCanOptions options;
    options.filters = filters;
    ASSERT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    EXPECT_TRUE(port.descriptor() == former || ::fcntl(former, F_GETFD) == -1) << "its socket is closed";
    EXPECT_EQ(kernel.filters.size(), 1U);
    kernel.filters.clear();
    ASSERT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::ok);
    EXPECT_TRUE(kernel.filters.empty());
    EXPECT_EQ(port.open("", {}, kRetry), CanOpenStatus::bad_name);
    EXPECT_EQ(port.descriptor(), -1);
}

TEST_F(SocketCan, CloseEndsEverything)
{
    open();
    const int former = port.descriptor();
    port.close();
    EXPECT_EQ(port.health().state, CanState::closed);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(::fcntl(former, F_GETFD), -1);
    port.service(10 * kRetry);
    EXPECT_EQ(kernel.opened, 1);
    EXPECT_EQ(port.health().downs, 0U);
}

// A service may start a program without standard input: its first descriptor is then 0.
TEST_F(SocketCan, WorksAsTheFirstDescriptor)
{
    const FreeDescriptorZero zero;
    open();
    ASSERT_EQ(port.descriptor(), 0);
    EXPECT_TRUE(port.send({}));
    EXPECT_EQ(on_the_bus(), 1U);
    can_frame raw{};
    put(&raw, CAN_MTU);
    CanFrame frame;
    EXPECT_TRUE(port.receive(frame));
    port.service(0);
    EXPECT_EQ(kernel.opened, 1);
    port.close();
    EXPECT_EQ(::fcntl(0, F_GETFD), -1);
}

}  // namespace
}  // namespace jink::hal::test
