// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/can/daemon.hpp"

#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "firmware/app/can_frame.hpp"
#include "firmware/link/dronecan/node.hpp"
#include "firmware/link/dronecan/tunnel.hpp"
#include "firmware/link/mavlink/codec.hpp"
#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "hal/linux/socket_can_port.hpp"
#include "tests/target/can/check.hpp"

namespace jink::target {
namespace {

namespace can = link::dronecan;
namespace mav = link::mavlink;

constexpr std::uint8_t kUs = 10;
constexpr std::uint8_t kJinkd = 42;
constexpr long kTickMs = 20;

std::int64_t now_us()
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000 + t.tv_nsec / 1000;
}

can::NodeOptions our_node()
{
    can::NodeOptions options;
    options.node = kUs;
    return options;
}

/// The autopilot's end of the bus.
class Peer {
public:
    explicit Peer(const char* interface)
    {
        EXPECT(port_.open(interface, {}, 1000) == hal::CanOpenStatus::ok);
        answers_.set_node(kUs);
    }

    /// One tick: records received transfers, sends an autopilot's telemetry.
    void tick()
    {
        const TimePoint now{now_us()};
        port_.service(now.us);
        hal::CanFrame got;
        while (port_.receive(got)) {
            take(got, now);
        }
        read_mavlink();
        node_.service(now, link::SystemState::active);
        if (speaks && node_.outgoing().front() == nullptr) {
            send_telemetry(now);
        }
        while (const can::Frame* const frame = node_.outgoing().front()) {
            if (!send(*frame)) {
                break;
            }
            node_.outgoing().pop();
        }
        const timespec t{0, kTickMs * 1'000'000};
        ::nanosleep(&t, nullptr);
    }
    template <class Done>
    bool until(Done done, int ticks = 500)
    {
        for (int i = 0; i < ticks && !done(); ++i) {
            tick();
        }
        return done();
    }
    void tick_for(int ticks)
    {
        until([] { return false; }, ticks);
    }

    template <can::Described M>
    void ask(const M& message)
    {
        std::array<std::byte, can::kMaxPayload> payload{};
        std::size_t size = 0;
        EXPECT(can::encode(message, std::span(payload).first(M::kType.max_length), size) == can::CodecStatus::ok);
        can::TransmitQueue queue;
        EXPECT(queue.push({M::kType, can::Priority::medium, kUs, kJinkd, static_cast<std::uint8_t>(transfer_++ % 32)},
                          std::span(payload).first(size)));
        for (; queue.front() != nullptr; queue.pop()) {
            EXPECT(send(*queue.front()));
        }
    }

    bool speaks = true;
    std::vector<TimePoint> statuses;
    can::NodeStatus status;
    can::GetNodeInfoResponse info;
    can::GetSetResponse param;
    bool has_info = false;
    bool has_param = false;
    int heartbeats = 0;
    std::uint8_t state = 0;  ///< of the newest

private:
    void take(const hal::CanFrame& got, TimePoint now)
    {
        const can::Frame frame = app::from_port(got);
        if (const can::Transfer* const t = node_.receive(frame, now)) {
            tunnel_.receive(node_, *t);
        }
        const can::Transfer* const t = answers_.accept(frame, now);
        if (t == nullptr || t->source != kJinkd) {
            return;
        }
        if (t->type.id == can::NodeStatus::kType.id && can::decode(t->payload, status) == can::CodecStatus::ok) {
            statuses.push_back(now);
        } else if (t->type.id == can::GetNodeInfoResponse::kType.id) {
            has_info = can::decode(t->payload, info) == can::CodecStatus::ok;
        } else if (t->type.id == can::GetSetResponse::kType.id) {
            has_param = can::decode(t->payload, param) == can::CodecStatus::ok;
        }
    }

    void read_mavlink()
    {
        std::array<std::byte, 1024> buffer{};
        std::span<const std::byte> bytes = std::span(buffer).first(tunnel_.read(buffer));
        while (const auto frame = parser_.next(bytes)) {
            mav::Heartbeat m;
            if (mav::decode(*frame, m) && frame->header.component_id == 196) {
                ++heartbeats;
                state = m.system_status;
            }
        }
    }

    template <mav::Message M>
    void write(const M& message)
    {
        std::array<std::byte, mav::kMaxFrame> frame{};
        const std::size_t size = mav::encode(message, mav::Header{1, 1, sequence_++}, frame);
        EXPECT(tunnel_.write(node_, std::span(frame).first(size)) == size);
    }

    void send_telemetry(TimePoint now)
    {
        if (ticks_++ % 25 == 0) {
            mav::Heartbeat heartbeat;
            heartbeat.type = 2;
            heartbeat.autopilot = 3;
            heartbeat.base_mode = 1;
            heartbeat.custom_mode = 5;
            write(heartbeat);
        }
        mav::LocalPositionNed own;
        own.time_boot_ms = static_cast<std::uint32_t>(now.us / 1000);
        own.z = -30.0F;
        write(own);
    }

    bool send(const can::Frame& frame) { return port_.send(app::to_port(frame)); }

    static constexpr std::array kAnswers{can::NodeStatus::kType, can::GetNodeInfoResponse::kType,
                                         can::GetSetResponse::kType};
    hal::SocketCanPort port_;
    can::Node node_{our_node()};
    can::Tunnel tunnel_{can::TunnelOptions{kJinkd, 0}};
    can::Receiver answers_{kAnswers};
    mav::Parser parser_;
    std::uint8_t transfer_ = 0;
    std::uint8_t sequence_ = 0;
    int ticks_ = 0;
};

can::GetSetRequest set_request(std::string_view name, float value)
{
    can::GetSetRequest m;
    for (const char c : name) {
        m.name.unchecked_push_back(static_cast<std::uint8_t>(c));
    }
    m.value.tag = can::ParamValue::Tag::real;
    m.value.real = value;
    return m;
}

void try_node(Peer& peer)
{
    EXPECT(peer.until([&] { return !peer.statuses.empty(); }));
    peer.statuses.clear();
    peer.tick_for(200);
    // At least four seconds: one status each, for any load of the host, and one more for a change of state.
    EXPECT(peer.statuses.size() >= 3);
    bool quick = false;
    for (std::size_t i = 2; i < peer.statuses.size(); ++i) {
        quick = quick || peer.statuses[i] - peer.statuses[i - 2] < 0.9F;
    }
    EXPECT(!quick);
    peer.ask(can::GetNodeInfoRequest{});
    EXPECT(peer.until([&] { return peer.has_info; }));
    EXPECT(std::string(peer.info.name.begin(), peer.info.name.end()) == "org.jink.coprocessor");
    for (const auto& [asked, stands] : {std::pair{12.0F, 12.0F}, std::pair{1000.0F, 12.0F}}) {
        peer.has_param = false;
        peer.ask(set_request("JNK_LOOKAHEAD", asked));
        EXPECT(peer.until([&] { return peer.has_param; }));
        EXPECT(peer.param.value.tag == can::ParamValue::Tag::real && peer.param.value.real == stands);
        EXPECT(peer.param.initial.real == 8.0F);
    }
}

void try_mavlink(Peer& peer, Netlink& links, const char* interface)
{
    constexpr std::uint8_t kStandby = 3;
    EXPECT(peer.until([&] { return peer.state == kStandby; }));
    EXPECT(peer.status.mode == can::Mode::operational && peer.status.health == can::Health::ok);
    EXPECT(links.set_up(interface, false) == 0);
    peer.tick_for(25);
    const int before = peer.heartbeats;
    peer.tick_for(25);
    EXPECT(peer.heartbeats == before);
    EXPECT(links.set_up(interface, true) == 0);
    peer.statuses.clear();
    EXPECT(peer.until([&] { return peer.heartbeats > before && peer.state == kStandby && !peer.statuses.empty(); }));
    // Without an autopilot: continues as a node, and reports the missing autopilot.
    peer.speaks = false;
    EXPECT(peer.until([&] { return peer.status.health == can::Health::error; }));
    EXPECT(peer.status.vendor_status != 0);
}

std::string text_of(const char* path)
{
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

bool try_daemon(Netlink& links, const char* interface)
{
    constexpr const char* kProgram = "/jinkd";
    if (::access(kProgram, X_OK) != 0) {
        return false;
    }
    std::printf("jinkd on %s\n", interface);
    const std::string summary = std::string("/summary_").append(interface).append(".json");
    const pid_t child = ::fork();
    if (child == 0) {
        ::execl(kProgram, kProgram, "--can", interface, "--node-id", "42", "--quiet", "--summary", summary.c_str(),
                nullptr);
        ::_exit(127);
    }
    Peer peer(interface);
    try_node(peer);
    try_mavlink(peer, links, interface);
    EXPECT(::kill(child, SIGTERM) == 0);
    int status = -1;
    EXPECT(::waitpid(child, &status, 0) == child);
    EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    const std::string said = text_of(summary.c_str());
    EXPECT(said.find("\"node\": 42, \"tunnel_peer\": 10") != std::string::npos);
    EXPECT(said.find("\"downs\": 1, \"ups\": 1") != std::string::npos);
    EXPECT(said.find("\"params_set\": 1, \"params_refused\": 1") != std::string::npos);
    std::printf("%s", said.c_str());
    return true;
}

}  // namespace jink::target
