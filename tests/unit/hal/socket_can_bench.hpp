// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/linux/socket_can_port.hpp"
#include "tests/unit/hal/ioctl_hook.hpp"

namespace jink::hal::test {

/// The faked kernel's answers to the port, and the port's requests. An error of 0 is success.
struct FakeCan {
    int bus_end = -1;  ///< set when the port opens its socket
    int socket_error = 0;
    int bind_error = 0;
    int refused_option = -1;  ///< of SOL_CAN_RAW or SOL_SOCKET: EINVAL
    int write_error = 0;
    int read_error = 0;
    struct Ancillary {
        int level = SOL_SOCKET;
        int type = SO_RXQ_OVFL;
        std::uint32_t value = 0;
    };
    std::optional<Ancillary> ancillary;  ///< comes with each frame

    int opened = 0;
    std::optional<int> bound_to;
    std::optional<can_err_mask_t> error_mask;
    std::vector<can_filter> filters;
    bool fd_frames = false;
    bool counts_drops = false;
    std::optional<int> receive_buffer;
};
/// The kernel is faked while this is not null. Its functions are in socket_can_port_test.cpp.
extern FakeCan* fake_can;

class SocketCan : public testing::Test {
protected:
    static constexpr std::int64_t kRetry = 100'000;

    SocketCan() { fake_can = &kernel; }
    ~SocketCan() override
    {
        fake_can = nullptr;
        if (kernel.bus_end >= 0) {
            ::close(kernel.bus_end);
        }
    }
    SocketCan(const SocketCan&) = delete;
    SocketCan& operator=(const SocketCan&) = delete;

    FakeCan kernel;
    bool up = true;
    int missing_error = 0;  ///< of every question about the interface
    int index = 3;
    int mtu = CAN_MTU;
    unsigned short hardware = ARPHRD_CAN;
    unsigned long unanswered = 0;  ///< a request that fails
    std::string asked_about;
    IoctlHook hook{[this](int, unsigned long request, void* argument) -> std::optional<int> {
        auto* const interface = static_cast<ifreq*>(argument);
        if (request != SIOCGIFINDEX && request != SIOCGIFHWADDR && request != SIOCGIFFLAGS && request != SIOCGIFMTU) {
            return std::nullopt;
        }
        asked_about = interface->ifr_name;
        switch (request) {
        case SIOCGIFINDEX: interface->ifr_ifindex = index; break;
        case SIOCGIFHWADDR: interface->ifr_hwaddr.sa_family = hardware; break;
        case SIOCGIFMTU: interface->ifr_mtu = mtu; break;
        default: interface->ifr_flags = static_cast<short>(up ? IFF_UP : IFF_RUNNING); break;
        }
        if (missing_error != 0 || request == unanswered) {
            errno = missing_error != 0 ? missing_error : EINVAL;
            return -1;  // independent of the answer's contents
        }
        return 0;
    }};
    SocketCanPort port;

    void open() { ASSERT_EQ(port.open("can0", {}, kRetry), CanOpenStatus::ok); }
    void open_fd()
    {
        mtu = CANFD_MTU;
        SocketCanOptions options;
        options.fd = true;
        ASSERT_EQ(port.open("can0", options, kRetry), CanOpenStatus::ok);
    }
    /// An error message of the controller.
    void put_error(std::uint32_t id, std::uint8_t controller = 0) const
    {
        can_frame raw{};
        raw.can_id = id | CAN_ERR_FLAG;
        raw.can_dlc = CAN_ERR_DLC;
        raw.data[1] = controller;
        put(&raw, CAN_MTU);
    }
    /// The same, processed by the port.
    void error_frame(std::uint32_t id, std::uint8_t controller = 0)
    {
        put_error(id, controller);
        CanFrame frame;
        EXPECT_FALSE(port.receive(frame)) << "an error frame is no frame";
    }
    void put(const void* raw, std::size_t size) const
    {
        ASSERT_EQ(::send(kernel.bus_end, raw, size, 0), static_cast<ssize_t>(size));
    }
    /// Frames that have reached the bus.
    [[nodiscard]] std::size_t on_the_bus() const
    {
        std::size_t n = 0;
        canfd_frame raw{};
        while (::recv(kernel.bus_end, &raw, sizeof raw, MSG_DONTWAIT) > 0) {
            ++n;
        }
        return n;
    }
};

}  // namespace jink::hal::test
