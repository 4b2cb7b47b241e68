// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "firmware/link/mavlink/encoder.hpp"

namespace jink::sim {

/// A sender on the autopilot's side of the cable.
struct Sender {
    std::uint8_t system = 1;
    std::uint8_t component = 1;
};
inline constexpr Sender kAutopilot{1, 1};
inline constexpr Sender kAdsbReceiver{1, 156};
inline constexpr Sender kRangefinder{1, 158};
inline constexpr Sender kGroundStation{255, 190};

/// Encodes messages in sequence, with a sequence number per sender. The vehicle's own senders, system 1 above, are sent
/// with the vehicle's actual system id.
class FrameWriter {
public:
    explicit FrameWriter(std::uint8_t system = kAutopilot.system) : system_(system) {}

    template <link::mavlink::Message M>
    void write(const M& message, Sender sender = kAutopilot)
    {
        std::array<std::byte, link::mavlink::kMaxFrame> frame{};
        const std::uint8_t sequence = sequences_[{sender.system, sender.component}]++;
        const std::uint8_t system = sender.system == kAutopilot.system ? system_ : sender.system;
        const std::size_t n = link::mavlink::encode(message, {system, sender.component, sequence}, frame);
        bytes_.insert(bytes_.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n));
    }

    /// Restarts the sequence numbers, as after a reboot.
    void restart() { sequences_.clear(); }
    [[nodiscard]] std::vector<std::byte>& bytes() noexcept { return bytes_; }

private:
    std::uint8_t system_;
    std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> sequences_;
    std::vector<std::byte> bytes_;
};

}  // namespace jink::sim
