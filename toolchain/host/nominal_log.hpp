// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "firmware/linux/flight_log/shown_curves.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/host/log_fields.hpp"

namespace jink::host {

/// The nominal paths of a flight log (topic jink_nominal), segment by segment.
class NominalLog {
public:
    /// Times do not go backwards [s].
    void note(const LogFields& topic, double time);
    /// Curves from the point abeam of the vehicle on, in order of time.
    /// @param own_at     own position at a time [m]; not finite: unknown
    /// @param lookahead  they are drawn so far ahead [s]
    [[nodiscard]] std::vector<PageNominal> curves(const std::function<Vec3(double)>& own_at, Seconds lookahead) const;

private:
    struct At {
        double time = 0.0;
        std::array<flightlog::NominalRoute, 2> routes;
    };
    std::vector<At> all_;
};

}  // namespace jink::host
