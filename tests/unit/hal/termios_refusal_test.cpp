// SPDX-License-Identifier: BSD-3-Clause
// Why a serial device does not open, and behaviour of drivers that test machines lack.
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>

#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <linux/serial.h>

#include "hal/linux/termios_serial_port.hpp"
#include "tests/unit/hal/ioctl_hook.hpp"
#include "tests/unit/hal/pty.hpp"

namespace jink::hal {
namespace {

using test::IoctlHook;
using test::Pty;
using test::TemporaryFolder;

constexpr std::int64_t kRetry = 500'000;

TEST(TermiosSerialPort, RefusesUselessArguments)
{
    TermiosSerialPort port;
    EXPECT_EQ(port.open("", 57'600, kRetry), OpenStatus::bad_path);
    EXPECT_EQ(port.open(std::string(kMaxDevicePath, 'x'), 57'600, kRetry), OpenStatus::bad_path);
    EXPECT_EQ(port.health().state, PortState::closed);
    EXPECT_EQ(port.open("/" + std::string(kMaxDevicePath - 2, 'x'), 57'600, kRetry), OpenStatus::no_device);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.open("/dev/null", 0, kRetry), OpenStatus::bad_baud);
    EXPECT_EQ(port.health().state, PortState::closed);
    EXPECT_EQ(port.open_status(), OpenStatus::bad_baud);
}

TEST(TermiosSerialPort, TellsWhyADeviceDoesNotOpen)
{
    TermiosSerialPort port;
    EXPECT_EQ(port.open("/dev/null", 57'600, kRetry), OpenStatus::not_a_serial_device);
    EXPECT_EQ(port.open("/", 57'600, kRetry), OpenStatus::not_a_serial_device);
    EXPECT_EQ(port.open("/dev/null/tty", 57'600, kRetry), OpenStatus::no_device);
    // A running program may not be opened for writing: an error that fits no other cause.
    EXPECT_EQ(port.open("/proc/self/exe", 57'600, kRetry), OpenStatus::failed);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.health().open_failures, 4U);
}

TEST(TermiosSerialPort, TellsThatPermissionIsMissing)
{
    const TemporaryFolder folder;
    const std::string locked = folder / "locked";
    std::ofstream(locked) << "x";
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
    TermiosSerialPort port;
    OpenStatus status{};
    {
        const test::AsNobody unprivileged;
        status = port.open(locked, 57'600, kRetry);
    }
    EXPECT_EQ(status, OpenStatus::access_denied);
}

TEST(TermiosSerialPort, LeavesADeviceToTheProgramThatHasIt)
{
    const Pty peer;
    TermiosSerialPort first;
    TermiosSerialPort second;
    ASSERT_EQ(first.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    const std::array<std::byte, 3> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
    ASSERT_EQ(peer.write(bytes.data(), bytes.size()), bytes.size());
    EXPECT_EQ(second.open(peer.path(), 115'200, kRetry), OpenStatus::access_denied);
    EXPECT_EQ(second.health().state, PortState::lost);
    std::array<std::byte, 8> got{};
    EXPECT_EQ(first.read(got), bytes.size()) << "the refused one discards nothing";
    termios2 settings{};
    ASSERT_EQ(test::kernel_ioctl(first.descriptor(), TCGETS2, &settings), 0);
    EXPECT_EQ(settings.c_ospeed, 57'600U) << "nor does it change the rate";
    second.service(0);
    EXPECT_EQ(second.health().state, PortState::lost);
    first.close();
    second.service(2 * kRetry);
    EXPECT_EQ(second.health().state, PortState::open);
}

TEST(TermiosSerialPort, RefusesADriverThatDoesNotTakeTheSettings)
{
    const Pty peer;
    TermiosSerialPort port;
    const IoctlHook refusing([](int, unsigned long request, void*) -> std::optional<int> {
        if (request == TCSETS2) {
            errno = EINVAL;
            return -1;
        }
        return std::nullopt;
    });
    EXPECT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::settings_refused);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.health().state, PortState::lost);
}

TEST(TermiosSerialPort, BelievesNoSettingsOfACallThatFailed)
{
    for (const unsigned long failing : {TCSETS2, TCGETS2}) {
        SCOPED_TRACE(failing);
        const Pty peer;
        TermiosSerialPort port;
        int answers_wanted = 0;
        const IoctlHook hook([&](int descriptor, unsigned long request, void* argument) -> std::optional<int> {
            if (request != TCSETS2 && request != TCGETS2) {
                return std::nullopt;
            }
            const int result = test::kernel_ioctl(descriptor, request, argument);
            const bool reads_back = request == TCGETS2 && ++answers_wanted == 2;
            if (reads_back) {
                auto* const settings = static_cast<termios2*>(argument);
                settings->c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
                settings->c_ispeed = settings->c_ospeed = 57'600;
            }
            return request == failing && (request == TCSETS2 || reads_back) ? -1 : result;
        });
        EXPECT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::settings_refused);
        EXPECT_EQ(port.actual_baud(), 0U);
    }
}

/// A driver that takes all settings and then does something else.
OpenStatus open_with_driver(TermiosSerialPort& port, std::uint32_t asked, const std::function<void(termios2&)>& change)
{
    const Pty peer;
    bool has_set = false;
    const IoctlHook changing([&](int descriptor, unsigned long request, void* argument) -> std::optional<int> {
        const int result = test::kernel_ioctl(descriptor, request, argument);
        has_set = has_set || request == TCSETS2;
        if (has_set && request == TCGETS2) {
            change(*static_cast<termios2*>(argument));
        }
        return result;
    });
    return port.open(peer.path(), asked, kRetry);
}

TEST(TermiosSerialPort, ChecksWhatTheDriverMadeOfTheSettings)
{
    TermiosSerialPort port;
    const auto rate = [](std::uint32_t baud) {
        return [baud](termios2& settings) { settings.c_ispeed = settings.c_ospeed = baud; };
    };
    // 2.5 % of 100000 is 2500.
    EXPECT_EQ(open_with_driver(port, 100'000, rate(102'500)), OpenStatus::ok);
    EXPECT_EQ(port.actual_baud(), 102'500U);
    EXPECT_EQ(open_with_driver(port, 100'000, rate(102'501)), OpenStatus::settings_refused);
    EXPECT_EQ(open_with_driver(port, 100'000, rate(97'500)), OpenStatus::ok);
    EXPECT_EQ(open_with_driver(port, 100'000, rate(97'499)), OpenStatus::settings_refused);
    EXPECT_EQ(open_with_driver(port, 4'000'000'000U, rate(9600)), OpenStatus::settings_refused);
    const auto input_only = [](termios2& settings) { settings.c_ispeed = 9600; };
    EXPECT_EQ(open_with_driver(port, 100'000, input_only), OpenStatus::settings_refused);
    const auto output_only = [](termios2& settings) { settings.c_ospeed = 9600; };
    EXPECT_EQ(open_with_driver(port, 100'000, output_only), OpenStatus::settings_refused);
    const auto two_stop_bits = [](termios2& settings) { settings.c_cflag |= CSTOPB; };
    EXPECT_EQ(open_with_driver(port, 100'000, two_stop_bits), OpenStatus::settings_refused);
    const auto parity = [](termios2& settings) { settings.c_cflag |= PARENB; };
    EXPECT_EQ(open_with_driver(port, 100'000, parity), OpenStatus::settings_refused);
    const auto flow_control = [](termios2& settings) { settings.c_cflag |= CRTSCTS; };
    EXPECT_EQ(open_with_driver(port, 100'000, flow_control), OpenStatus::settings_refused);
    const auto seven_bits = [](termios2& settings) { settings.c_cflag = (settings.c_cflag & ~tcflag_t{CSIZE}) | CS7; };
    EXPECT_EQ(open_with_driver(port, 100'000, seven_bits), OpenStatus::settings_refused);
}

TEST(TermiosSerialPort, CountsWhatTheDriverSaysWasLost)
{
    const Pty peer;
    serial_icounter_struct driver{};
    driver.overrun = -1;  // about to wrap
    driver.frame = 100;
    const IoctlHook counting([&](int, unsigned long request, void* argument) -> std::optional<int> {
        if (request != TIOCGICOUNT) {
            return std::nullopt;
        }
        *static_cast<serial_icounter_struct*>(argument) = driver;
        return 0;
    });
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    port.service(0);
    EXPECT_EQ(port.health().overruns, 0U);
    EXPECT_EQ(port.health().line_errors, 0U);
    driver.overrun = 2;
    driver.buf_overrun = 4;
    driver.frame = 101;
    driver.parity = 20;
    driver.brk = 300;
    port.service(1);
    EXPECT_EQ(port.health().overruns, 7U);
    EXPECT_EQ(port.health().line_errors, 321U);
    port.service(2);
    EXPECT_EQ(port.health().overruns, 7U);
    EXPECT_EQ(port.health().line_errors, 321U);
    port.close();
    driver.overrun = 50;
    port.service(3);
    EXPECT_EQ(port.health().overruns, 7U) << "a closed port counts nothing";
}

TEST(TermiosSerialPort, CountsNothingThatTheDriverDoesNotSay)
{
    const Pty peer;
    std::optional<int> overruns;
    const IoctlHook counting([&](int, unsigned long request, void* argument) -> std::optional<int> {
        if (request != TIOCGICOUNT) {
            return std::nullopt;
        }
        static_cast<serial_icounter_struct*>(argument)->overrun = overruns.value_or(99);
        return overruns ? 0 : -1;
    });
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    overruns = 7;  // since when is not known
    port.service(0);
    port.service(1);
    EXPECT_EQ(port.health().overruns, 0U);
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    overruns.reset();
    port.service(2);
    EXPECT_EQ(port.health().overruns, 0U);
    overruns = 9;
    port.service(3);
    EXPECT_EQ(port.health().overruns, 2U) << "the count that failed lost nothing";
}

TEST(TermiosSerialPort, WritesThatAreNotTakenNowAreNoError)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    const std::array<std::byte, 4> bytes{};
    ssize_t answer = 0;
    int error = 0;
    int calls = 0;
    const test::WriteHook hook([&](int descriptor, const void*, std::size_t) -> std::optional<ssize_t> {
        if (descriptor != port.descriptor()) {
            return std::nullopt;
        }
        errno = error;
        return ++calls < 1000 ? answer : 4;
    });
    error = EIO;  // means nothing where the call did not fail
    EXPECT_EQ(port.write(bytes), 0U);
    answer = -1;
    for (const int later : {EAGAIN, EINTR}) {
        error = later;
        EXPECT_EQ(port.write(bytes), 0U);
    }
    EXPECT_EQ(calls, 3);
    EXPECT_EQ(port.health().bytes_refused, 12U);
    EXPECT_EQ(port.health().write_errors, 0U);
    EXPECT_EQ(port.health().state, PortState::open);
    error = EIO;
    EXPECT_EQ(port.write(bytes), 0U);
    EXPECT_EQ(port.health().write_errors, 1U);
    EXPECT_EQ(port.health().state, PortState::lost);
}

// A service may start a program without standard input: its first descriptor is then 0.
TEST(TermiosSerialPort, WorksAsTheFirstDescriptor)
{
    const Pty peer;
    TermiosSerialPort port;
    const test::FreeDescriptorZero zero;
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    ASSERT_EQ(port.descriptor(), 0);
    const IoctlHook holding([&](int, unsigned long request, void* argument) -> std::optional<int> {
        if (request != TIOCOUTQ) {
            return std::nullopt;
        }
        *static_cast<int*>(argument) = 17;
        return 0;
    });
    EXPECT_EQ(port.unsent(), 17U);
    port.close();
    EXPECT_EQ(::fcntl(0, F_GETFD), -1);
}

TEST(TermiosSerialPort, TellsWhatTheDriverStillHolds)
{
    const Pty peer;
    TermiosSerialPort port;
    EXPECT_EQ(port.unsent(), 0U);
    ASSERT_EQ(port.open(peer.path(), 57'600, kRetry), OpenStatus::ok);
    EXPECT_EQ(port.unsent(), 0U);
    std::optional<int> held = 17;
    const IoctlHook holding([&](int, unsigned long request, void* argument) -> std::optional<int> {
        if (request != TIOCOUTQ) {
            return std::nullopt;
        }
        *static_cast<int*>(argument) = held.value_or(99);
        return held ? 0 : -1;
    });
    EXPECT_EQ(port.unsent(), 17U);
    held = -1;
    EXPECT_EQ(port.unsent(), 0U);
    held.reset();  // the driver does not report
    EXPECT_EQ(port.unsent(), 0U);
    held = 17;
    port.close();
    EXPECT_EQ(port.unsent(), 0U);
}

}  // namespace
}  // namespace jink::hal
