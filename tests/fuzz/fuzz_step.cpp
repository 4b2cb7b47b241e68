// SPDX-License-Identifier: BSD-3-Clause
// The whole Coprocessor::step: time, bytes and the state of the line come from the input; a minimal autopilot is behind
// the wire, so that conflicts, take-overs and faults are reachable. First byte: 1 repair checksums, 2 raw frames claim
// to be the autopilot's, 4 a PX4, 8 requests are acknowledged, 16 a log is streamed. Then records, the first byte's low
// three bits saying which, the other five an argument:
//   0 raw [length][bytes]   1 ticks (argument + 1)   2 autopilot [bits]   3 line [space]   4 traffic
//   [x][y][z][vx][vy][bits] 5 parameter [index][float]   6 no step for argument * 0.1 s   7 range [range][bits]
// Checked after each step: set-points are finite, within the vehicle's limits, recent, and never sent in a fault;
// output is whole frames; bytes are bounded; counters only grow.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

#include "firmware/app/cloud_input.hpp"
#include "firmware/flight_log/log_stream.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/mavlink_repair.hpp"
#include "tests/unit/app/flight.hpp"

using namespace jink;
using namespace jink::app;
using namespace jink::app::test;

namespace {

/// Steps of one input: enough to take over and give back, few enough to try many.
constexpr int kMaxSteps = 500;

template <class Counters>
bool only_grow(const Counters& before, const Counters& after)
{
    static_assert(sizeof(Counters) % sizeof(std::uint32_t) == 0);
    using Words = std::array<std::uint32_t, sizeof(Counters) / sizeof(std::uint32_t)>;
    const auto a = std::bit_cast<Words>(before);
    const auto b = std::bit_cast<Words>(after);
    return std::equal(a.begin(), a.end(), b.begin(), [](std::uint32_t x, std::uint32_t y) { return x <= y; });
}

class Run {
public:
    explicit Run(unsigned options)
        : repairs_((options & 1U) != 0), claims_((options & 2U) != 0), logs_((options & 16U) != 0)
    {
        f_.px4 = (options & 4U) != 0;
        f_.acknowledges = (options & 8U) != 0;
        f_.mode = f_.mission_mode();
        f_.coprocessor.use_clouds(clouds_);
        if (logs_) {
            f_.coprocessor.stream(log_);
        }
    }

    [[nodiscard]] bool over() const { return steps_ >= kMaxSteps; }

    void tick()
    {
        f_.prepare();
        step();
    }

    void raw(std::vector<std::byte> bytes)
    {
        if (claims_) {
            claim_to_be_the_autopilot(bytes);
        }
        if (repairs_) {
            fuzz::repair_checksums(bytes);
        }
        f_.feed_bytes(bytes);
        tick();
    }

    void set_autopilot(unsigned bits)
    {
        const std::array<std::uint32_t, 8> modes{
            f_.mission_mode(), f_.external_mode(), wire::kCopterLoiter, wire::kCopterBrake, 0, 6,
            px4_mode(4, 3),    px4_mode(3, 0)};
        f_.mode = modes[bits & 7U];
        f_.armed = (bits & 8U) == 0;
        f_.obeys = (bits & 16U) == 0;
        f_.heartbeats = (bits & 32U) == 0;
        f_.own_state = (bits & 64U) == 0;
        if ((bits & 128U) != 0) {
            f_.boot_us = 1'000'000;
        }
    }

    void set_line(unsigned room)
    {
        f_.port.state = room == 254U ? hal::PortState::lost : hal::PortState::open;
        f_.port.room = room == 255U ? std::size_t{1} << 20U : room;
    }

    void traffic(std::uint32_t id, const std::uint8_t* b)
    {
        constexpr GlobalPosition kOrigin{473977420, 85455940, 488000};
        const auto metres = [](std::uint8_t x) { return 0.5F * static_cast<float>(static_cast<std::int8_t>(x)); };
        const auto where = to_global(f_.position + Vec3(metres(b[0]), metres(b[1]), metres(b[2])), kOrigin);
        if (!where) {
            return;
        }
        AdsbVehicle m = wire::adsb(id, *where);
        const Vec3 v(metres(b[3]), metres(b[4]), 0.0F);
        m.hor_velocity = static_cast<std::uint16_t>(v.norm() * 100.0F);
        m.heading =
            static_cast<std::uint16_t>(std::fmod(90.0F - std::atan2(v.y(), v.x()) * 57.29F + 360.0F, 360.0F) * 100.0F);
        m.emitter_type = (b[5] & 1U) != 0 ? 19 : 1;
        m.flags = static_cast<std::uint16_t>((b[5] & 2U) != 0 ? m.flags & ~128U : m.flags);
        m.tslc = b[5] >> 6U;
        f_.feed(m, 156);
    }

    void parameter(std::uint8_t index, float value)
    {
        ParamSet m;
        m.param_id = wire::param_name(param_table()[index % kParamCount].name);
        m.param_value = value;
        m.param_type = 9;
        m.target_system = wire::kSystem;
        m.target_component = wire::kUs;
        f_.feed(m, 190);
    }

    void gap(unsigned tenths) { f_.now.us += 100'000 * std::int64_t{tenths}; }

    void range(std::uint8_t range, unsigned bits)
    {
        f_.feed(wire::attitude(f_.boot_ms(), 0.5F * kPi));
        if ((bits & 1U) != 0) {
            DistanceSensor m;
            m.min_distance = 10;
            m.max_distance = 5000;
            m.current_distance = static_cast<std::uint16_t>(range * 25U);
            m.orientation = static_cast<std::uint8_t>((bits >> 1U) % 8U + ((bits & 64U) != 0 ? 20U : 0U));
            m.horizontal_fov = static_cast<float>(bits >> 6U);
            f_.feed(m, 156);
            return;
        }
        ObstacleDistance m;
        m.distances.fill(5001);
        m.distances[(bits >> 1U) % 8U] = static_cast<std::uint16_t>(range * 25U);
        m.min_distance = 10;
        m.max_distance = 5000;
        m.increment = static_cast<std::uint8_t>(1U + bits % 180U);
        m.frame = 12;
        f_.feed(m, 156);
    }

private:
    static void claim_to_be_the_autopilot(std::vector<std::byte>& bytes)
    {
        for (std::size_t p = 0; p + kHeaderV2 < bytes.size(); ++p) {
            if (bytes[p] == kStartV2 || bytes[p] == kStartV1) {
                const std::size_t sender = p + (bytes[p] == kStartV2 ? 5 : 3);
                bytes[sender] = std::byte{wire::kSystem};
                bytes[sender + 1] = std::byte{wire::kAutopilot};
                p += std::to_integer<std::size_t>(bytes[p + 1]) + (bytes[p] == kStartV2 ? kHeaderV2 : kHeaderV1) + 1;
            }
        }
    }

    /// A receiver that starts anew now and then, and whose acknowledgements are sometimes lost.
    void receive_log()
    {
        if (steps_ % 128 == 60) {
            CommandLong start;
            start.command = steps_ % 384 == 60 ? 2511 : 2510;
            start.target_system = wire::kSystem;
            start.target_component = wire::kUs;
            f_.feed(start, 190);
        }
        for (const LoggingDataAcked& m : f_.said_of<LoggingDataAcked>()) {
            JINK_FUZZ_CHECK(m.length > 0 && m.length <= m.data.size());
            LoggingAck ack;
            ack.sequence = static_cast<std::uint16_t>(m.sequence + (steps_ % 7 == 0 ? 1 : 0));
            ack.target_system = wire::kSystem;
            ack.target_component = wire::kUs;
            f_.feed(ack, 190);
        }
        JINK_FUZZ_CHECK(f_.said_of<LoggingData>().size() + f_.said_of<LoggingDataAcked>().size() <= 1);
        JINK_FUZZ_CHECK(log_.ring().size() <= flightlog::MessageRing::kBytes);
    }

    void step()
    {
        ++steps_;
        const auto before = f_.coprocessor.diagnostics();
        const auto link_before = f_.endpoint.diagnostics();
        const auto takeover_before = f_.coprocessor.takeover_diagnostics();
        const int fed = f_.watchdog.fed;
        const StepReport report = f_.step();
        const Coprocessor& c = f_.coprocessor;
        JINK_FUZZ_CHECK(only_grow(before, c.diagnostics()) && c.diagnostics().steps == before.steps + 1);
        JINK_FUZZ_CHECK(only_grow(link_before, f_.endpoint.diagnostics()));
        JINK_FUZZ_CHECK(only_grow(takeover_before, c.takeover_diagnostics()));
        JINK_FUZZ_CHECK(report.bytes_in <= Coprocessor::kMaxBytesPerStep);
        JINK_FUZZ_CHECK(report.bytes_out <= Endpoint::kTransmitBytes);
        JINK_FUZZ_CHECK((report.faults & static_cast<std::uint16_t>(Fault::not_finite)) == 0);
        JINK_FUZZ_CHECK(report.faults == 0 || !report.setpoint_sent);
        JINK_FUZZ_CHECK(report.faults == 0 ||
                        (report.control != Control::ours && report.control != Control::returning));
        JINK_FUZZ_CHECK(f_.watchdog.fed - fed ==
                        ((report.faults & static_cast<std::uint16_t>(Fault::late)) != 0 ? 0 : 1));
        JINK_FUZZ_CHECK(is_finite(c.own().position) && is_finite(c.own().velocity) && std::isfinite(c.own().yaw));
        note_limits();
        listen(report);
        f_.react();
        if (logs_) {
            receive_log();
        }
    }

    /// The greatest speeds that there was a reason for.
    void note_limits()
    {
        const vehicle::VehicleLimits& limits = f_.coprocessor.parameters().configuration().limits;
        const float own = f_.coprocessor.own().velocity.norm();
        level_ = std::max({level_, limits.cruise_speed, own});
        vertical_ = std::max({vertical_, limits.max_climb, limits.max_descent, own});
    }

    void listen(const StepReport& report)
    {
        if (f_.port.state != hal::PortState::open) {
            ears_ = Parser();  // a cut frame is lost
            return;
        }
        bool begun = ears_.pending() > 0;
        std::span<const std::byte> said = f_.port.written();
        while (const auto frame = ears_.next(said)) {
            JINK_FUZZ_CHECK(frame->header.component_id == wire::kUs);
            SetPositionTargetLocalNed m;
            if (decode(*frame, m)) {
                check_setpoint(m, report, begun);
            }
            begun = false;
        }
        JINK_FUZZ_CHECK(ears_.diagnostics().noise_bytes == 0);
    }

    void check_setpoint(const SetPositionTargetLocalNed& m, const StepReport& report, bool begun_before) const
    {
        const Vec3 v(m.vx, m.vy, m.vz);
        JINK_FUZZ_CHECK(is_finite(v));
        JINK_FUZZ_CHECK(v.norm() <= 1.01F * std::hypot(level_, vertical_) + 0.1F);
        JINK_FUZZ_CHECK(m.type_mask == 0x0DC7 && m.coordinate_frame == 1);
        if (!begun_before) {
            JINK_FUZZ_CHECK(report.faults == 0);
            JINK_FUZZ_CHECK(static_cast<std::uint32_t>(f_.now.us / 1000) - m.time_boot_ms <= 200);
        }
    }

    CloudInput clouds_;
    flightlog::LogStream log_{921600};
    Flight f_;
    Parser ears_;
    bool repairs_;
    bool claims_;
    bool logs_;
    int steps_ = 0;
    float level_ = 0.0F;
    float vertical_ = 0.0F;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const auto run = std::make_unique<Run>(data[0]);
    std::size_t at = 1;
    const auto left = [&] { return size - at; };
    while (left() > 0 && !run->over()) {
        const unsigned kind = data[at] & 7U;
        const unsigned argument = data[at] >> 3U;
        ++at;
        constexpr std::array<std::size_t, 8> kNeeds{1, 0, 1, 1, 6, 5, 0, 2};
        if (left() < kNeeds[kind]) {
            break;
        }
        const std::uint8_t* const b = data + at;
        at += kNeeds[kind];
        switch (kind) {
        case 0: {
            const std::size_t n = std::min<std::size_t>(b[0], left());
            std::vector<std::byte> bytes(n);
            if (n > 0) {
                std::memcpy(bytes.data(), data + at, n);
            }
            at += n;
            run->raw(std::move(bytes));
            break;
        }
        case 1:
            for (unsigned i = 0; i <= argument && !run->over(); ++i) {
                run->tick();
            }
            break;
        case 2: run->set_autopilot(b[0]); break;
        case 3: run->set_line(b[0]); break;
        case 4: run->traffic(argument, b); break;
        case 5: {
            float value = 0.0F;
            std::memcpy(&value, b + 1, sizeof value);
            run->parameter(b[0], value);
            break;
        }
        case 6: run->gap(argument); break;
        default: run->range(b[0], b[1]); break;
        }
    }
    return 0;
}
