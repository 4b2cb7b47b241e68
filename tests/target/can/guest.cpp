// SPDX-License-Identifier: BSD-3-Clause
// The first and only process of a guest: loads the CAN modules, sets interfaces up, tries SocketCanPort against the
// real kernel, says RESULT PASS or RESULT FAIL, and switches the machine off.
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/reboot.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "hal/linux/socket_can_port.hpp"
#include "tests/target/can/check.hpp"
#include "tests/target/can/daemon.hpp"
#include "tests/target/can/netlink.hpp"

namespace {

using namespace jink::hal;
using jink::target::Netlink;

int failures = 0;
int checks = 0;

std::int64_t now_us()
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000 + t.tv_nsec / 1000;
}

void wait_ms(long ms)
{
    const timespec t{ms / 1000, ms % 1000 * 1'000'000};
    ::nanosleep(&t, nullptr);
}

bool load(const char* module)
{
    const std::string path = std::string("/modules/") + module + ".ko";
    const int file = ::open(path.c_str(), O_RDONLY);
    const bool ok = file >= 0 && ::syscall(SYS_finit_module, file, "", 0) == 0;
    std::printf("module %s: %s\n", module, ok ? "loaded" : std::strerror(errno));
    ::close(file);
    return ok;
}

CanFrame frame(std::uint32_t id, bool extended, std::size_t length, unsigned first = 0)
{
    CanFrame f;
    f.id = id;
    f.extended = extended;
    f.fd = length > 8;
    f.length = static_cast<std::uint8_t>(length);
    for (std::size_t i = 0; i < length; ++i) {
        f.data[i] = static_cast<std::byte>(first + i);
    }
    return f;
}

bool same(const CanFrame& a, const CanFrame& b)
{
    return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.fd == b.fd && a.length == b.length &&
           a.bit_rate_switch == b.bit_rate_switch && std::memcmp(a.data.data(), b.data.data(), a.length) == 0;
}

/// With a short time-out: the other end may be another controller.
bool receive_soon(SocketCanPort& port, CanFrame& f)
{
    for (int i = 0; i < 200; ++i) {
        if (port.receive(f)) {
            return true;
        }
        wait_ms(1);
    }
    return false;
}

/// A plain socket that can send error frames, which the port must not.
int raw_socket(const char* interface)
{
    const int s = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
    EXPECT(::bind(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    return s;
}

void inject_error(int socket, std::uint32_t cause, std::uint8_t controller = 0)
{
    can_frame f{};
    f.can_id = CAN_ERR_FLAG | cause;
    f.can_dlc = CAN_ERR_DLC;
    f.data[1] = controller;
    EXPECT(::write(socket, &f, sizeof f) == static_cast<ssize_t>(sizeof f));
}

void try_frames()
{
    std::printf("frames\n");
    SocketCanPort a;
    SocketCanPort b;
    SocketCanPort classic;
    EXPECT(a.open("vcan0", {true, {}, 0}, 1000) == CanOpenStatus::ok);
    EXPECT(b.open("vcan0", {true, {}, 0}, 1000) == CanOpenStatus::ok);
    EXPECT(classic.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(a.health().state == CanState::active);
    CanFrame got;
    EXPECT(!b.receive(got));
    for (const std::size_t length : {0U, 1U, 7U, 8U, 12U, 16U, 20U, 24U, 32U, 48U, 64U}) {
        for (const bool extended : {false, true}) {
            CanFrame f = frame(extended ? 0x1855962A : 0x7FF, extended, length, 3);
            f.bit_rate_switch = f.fd;
            EXPECT(a.send(f));
            EXPECT(b.receive(got) && same(got, f));
            EXPECT(!a.receive(got));  // no echo of one's own
            EXPECT(classic.receive(got) == !f.fd);
        }
    }
    CanFrame remote = frame(0x123, false, 0);
    remote.remote = true;
    EXPECT(a.send(remote));
    EXPECT(b.receive(got) && same(got, remote));
    // Invalid frames.
    EXPECT(!a.send(frame(0x800, false, 1)));
    EXPECT(!a.send(frame(0x20000000, true, 1)));
    CanFrame odd = frame(1, false, 12);
    odd.length = 13;
    EXPECT(!a.send(odd));
    EXPECT(a.health().frames_bad == 3);
    EXPECT(!classic.send(frame(1, false, 64)));  // FD through a port that is not
    EXPECT(classic.health().frames_bad == 1);
    EXPECT(a.health().frames_out == 23 && b.health().frames_in == 23);
}

void try_filters()
{
    std::printf("filters\n");
    const std::array<CanFilter, 2> filters{{{0x10, 0x7F0, false}, {0x1855962A, 0x1FFFFFFF, true}}};
    SocketCanPort a;
    SocketCanPort b;
    EXPECT(a.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(b.open("vcan0", {false, filters, 0}, 1000) == CanOpenStatus::ok);
    CanFrame got;
    for (const std::uint32_t id : {0x10U, 0x1FU, 0x20U, 0x7FFU}) {
        EXPECT(a.send(frame(id, false, 1)));
        EXPECT(b.receive(got) == (id < 0x20));
    }
    EXPECT(a.send(frame(0x1855962A, true, 1)));
    EXPECT(b.receive(got));
    EXPECT(a.send(frame(0x10, true, 1)));  // the same number, but 29 bits
    EXPECT(!b.receive(got));
    const std::array<CanFilter, kMaxCanFilters + 1> many{};
    EXPECT(b.open("vcan0", {false, many, 0}, 1000) == CanOpenStatus::too_many_filters);
    EXPECT(b.health().state == CanState::closed);
}

void try_overrun()
{
    std::printf("overrun\n");
    SocketCanPort a;
    SocketCanPort b;
    EXPECT(a.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(b.open("vcan0", {false, {}, 1}, 1000) == CanOpenStatus::ok);  // the least buffer there is
    for (unsigned i = 0; i < 100; ++i) {
        EXPECT(a.send(frame(1, false, 4, i)));
    }
    CanFrame got;
    std::uint64_t received = 0;
    while (b.receive(got)) {
        ++received;
    }
    // The kernel reports a loss with the next frame that fits into the queue.
    EXPECT(a.send(frame(2, false, 0)));
    EXPECT(b.receive(got));
    EXPECT(received > 0 && received < 100);
    EXPECT(received + b.health().overruns == 100);
    std::printf("  %llu of 100 received, %llu counted as lost\n", static_cast<unsigned long long>(received),
                static_cast<unsigned long long>(b.health().overruns));
}

void try_errors()
{
    std::printf("errors\n");
    SocketCanPort a;
    EXPECT(a.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    const int injector = raw_socket("vcan0");
    CanFrame got;
    inject_error(injector, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    EXPECT(!a.receive(got));
    EXPECT(a.health().state == CanState::error_passive);
    inject_error(injector, CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    inject_error(injector, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
    inject_error(injector, CAN_ERR_ACK);
    inject_error(injector, CAN_ERR_PROT | CAN_ERR_BUSERROR);
    EXPECT(!a.receive(got));
    EXPECT(a.health().state == CanState::active);
    EXPECT(a.health().overruns == 1);
    EXPECT(a.health().bus_errors == 2);
    inject_error(injector, CAN_ERR_BUSOFF);
    EXPECT(!a.receive(got));
    EXPECT(a.health().state == CanState::bus_off);
    EXPECT(!a.send(frame(1, false, 0)));
    EXPECT(a.health().frames_refused == 1);
    inject_error(injector, CAN_ERR_RESTARTED);
    EXPECT(!a.receive(got));
    EXPECT(a.health().state == CanState::active);
    EXPECT(a.health().bus_offs == 1 && a.health().restarts == 1);
    EXPECT(a.send(frame(1, false, 0)));
    // A frame behind many errors is not lost.
    for (int i = 0; i < 40; ++i) {
        inject_error(injector, CAN_ERR_ACK);
    }
    SocketCanPort b;
    EXPECT(b.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(b.send(frame(0x42, false, 1)));
    EXPECT(a.receive(got) && got.id == 0x42);
    ::close(injector);
}

void try_down_and_up(Netlink& links)
{
    std::printf("down and up\n");
    SocketCanPort a;
    SocketCanPort b;
    EXPECT(a.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(b.open("vcan0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(links.set_up("vcan0", false) == 0);
    CanFrame got;
    EXPECT(!a.send(frame(1, false, 0)));
    EXPECT(a.health().state == CanState::down && a.health().write_errors == 1);
    EXPECT(!b.receive(got));
    EXPECT(b.health().state == CanState::down && b.health().downs == 1);
    EXPECT(links.set_up("vcan0", true) == 0);
    a.service(now_us());
    b.service(now_us());
    EXPECT(a.health().state == CanState::active && a.health().ups == 1);
    EXPECT(a.send(frame(7, false, 0)));
    EXPECT(b.receive(got) && got.id == 7);

    // Deleted, and another of its name made.
    EXPECT(links.remove("vcan0") == 0);
    a.service(now_us());
    b.service(now_us());
    EXPECT(a.health().state == CanState::down);
    EXPECT(!a.send(frame(1, false, 0)));
    wait_ms(5);
    a.service(now_us());
    EXPECT(a.open_status() == CanOpenStatus::no_interface);
    EXPECT(links.add_vcan("vcan0") == 0);
    EXPECT(links.set_mtu("vcan0", CANFD_MTU) == 0);
    EXPECT(links.set_up("vcan0", true) == 0);
    wait_ms(5);
    a.service(now_us());
    b.service(now_us());
    EXPECT(a.health().state == CanState::active && b.health().state == CanState::active);
    EXPECT(a.send(frame(9, false, 0)));
    EXPECT(b.receive(got) && got.id == 9);
}

void try_refusals(Netlink& links)
{
    std::printf("refusals\n");
    SocketCanPort a;
    EXPECT(a.open("", {}, 1000) == CanOpenStatus::bad_name);
    EXPECT(a.open("an_interface_with_a_long_name", {}, 1000) == CanOpenStatus::bad_name);
    EXPECT(a.open("nothing0", {}, 1000) == CanOpenStatus::no_interface);
    EXPECT(a.health().state == CanState::down);  // it may come
    EXPECT(a.open("lo", {}, 1000) == CanOpenStatus::not_can);
    EXPECT(a.health().state == CanState::closed);
    EXPECT(links.add_vcan("vcan1") == 0);
    EXPECT(links.set_mtu("vcan1", CAN_MTU) == 0);
    EXPECT(a.open("vcan1", {true, {}, 0}, 1000) == CanOpenStatus::no_fd);
    EXPECT(a.open("vcan1", {}, 1000) == CanOpenStatus::ok);
    EXPECT(a.health().state == CanState::down);  // not up yet
    EXPECT(links.set_up("vcan1", true) == 0);
    a.service(now_us());
    EXPECT(a.health().state == CanState::active);
    a.close();
    CanFrame got;
    EXPECT(!a.receive(got) && !a.send(frame(1, false, 0)));
    EXPECT(a.health().state == CanState::closed);
}

/// Two kvaser_pci cards on one emulated bus: tests a real driver and controller (SJA1000).
void try_controllers(Netlink& links)
{
    std::printf("two controllers on one bus\n");
    for (const char* name : {"can0", "can1"}) {
        EXPECT(::if_nametoindex(name) != 0);
        EXPECT(links.set_bit_rate(name, 500'000, 100) == 0);
        EXPECT(links.set_up(name, true) == 0);
    }
    SocketCanPort a;
    SocketCanPort b;
    EXPECT(a.open("can0", {}, 1000) == CanOpenStatus::ok);
    EXPECT(b.open("can1", {}, 1000) == CanOpenStatus::ok);
    EXPECT(a.open_status() == CanOpenStatus::ok && a.health().state == CanState::active);
    CanFrame got;
    for (unsigned i = 0; i < 50; ++i) {
        const CanFrame f = frame(0x1000 + i, true, i % 9, i);
        EXPECT(a.send(f));
        EXPECT(receive_soon(b, got) && same(got, f));
        EXPECT(b.send(f));
        EXPECT(receive_soon(a, got) && same(got, f));
    }
    // An unread burst: losses in the controller or the socket's queue are reported, and received frames are whole and
    // in order.
    unsigned sent = 0;
    for (unsigned i = 0; i < 2000; ++i) {
        CanFrame f = frame(i, true, 8);
        std::memcpy(f.data.data(), &i, sizeof i);
        sent += a.send(f) ? 1U : 0U;
    }
    unsigned received = 0;
    unsigned out_of_order = 0;
    std::uint32_t last = 0;
    while (receive_soon(b, got)) {
        std::uint32_t i = 0;
        std::memcpy(&i, got.data.data(), sizeof i);
        EXPECT(got.id == i);
        out_of_order += received > 0 && i <= last ? 1U : 0U;
        last = i;
        ++received;
    }
    EXPECT(a.send(frame(2000, true, 0)));  // the kernel reports a loss with the next frame that fits into the queue
    EXPECT(receive_soon(b, got) && got.id == 2000);
    std::printf("  burst: %u taken of 2000, %u refused, %u arrived, %llu overruns told\n", sent,
                static_cast<unsigned>(a.health().frames_refused), received,
                static_cast<unsigned long long>(b.health().overruns));
    EXPECT(sent + a.health().frames_refused == 2000);
    EXPECT(received > 0 && received <= sent && out_of_order == 0);
    EXPECT(received + b.health().overruns >= sent);
}

}  // namespace

void jink::target::expect(bool ok, const char* what, int line)
{
    ++checks;
    if (!ok) {
        ++failures;
        std::printf("FAILED line %d: %s\n", line, what);
    }
}

int main()
{
    ::mount("none", "/dev", "devtmpfs", 0, nullptr);
    std::setvbuf(stdout, nullptr, _IONBF, 0);
    bool loaded = true;
    for (const char* module : {"can", "can-raw", "can-dev", "vcan"}) {
        loaded = load(module) && loaded;
    }
    const bool controllers = load("sja1000") && load("kvaser_pci");
    EXPECT(loaded);
    EXPECT(controllers);
    Netlink links;
    EXPECT(links.set_up("lo", true) == 0);
    EXPECT(links.add_vcan("vcan0") == 0);
    EXPECT(links.set_mtu("vcan0", CANFD_MTU) == 0);
    EXPECT(links.set_up("vcan0", true) == 0);
    try_frames();
    try_filters();
    try_overrun();
    try_errors();
    try_down_and_up(links);
    try_refusals(links);
    try_controllers(links);
    const bool daemon =
        jink::target::try_daemon(links, "vcan0") && (!controllers || jink::target::try_daemon(links, "can0"));
    std::printf("jinkd: %s\n", daemon ? "tried" : "not here, not tried");
    std::printf("%d checks, %d failed\nRESULT %s\n", checks, failures, failures == 0 ? "PASS" : "FAIL");
    ::sync();
    ::reboot(RB_POWER_OFF);
}
