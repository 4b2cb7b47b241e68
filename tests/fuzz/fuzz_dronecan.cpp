// SPDX-License-Identifier: BSD-3-Clause
// A DroneCAN endpoint with its tunnel on arbitrary frames and on whole transfers with a correct checksum. Checked:
// every number that reaches the inbox is finite, directions are unit vectors, queues keep their bounds, frames are
// accounted for, and the answers that go out can be read back.
//
// Input: records of an operation and its operands. 0 a frame as it stands (flags, id 4, length, data 8), 1 a transfer
// (type, source, transfer id, length, payload), 2 time passes (units of 10 ms), 3 a step of the node, and the tunnel
// read and written.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "firmware/link/dronecan/endpoint.hpp"
#include "firmware/link/dronecan/tunnel.hpp"
#include "tests/fuzz/check.hpp"

using namespace jink;
using namespace jink::link;
using namespace jink::link::dronecan;

namespace {

class Input {
public:
    Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}
    [[nodiscard]] bool empty() const { return rest_.empty(); }
    std::uint8_t next()
    {
        if (rest_.empty()) {
            return 0;
        }
        const std::uint8_t byte = rest_.front();
        rest_ = rest_.subspan(1);
        return byte;
    }

private:
    std::span<const std::uint8_t> rest_;
};

class Params final : public ParamServer {
public:
    bool read(std::uint16_t index, ParamEntry& entry) const noexcept override
    {
        entry.name = {'A'};
        entry.value = value_;
        entry.integer = index == 1;
        return index < 2;
    }
    bool find(const ParamName& name, std::uint16_t& index) const noexcept override
    {
        index = 1;
        return name[0] == 'A';
    }
    void write(std::uint16_t, float value) noexcept override
    {
        JINK_FUZZ_CHECK(std::isfinite(value));
        value_ = value;
    }
    bool save() noexcept override { return true; }
    bool erase() noexcept override { return false; }

private:
    float value_ = 0.0F;
};

void check(const Inbox& inbox)
{
    if (inbox.has_bus_state) {
        const vehicle::VehicleState& own = inbox.bus_state.state;
        JINK_FUZZ_CHECK(is_finite(own.position) && is_finite(own.velocity) && std::isfinite(own.yaw));
        JINK_FUZZ_CHECK(own.sigma_position >= 0.0F && std::isfinite(own.sigma_position));
        JINK_FUZZ_CHECK(own.sigma_velocity >= 0.0F && std::isfinite(own.sigma_velocity));
    }
    for (const TrackReport& track : inbox.tracks) {
        JINK_FUZZ_CHECK(is_finite(track.position) && is_finite(track.velocity));
    }
    for (const RangeReading& reading : inbox.readings) {
        JINK_FUZZ_CHECK(std::abs(reading.direction.norm() - 1.0F) < 1e-3F);
        JINK_FUZZ_CHECK(reading.range >= 0.0F && std::isfinite(reading.range) && std::isfinite(reading.max_range));
        JINK_FUZZ_CHECK(reading.half_angle > 0.0F && reading.half_angle < 2.0F);
    }
}

/// Everything that waits to go out, through a receiver that knows all that we send.
void drain(Endpoint& endpoint)
{
    static constexpr std::array kSentTypes{NodeStatus::kType,     GetNodeInfoResponse::kType,
                                           GetSetResponse::kType, ExecuteOpcodeResponse::kType,
                                           Allocation::kType,     TunnelTargetted::kType};
    Receiver receiver(kSentTypes);
    TimePoint now;
    while (const Frame* const frame = endpoint.pending()) {
        JINK_FUZZ_CHECK(frame->extended && !frame->remote && frame->length >= 1 && frame->length <= Frame::kBytes);
        static_cast<void>(receiver.accept(*frame, now));
        now = now + 3.0F * (unpack(frame->data[frame->length - 1U]).end ? 1.0F : 0.0F);
        endpoint.consume();
    }
    JINK_FUZZ_CHECK(receiver.diagnostics().bad_crc == 0 && receiver.diagnostics().wrong_toggle == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    Input input(data, size);
    const std::uint8_t setup = input.next();
    NodeOptions node;
    node.node = (setup & 1U) != 0 ? 42 : kAnonymous;
    EndpointOptions options;
    options.believe_stamps = (setup & 2U) != 0;
    Params params;
    Endpoint endpoint(node, options, (setup & 4U) != 0 ? &params : nullptr);
    Tunnel tunnel;
    Inbox inbox;
    TimePoint now{1'000'000};
    const auto give = [&](const Frame& frame) {
        if (const Transfer* const transfer = endpoint.receive(frame, now, inbox)) {
            tunnel.receive(endpoint.node(), *transfer);
        }
        check(inbox);
        JINK_FUZZ_CHECK(endpoint.node().outgoing().size() <= kTransmitFrames);
    };
    while (!input.empty()) {
        switch (input.next() % 4) {
        case 0: {
            Frame frame;
            const std::uint8_t flags = input.next();
            frame.extended = flags % 16 != 1;
            frame.remote = flags % 16 == 2;
            for (int i = 0; i < 4; ++i) {
                frame.id = frame.id << 8U | input.next();
            }
            frame.length = input.next() % 10;
            for (std::byte& byte : frame.data) {
                byte = std::byte{input.next()};
            }
            give(frame);
            break;
        }
        case 1: {
            const TypeInfo& type = kTakenIn[input.next() % kTakenIn.size()];
            const std::uint8_t source = input.next() & kMaxNode;
            const std::uint8_t transfer = input.next() % kTransferIds;
            std::array<std::byte, 256> payload{};
            const std::size_t length = input.next();
            for (std::size_t i = 0; i < length; ++i) {
                payload[i] = std::byte{input.next()};
            }
            TransmitQueue queue;
            static_cast<void>(
                queue.push({type, Priority::medium, source, 42, transfer}, std::span(payload).first(length)));
            for (; queue.front() != nullptr; queue.pop()) {
                give(*queue.front());
            }
            break;
        }
        case 2: now.us += input.next() * 10'000; break;
        default: {
            endpoint.service(now, SystemState::active);
            std::array<std::byte, 200> bytes{};
            static_cast<void>(tunnel.write(endpoint.node(), std::span(bytes).first(tunnel.read(bytes))));
            drain(endpoint);
            inbox.clear();
        }
        }
    }
    const ReceiverDiagnostics& d = endpoint.node().receiver_diagnostics();
    const std::uint64_t lost = std::uint64_t{d.ignored} + d.standard_id + d.remote + d.bad_length + d.bad_id +
                               d.missed_start + d.wrong_toggle + d.wrong_transfer + d.short_frame + d.too_long +
                               d.bad_crc + d.timed_out + d.duplicates + d.anonymous_refused + d.transfers;
    JINK_FUZZ_CHECK(lost <= std::uint64_t{d.frames} + d.timed_out + d.interrupted);
    return 0;
}
