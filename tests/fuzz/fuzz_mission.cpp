// SPDX-License-Identifier: BSD-3-Clause
// The mission line from bytes to what is flown. First input byte: 1 repair lengths and checksums, 2 the line out takes
// nothing. Then records: time step in units of 10 ms, length, bytes. Checked after each record: every byte is in one
// place, what is to be flown is finite and old states are not believed, neighbours are sound, and what goes out can be
// read again.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "firmware/app/mission_protocol.hpp"
#include "firmware/link/mavlink/checksum.hpp"
#include "tests/fuzz/check.hpp"

using namespace jink;
using namespace jink::link;

namespace {

struct Host final : app::MissionHost {
    mission::ConfigStatus configure(std::uint16_t key, bool set, float& value) noexcept override
    {
        JINK_FUZZ_CHECK(!set || std::isfinite(value));
        setting = set ? value : setting;
        value = setting;
        return key < 10 ? mission::ConfigStatus::ok : mission::ConfigStatus::unknown_key;
    }
    mission::MapInfo map_info() const noexcept override { return {}; }
    void acknowledge_trip() noexcept override { monitor.acknowledge(); }
    float setting = 0.0F;
    orca::Monitor monitor;
};

/// The other end: only what may go out comes.
struct Reader final : mission::FrameSink {
    void take(const mission::Frame& frame, TimePoint /*now*/) noexcept override
    {
        JINK_FUZZ_CHECK(frame.sender == 1);
        JINK_FUZZ_CHECK(frame.type != mission::MessageType::task_upload && frame.type != mission::MessageType::config);
        ++frames;
    }
    std::uint64_t frames = 0;
};

/// Makes length and checksum of whatever starts like a frame right, as far as it is there.
void repair(std::vector<std::byte>& bytes)
{
    for (std::size_t p = 0; p + mission::kHeaderSize <= bytes.size(); ++p) {
        if (bytes[p] != mission::kSync[0] || bytes[p + 1] != mission::kSync[1]) {
            continue;
        }
        bytes[p + 2] = std::byte{mission::kVersion};
        bytes[p + 3] = static_cast<std::byte>(1U + std::to_integer<unsigned>(bytes[p + 3]) % 11U);
        const std::size_t payload = mission::payload_size(std::to_integer<std::uint8_t>(bytes[p + 3]));
        bytes[p + 8] = static_cast<std::byte>(payload);
        const std::size_t size = mission::frame_size(payload);
        if (p + size <= bytes.size()) {
            mavlink::Checksum checksum;
            checksum.add(std::span<const std::byte>(bytes).subspan(p + 2, size - 4));
            bytes[p + size - 2] = static_cast<std::byte>(checksum.value() & 0xFFU);
            bytes[p + size - 1] = static_cast<std::byte>(checksum.value() >> 8U);
            p += size - 1;
        }
    }
}

void check_input(const app::MissionInput& input, TimePoint now)
{
    JINK_FUZZ_CHECK(is_finite(input.preferred) && is_finite(input.own.position) && is_finite(input.own.velocity));
    JINK_FUZZ_CHECK(input.hold || now - input.own.stamp <= app::MissionProtocol::kOwnStateAge);
    JINK_FUZZ_CHECK(input.hold == ((input.faults & bit(app::MissionFault::own_state_stale)) != 0));
    JINK_FUZZ_CHECK(!input.hold || input.preferred == Vec3::Zero());
}

void check_neighbours(const app::MissionProtocol& protocol, TimePoint now)
{
    for (const app::MissionNeighbour& n : protocol.neighbours()) {
        JINK_FUZZ_CHECK(n.heard.id != 1 && n.heard.state.stamp <= now);
        JINK_FUZZ_CHECK(is_finite(n.heard.state.position) && is_finite(n.heard.state.velocity));
        JINK_FUZZ_CHECK(n.radius_xy > 0.0F && n.radius_z > 0.0F && n.horizon > 0.0F);
        const orca::PredictedNeighbour there = orca::predict_neighbour(n.heard, now + 0.5F, {}, 100.0F);
        JINK_FUZZ_CHECK(is_finite(there.position) && is_finite(there.velocity) && there.inflation >= 0.0F);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const auto host = std::make_unique<Host>();
    const auto generator =
        std::make_unique<path::TrajectoryGenerator>(path::GeneratorSettings{}, vehicle::VehicleLimits{});
    const auto protocol = std::make_unique<app::MissionProtocol>(1, 0.01F, *generator, *host);
    mission::Receiver other;
    Reader reader;
    TimePoint now{10'000'000};
    std::uint64_t heard = 0;
    std::uint64_t sent = 0;
    for (std::size_t at = 1; at + 2 <= size;) {
        now.us += 10'000 * std::int64_t{data[at]};
        const std::size_t n = std::min<std::size_t>(4U * data[at + 1], size - at - 2);
        std::vector<std::byte> bytes(n);
        if (n > 0) {
            std::memcpy(bytes.data(), data + at + 2, n);
        }
        at += 2 + n;
        if ((data[0] & 1U) != 0) {
            repair(bytes);
        }
        protocol->receive(bytes, now);
        heard += n;
        const mission::ReceiverDiagnostics& d = protocol->receiver_diagnostics();
        JINK_FUZZ_CHECK(d.frame_bytes + d.noise_bytes <= heard);
        JINK_FUZZ_CHECK(heard - d.frame_bytes - d.noise_bytes < mission::kMaxFrame);
        protocol->step(now);
        app::MissionInput input = protocol->input(now);
        check_input(input, now);
        check_neighbours(*protocol, now);
        if (!input.hold) {
            const path::GeneratorOutput output = generator->step(input.own, now, false);
            JINK_FUZZ_CHECK(is_finite(output.velocity) && std::isfinite(output.error) && std::isfinite(output.left));
            protocol->take_preferred(output.velocity, now);
            protocol->tell_progress(output, now);
            orca::Broadcast own;
            own.state = input.own;
            protocol->tell_state(own, 0.6F, 0.3F, 10.0F, now);
            std::vector<orca::MonitoredVehicle> vehicles;
            for (const app::MissionNeighbour& neighbour : protocol->neighbours()) {
                vehicles.push_back({neighbour.heard.id, neighbour.heard.state.position});
            }
            host->monitor.update(now, input.own.position, vehicles, {});
            protocol->tell_monitor(host->monitor, now);
        }
        for (int frame = 0; frame < 40 && (data[0] & 2U) == 0 && !protocol->pending().empty(); ++frame) {
            const auto out = protocol->pending();
            other.receive(out, now, reader);
            sent += 1;
            protocol->consume(out.size());
        }
        JINK_FUZZ_CHECK(reader.frames == sent && other.diagnostics().noise_bytes == 0);
    }
    return 0;
}
