// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/socket_can_port.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace jink::hal {
namespace {

CanOpenStatus cause_of(int error) noexcept
{
    switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT: return CanOpenStatus::no_can;
    case ENODEV:
    case ENXIO: return CanOpenStatus::no_interface;
    case EACCES:
    case EPERM: return CanOpenStatus::access_denied;
    default: return CanOpenStatus::failed;
    }
}

/// Whether time cannot change the failure; bad_name and too_many_filters do not get this far.
bool is_final(CanOpenStatus status) noexcept
{
    return status == CanOpenStatus::no_can || status == CanOpenStatus::not_can || status == CanOpenStatus::no_fd;
}

template <class T>
bool set(int descriptor, int level, int option, const T& value) noexcept
{
    return ::setsockopt(descriptor, level, option, &value, sizeof value) == 0;
}

ifreq request_for(const std::array<char, kMaxInterfaceName>& name) noexcept
{
    static_assert(kMaxInterfaceName == IFNAMSIZ);
    ifreq request{};
    std::memcpy(request.ifr_name, name.data(), name.size());
    return request;
}

}  // namespace

SocketCanPort::~SocketCanPort() { release(); }

CanOpenStatus SocketCanPort::open(std::string_view interface, const SocketCanOptions& options,
                                  std::int64_t retry_period_us) noexcept
{
    assert(retry_period_us > 0);
    close();
    if (interface.empty() || interface.size() >= kMaxInterfaceName) {
        open_status_ = CanOpenStatus::bad_name;
        return open_status_;
    }
    if (options.filters.size() > kMaxCanFilters) {
        open_status_ = CanOpenStatus::too_many_filters;
        return open_status_;
    }
    name_.fill('\0');
    interface.copy(name_.data(), interface.size());
    filter_count_ = options.filters.size();
    std::copy(options.filters.begin(), options.filters.end(), filters_.begin());
    fd_ = options.fd;
    receive_buffer_ = options.receive_buffer;
    retry_period_us_ = retry_period_us;
    next_attempt_us_ = 0;
    open_status_ = try_open();
    if (health_.state != CanState::active) {  // no interface, or an interface that is down
        health_.state = is_final(open_status_) ? CanState::closed : CanState::down;
    }
    return open_status_;
}

void SocketCanPort::close() noexcept
{
    release();
    health_.state = CanState::closed;
}

CanOpenStatus SocketCanPort::try_open() noexcept
{
    descriptor_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (descriptor_ < 0) {
        return cause_of(errno);
    }
    ifreq request = request_for(name_);
    CanOpenStatus status = CanOpenStatus::ok;
    if (::ioctl(descriptor_, SIOCGIFINDEX, &request) != 0) {
        status = cause_of(errno);
    } else {
        status = configure(request.ifr_ifindex);
    }
    if (status != CanOpenStatus::ok) {
        release();
    }
    return status;
}

CanOpenStatus SocketCanPort::configure(int index) noexcept
{
    ifreq request = request_for(name_);
    if (::ioctl(descriptor_, SIOCGIFHWADDR, &request) != 0) {
        return cause_of(errno);
    }
    if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
        return CanOpenStatus::not_can;
    }
    if (fd_) {
        request = request_for(name_);
        if (::ioctl(descriptor_, SIOCGIFMTU, &request) != 0 || request.ifr_mtu < static_cast<int>(CANFD_MTU) ||
            !set(descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1)) {
            return CanOpenStatus::no_fd;
        }
    }
    std::array<can_filter, kMaxCanFilters> wanted{};
    for (std::size_t i = 0; i < filter_count_; ++i) {
        const CanFilter& f = filters_[i];
        wanted[i].can_id = f.id | (f.extended ? CAN_EFF_FLAG : 0U);
        wanted[i].can_mask = f.mask | CAN_EFF_FLAG;
    }
    const can_err_mask_t errors = CAN_ERR_MASK;
    const bool options_ok =
        set(descriptor_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) && set(descriptor_, SOL_SOCKET, SO_RXQ_OVFL, 1) &&
        (filter_count_ == 0 || ::setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FILTER, wanted.data(),
                                            static_cast<socklen_t>(filter_count_ * sizeof(can_filter))) == 0) &&
        (receive_buffer_ == 0 || set(descriptor_, SOL_SOCKET, SO_RCVBUF, receive_buffer_));
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (!options_ok || ::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        return cause_of(errno);
    }
    dropped_ = 0;
    request = request_for(name_);
    const bool up = ::ioctl(descriptor_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
    health_.state = up ? CanState::active : CanState::down;
    return CanOpenStatus::ok;
}

void SocketCanPort::service(std::int64_t now_us) noexcept
{
    if (health_.state == CanState::closed) {
        return;
    }
    if (descriptor_ < 0) {
        if (now_us < next_attempt_us_) {
            return;
        }
        next_attempt_us_ = now_us + retry_period_us_;
        open_status_ = try_open();
        health_.ups += health_.state == CanState::active ? 1U : 0U;  // it was down
        return;
    }
    ifreq request = request_for(name_);
    if (::ioctl(descriptor_, SIOCGIFFLAGS, &request) != 0) {
        become(CanState::down);  // deleted: a new interface of that name has another index
        release();
        next_attempt_us_ = now_us;
        return;
    }
    const bool up = (request.ifr_flags & IFF_UP) != 0;
    if (!up) {
        become(CanState::down);
    } else if (health_.state == CanState::down) {
        become(CanState::active);
    }
}

void SocketCanPort::become(CanState state) noexcept
{
    if (state == health_.state) {
        return;
    }
    health_.downs += state == CanState::down ? 1U : 0U;
    health_.ups += health_.state == CanState::down ? 1U : 0U;
    health_.bus_offs += state == CanState::bus_off ? 1U : 0U;
    health_.state = state;
}

void SocketCanPort::note_error(int error) noexcept
{
    if (error == ENETDOWN) {
        become(CanState::down);
    } else if (error == ENODEV || error == ENXIO) {
        become(CanState::down);
        release();
    }
}

void SocketCanPort::note_error_frame(std::uint32_t id, const std::uint8_t* data) noexcept
{
    constexpr std::uint32_t kErrors = CAN_ERR_PROT | CAN_ERR_TRX | CAN_ERR_ACK | CAN_ERR_BUSERROR | CAN_ERR_TX_TIMEOUT;
    health_.bus_errors += (id & kErrors) != 0 ? 1U : 0U;
    if ((id & CAN_ERR_BUSOFF) != 0) {
        become(CanState::bus_off);
        return;
    }
    if ((id & CAN_ERR_RESTARTED) != 0) {
        ++health_.restarts;
        become(CanState::active);
    }
    if ((id & CAN_ERR_CRTL) != 0) {
        const std::uint8_t controller = data[1];
        health_.overruns += (controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0 ? 1U : 0U;
        if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
            become(CanState::error_passive);
        } else if ((controller & CAN_ERR_CRTL_ACTIVE) != 0) {
            become(CanState::active);
        }
    }
}

SocketCanPort::Read SocketCanPort::read_one(CanFrame& frame) noexcept
{
    canfd_frame raw{};
    iovec part{&raw, sizeof raw};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = ::recvmsg(descriptor_, &message, 0);
    if (got < 0) {
        if (errno != EAGAIN && errno != EINTR) {
            ++health_.read_errors;
            note_error(errno);
        }
        return Read::nothing;
    }
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, const_cast<cmsghdr*>(c))) {
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL) {
            std::uint32_t dropped = 0;
            std::memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
            health_.overruns += dropped - dropped_;  // 32-bit difference: right across the wrap
            dropped_ = dropped;
        }
    }
    if (got != static_cast<ssize_t>(CAN_MTU) && got != static_cast<ssize_t>(CANFD_MTU)) {
        ++health_.read_errors;
        return Read::error;
    }
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
        note_error_frame(raw.can_id, raw.data);
        return Read::error;
    }
    frame = {};
    frame.fd = got == static_cast<ssize_t>(CANFD_MTU);
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.bit_rate_switch = frame.fd && (raw.flags & CANFD_BRS) != 0;
    const std::size_t most = frame.fd ? CanFrame::kFdBytes : CanFrame::kClassicBytes;
    frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(raw.len, most));
    std::memcpy(frame.data.data(), raw.data, frame.length);
    return Read::data;
}

bool SocketCanPort::receive(CanFrame& frame) noexcept
{
    for (int i = 0; i < kErrorFramesPerCall && descriptor_ >= 0; ++i) {
        switch (read_one(frame)) {
        case Read::nothing: return false;
        case Read::error: continue;
        case Read::data: ++health_.frames_in; return true;
        }
    }
    return false;
}

bool SocketCanPort::send(const CanFrame& frame) noexcept
{
    if (!is_valid(frame) || (frame.fd && !fd_)) {
        ++health_.frames_bad;
        return false;
    }
    if (descriptor_ < 0 || health_.state == CanState::bus_off) {
        ++health_.frames_refused;
        return false;
    }
    canfd_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
    raw.len = frame.length;
    raw.flags = frame.bit_rate_switch ? CANFD_BRS : 0;
    if (!frame.remote) {
        std::memcpy(raw.data, frame.data.data(), frame.length);
    }
    const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
    if (::write(descriptor_, &raw, size) == static_cast<ssize_t>(size)) {
        ++health_.frames_out;
        return true;
    }
    ++health_.frames_refused;
    if (errno != EAGAIN && errno != ENOBUFS && errno != EINTR) {
        ++health_.write_errors;
        note_error(errno);
    }
    return false;
}

void SocketCanPort::release() noexcept
{
    if (descriptor_ >= 0) {
        (void)::close(descriptor_);
        descriptor_ = -1;
    }
}

}  // namespace jink::hal
