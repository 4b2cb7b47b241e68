// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/termios_serial_port.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <asm/ioctls.h>
#include <asm/termbits.h>

#include "tests/unit/hal/ioctl_hook.hpp"
#include "tests/unit/hal/pty.hpp"

namespace jink::hal {
namespace {

using test::Pty;
using test::TemporaryFolder;

constexpr std::int64_t kPortRetry = 500'000;
// A pty hands bytes over in a kernel thread; this is only how long a test that fails anyway waits for them.
constexpr int kPatienceMs = 10'000;

std::vector<std::byte> random_bytes(std::size_t size, std::uint32_t seed)
{
    std::mt19937 random(seed);
    std::vector<std::byte> bytes(size);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random() & 0xFFU); });
    return bytes;
}

std::vector<std::byte> read_all(TermiosSerialPort& port, std::size_t wanted)
{
    std::vector<std::byte> got(wanted);
    std::size_t count = 0;
    while (count < wanted && port.health().state == PortState::open) {
        pollfd waiting{port.descriptor(), POLLIN, 0};
        if (::poll(&waiting, 1, kPatienceMs) <= 0) {
            break;
        }
        // A small odd span: a read must leave the rest for the next one.
        count += port.read(std::span(got).subspan(count, std::min<std::size_t>(wanted - count, 37)));
    }
    got.resize(count);
    return got;
}

std::vector<std::byte> read_all(const Pty& peer, std::size_t wanted)
{
    std::vector<std::byte> all;
    while (all.size() < wanted) {
        const auto got = peer.read(wanted - all.size(), kPatienceMs);
        if (got.empty()) {
            break;
        }
        all.insert(all.end(), got.begin(), got.end());
    }
    return all;
}

std::size_t open_descriptors()
{
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}));
}

TEST(TermiosSerialPort, IsClosedAndHarmlessBeforeOpen)
{
    TermiosSerialPort port;
    std::array<std::byte, 8> bytes{};
    EXPECT_EQ(port.health().state, PortState::closed);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.read(bytes), 0U);
    EXPECT_EQ(port.write(bytes), 0U);
    EXPECT_EQ(port.health().bytes_refused, 8U);
    port.service(0);
    port.close();
    EXPECT_EQ(port.health().state, PortState::closed);
    EXPECT_EQ(port.health().open_failures, 0U);
    EXPECT_EQ(port.actual_baud(), 0U);
}

TEST(TermiosSerialPort, CarriesRandomBytesBothWaysThroughPartialWrites)
{
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Pty peer;
        TermiosSerialPort port;
        ASSERT_EQ(port.open(peer.path(), 921'600, kPortRetry), OpenStatus::ok);

        const auto out = random_bytes(100'000, seed);
        std::vector<std::byte> arrived;
        std::size_t sent = 0;
        std::size_t partial = 0;
        while (arrived.size() < out.size()) {
            const std::size_t taken = port.write(std::span(out).subspan(sent));
            partial += taken < out.size() - sent ? 1U : 0U;
            sent += taken;
            const auto got = peer.read(1000, kPatienceMs);
            ASSERT_FALSE(got.empty());
            arrived.insert(arrived.end(), got.begin(), got.end());
        }
        EXPECT_EQ(arrived, out);
        EXPECT_GT(partial, 0U);
        EXPECT_EQ(port.health().bytes_out, out.size());
        EXPECT_GT(port.health().bytes_refused, 0U);

        const auto in = random_bytes(20'000, seed + 100);
        std::vector<std::byte> received;
        std::size_t given = 0;
        while (received.size() < in.size()) {
            given += peer.write(in.data() + given, std::min<std::size_t>(in.size() - given, 700));
            const auto got = read_all(port, given - received.size());
            ASSERT_FALSE(got.empty());
            received.insert(received.end(), got.begin(), got.end());
        }
        EXPECT_EQ(received, in);
        EXPECT_EQ(port.health().bytes_in, in.size());
        EXPECT_EQ(port.health().state, PortState::open);
        EXPECT_EQ(port.health().read_errors + port.health().write_errors, 0U);
    }
}

// Start, stop, interrupt, end of file, carriage return: a terminal would eat or change each of these.
TEST(TermiosSerialPort, ChangesNoByteValue)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 115'200, kPortRetry), OpenStatus::ok);
    std::vector<std::byte> all(256);
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = static_cast<std::byte>(i);
    }
    ASSERT_EQ(port.write(all), all.size());
    EXPECT_EQ(read_all(peer, all.size()), all);
    ASSERT_EQ(peer.write(all.data(), all.size()), all.size());
    EXPECT_EQ(read_all(port, all.size()), all);
    // No echo: the peer's bytes are not returned.
    EXPECT_TRUE(peer.read(1, 0).empty());
}

class TermiosBaud : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(TermiosBaud, IsSetAsAsked)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), GetParam(), kPortRetry), OpenStatus::ok);
    EXPECT_EQ(port.actual_baud(), GetParam());
    termios2 settings{};
    ASSERT_EQ(test::kernel_ioctl(port.descriptor(), TCGETS2, &settings), 0);
    EXPECT_EQ(settings.c_ospeed, GetParam());
    EXPECT_EQ(settings.c_ispeed, GetParam());
    EXPECT_EQ(settings.c_cflag & (CSIZE | PARENB | CSTOPB | CRTSCTS | HUPCL), static_cast<tcflag_t>(CS8));
    EXPECT_EQ(settings.c_iflag | settings.c_oflag | settings.c_lflag, 0U);
}

INSTANTIATE_TEST_SUITE_P(Rates, TermiosBaud,
                         ::testing::Values(1U, 57'600U, 115'200U, 921'600U, 1'234'567U, 12'000'000U));

TEST(TermiosSerialPort, DescriptorNeitherBlocksNorLeaksIntoChildren)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
    EXPECT_NE(::fcntl(port.descriptor(), F_GETFL) & O_NONBLOCK, 0);
    EXPECT_NE(::fcntl(port.descriptor(), F_GETFD) & FD_CLOEXEC, 0);
}

TEST(TermiosSerialPort, FullBufferTakesLessAndReturns)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 921'600, kPortRetry), OpenStatus::ok);
    const auto flood = random_bytes(1'000'000, 7);
    const std::size_t first = port.write(flood);
    EXPECT_GT(first, 0U);
    EXPECT_LT(first, flood.size());
    EXPECT_EQ(port.health().bytes_out, first);
    EXPECT_EQ(port.health().bytes_refused, flood.size() - first);
    EXPECT_EQ(port.health().write_errors, 0U);
    EXPECT_EQ(port.health().state, PortState::open);
}

TEST(TermiosSerialPort, EmptySpansAreNothing)
{
    Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
    EXPECT_EQ(port.read({}), 0U);
    EXPECT_EQ(port.write({}), 0U);
    peer.hang_up();
    EXPECT_EQ(port.read({}), 0U);
    EXPECT_EQ(port.write({}), 0U);
    EXPECT_EQ(port.health().state, PortState::open);
}

TEST(TermiosSerialPort, ReadNoticesAHangUp)
{
    Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
    std::array<std::byte, 4> bytes{};
    EXPECT_EQ(port.read(bytes), 0U);
    EXPECT_EQ(port.health().state, PortState::open);
    peer.hang_up();
    EXPECT_EQ(port.read(bytes), 0U);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.health().disconnects, 1U);
    EXPECT_EQ(port.descriptor(), -1);
    EXPECT_EQ(port.read(bytes), 0U);
    EXPECT_EQ(port.health().disconnects, 1U);
}

TEST(TermiosSerialPort, WriteNoticesAHangUpAndCountsIt)
{
    Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
    peer.hang_up();
    const std::array<std::byte, 5> bytes{};
    EXPECT_EQ(port.write(bytes), 0U);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.health().write_errors, 1U);
    EXPECT_EQ(port.health().bytes_refused, 5U);
    EXPECT_EQ(port.write(bytes), 0U);
    EXPECT_EQ(port.health().write_errors, 1U);
    EXPECT_EQ(port.health().bytes_refused, 10U);
}

TEST(TermiosSerialPort, ServiceNoticesAHangUp)
{
    const TemporaryFolder folder;
    const std::string link = folder / "fc";
    Pty peer;
    std::filesystem::create_symlink(peer.path(), link);
    TermiosSerialPort port;
    ASSERT_EQ(port.open(link, 57'600, kPortRetry), OpenStatus::ok);
    port.service(0);
    EXPECT_EQ(port.health().state, PortState::open);
    std::filesystem::remove(link);
    peer.hang_up();
    port.service(1);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.health().disconnects, 1U);
}

// The descriptor is closed under the port: the only method to make read() fail without a broken driver.
TEST(TermiosSerialPort, ReadErrorsAreCountedAndLoseThePort)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
    const int directory = ::open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_GE(directory, 0);
    ASSERT_EQ(::dup2(directory, port.descriptor()), port.descriptor());
    ::close(directory);
    std::array<std::byte, 4> bytes{};
    EXPECT_EQ(port.read(bytes), 0U);
    EXPECT_EQ(port.health().read_errors, 1U);
    EXPECT_EQ(port.health().state, PortState::lost);
}

TEST(TermiosSerialPort, FollowsALinkToTheNextDevice)
{
    const TemporaryFolder folder;
    const std::string link = folder / "fc";
    auto first = std::make_unique<Pty>();
    std::filesystem::create_symlink(first->path(), link);
    TermiosSerialPort port;
    ASSERT_EQ(port.open(link, 921'600, kPortRetry), OpenStatus::ok);

    std::filesystem::remove(link);
    first.reset();
    port.service(1'000'000);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.open_status(), OpenStatus::no_device);
    EXPECT_EQ(port.health().open_failures, 1U);
    port.service(1'000'000 + kPortRetry - 1);
    EXPECT_EQ(port.health().open_failures, 1U);
    port.service(1'000'000 + kPortRetry);
    EXPECT_EQ(port.health().open_failures, 2U);

    const Pty second;
    std::filesystem::create_symlink(second.path(), link);
    port.service(1'000'000 + 2 * kPortRetry - 1);
    EXPECT_EQ(port.health().state, PortState::lost);
    port.service(1'000'000 + 2 * kPortRetry);
    EXPECT_EQ(port.health().state, PortState::open);
    EXPECT_EQ(port.open_status(), OpenStatus::ok);
    EXPECT_EQ(port.health().reconnects, 1U);
    EXPECT_EQ(port.actual_baud(), 921'600U);

    const auto sent = random_bytes(100, 3);
    ASSERT_EQ(second.write(sent.data(), sent.size()), sent.size());
    EXPECT_EQ(read_all(port, sent.size()), sent);
    EXPECT_EQ(port.health().bytes_in, 100U);
}

// A loose plug: each loss is followed by an attempt at once, however short ago the last one was.
TEST(TermiosSerialPort, ComesBackAtOnceWhenTheDeviceIsThereAgain)
{
    const TemporaryFolder folder;
    const std::string link = folder / "fc";
    std::array<Pty, 4> devices;
    std::filesystem::create_symlink(devices[0].path(), link);
    TermiosSerialPort port;
    ASSERT_EQ(port.open(link, 921'600, kPortRetry), OpenStatus::ok);
    for (std::size_t i = 1; i < devices.size(); ++i) {
        std::filesystem::remove(link);
        std::filesystem::create_symlink(devices[i].path(), link);
        devices[i - 1].hang_up();
        port.service(static_cast<std::int64_t>(i));
        EXPECT_EQ(port.health().state, PortState::open);
        EXPECT_EQ(port.health().disconnects, i);
        EXPECT_EQ(port.health().reconnects, i);
    }
}

TEST(TermiosSerialPort, WaitsForADeviceThatWasNeverThere)
{
    const TemporaryFolder folder;
    const std::string link = folder / "fc";
    TermiosSerialPort port;
    EXPECT_EQ(port.open(link, 57'600, kPortRetry), OpenStatus::no_device);
    EXPECT_EQ(port.health().state, PortState::lost);
    EXPECT_EQ(port.health().open_failures, 1U);
    EXPECT_EQ(port.health().disconnects, 0U);
    const Pty peer;
    std::filesystem::create_symlink(peer.path(), link);
    port.service(-5);
    EXPECT_EQ(port.health().state, PortState::open);
}

TEST(TermiosSerialPort, CloseEndsTheRetries)
{
    const TemporaryFolder folder;
    TermiosSerialPort port;
    EXPECT_EQ(port.open(folder / "fc", 57'600, kPortRetry), OpenStatus::no_device);
    port.close();
    port.service(10 * kPortRetry);
    EXPECT_EQ(port.health().state, PortState::closed);
    EXPECT_EQ(port.health().open_failures, 1U);
}

TEST(TermiosSerialPort, CloseWithUnsentBytesReturns)
{
    const Pty peer;
    TermiosSerialPort port;
    ASSERT_EQ(port.open(peer.path(), 300, kPortRetry), OpenStatus::ok);
    EXPECT_GT(port.write(random_bytes(100'000, 9)), 0U);
    port.close();
    EXPECT_EQ(port.health().state, PortState::closed);
}

TEST(TermiosSerialPort, ManyReconnectsKeepNoDescriptor)
{
    const TemporaryFolder folder;
    const std::string link = folder / "fc";
    const std::size_t before = open_descriptors();
    {
        TermiosSerialPort port;
        EXPECT_EQ(port.open(link, 57'600, kPortRetry), OpenStatus::no_device);
        for (std::int64_t i = 0; i < 100; ++i) {
            {
                const Pty peer;
                std::filesystem::create_symlink(peer.path(), link);
                port.service(2 * i * kPortRetry);
                ASSERT_EQ(port.health().state, PortState::open);
            }
            std::filesystem::remove(link);
            port.service((2 * i + 1) * kPortRetry);
            ASSERT_EQ(port.health().state, PortState::lost);
        }
        EXPECT_EQ(port.health().reconnects, 100U);
        EXPECT_EQ(port.health().disconnects, 100U);
        EXPECT_EQ(open_descriptors(), before);
        const Pty peer;
        EXPECT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
        EXPECT_EQ(port.open(peer.path(), 57'600, kPortRetry), OpenStatus::ok);
        EXPECT_EQ(open_descriptors(), before + 2);
    }
    EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace jink::hal
