// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace jink::target {

/// Network interfaces of the guest, through rtnetlink: what `ip link` would do.
class Netlink {
public:
    Netlink();
    ~Netlink();
    Netlink(const Netlink&) = delete;
    Netlink& operator=(const Netlink&) = delete;

    /// 0, or the kernel's error.
    int add_vcan(const std::string& name);
    int remove(const std::string& name);
    int set_up(const std::string& name, bool up);
    int set_mtu(const std::string& name, std::uint32_t mtu);
    /// Of a real controller, while it is down.
    int set_bit_rate(const std::string& name, std::uint32_t bit_rate, std::uint32_t restart_ms);

private:
    struct Message;
    int talk(Message& message);

    int socket_ = -1;
    std::uint32_t sequence_ = 0;
};

}  // namespace jink::target
