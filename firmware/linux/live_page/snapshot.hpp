// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/live_page/shown_paths.hpp"
#include "firmware/linux/live_page/shown_shapes.hpp"

namespace jink::livepage {

/// Counters of the page itself, shown by it.
struct PageCounts {
    std::uint32_t clients = 0;   ///< that now hear events
    std::uint32_t slow = 0;      ///< closed: they took too long, or sent what nobody asked for
    std::uint32_t refused = 0;   ///< requests that were answered with a status other than 200
    std::uint32_t messages = 0;  ///< of the flight log that were lost on their way to the page
};

/// Parameters that the page shows, or shows something by. Changes in the flight log follow.
struct ShownParameters {
    float half_xy = 0.0F;    ///< JNK_HALF_XY [m]
    float lookahead = 0.0F;  ///< JNK_LOOKAHEAD [s]
    float max_cost = 1.0F;   ///< GEO_MAX_COST
};

/// The newest state of a flight, from messages of the flight log.
///
/// Own position and tracks are carried to the newest step with their velocities. Tracks and nominal paths without news
/// for kTrackLife are gone: the log has them every 0.2 s.
class Snapshot {
public:
    static constexpr double kTrackLife = 0.5;      ///< [s]
    static constexpr std::size_t kMaxTexts = 50;   ///< that a new client is sent
    static constexpr std::size_t kMaxTracks = 64;  ///< beyond: not shown, but counted in "tracks_known"

    /// @param shown  at the start
    explicit Snapshot(const ShownParameters& shown) : shown_(shown) {}

    /// Whole ULog messages, one after the other.
    void take(std::span<const std::byte> messages);
    /// A step came since the last call of `begin_next`.
    [[nodiscard]] bool has_news() const noexcept { return news_; }
    /// A step came at all.
    [[nodiscard]] bool has_step() const noexcept { return start_.has_value(); }
    /// One JSON object without line ends: docs/guides/live_page.md.
    /// @param is_first  of a client: the last kMaxTexts, the newest decision, and obstacles and closed areas; otherwise
    /// what came or changed since the last call of `begin_next`
    [[nodiscard]] std::string json(bool is_first, const PageCounts& counts) const;
    /// The next period begins: its texts and its most expensive step.
    void begin_next() noexcept;

private:
    struct Text {
        std::uint64_t number = 0;  ///< since the start
        std::uint64_t timestamp = 0;
        int level = 0;
        std::string text;
    };
    void take_message(std::uint8_t type, std::span<const std::byte> content);
    void take_data(std::span<const std::byte> content);
    void take_step(const flightlog::StepTopic& step);
    void take_track(const flightlog::TrackTopic& track);
    void take_parameter(std::span<const std::byte> content);
    [[nodiscard]] double seconds(std::uint64_t timestamp) const noexcept;
    void add_step(std::string& out) const;
    void add_own(std::string& out) const;
    void add_conflict(std::string& out) const;
    void add_tracks(std::string& out) const;
    void add_paths(std::string& out, bool is_first) const;
    void add_shapes(std::string& out, bool is_first) const;
    void add_texts(std::string& out, bool all) const;

    ShownParameters shown_;
    std::optional<std::uint64_t> start_;
    flightlog::StepTopic step_;
    std::optional<flightlog::OwnTopic> own_;
    std::vector<flightlog::TrackTopic> tracks_;
    ShownPaths paths_;
    ShownShapes shapes_;
    std::deque<Text> texts_;
    std::uint64_t texts_seen_ = 0;
    std::uint64_t texts_reported_ = 0;
    std::uint32_t decisions_ = 0;
    std::uint32_t deadlines_ = 0;  ///< missed
    std::uint32_t max_work_ = 0;   ///< of a step of this period
    std::uint32_t max_us_ = 0;
    bool news_ = false;
};

}  // namespace jink::livepage
