// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "core/base/random.hpp"
#include "toolchain/sim/world.hpp"

namespace jink::sim {

/// One arriving traffic report: the true position with noise, delayed by the sensor's latency.
struct Sighting {
    std::size_t threat = 0;
    Micros arrives = 0;
    Vec position = Vec::Zero();
    Vec velocity = Vec::Zero();
    std::size_t turns = 0;  ///< that the threat had made by then
};

/// Detects the world's threats that are sensed as traffic or point obstacles.
///
/// Each threat has its own random stream. Numbers are drawn for each sighting in the order of simulated time, whether
/// or not the sighting arrives. The numbers are independent of the co-processor and of the times of poll().
class TrafficReceiver {
public:
    explicit TrafficReceiver(const World& world);

    /// Sightings that have arrived since the last call, in order of arrival. Call every step. O(threats).
    [[nodiscard]] std::vector<Sighting> poll();

private:
    struct Channel {
        Random random;
        Micros next = -1;
        std::deque<Sighting> under_way{};
        std::optional<Vec> drift{};  ///< of the position, as of the last sighting
        Micros drifted_at = 0;
    };

    [[nodiscard]] Vec drift_of(Channel& channel) const;
    void sight(std::size_t i, Channel& channel);

    const World& world_;
    std::vector<Channel> channels_;
};

inline constexpr std::size_t kScanSectors = 72;
inline constexpr double kScanIncrement = 5.0;  // [deg]

/// Level scan from the vehicle: sector i points i * kScanIncrement degrees clockwise from the nose. Distance to the
/// nearest visible threat that is sensed by scan [m], or a negative number if none is within range.
[[nodiscard]] std::array<double, kScanSectors> scan(const World& world);

}  // namespace jink::sim
