// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/replay.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/geodesy.hpp"
#include "firmware/link/mavlink/numbers.hpp"
#include "toolchain/sim/mode_names.hpp"

namespace jink::sim {
namespace {

constexpr std::uint8_t kAutopilotComponentId = 1;
constexpr std::uint8_t kOwnComponentId = 196;
constexpr std::uint8_t kFixedWingType = 1;
/// The co-processor's clock at the start of a recording that does not contain it [us].
constexpr std::int64_t kUnknownStart = kSecond;

std::optional<Stack> stack_of(link::AutopilotStack stack)
{
    switch (stack) {
    case link::AutopilotStack::ardupilot: return Stack::ardupilot;
    case link::AutopilotStack::px4: return Stack::px4;
    case link::AutopilotStack::unknown: break;
    }
    return std::nullopt;
}

std::optional<Globe> globe_of(const std::optional<link::GlobalPosition>& place)
{
    if (!place) {
        return std::nullopt;
    }
    return Globe{place->lat * 1e-7, place->lon * 1e-7, place->alt * 1e-3};
}

}  // namespace

/// The end of a line that delivers fed bytes and accepts all output. Decodes the requests that need an answer.
class Replay::Port final : public hal::SerialPort {
public:
    void bring(std::span<const std::byte> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), waiting_.size());
        std::copy_n(waiting_.begin(), n, into.begin());
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
        health_.bytes_in += n;
        return n;
    }
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
    {
        health_.bytes_out += from.size();
        const std::size_t n = from.size();
        while (const auto frame = parser_.next(from)) {
            link::mavlink::Timesync sync;
            link::mavlink::MissionRequestInt item;
            if (link::mavlink::decode(*frame, sync) && sync.tc1 == 0) {
                asked_ = sync.ts1;
            } else if (frame->message_id == link::mavlink::MissionRequestList::kInfo.id) {
                wants_count_ = true;
            } else if (link::mavlink::decode(*frame, item)) {
                wanted_item_ = item.seq;
            }
        }
        return n;
    }
    /// Whether MISSION_REQUEST_LIST came since the last call.
    [[nodiscard]] bool take_list_request() { return std::exchange(wants_count_, false); }
    /// The newest MISSION_REQUEST_INT since the last call.
    [[nodiscard]] std::optional<std::uint16_t> take_item_request() { return std::exchange(wanted_item_, std::nullopt); }
    /// TIMESYNC.ts1 of the newest request [ns]; 0: none.
    [[nodiscard]] std::int64_t asked() const noexcept { return asked_; }
    [[nodiscard]] hal::PortHealth health() const noexcept override { return health_; }

private:
    std::deque<std::byte> waiting_;
    hal::PortHealth health_{hal::PortState::open};
    link::mavlink::Parser parser_;
    std::int64_t asked_ = 0;
    bool wants_count_ = false;
    std::optional<std::uint16_t> wanted_item_;
};

Replay::Replay(const app::Parameters& parameters, std::int64_t clock_start, std::optional<RecordedMission> mission)
    : clock_start_(clock_start), mission_(std::move(mission)), port_(std::make_unique<Port>()),
      endpoint_(std::make_unique<link::mavlink::Endpoint>()),
      coprocessor_(std::make_unique<app::Coprocessor>(*endpoint_, *port_, watchdog_, parameters))
{
}

Replay::~Replay() = default;

void Replay::feed(Micros time, std::span<const std::byte> bytes)
{
    port_->bring(bytes);
    while (const auto frame = parser_.next(bytes)) {
        const bool own = endpoint_->system_id() == 0 || frame->header.system_id == endpoint_->system_id();
        if (own && frame->header.component_id == kAutopilotComponentId) {
            hear(time, *frame);
        }
    }
}

void Replay::hear(Micros time, const link::mavlink::Frame& frame)
{
    link::mavlink::Heartbeat heartbeat;
    link::mavlink::Timesync sync;
    if (link::mavlink::decode(frame, heartbeat) && heartbeat.autopilot != link::mavlink::kAutopilotInvalid) {
        vehicle_ = heartbeat.type;
    } else if (link::mavlink::decode(frame, sync) && sync.tc1 != 0) {
        const std::int64_t received = clock_start_ + time;
        const std::int64_t sent = sync.ts1 / 1000;
        if (sent <= received && received - sent < kSecond) {
            reported_clock_ = ReportedClock{frame.header, sync.tc1 / 1000, sent + (received - sent) / 2};
        }
    }
}

/// Called between frames: the line carries whole frames.
void Replay::answer_timesync(Micros now)
{
    if (!reported_clock_ || port_->asked() == 0 || parser_.pending() != 0) {
        return;
    }
    const std::int64_t asked = port_->asked() / 1000;
    const std::int64_t middle = asked + (clock_start_ + now - asked) / 2;
    bring(
        link::mavlink::Timesync{(reported_clock_->remote + middle - reported_clock_->at) * 1000, port_->asked(), 0, 0});
    reported_clock_.reset();
}

/// Feeds a message in the name of the recorded autopilot.
template <class M>
void Replay::bring(const M& message)
{
    std::array<std::byte, link::mavlink::kMaxFrame> frame{};
    const std::size_t n = link::mavlink::encode(message, {endpoint_->system_id(), kAutopilotComponentId, 0}, frame);
    port_->bring({frame.data(), n});
}

/// Called between frames.
void Replay::answer_mission(Micros now)
{
    if (!mission_ || parser_.pending() != 0) {
        return;
    }
    if (port_->take_list_request()) {
        if (auto count = mission_->count(now)) {
            count->target_system = endpoint_->system_id();
            count->target_component = kOwnComponentId;
            bring(*count);
        }
    }
    if (const auto wanted = port_->take_item_request()) {
        if (auto item = mission_->item(*wanted, now)) {
            item->target_system = endpoint_->system_id();
            item->target_component = kOwnComponentId;
            bring(*item);
        }
    }
}

void Replay::step(Micros now)
{
    now_ = now;
    answer_timesync(now);
    answer_mission(now);
    report_ = coprocessor_->step({clock_start_ + now});
}

Belief Replay::belief() const
{
    Belief belief;
    belief.time = to_seconds(now_);
    belief.control = name_of(report_.control);
    belief.tracks = report_.tracks;
    belief.conflict = report_.guidance.conflict.has_value();
    if (const link::AutopilotReport* const autopilot = coprocessor_->autopilot()) {
        belief.stack = stack_of(autopilot->stack);
        belief.vehicle = vehicle_;
        if ((report_.faults & app::bit(app::Fault::autopilot_silent)) == 0) {
            const bool fixed_wing = vehicle_ == kFixedWingType;
            belief.mode = mode_name(autopilot->stack, fixed_wing, autopilot->custom_mode);
            belief.armed = autopilot->armed;
        }
    }
    if (const auto origin = endpoint_->origin(); origin && endpoint_->has_home()) {
        belief.home = globe_of(link::mavlink::to_global(coprocessor_->home(), *origin));
    }
    if (report_.own_source != app::OwnSource::none) {
        const TimePoint now{clock_start_ + now_};
        const vehicle::VehicleState& own = coprocessor_->own();
        belief.position = (own.position + own.velocity * (now - own.stamp)).cast<double>();
        belief.velocity = own.velocity.cast<double>();
        const app::NominalPaths& paths = coprocessor_->nominal_paths();
        const world::Reference& nominal = paths.primary();
        const path::RouteView route = nominal.route();
        const Vec3 end = route.at(route.length()).position;
        belief.nominal = {paths.is_intended(), end.cast<double>(), static_cast<double>(nominal.speed),
                          route.segments().size() > 1};
    }
    return belief;
}

std::int64_t clock_start_of(std::span<const WireRecord> records)
{
    link::mavlink::Parser parser;
    for (const WireRecord& record : records) {
        if (record.direction != WireDirection::from_jink) {
            continue;
        }
        std::span<const std::byte> bytes(record.bytes);
        while (const auto frame = parser.next(bytes)) {
            link::mavlink::Timesync sync;
            if (link::mavlink::decode(*frame, sync) && sync.tc1 == 0 && sync.ts1 > 0) {
                return sync.ts1 / 1000 - to_micros(record.time);
            }
        }
    }
    return kUnknownStart;
}

void replay(std::span<const WireRecord> records, const app::Parameters& parameters,
            const std::function<void(const Belief&)>& each_second)
{
    if (records.empty()) {
        return;
    }
    const auto run = std::make_unique<Replay>(parameters, clock_start_of(records), RecordedMission(records));
    const Micros end = to_micros(records.back().time);
    std::size_t next = 0;
    for (Micros now = 0; now <= end; now += Replay::kStep) {
        for (; next < records.size() && to_micros(records[next].time) <= now; ++next) {
            if (records[next].direction == WireDirection::from_autopilot) {
                run->feed(to_micros(records[next].time), records[next].bytes);
            }
        }
        run->step(now);
        if (now > 0 && now % kSecond == 0) {
            each_second(run->belief());
        }
    }
}

}  // namespace jink::sim
