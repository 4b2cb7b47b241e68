// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor with a CanBus: frames, the controller's state and time come from the input, MAVLink goes through the
// tunnel or over a serial line. First byte: 1 MAVLink through the tunnel, 2 near objects are reported. Then records,
// the first byte modulo 6 saying which:
//   0 raw frame [flags][id 4][length][data 8]   1 transfer [type][source][id][length][payload]   2 ticks [n]
//   3 controller [state][space]   4 no step for [n] * 10 ms   5 an autopilot speaks [bits]
// Checked after each step: nothing is steered in a fault or without an autopilot, own state is finite, output is valid,
// and set-points are recent; the work of a step is bounded and counters only grow.
#include <array>
#include <cmath>
#include <memory>

#include "tests/fuzz/check.hpp"
#include "tests/unit/app/bus_bench.hpp"

using namespace jink;
using namespace jink::app;
using namespace jink::app::test;

namespace {

constexpr int kMaxSteps = 300;
constexpr std::uint8_t kAutopilotNode = 10;

class Port final : public hal::CanPort {
public:
    bool receive(hal::CanFrame& frame) noexcept override
    {
        if (next >= in.size()) {
            in.clear();
            next = 0;
            return false;
        }
        ++taken;
        frame = in[next++];
        return true;
    }
    bool send(const hal::CanFrame& frame) noexcept override
    {
        JINK_FUZZ_CHECK(hal::is_valid(frame) && frame.extended && !frame.remote && frame.length >= 1);
        const bool takes = state == hal::CanState::active || state == hal::CanState::error_passive;
        if (!takes || room == 0) {
            return false;
        }
        --room;
        out.push_back(frame);
        return true;
    }
    hal::CanHealth health() const noexcept override
    {
        hal::CanHealth health;
        health.state = state;
        return health;
    }

    std::vector<hal::CanFrame> in;
    std::size_t next = 0;
    std::size_t taken = 0;
    std::vector<hal::CanFrame> out;
    std::size_t room = 1000;
    hal::CanState state = hal::CanState::active;
};

class Run {
public:
    explicit Run(unsigned options)
        : tunnel_((options & 1U) != 0), bus_(port_, node_options()),
          coprocessor_(std::make_unique<Coprocessor>(endpoint_, tunnel_ ? bus_.serial() : serial_, watchdog_,
                                                     with({{Param::tell_near, (options & 2U) != 0 ? 1.0F : 0.0F}}),
                                                     &bus_))
    {
        ears_.set_node(kAutopilotNode);
    }

    [[nodiscard]] bool over() const { return steps_ >= kMaxSteps; }
    void frame(const hal::CanFrame& f) { port_.in.push_back(f); }
    void transfer(const can::TypeInfo& type, std::uint8_t source, std::uint8_t id, std::span<const std::byte> payload)
    {
        can::TransmitQueue queue;
        static_cast<void>(queue.push({type, can::Priority::medium, source, kOurNode, id}, payload));
        for (; queue.front() != nullptr; queue.pop()) {
            frame(to_port(*queue.front()));
        }
    }
    void controller(unsigned state, std::size_t room)
    {
        port_.state = static_cast<hal::CanState>(state % 5);
        port_.room = room;
    }
    void gap(unsigned n) { now_.us += std::int64_t{n} * 10'000; }

    void autopilot(unsigned bits)
    {
        if ((bits & 1U) != 0) {
            say(wire::heartbeat((bits & 2U) != 0 ? wire::kCopterGuided : wire::kCopterAuto, (bits & 4U) != 0, 3));
        }
        if ((bits & 8U) != 0) {
            say(wire::origin());
        }
        const auto boot = static_cast<std::uint32_t>(now_.us / 1000);
        say(wire::local_position(boot, Vec3(0.0F, 0.0F, 50.0F), Vec3(0.0F, 5.0F, 0.0F)));
        if ((bits & 16U) != 0) {
            say(wire::attitude(boot, 1.0F));
        }
    }

    void tick()
    {
        ++steps_;
        now_.us += 20'000;
        port_.taken = 0;
        const Diagnostics before = coprocessor_->diagnostics();
        const StepReport report = coprocessor_->step(now_);
        const Diagnostics& after = coprocessor_->diagnostics();
        JINK_FUZZ_CHECK(port_.taken <= CanBus::kMaxFramesPerStep);
        JINK_FUZZ_CHECK(report.faults == 0 || !report.setpoint_sent);
        JINK_FUZZ_CHECK(report.faults == 0 || report.control != Control::ours);
        JINK_FUZZ_CHECK((report.faults & static_cast<unsigned>(Fault::not_finite)) == 0);
        JINK_FUZZ_CHECK(report.own_source != OwnSource::bus || report.faults != 0);
        JINK_FUZZ_CHECK(is_finite(coprocessor_->own().position) && is_finite(coprocessor_->own().velocity));
        JINK_FUZZ_CHECK(after.bus_states >= before.bus_states && after.params_set >= before.params_set &&
                        after.bus_reports_dropped >= before.bus_reports_dropped && after.steps == before.steps + 1);
        const std::array<float, kParamCount>& values = coprocessor_->parameters().values();
        JINK_FUZZ_CHECK(std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }));
        listen();
    }

private:
    template <class M>
    void say(const M& message)
    {
        const std::vector<std::byte> bytes = wire::frame_of(message, {wire::kSystem, wire::kAutopilot, sequence_++});
        if (!tunnel_) {
            static_cast<void>(serial_.arrive(bytes));
            return;
        }
        can::TunnelTargetted m;
        m.protocol = 1;
        m.target = kOurNode;
        for (const std::byte b : bytes) {
            m.bytes.unchecked_push_back(std::to_integer<std::uint8_t>(b));
        }
        const can::test::Bytes payload = can::test::payload_of(m);
        transfer(can::TunnelTargetted::kType, kAutopilotNode, transfer_++ % can::kTransferIds, payload);
    }

    void listen()
    {
        for (const hal::CanFrame& f : port_.out) {
            const can::Transfer* const t = ears_.accept(from_port(f), now_);
            can::TunnelTargetted m;
            can::Proximity near;
            if (t == nullptr) {
                continue;
            }
            if (t->type.id == can::Proximity::kType.id) {
                JINK_FUZZ_CHECK(can::decode(t->payload, near) == can::CodecStatus::ok);
                JINK_FUZZ_CHECK(std::abs(near.yaw) <= 180.5F && std::abs(near.pitch) <= 90.5F);
                JINK_FUZZ_CHECK(near.distance > 0.0F && near.distance <= 50.5F);
            } else if (can::decode(t->payload, m) == can::CodecStatus::ok) {
                hear(m);
            }
        }
        port_.out.clear();
    }

    void hear(const can::TunnelTargetted& m)
    {
        std::array<std::byte, can::TunnelTargetted::kBytes> bytes{};
        std::transform(m.bytes.begin(), m.bytes.end(), bytes.begin(), [](std::uint8_t b) { return std::byte{b}; });
        std::span<const std::byte> said = std::span(bytes).first(m.bytes.size());
        while (const auto frame = parser_.next(said)) {
            SetPositionTargetLocalNed target;
            if (decode(*frame, target)) {
                const auto age = static_cast<std::uint32_t>(now_.us / 1000) - target.time_boot_ms;
                JINK_FUZZ_CHECK(age <= 300);
            }
        }
    }

    static constexpr std::array kHeard{can::TunnelTargetted::kType, can::Proximity::kType};
    bool tunnel_;
    Port port_;
    FixedPort serial_;
    CountingWatchdog watchdog_;
    Endpoint endpoint_;
    CanBus bus_;
    std::unique_ptr<Coprocessor> coprocessor_;
    TimePoint now_{10'000'000};
    can::Receiver ears_{kHeard};
    Parser parser_;
    std::uint8_t sequence_ = 0;
    std::uint8_t transfer_ = 0;
    int steps_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    std::size_t at = 0;
    const auto next = [&]() -> std::uint8_t { return at < size ? data[at++] : 0; };
    const auto run = std::make_unique<Run>(next());
    while (at < size && !run->over()) {
        switch (next() % 6) {
        case 0: {
            hal::CanFrame frame;
            const std::uint8_t flags = next();
            frame.extended = flags % 16 != 1;
            frame.remote = flags % 16 == 2;
            frame.fd = flags % 16 == 3;
            for (int i = 0; i < 4; ++i) {
                frame.id = frame.id << 8U | next();
            }
            frame.id &= hal::CanFrame::kExtendedMask;
            frame.length = next() % 9;
            for (std::size_t i = 0; i < 8; ++i) {
                frame.data[i] = std::byte{next()};
            }
            run->frame(frame);
            break;
        }
        case 1: {
            const can::TypeInfo& type = can::kTakenIn[next() % can::kTakenIn.size()];
            const std::uint8_t source = next() & can::kMaxNode;
            const std::uint8_t id = next() % can::kTransferIds;
            std::array<std::byte, 256> payload{};
            const std::size_t length = next();
            for (std::size_t i = 0; i < length; ++i) {
                payload[i] = std::byte{next()};
            }
            run->transfer(type, source, id, std::span(payload).first(length));
            break;
        }
        case 2:
            for (unsigned n = next() % 32U + 1U; n > 0 && !run->over(); --n) {
                run->tick();
            }
            break;
        case 3: {
            const std::uint8_t state = next();
            const std::uint8_t room = next();
            run->controller(state, room == 255 ? 100000U : room);
            break;
        }
        case 4: run->gap(next()); break;
        default: run->autopilot(next()); break;
        }
    }
    return 0;
}
