// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/linux_watchdog.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <linux/watchdog.h>

#include "tests/unit/hal/ioctl_hook.hpp"
#include "tests/unit/hal/pty.hpp"

namespace jink::hal {
namespace {

using test::IoctlHook;
using test::TemporaryFolder;

/// Plays /dev/watchdog: a FIFO shows each byte written; a hook has to answer the timeout.
class FakeDevice {
public:
    FakeDevice() : path_(folder_ / "watchdog")
    {
        if (::mkfifo(path_.c_str(), 0600) != 0) {
            throw std::runtime_error("no FIFO to be had");
        }
        reader_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    }
    ~FakeDevice() { remove_driver(); }
    FakeDevice(const FakeDevice&) = delete;
    FakeDevice& operator=(const FakeDevice&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

    [[nodiscard]] std::string written() const
    {
        std::array<char, 64> bytes{};
        const ssize_t n = ::read(reader_, bytes.data(), bytes.size());
        return {bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0};
    }

    /// Fills the pipe, so that it takes nothing more.
    void jam() const
    {
        const int writer = ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        const std::array<char, 1024> bytes{};
        while (::write(writer, bytes.data(), bytes.size()) > 0 || ::write(writer, bytes.data(), 1) > 0) {
        }
        ::close(writer);
    }

    /// Without a reader, opening gives ENXIO, as a node without its driver does.
    void remove_driver()
    {
        if (reader_ >= 0) {
            ::close(reader_);
            reader_ = -1;
        }
    }

private:
    TemporaryFolder folder_;
    std::string path_;
    int reader_ = -1;
};

/// Plays the service manager.
class Manager {
public:
    explicit Manager(const std::string& address)
        : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0))
    {
        sockaddr_un at{};
        at.sun_family = AF_UNIX;
        std::memcpy(at.sun_path, address.data(), address.size());
        if (address.front() == '@') {
            at.sun_path[0] = '\0';
        }
        const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
        if (::bind(socket_, reinterpret_cast<sockaddr*>(&at), size) != 0) {
            throw std::runtime_error("no socket to be had");
        }
    }
    ~Manager() { ::close(socket_); }
    Manager(const Manager&) = delete;
    Manager& operator=(const Manager&) = delete;

    [[nodiscard]] std::string received() const
    {
        std::array<char, 64> bytes{};
        const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
        return {bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0};
    }

private:
    int socket_;
};

TEST(LinuxWatchdog, WithoutOutletsOnlyCounts)
{
    LinuxWatchdog watchdog;
    watchdog.feed();
    watchdog.feed();
    EXPECT_EQ(watchdog.counters().feeds, 2U);
    EXPECT_EQ(watchdog.counters().device_errors, 0U);
    EXPECT_EQ(watchdog.counters().notify_errors, 0U);
    EXPECT_FALSE(watchdog.notify_ready());
}

TEST(LinuxWatchdog, FeedsTheDeviceAndDisarmsItAtTheEnd)
{
    const FakeDevice device;
    int asked = 0;
    const IoctlHook hook([&](int, unsigned long request, void* argument) -> std::optional<int> {
        if (request != WDIOC_SETTIMEOUT) {
            return std::nullopt;
        }
        asked = *static_cast<int*>(argument);
        *static_cast<int*>(argument) = 16;  // this driver counts in steps of 16 s
        return 0;
    });
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::ok);
    EXPECT_EQ(asked, 10);
    EXPECT_EQ(watchdog.device_timeout_s(), 16);
    EXPECT_EQ(device.written(), "");
    watchdog.feed();
    watchdog.feed();
    EXPECT_EQ(device.written(), std::string(2, '\0'));
    watchdog.close();
    EXPECT_EQ(device.written(), "V");
    watchdog.feed();
    EXPECT_EQ(device.written(), "");
    EXPECT_EQ(watchdog.counters().feeds, 3U);
    EXPECT_EQ(watchdog.counters().device_errors, 0U);
    EXPECT_EQ(watchdog.device_timeout_s(), 0);
}

TEST(LinuxWatchdog, DisarmsADeviceThatRefusesTheTimeout)
{
    const FakeDevice device;
    LinuxWatchdog watchdog;
    // Without a hook: a FIFO knows no watchdog requests.
    EXPECT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::timeout_refused);
    EXPECT_EQ(device.written(), "V");
    watchdog.feed();
    EXPECT_EQ(device.written(), "");
}

TEST(LinuxWatchdog, CountsFeedsThatTheDeviceDidNotTake)
{
    const FakeDevice device;
    const IoctlHook hook([](int, unsigned long request, void*) -> std::optional<int> {
        return request == WDIOC_SETTIMEOUT ? std::optional<int>(0) : std::nullopt;
    });
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::ok);
    device.jam();
    watchdog.feed();
    watchdog.feed();
    EXPECT_EQ(watchdog.counters().device_errors, 2U);
    watchdog.close();
    EXPECT_EQ(watchdog.counters().device_errors, 3U);
}

TEST(LinuxWatchdog, TellsWhyThereIsNoDevice)
{
    const TemporaryFolder folder;
    LinuxWatchdog watchdog;
    EXPECT_EQ(watchdog.open_device("", 10), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_device(std::string(108, '/'), 10), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_device(folder / "none", 10), WatchdogStatus::no_device);
    EXPECT_EQ(watchdog.open_device("/", 10), WatchdogStatus::failed);
    FakeDevice device;
    device.remove_driver();
    EXPECT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::no_device);
}

// A terminal in exclusive use answers EBUSY, as a watchdog that another program has armed does; but not to root.
TEST(LinuxWatchdog, TellsThatTheDeviceIsHeld)
{
    const test::Pty pty;
    const int holder = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(holder, 0);
    ASSERT_EQ(::ioctl(holder, TIOCEXCL, nullptr), 0);
    ASSERT_EQ(::chmod(pty.path().c_str(), 0666), 0);
    LinuxWatchdog watchdog;
    WatchdogStatus status{};
    {
        const test::AsNobody unprivileged;
        status = watchdog.open_device(pty.path(), 10);
    }
    EXPECT_EQ(status, WatchdogStatus::busy);
    ::close(holder);
}

TEST(LinuxWatchdog, NotifiesAManagerByPath)
{
    const TemporaryFolder folder;
    const std::string address = folder / "notify";
    const Manager manager(address);
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_notify(address), WatchdogStatus::ok);
    EXPECT_TRUE(watchdog.notify_ready());
    EXPECT_EQ(manager.received(), "READY=1");
    watchdog.feed();
    EXPECT_EQ(manager.received(), "WATCHDOG=1");
    EXPECT_EQ(manager.received(), "");
    EXPECT_EQ(watchdog.counters().notify_errors, 0U);
    watchdog.close();
    watchdog.feed();
    EXPECT_EQ(manager.received(), "");
}

TEST(LinuxWatchdog, NotifiesAManagerByAbstractName)
{
    const std::string address = "@jink-test-" + std::to_string(::getpid());
    const Manager manager(address);
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_notify(address), WatchdogStatus::ok);
    watchdog.feed();
    EXPECT_EQ(manager.received(), "WATCHDOG=1");
}

TEST(LinuxWatchdog, FindsAManagerThatWasRestarted)
{
    const TemporaryFolder folder;
    const std::string address = folder / "notify";
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_notify(address), WatchdogStatus::ok);
    watchdog.feed();
    EXPECT_FALSE(watchdog.notify_ready());
    EXPECT_EQ(watchdog.counters().notify_errors, 2U);
    const Manager manager(address);
    watchdog.feed();
    EXPECT_EQ(manager.received(), "WATCHDOG=1");
    EXPECT_EQ(watchdog.counters().notify_errors, 2U);
}

TEST(LinuxWatchdog, ADeafManagerDoesNotBlock)
{
    const TemporaryFolder folder;
    const std::string address = folder / "notify";
    const Manager manager(address);
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_notify(address), WatchdogStatus::ok);
    for (int i = 0; i < 10'000; ++i) {
        watchdog.feed();
    }
    EXPECT_GT(watchdog.counters().notify_errors, 0U);
    EXPECT_LT(watchdog.counters().notify_errors, 10'000U);
}

TEST(LinuxWatchdog, RefusesUselessAddresses)
{
    LinuxWatchdog watchdog;
    EXPECT_EQ(watchdog.open_notify(""), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_notify({}), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_notify("@"), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_notify("relative/path"), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_notify("/" + std::string(107, 'x')), WatchdogStatus::bad_path);
    EXPECT_EQ(watchdog.open_notify("vsock:2:1234"), WatchdogStatus::bad_path);
    watchdog.feed();
    EXPECT_EQ(watchdog.counters().notify_errors, 0U);
    EXPECT_EQ(watchdog.open_notify("/" + std::string(106, 'x')), WatchdogStatus::ok) << "the longest that fits";
    EXPECT_EQ(watchdog.open_notify("/x"), WatchdogStatus::ok) << "the shortest";
    EXPECT_EQ(watchdog.open_notify("@x"), WatchdogStatus::ok);
}

TEST(LinuxWatchdog, ALongPathThatFitsIsOnlyNotThere)
{
    LinuxWatchdog watchdog;
    EXPECT_EQ(watchdog.open_device("/" + std::string(106, 'x'), 10), WatchdogStatus::no_device);
}

TEST(LinuxWatchdog, AnotherOutletTakesTheFormerOnesPlace)
{
    const FakeDevice first;
    const FakeDevice second;
    const IoctlHook hook([](int, unsigned long request, void*) -> std::optional<int> {
        return request == WDIOC_SETTIMEOUT ? std::optional<int>(0) : std::nullopt;
    });
    const TemporaryFolder folder;
    const Manager manager(folder / "notify");
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_device(first.path(), 10), WatchdogStatus::ok);
    ASSERT_EQ(watchdog.open_device(second.path(), 20), WatchdogStatus::ok);
    EXPECT_EQ(first.written(), "V") << "or it would reset the machine";
    ASSERT_EQ(watchdog.open_notify(folder / "notify"), WatchdogStatus::ok);
    watchdog.feed();
    EXPECT_EQ(first.written(), "");
    EXPECT_EQ(second.written(), std::string(1, '\0'));
    EXPECT_EQ(manager.received(), "WATCHDOG=1");
    EXPECT_EQ(watchdog.device_timeout_s(), 20);
    EXPECT_EQ(watchdog.open_device("", 10), WatchdogStatus::bad_path);
    EXPECT_EQ(second.written(), "V");
    EXPECT_EQ(watchdog.open_notify("nowhere"), WatchdogStatus::bad_path);
    watchdog.feed();
    EXPECT_EQ(manager.received(), "");
    EXPECT_EQ(watchdog.counters().notify_errors, 0U);
}

TEST(LinuxWatchdog, TheEndOfItsLifeDisarmsTheDevice)
{
    const FakeDevice device;
    const IoctlHook hook([](int, unsigned long request, void*) -> std::optional<int> {
        return request == WDIOC_SETTIMEOUT ? std::optional<int>(0) : std::nullopt;
    });
    {
        LinuxWatchdog watchdog;
        ASSERT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::ok);
    }
    EXPECT_EQ(device.written(), "V");
}

TEST(LinuxWatchdog, CountsNoticesThatNobodyHeard)
{
    const TemporaryFolder folder;
    LinuxWatchdog watchdog;
    ASSERT_EQ(watchdog.open_notify(folder / "notify"), WatchdogStatus::ok);
    EXPECT_FALSE(watchdog.notify_ready()) << "nobody listens";
    const Manager manager(folder / "notify");
    EXPECT_TRUE(watchdog.notify_ready());
    EXPECT_EQ(watchdog.counters().notify_errors, 1U);
    watchdog.close();
    EXPECT_FALSE(watchdog.notify_ready());
    EXPECT_EQ(watchdog.counters().notify_errors, 1U) << "without an outlet nothing can fail";
}

// A service may start a program without standard input: its first descriptor is then 0.
TEST(LinuxWatchdog, WorksWithTheFirstDescriptor)
{
    const FakeDevice device;
    const TemporaryFolder folder;
    const Manager manager(folder / "notify");
    const IoctlHook hook([](int, unsigned long request, void*) -> std::optional<int> {
        return request == WDIOC_SETTIMEOUT ? std::optional<int>(0) : std::nullopt;
    });
    LinuxWatchdog watchdog;
    const test::FreeDescriptorZero zero;
    ASSERT_EQ(watchdog.open_device(device.path(), 10), WatchdogStatus::ok);
    watchdog.feed();
    EXPECT_EQ(device.written(), std::string(1, '\0'));
    watchdog.close();
    EXPECT_EQ(device.written(), "V");
    EXPECT_EQ(::fcntl(0, F_GETFD), -1);
    ASSERT_EQ(watchdog.open_notify(folder / "notify"), WatchdogStatus::ok);
    EXPECT_TRUE(watchdog.notify_ready());
    watchdog.feed();
    EXPECT_EQ(manager.received(), "READY=1");
    EXPECT_EQ(manager.received(), "WATCHDOG=1");
    watchdog.close();
    EXPECT_EQ(::fcntl(0, F_GETFD), -1);
}

}  // namespace
}  // namespace jink::hal
