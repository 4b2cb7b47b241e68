// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/termios_serial_port.hpp"

#include <cassert>
#include <cerrno>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

// The kernel's own termios2: the C library's <termios.h> has fixed rates only and would clash with it.
#include <asm/termbits.h>
#include <linux/serial.h>

namespace jink::hal {

namespace {

// A receiver samples its last bit 9.5 bit times after the start edge: 5 % of tolerance between both ends, half of it
// for each.
constexpr std::uint64_t kBaudTolerancePerMille = 25;

OpenStatus cause_of(int error) noexcept
{
    switch (error) {
    case ENOENT:
    case ENOTDIR:
    case ENODEV:
    case ENXIO: return OpenStatus::no_device;
    case EACCES:
    case EPERM:
    case EBUSY: return OpenStatus::access_denied;
    case EISDIR:
    case ENOTTY: return OpenStatus::not_a_serial_device;
    default: return OpenStatus::failed;
    }
}

bool is_near(std::uint32_t actual, std::uint32_t wanted) noexcept
{
    const std::uint64_t off = actual > wanted ? actual - wanted : wanted - actual;
    return off * 1000U <= wanted * kBaudTolerancePerMille;
}

}  // namespace

TermiosSerialPort::~TermiosSerialPort() { release(); }

OpenStatus TermiosSerialPort::open(std::string_view path, std::uint32_t baud, std::int64_t retry_period_us) noexcept
{
    assert(retry_period_us > 0);
    close();
    if (path.empty() || path.size() >= kMaxDevicePath) {
        open_status_ = OpenStatus::bad_path;
        return open_status_;
    }
    if (baud == 0) {
        open_status_ = OpenStatus::bad_baud;
        return open_status_;
    }
    path.copy(path_.data(), path.size());
    path_[path.size()] = '\0';
    baud_ = baud;
    retry_period_us_ = retry_period_us;
    attempt_at_once_ = true;
    open_status_ = try_open();
    health_.state = open_status_ == OpenStatus::ok ? PortState::open : PortState::lost;
    return open_status_;
}

void TermiosSerialPort::close() noexcept
{
    release();
    health_.state = PortState::closed;
}

void TermiosSerialPort::service(std::int64_t now_us) noexcept
{
    if (health_.state == PortState::open) {
        pollfd waiting{descriptor_, 0, 0};
        if (::poll(&waiting, 1, 0) > 0) {
            lose();
        } else {
            count_line_errors();
        }
    }
    if (health_.state != PortState::lost || (!attempt_at_once_ && now_us < next_attempt_us_)) {
        return;
    }
    attempt_at_once_ = false;
    next_attempt_us_ = now_us + retry_period_us_;
    open_status_ = try_open();
    if (open_status_ == OpenStatus::ok) {
        health_.state = PortState::open;
        ++health_.reconnects;
    }
}

std::size_t TermiosSerialPort::read(std::span<std::byte> into) noexcept
{
    std::size_t count = 0;
    while (health_.state == PortState::open && count < into.size()) {
        const ssize_t got = ::read(descriptor_, into.data() + count, into.size() - count);
        if (got > 0) {
            count += static_cast<std::size_t>(got);
        } else if (got == 0) {
            lose();  // with VMIN = 1, no data is EAGAIN; zero is the end of the line
        } else if (errno == EAGAIN || errno == EINTR) {
            break;
        } else {
            ++health_.read_errors;
            lose();
        }
    }
    health_.bytes_in += count;
    return count;
}

std::size_t TermiosSerialPort::write(std::span<const std::byte> from) noexcept
{
    std::size_t count = 0;
    while (health_.state == PortState::open && count < from.size()) {
        const ssize_t put = ::write(descriptor_, from.data() + count, from.size() - count);
        if (put > 0) {
            count += static_cast<std::size_t>(put);
        } else if (put == 0 || errno == EAGAIN || errno == EINTR) {
            break;
        } else {
            ++health_.write_errors;
            lose();
        }
    }
    health_.bytes_out += count;
    health_.bytes_refused += from.size() - count;
    return count;
}

OpenStatus TermiosSerialPort::try_open() noexcept
{
    descriptor_ = ::open(path_.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    // Two programs on a line would each get a part of its bytes. The lock ends with the descriptor; TIOCEXCL would
    // outlive a program that is killed, and root passes it.
    if (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ++health_.open_failures;
        (void)::close(descriptor_);  // not release(): the bytes that it would discard are the other program's
        descriptor_ = -1;
        return OpenStatus::access_denied;
    }
    const OpenStatus status = descriptor_ < 0 ? cause_of(errno) : configure();
    if (status != OpenStatus::ok) {
        ++health_.open_failures;
        release();
        return status;
    }
    has_line_counts_ = line_counts(line_counts_);
    return OpenStatus::ok;
}

OpenStatus TermiosSerialPort::configure() noexcept
{
    termios2 settings{};
    if (::ioctl(descriptor_, TCGETS2, &settings) != 0) {
        return cause_of(errno);
    }
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    // No HUPCL: dropping DTR at close resets many flight controllers' USB bridges.
    settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (static_cast<tcflag_t>(BOTHER) << IBSHIFT);
    settings.c_ispeed = baud_;
    settings.c_ospeed = baud_;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    // The call succeeds if any one setting was made, so the result is read back.
    termios2 actual{};
    if (::ioctl(descriptor_, TCSETS2, &settings) != 0 || ::ioctl(descriptor_, TCGETS2, &actual) != 0) {
        return OpenStatus::settings_refused;
    }
    const bool is_8n1 = (actual.c_cflag & (CSIZE | PARENB | CSTOPB | CRTSCTS)) == CS8;
    if (!is_8n1 || !is_near(actual.c_ospeed, baud_) || !is_near(actual.c_ispeed, baud_)) {
        return OpenStatus::settings_refused;
    }
    actual_baud_ = actual.c_ospeed;
    return OpenStatus::ok;
}

bool TermiosSerialPort::line_counts(LineCounts& counts) const noexcept
{
    serial_icounter_struct driver{};
    if (::ioctl(descriptor_, TIOCGICOUNT, &driver) != 0) {
        return false;  // ptys and some USB drivers have no such counters
    }
    counts.overruns = static_cast<std::uint32_t>(driver.overrun) + static_cast<std::uint32_t>(driver.buf_overrun);
    counts.errors = static_cast<std::uint32_t>(driver.frame) + static_cast<std::uint32_t>(driver.parity) +
                    static_cast<std::uint32_t>(driver.brk);
    return true;
}

void TermiosSerialPort::count_line_errors() noexcept
{
    LineCounts now{};
    if (has_line_counts_ && line_counts(now)) {
        // 32-bit differences: right across the wrap of the driver's counters.
        health_.overruns += now.overruns - line_counts_.overruns;
        health_.line_errors += now.errors - line_counts_.errors;
        line_counts_ = now;
    }
}

std::size_t TermiosSerialPort::unsent() const noexcept
{
    int held = 0;
    const bool known = descriptor_ >= 0 && ::ioctl(descriptor_, TIOCOUTQ, &held) == 0 && held > 0;
    return known ? static_cast<std::size_t>(held) : 0;
}

void TermiosSerialPort::release() noexcept
{
    if (descriptor_ >= 0) {
        // Without the flush, close() would wait until a real UART has sent its buffer, up to 30 s by the kernel's
        // default.
        (void)::ioctl(descriptor_, TCFLSH, TCIOFLUSH);
        (void)::close(descriptor_);
        descriptor_ = -1;
    }
}

void TermiosSerialPort::lose() noexcept
{
    release();
    health_.state = PortState::lost;
    ++health_.disconnects;
    attempt_at_once_ = true;
}

}  // namespace jink::hal
