// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "firmware/link/dronecan/frame.hpp"
#include "hal/can_port.hpp"

// A classic CAN frame as the port has it, and as DroneCAN has it.

namespace jink::app {

[[nodiscard]] constexpr hal::CanFrame to_port(const link::dronecan::Frame& frame) noexcept
{
    hal::CanFrame out;
    out.id = frame.id;
    out.extended = frame.extended;
    out.remote = frame.remote;
    out.length = frame.length;
    std::copy_n(frame.data.begin(), link::dronecan::Frame::kBytes, out.data.begin());
    return out;
}

/// A frame of CAN FD keeps its length when that is more than a classic one has, and is given one otherwise: the
/// receiver refuses it.
[[nodiscard]] constexpr link::dronecan::Frame from_port(const hal::CanFrame& frame) noexcept
{
    link::dronecan::Frame out;
    out.id = frame.id;
    out.extended = frame.extended;
    out.remote = frame.remote;
    out.length = frame.fd ? static_cast<std::uint8_t>(hal::CanFrame::kFdBytes) : frame.length;
    std::copy_n(frame.data.begin(), link::dronecan::Frame::kBytes, out.data.begin());
    return out;
}

}  // namespace jink::app
