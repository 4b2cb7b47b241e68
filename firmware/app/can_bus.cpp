// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/can_bus.hpp"

#include "firmware/app/can_frame.hpp"

namespace jink::app {

CanBus::CanBus(hal::CanPort& port, const link::dronecan::NodeOptions& node,
               const link::dronecan::EndpointOptions& options, const link::dronecan::TunnelOptions& tunnel) noexcept
    : port_(port), endpoint_(node, options), tunnel_(tunnel), serial_(*this)
{
}

bool CanBus::is_lost() const noexcept
{
    const hal::CanState state = port_.health().state;
    return state != hal::CanState::active && state != hal::CanState::error_passive;
}

void CanBus::take(const hal::CanFrame& frame, TimePoint now, link::Inbox& inbox) noexcept
{
    diagnostics_.frames_foreign += frame.fd ? 1U : 0U;
    if (const link::dronecan::Transfer* const transfer = endpoint_.receive(from_port(frame), now, inbox)) {
        tunnel_.receive(endpoint_.node(), *transfer);
    }
}

void CanBus::receive(TimePoint now, link::Inbox& inbox) noexcept
{
    behind_ = behind_ || (has_received_ && now - last_receive_ > kStall);
    has_received_ = true;
    last_receive_ = now;
    now_ = now;
    last_progress_ = endpoint_.pending() == nullptr ? now : last_progress_;
    hal::CanFrame frame;
    std::size_t taken = 0;
    for (; taken < kMaxFramesPerStep && port_.receive(frame); ++taken) {
        if (behind_) {
            ++diagnostics_.frames_late;
        } else {
            take(frame, now, inbox);
        }
    }
    diagnostics_.full_steps += taken == kMaxFramesPerStep ? 1U : 0U;
    behind_ = behind_ && taken == kMaxFramesPerStep;
    serial_.note_state();
}

void CanBus::service(TimePoint now, const link::BusStatus& status) noexcept
{
    now_ = now;
    endpoint_.service(now, status);
    flush();
}

bool CanBus::send_near(const link::NearObject& object) noexcept
{
    constexpr float kDegrees = 180.0F / kPi;
    if (endpoint_.pending() != nullptr) {
        ++diagnostics_.near_not_sent;
        return false;
    }
    link::dronecan::Proximity message;  // of sensor 0: ArduPilot takes that of PRX1_ADDR alone
    message.reading = link::dronecan::Proximity::Reading::good;
    message.yaw = object.yaw * kDegrees;
    message.pitch = object.pitch * kDegrees;
    message.distance = object.distance;
    const bool sent = endpoint_.node().send(message, link::dronecan::Priority::low);
    flush();
    return sent;
}

void CanBus::flush() noexcept
{
    if (is_lost()) {
        diagnostics_.losses += endpoint_.pending() != nullptr ? 1U : 0U;
        endpoint_.discard_pending();
    } else if (endpoint_.pending() != nullptr && now_ - last_progress_ > kStall) {
        ++diagnostics_.stalls;
        endpoint_.discard_pending();
    }
    while (const link::dronecan::Frame* const frame = endpoint_.pending()) {
        if (!port_.send(to_port(*frame))) {
            return;
        }
        endpoint_.consume();
        last_progress_ = now_;
    }
    last_progress_ = now_;
}

std::size_t CanBus::Serial::read(std::span<std::byte> into) noexcept
{
    const std::size_t n = bus_.tunnel_.read(into);
    if (health_.state != hal::PortState::open) {  // nor may it be read later, when it is old
        bus_.diagnostics_.tunnel_dropped += static_cast<std::uint32_t>(n);
        return 0;
    }
    health_.bytes_in += n;
    return n;
}

std::size_t CanBus::Serial::write(std::span<const std::byte> from) noexcept
{
    std::size_t n = 0;
    if (bus_.endpoint_.pending() != nullptr) {
        ++bus_.diagnostics_.tunnel_withheld;
    } else if (health().state == hal::PortState::open) {
        n = bus_.tunnel_.write(bus_.endpoint_.node(), from);
        bus_.flush();
    }
    health_.bytes_out += n;
    health_.bytes_refused += from.size() - n;
    return n;
}

hal::PortHealth CanBus::Serial::health() const noexcept
{
    hal::PortHealth health = health_;
    health.state = bus_.port_.health().state == hal::CanState::active ? hal::PortState::open : hal::PortState::lost;
    health.overruns = bus_.tunnel_.diagnostics().bytes_overwritten;
    return health;
}

void CanBus::Serial::note_state() noexcept
{
    const hal::PortState state = health().state;
    const bool was_open = health_.state == hal::PortState::open;
    health_.disconnects += was_open && state != hal::PortState::open ? 1U : 0U;
    health_.reconnects += health_.state == hal::PortState::lost && state == hal::PortState::open ? 1U : 0U;
    health_.state = state;
}

}  // namespace jink::app
