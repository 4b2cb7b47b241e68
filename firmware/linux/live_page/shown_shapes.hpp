// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "firmware/linux/flight_log/shown_shapes.hpp"

namespace jink::livepage {

/// Obstacles and closed areas as jink believes them, from messages of the flight log: those of the newest complete
/// round, for flightlog::kShapeLife. Memory: three rounds.
class ShownShapes {
public:
    template <class T>
    void take(const T& topic)
    {
        if (rounds_.take(topic)) {
            take_round();
        }
    }
    /// A step came.
    /// @param knows_any  it knows obstacles or closed areas; otherwise nothing is shown from now on
    void note_step(std::uint64_t timestamp, bool knows_any);
    /// What is shown is not new any more.
    void begin_next() noexcept { is_new_ = false; }

    /// What is shown has changed since `begin_next`.
    [[nodiscard]] bool is_new() const noexcept { return is_new_; }
    /// When it was known [us]; 0: nothing yet.
    [[nodiscard]] std::uint64_t known() const noexcept { return shown_.known; }

    /// Appends JSON: known at `time` [s].
    void add(std::string& out, double time) const;

private:
    void take_round();

    flightlog::ShapeCollector rounds_;
    flightlog::Shapes shown_;
    std::uint64_t newest_ = 0;  ///< the newest round, the same as what is shown, was known [us]
    bool knows_any_ = false;
    bool is_new_ = false;
};

}  // namespace jink::livepage
