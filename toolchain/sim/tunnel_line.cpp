// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/tunnel_line.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

using namespace link::dronecan;

NodeOptions node_options(std::uint8_t node)
{
    NodeOptions options;
    options.node = node;
    return options;
}

}  // namespace

TunnelLine::TunnelLine(hal::Clock& clock, std::uint64_t seed)
    : clock_(clock), wire_(clock, seed), bus_(wire_.port(1), node_options(kOurNode)),
      peer_(node_options(kAutopilotNode)), peer_tunnel_(TunnelOptions{kOurNode, 0})
{
}

std::size_t TunnelLine::read(std::span<std::byte> into)
{
    const TimePoint now{clock_.now_us()};
    hal::CanFrame got;
    while (wire_.port(0).receive(got)) {
        Frame frame;
        frame.id = got.id;
        frame.extended = got.extended;
        frame.remote = got.remote;
        frame.length = got.length;
        std::copy_n(got.data.begin(), Frame::kBytes, frame.data.begin());
        if (const Transfer* const transfer = peer_.receive(frame, now)) {
            peer_tunnel_.receive(peer_, *transfer);
        }
    }
    peer_.service(now, link::SystemState::active);
    flush();
    return peer_tunnel_.read(into);
}

bool TunnelLine::write(std::span<const std::byte> bytes)
{
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    const bool fits = waiting_.size() <= kWaitingBytes;
    waiting_.resize(std::min(waiting_.size(), kWaitingBytes));
    if (peer_.outgoing().front() == nullptr) {
        const std::size_t taken = peer_tunnel_.write(peer_, waiting_);
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(taken));
    }
    flush();
    return fits;
}

void TunnelLine::flush()
{
    while (const Frame* const frame = peer_.outgoing().front()) {
        hal::CanFrame out;
        out.id = frame->id;
        out.extended = true;
        out.length = frame->length;
        std::copy_n(frame->data.begin(), Frame::kBytes, out.data.begin());
        if (!wire_.port(0).send(out)) {
            return;
        }
        peer_.outgoing().pop();
    }
}

}  // namespace jink::sim
