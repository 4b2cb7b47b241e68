// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/orca/monitor.hpp"
#include "core/orca/prediction.hpp"
#include "core/path/trajectory_generator.hpp"
#include "firmware/app/mission_upload.hpp"
#include "firmware/link/mission/frame.hpp"

namespace jink::app {

/// Why the vehicle does not fly what it should; a bit set.
enum class MissionFault : std::uint16_t {
    none = 0,
    own_state_stale = 1,    ///< no STATE_OWN for kOwnStateAge: v = 0 is held
    no_preferred = 2,       ///< no preferred velocity for kPreferredAge: 0 is preferred, and avoidance goes on
    tripped = 4,            ///< the monitor, not yet acknowledged
    neighbour_dropped = 8,  ///< there are more than are kept
};
[[nodiscard]] constexpr std::uint16_t bit(MissionFault fault) noexcept { return static_cast<std::uint16_t>(fault); }

/// What the line asks of whoever has the settings, the map and the monitor.
class MissionHost {
public:
    /// Sets what has this key, or reads it.
    /// @param value  finite; out: what is in force
    [[nodiscard]] virtual link::mission::ConfigStatus configure(std::uint16_t key, bool set, float& value) noexcept = 0;
    [[nodiscard]] virtual link::mission::MapInfo map_info() const noexcept = 0;
    virtual void acknowledge_trip() noexcept = 0;

protected:
    ~MissionHost() = default;
};

/// A vehicle as it says of itself, placed on our clock.
struct MissionNeighbour {
    orca::Broadcast heard;
    float radius_xy = 0.0F;  ///< its share of the required separations [m]
    float radius_z = 0.0F;
    Seconds horizon = 0.0F;  ///< tau
    bool cooperative = false;
    TimePoint arrival;
};

/// What the avoidance is to fly by in a tick.
struct MissionInput {
    std::uint16_t faults = 0;  ///< MissionFault bits
    bool hold = false;         ///< fly v = 0, whatever the avoidance would say: the own state is not known
    vehicle::VehicleState own;
    Vec3 preferred = Vec3::Zero();  ///< [m/s]
};

/// Counts since start.
struct MissionDiagnostics {
    std::uint32_t states = 0;
    std::uint32_t neighbour_states = 0;
    std::uint32_t refused = 0;  ///< streams with numbers that are none or out of range, or of ourselves
    std::uint32_t older = 0;    ///< streams that say less than what is known
    std::uint32_t events = 0;
    std::uint32_t events_refused = 0;   ///< the queue was full, and the sender was told
    std::uint32_t answers_dropped = 0;  ///< not told even that: there was no room for answers
    std::uint32_t neighbours_dropped = 0;
    std::uint32_t unexpected = 0;  ///< messages that only go out
};

/// The vehicle's end of the mission line (G-ORCA 16, Alejo C.2.1): tasks come in and are flown, reports go out; states
/// of vehicles go both ways. A state machine without ports: bytes in, bytes out.
///
/// * Streams (own state, neighbours, our state, our command): one place each, the newest wins.
/// * Events (tasks, settings, acknowledgements): a queue of kMostEvents, kEventsPerStep of which are answered in a
///   step. What finds it full is refused with a status.
/// * Answers: a queue of kMostAnswers. MISSION_REPORT goes out on a change and every kReportPeriod, MONITOR_TRIP every
///   kReportPeriod until TRIP_ACK comes: whatever is lost on the way comes again.
/// * Loss: no own state for kOwnStateAge: hold; no preferred velocity for kPreferredAge: 0 is preferred.
///
/// Neighbours: kMostNeighbours; when full the farthest gives way, or the new one where that is farther.
/// Memory: about 22 KiB. No allocation.
class MissionProtocol final : private link::mission::FrameSink {
public:
    static constexpr Seconds kOwnStateAge = 0.2F;
    static constexpr Seconds kPreferredAge = 0.5F;
    static constexpr Seconds kReportPeriod = 1.0F;
    static constexpr std::size_t kMostEvents = 8;
    static constexpr std::size_t kEventsPerStep = 4;
    static constexpr std::size_t kMostAnswers = 16;
    static constexpr std::size_t kMostNeighbours = 64;

    /// @param id          of this vehicle, as others know it
    /// @param link_delay  what a frame takes on its way at least [s]: its ages are older by that much
    /// generator and host outlive this
    MissionProtocol(std::uint16_t id, Seconds link_delay, path::TrajectoryGenerator& generator,
                    MissionHost& host) noexcept
        : id_(id), link_delay_(link_delay), generator_(generator), upload_(generator), host_(host)
    {
    }

    /// Takes bytes of the line, none while it is silent. O(bytes).
    void receive(std::span<const std::byte> bytes, TimePoint now) noexcept { receiver_.receive(bytes, now, *this); }

    /// Own state of another source than the line. What is older than what is known is passed over, and what is stamped
    /// later than `now` refused: it would be believed for too long.
    void take_own_state(const vehicle::VehicleState& state, TimePoint now) noexcept;
    /// What the trajectory generator wants; finite, or it counts as not said.
    void take_preferred(const Vec3& velocity, TimePoint now) noexcept;

    /// Answers events. Once per tick. O(kEventsPerStep * kPointsPerUpload).
    void step(TimePoint now) noexcept;
    /// What to fly by now. O(1).
    [[nodiscard]] MissionInput input(TimePoint now) const noexcept;
    [[nodiscard]] std::span<const MissionNeighbour> neighbours() const noexcept
    {
        return {neighbours_.data(), neighbours_.size()};
    }
    /// A neighbour that is gone (orca::Freshness::gone).
    void forget(std::uint16_t id) noexcept;

    // Once per tick each, in any order: what there is to tell.
    void tell_state(const orca::Broadcast& own, float radius_xy, float radius_z, Seconds horizon,
                    TimePoint now) noexcept;
    void tell_command(const Vec3& velocity, std::uint32_t status, std::uint8_t level) noexcept;
    void tell_progress(const path::GeneratorOutput& output, TimePoint now) noexcept;
    void tell_monitor(const orca::Monitor& monitor, TimePoint now) noexcept;

    /// Bytes of the frame that waits to go out, and taking `n` of them off. Answers first, then our state
    /// and our command in turn; a frame that is partly consumed stays.
    [[nodiscard]] std::span<const std::byte> pending() noexcept;
    void consume(std::size_t n) noexcept;
    /// On a lost port: nothing stale may go out later.
    void discard_pending() noexcept;

    [[nodiscard]] const MissionDiagnostics& diagnostics() const noexcept { return diagnostics_; }
    [[nodiscard]] const link::mission::ReceiverDiagnostics& receiver_diagnostics() const noexcept
    {
        return receiver_.diagnostics();
    }
    [[nodiscard]] const MissionUpload& upload() const noexcept { return upload_; }

private:
    using Frame = link::mission::Frame;

    void take(const Frame& frame, TimePoint now) noexcept override;
    void take_state(const link::mission::StateOwn& state, TimePoint now) noexcept;
    void take_neighbour(std::uint16_t sender, const link::mission::StateNeighbour& state, TimePoint now) noexcept;
    void keep(const MissionNeighbour& neighbour) noexcept;
    void queue_event(const Frame& frame) noexcept;
    void answer(const Frame& event, TimePoint now) noexcept;
    void send(const Frame& frame) noexcept;

    std::uint16_t id_;
    Seconds link_delay_;
    path::TrajectoryGenerator& generator_;
    MissionUpload upload_;
    MissionHost& host_;
    link::mission::Receiver receiver_;
    MissionDiagnostics diagnostics_;

    bool has_own_ = false;
    vehicle::VehicleState own_;
    bool has_preferred_ = false;
    Vec3 preferred_ = Vec3::Zero();
    TimePoint preferred_at_;
    StaticVector<MissionNeighbour, kMostNeighbours> neighbours_;

    StaticVector<Frame, kMostEvents> events_;
    StaticVector<Frame, kMostAnswers> answers_;
    bool has_state_out_ = false;
    bool has_command_out_ = false;
    bool command_next_ = false;  ///< the streams take turns on a slow line
    Frame state_out_;
    Frame command_out_;
    std::uint16_t sequence_ = 0;
    std::array<std::byte, link::mission::kMaxFrame> out_{};
    std::size_t out_begin_ = 0;
    std::size_t out_end_ = 0;

    bool reported_ = false;
    path::GeneratorStatus told_status_ = path::GeneratorStatus::idle;
    std::uint16_t told_faults_ = 0;
    std::uint32_t told_task_ = 0;
    TimePoint told_at_;
    bool tripped_ = false;
    std::uint16_t told_trip_ = 0;
    TimePoint told_trip_at_;
};

}  // namespace jink::app
