// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/linux/flight_log/shown_curves.hpp"
#include "firmware/linux/flight_log/topics.hpp"

namespace jink::livepage {

/// The newest decision with its candidates, and the nominal paths, from messages of the flight log.
///
/// A decision is complete when the step after it comes: its candidates may come in several portions. Those of another
/// decision are passed over. Memory: twice kMaxCandidates topics.
class ShownPaths {
public:
    /// Of a decision: four times as many as a plan has by default. Beyond, the first ones and the chosen one are shown.
    /// Their curves take 100 KiB of an event at most.
    static constexpr std::size_t kMaxCandidates = 128;

    void take(const flightlog::DecisionTopic& decision);
    void take(const flightlog::CandidateTopic& candidate);
    void take(const flightlog::NominalTopic& segment);
    /// A step came: the decision before it is complete.
    void end_decision();
    /// The decision is not new any more.
    void begin_next() noexcept { is_new_ = false; }

    [[nodiscard]] bool has_new_decision() const noexcept { return is_new_; }
    /// Of the newest decision, and of the nominal paths; nothing: there is none [us].
    [[nodiscard]] std::optional<std::uint64_t> decision_time() const noexcept;
    [[nodiscard]] std::optional<std::uint64_t> nominal_time() const noexcept { return nominal_time_; }

    /// Appends JSON. There is a decision, made at `time` [s].
    void add_decision(std::string& out, double time, float max_cost) const;
    /// Appends JSON: the path that is flown in control first.
    /// @param own        not finite: unknown [m]
    /// @param lookahead  paths are shown so far ahead [s]
    void add_nominal(std::string& out, const Vec3& own, Seconds lookahead) const;

private:
    struct Decision {
        flightlog::DecisionTopic topic;
        std::vector<flightlog::CandidateTopic> candidates;
        std::uint32_t known = 0;  ///< candidates, shown or not
    };

    std::optional<Decision> growing_;
    std::optional<Decision> newest_;
    bool is_new_ = false;
    std::array<flightlog::NominalRoute, 2> nominal_;
    std::optional<std::uint64_t> nominal_time_;
};

}  // namespace jink::livepage
