// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/linux_watchdog.hpp"

#include <cassert>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <linux/watchdog.h>

namespace jink::hal {

namespace {

WatchdogStatus cause_of(int error) noexcept
{
    switch (error) {
    case ENOENT:
    case ENOTDIR:
    case ENODEV:
    case ENXIO: return WatchdogStatus::no_device;
    case EBUSY: return WatchdogStatus::busy;
    default: return WatchdogStatus::failed;
    }
}

bool write_byte(int descriptor, char value) noexcept { return ::write(descriptor, &value, 1) == 1; }

}  // namespace

static_assert(sizeof(sockaddr_un::sun_path) == 108);

LinuxWatchdog::~LinuxWatchdog() { close(); }

WatchdogStatus LinuxWatchdog::open_device(std::string_view path, int timeout_s) noexcept
{
    assert(timeout_s > 0);
    close_device();
    std::array<char, kMaxPath> terminated{};
    if (path.empty() || path.size() >= terminated.size()) {
        return WatchdogStatus::bad_path;
    }
    path.copy(terminated.data(), path.size());
    device_ = ::open(terminated.data(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    if (device_ < 0) {
        return cause_of(errno);
    }
    device_timeout_s_ = timeout_s;
    if (::ioctl(device_, WDIOC_SETTIMEOUT, &device_timeout_s_) != 0) {
        close_device();
        return WatchdogStatus::timeout_refused;
    }
    return WatchdogStatus::ok;
}

WatchdogStatus LinuxWatchdog::open_notify(std::string_view address) noexcept
{
    close_notify();
    const bool known_form = !address.empty() && (address.front() == '/' || address.front() == '@');
    if (!known_form || address.size() < 2 || address.size() >= notify_address_.size()) {
        return WatchdogStatus::bad_path;
    }
    notify_address_ = {};
    address.copy(notify_address_.data(), address.size());
    notify_address_size_ = address.size();
    notify_socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    return notify_socket_ < 0 ? cause_of(errno) : WatchdogStatus::ok;
}

void LinuxWatchdog::feed() noexcept
{
    ++counters_.feeds;
    if (device_ >= 0 && !write_byte(device_, '\0')) {
        ++counters_.device_errors;
    }
    if (notify_socket_ >= 0) {
        (void)notify("WATCHDOG=1");  // notify() counts a failure
    }
}

void LinuxWatchdog::close() noexcept
{
    close_device();
    close_notify();
}

bool LinuxWatchdog::notify(std::string_view message) noexcept
{
    if (notify_socket_ < 0) {
        return false;
    }
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::memcpy(to.sun_path, notify_address_.data(), notify_address_size_);
    if (to.sun_path[0] == '@') {
        to.sun_path[0] = '\0';
    }
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + notify_address_size_);
    // Addressed again each time, so that a manager that has recreated its socket is found.
    const ssize_t sent =
        ::sendto(notify_socket_, message.data(), message.size(), MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&to), size);
    const bool ok = sent == static_cast<ssize_t>(message.size());
    counters_.notify_errors += ok ? 0U : 1U;
    return ok;
}

void LinuxWatchdog::close_device() noexcept
{
    if (device_ >= 0) {
        // 'V' before close disarms the device (kernel: "magic close"), unless the driver was built with nowayout.
        if (!write_byte(device_, 'V')) {
            ++counters_.device_errors;
        }
        (void)::close(device_);
        device_ = -1;
        device_timeout_s_ = 0;
    }
}

void LinuxWatchdog::close_notify() noexcept
{
    if (notify_socket_ >= 0) {
        (void)::close(notify_socket_);
        notify_socket_ = -1;
    }
}

}  // namespace jink::hal
