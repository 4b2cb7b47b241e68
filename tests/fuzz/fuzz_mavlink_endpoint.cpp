// SPDX-License-Identifier: BSD-3-Clause
// The whole receiving side of the MAVLink link on arbitrary bytes. First input byte: 1 repair checksums, 2 all frames
// claim to be the autopilot's, 4 inbox emptied only now and then. Then records: time step in units of 10 ms, length,
// bytes. Checked after each record: every number in the inbox and every point is finite and within the ranges that the
// application relies on, and the output consists of whole frames without a gap.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/track_ids.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/mavlink_repair.hpp"

using namespace jink;
using namespace jink::link;
using namespace jink::link::mavlink;

namespace {

constexpr float kFar = 200'000.0F;  // of own positions and legs [m]
constexpr float kRound = 45e6F;     // no two places on the globe are farther apart on the map [m]

/// Points come scan by scan, hits within their reach and directions of length 1.
struct PointCheck final : CloudSink {
    void begin_scan(const CloudScan& scan) noexcept override
    {
        JINK_FUZZ_CHECK(!open && std::isfinite(scan.max_range) && scan.max_range > 0.0F);
        open = true;
    }
    void add(Ray ray, const Vec3& point) noexcept override
    {
        JINK_FUZZ_CHECK(open && is_finite(point) && ray != Ray::invalid);
        JINK_FUZZ_CHECK(ray == Ray::hit ? point != Vec3::Zero() : std::abs(point.norm() - 1.0F) < 1e-4F);
    }
    void end_scan(std::uint32_t points_lost) noexcept override
    {
        JINK_FUZZ_CHECK(open && points_lost == 0);
        open = false;
    }
    bool open = false;
};

void check_scan(const RangeScan& scan, TimePoint now)
{
    JINK_FUZZ_CHECK(scan.stamp <= now);
    JINK_FUZZ_CHECK(std::isfinite(scan.yaw_first) && std::abs(scan.yaw_first) < 20.0F);
    JINK_FUZZ_CHECK(std::abs(scan.increment) > 0.008F && std::abs(scan.increment) < 3.2F);
    JINK_FUZZ_CHECK(scan.max_range > 0.0F && scan.min_range >= 0.0F && scan.min_range <= scan.max_range);
    JINK_FUZZ_CHECK(!scan.ranges.empty());
    for (const float r : scan.ranges) {
        JINK_FUZZ_CHECK(r == RangeScan::kNothing || r == RangeScan::kUnknown ||
                        (r >= scan.min_range && r <= scan.max_range));
    }
}

void check_inbox(const Inbox& inbox, TimePoint now)
{
    if (inbox.has_own_state) {
        const vehicle::VehicleState& s = inbox.own_state.state;
        JINK_FUZZ_CHECK(s.stamp <= now);
        JINK_FUZZ_CHECK(s.position.norm() <= kFar && s.velocity.norm() <= 401.0F);
        JINK_FUZZ_CHECK(std::isfinite(s.yaw) && std::abs(s.yaw) < 10.0F);
        JINK_FUZZ_CHECK(std::isfinite(s.sigma_position) && s.sigma_position >= 0.0F);
        JINK_FUZZ_CHECK(std::isfinite(s.sigma_velocity) && s.sigma_velocity >= 0.0F);
    }
    for (const RangeScan& scan : inbox.scans) {
        check_scan(scan, now);
    }
    JINK_FUZZ_CHECK(!inbox.has_home || inbox.home.norm() <= kFar);
    if (inbox.has_leg) {
        JINK_FUZZ_CHECK(inbox.leg.leg.start.norm() <= kFar && inbox.leg.leg.end.norm() <= kFar);
        JINK_FUZZ_CHECK(inbox.leg.leg.speed >= 0.0F && inbox.leg.leg.speed < 400.0F);
    }
    for (const TrackReport& t : inbox.tracks) {
        JINK_FUZZ_CHECK(t.stamp <= now && is_finite(t.position) && t.position.norm() < kRound);
        JINK_FUZZ_CHECK(is_finite(t.velocity) && t.velocity.norm() < 1000.0F);
        JINK_FUZZ_CHECK(t.has_velocity || t.velocity == Vec3::Zero());
        JINK_FUZZ_CHECK(t.sigma_position >= 0.0F && t.sigma_position < 200.0F);
        JINK_FUZZ_CHECK(t.sigma_velocity >= 0.0F && t.sigma_velocity < 1000.0F);
        JINK_FUZZ_CHECK((t.source == world::TrackSource::datalink) == is_of_system(t.id));
        JINK_FUZZ_CHECK((t.source == world::TrackSource::utm) == (t.id >= kUtmIds && t.id < kWideAddressIds));
    }
    for (const RangeReading& r : inbox.readings) {
        JINK_FUZZ_CHECK(std::abs(r.direction.norm() - 1.0F) < 1e-4F);
        JINK_FUZZ_CHECK(r.max_range > 0.0F && r.half_angle > 0.0F && r.half_angle <= 1.6F);
        JINK_FUZZ_CHECK(r.range == RangeScan::kNothing || (r.range >= 0.0F && r.range <= r.max_range));
    }
    for (const ParamRequest& p : inbox.params) {
        JINK_FUZZ_CHECK(std::isfinite(p.value) && (p.value_finite || p.value == 0.0F));
    }
}

/// Makes the endpoint talk, and listens.
void converse(Endpoint& endpoint, const Inbox& inbox, Parser& ears, TimePoint now)
{
    endpoint.service(now);
    for (const CommandRequest& request : inbox.commands) {
        endpoint.acknowledge(request, CommandResult::unsupported);
    }
    endpoint.send_heartbeat(SystemState::active);
    endpoint.request_external_mode();
    JINK_FUZZ_CHECK(endpoint.pending().size() <= Endpoint::kTransmitBytes);
    std::span<const std::byte> said = endpoint.pending();
    while (const auto frame = ears.next(said)) {
        JINK_FUZZ_CHECK(frame->header.component_id == 196 && frame->header.system_id != 0);
    }
    JINK_FUZZ_CHECK(ears.pending() == 0 && ears.diagnostics().noise_bytes == 0 && ears.diagnostics().repeated == 0);
    endpoint.consume(endpoint.pending().size());
}

void claim_to_be_the_autopilot(std::vector<std::byte>& bytes)
{
    for (std::size_t p = 0; p + kHeaderV2 < bytes.size(); ++p) {
        if (bytes[p] == kStartV2 || bytes[p] == kStartV1) {
            const std::size_t sender = p + (bytes[p] == kStartV2 ? 5 : 3);
            bytes[sender] = std::byte{1};
            bytes[sender + 1] = std::byte{1};
            p += std::to_integer<std::size_t>(bytes[p + 1]) + (bytes[p] == kStartV2 ? kHeaderV2 : kHeaderV1) + 1;
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const unsigned options = data[0];
    const auto endpoint = std::make_unique<Endpoint>();
    const auto inbox = std::make_unique<Inbox>();
    PointCheck points;
    endpoint->report_points_to(points);
    Parser ears;
    TimePoint now{10'000'000};
    unsigned records = 0;
    for (std::size_t at = 1; at + 2 <= size; ++records) {
        now.us += 10'000 * std::int64_t{data[at]};
        const std::size_t n = std::min<std::size_t>(data[at + 1], size - at - 2);
        std::vector<std::byte> bytes(n);
        if (n > 0) {
            std::memcpy(bytes.data(), data + at + 2, n);
        }
        at += 2 + n;
        if ((options & 2U) != 0) {
            claim_to_be_the_autopilot(bytes);
        }
        if ((options & 1U) != 0) {
            jink::fuzz::repair_checksums(bytes);
        }
        endpoint->receive(bytes, now, *inbox);
        check_inbox(*inbox, now);
        JINK_FUZZ_CHECK(endpoint->diagnostics().frames_in == endpoint->parser_diagnostics().accepted);
        converse(*endpoint, *inbox, ears, now);
        if ((options & 4U) == 0 || records % 8 == 7) {
            inbox->clear();
        }
    }
    return 0;
}
