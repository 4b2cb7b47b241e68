// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/can/netlink.hpp"

#include <cerrno>
#include <cstring>

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

namespace jink::target {

struct Netlink::Message {
    alignas(nlmsghdr) char bytes[1024] = {};

    Message(std::uint16_t type, std::uint16_t flags)
    {
        header()->nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg));
        header()->nlmsg_type = type;
        header()->nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | NLM_F_ACK | flags);
    }
    nlmsghdr* header() { return reinterpret_cast<nlmsghdr*>(bytes); }
    ifinfomsg* link() { return static_cast<ifinfomsg*>(NLMSG_DATA(header())); }
    rtattr* add(std::uint16_t type, const void* data, std::size_t size)
    {
        auto* const attribute = reinterpret_cast<rtattr*>(bytes + NLMSG_ALIGN(header()->nlmsg_len));
        attribute->rta_type = type;
        attribute->rta_len = static_cast<std::uint16_t>(RTA_LENGTH(size));
        if (size > 0) {
            std::memcpy(RTA_DATA(attribute), data, size);
        }
        header()->nlmsg_len =
            static_cast<std::uint32_t>(NLMSG_ALIGN(header()->nlmsg_len) + RTA_ALIGN(RTA_LENGTH(size)));
        return attribute;
    }
    rtattr* open(std::uint16_t type) { return add(type, nullptr, 0); }
    void close(rtattr* nest)
    {
        nest->rta_len = static_cast<std::uint16_t>(bytes + header()->nlmsg_len - reinterpret_cast<char*>(nest));
    }
};

Netlink::Netlink() : socket_(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)) {}

Netlink::~Netlink() { ::close(socket_); }

int Netlink::talk(Message& message)
{
    message.header()->nlmsg_seq = ++sequence_;
    if (::send(socket_, message.bytes, message.header()->nlmsg_len, 0) < 0) {
        return errno;
    }
    alignas(nlmsghdr) char answer[4096];
    if (::recv(socket_, answer, sizeof answer, 0) < 0) {
        return errno;
    }
    const auto* const header = reinterpret_cast<const nlmsghdr*>(answer);
    if (header->nlmsg_type != NLMSG_ERROR) {
        return EPROTO;
    }
    return -static_cast<const nlmsgerr*>(NLMSG_DATA(header))->error;
}

int Netlink::add_vcan(const std::string& name)
{
    Message message(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL);
    message.add(IFLA_IFNAME, name.c_str(), name.size() + 1);
    rtattr* const info = message.open(IFLA_LINKINFO);
    message.add(IFLA_INFO_KIND, "vcan", 5);
    message.close(info);
    return talk(message);
}

int Netlink::remove(const std::string& name)
{
    Message message(RTM_DELLINK, 0);
    message.link()->ifi_index = static_cast<int>(::if_nametoindex(name.c_str()));
    return talk(message);
}

int Netlink::set_up(const std::string& name, bool up)
{
    Message message(RTM_NEWLINK, 0);
    message.link()->ifi_index = static_cast<int>(::if_nametoindex(name.c_str()));
    message.link()->ifi_flags = up ? IFF_UP : 0;
    message.link()->ifi_change = IFF_UP;
    return talk(message);
}

int Netlink::set_mtu(const std::string& name, std::uint32_t mtu)
{
    Message message(RTM_NEWLINK, 0);
    message.link()->ifi_index = static_cast<int>(::if_nametoindex(name.c_str()));
    message.add(IFLA_MTU, &mtu, sizeof mtu);
    return talk(message);
}

int Netlink::set_bit_rate(const std::string& name, std::uint32_t bit_rate, std::uint32_t restart_ms)
{
    Message message(RTM_NEWLINK, 0);
    message.link()->ifi_index = static_cast<int>(::if_nametoindex(name.c_str()));
    rtattr* const info = message.open(IFLA_LINKINFO);
    message.add(IFLA_INFO_KIND, "can", 4);
    rtattr* const data = message.open(IFLA_INFO_DATA);
    can_bittiming timing{};
    timing.bitrate = bit_rate;
    message.add(IFLA_CAN_BITTIMING, &timing, sizeof timing);
    message.add(IFLA_CAN_RESTART_MS, &restart_ms, sizeof restart_ms);
    message.close(data);
    message.close(info);
    return talk(message);
}

}  // namespace jink::target
