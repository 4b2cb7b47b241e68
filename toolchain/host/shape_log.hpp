// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "firmware/linux/flight_log/shown_shapes.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/host/log_fields.hpp"

namespace jink::host {

/// The obstacles and closed areas of a flight log (topics jink_obstacle and jink_area), round by round: each as long as
/// the rounds repeat it unchanged. Times do not go backwards [s].
class ShapeLog {
public:
    void note_obstacle(const LogFields& topic, double time);
    void note_area(const LogFields& topic, double time);
    /// @param knows_any  the step knows obstacles or closed areas; otherwise none is believed from now on
    void note_step(double time, bool knows_any);
    /// In order of PageShape::from.
    [[nodiscard]] const std::vector<PageShape>& shapes() const noexcept { return shapes_; }

private:
    void take_round(double known);

    flightlog::ShapeCollector rounds_;
    flightlog::Shapes believed_;             ///< the newest round
    std::vector<std::size_t> obstacles_at_;  ///< in shapes_, of its obstacles
    std::vector<std::size_t> areas_at_;
    std::vector<PageShape> shapes_;
    double none_since_ = 0.0;  ///< the newest step that knew nothing
};

}  // namespace jink::host
