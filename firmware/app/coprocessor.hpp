// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/world/obstacle_table.hpp"
#include "core/world/track_table.hpp"
#include "firmware/app/constraint_upload.hpp"
#include "firmware/app/constraints.hpp"
#include "firmware/app/follow_check.hpp"
#include "firmware/app/nominal_paths.hpp"
#include "firmware/app/param_service.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/app/stick_watch.hpp"
#include "firmware/app/takeover.hpp"
#include "firmware/app/text.hpp"
#include "firmware/link/link.hpp"
#include "firmware/link/sensor_bus.hpp"
#include "hal/last_words.hpp"
#include "hal/serial_port.hpp"
#include "hal/watchdog.hpp"

namespace jink::app {

class Clouds;

class ReachPicture;

/// Why the co-processor is not fit to act; a bit set.
enum class Fault : std::uint16_t {
    none = 0,
    no_autopilot = 1,       ///< never heard
    autopilot_silent = 2,   ///< HEARTBEAT too old
    own_state_missing = 4,  ///< the autopilot's; that of a receiver on the bus is good for advice alone
    own_state_stale = 8,
    port_lost = 16,
    late = 32,                ///< the last step came later than two ticks after the one before
    not_finite = 64,          ///< a command that is not a number: never sent
    passive = 128,            ///< told to plan and ask nothing (stay_passive)
    bus_lost = 256,           ///< the sensor bus is not there: nothing seen does not mean that there is nothing
    airspace_unplaced = 512,  ///< something closed is known by its place on the globe, but no origin to place it by
};

[[nodiscard]] constexpr std::uint16_t bit(Fault fault) noexcept { return static_cast<std::uint16_t>(fault); }

/// Whose own state the picture of the world is drawn about.
enum class OwnSource : std::uint8_t { none, autopilot, bus };

/// What one step did and cost.
struct StepReport {
    link::SystemState state = link::SystemState::boot;
    std::uint16_t faults = 0;      ///< Fault bits
    bool deadline_missed = false;  ///< this step came late
    bool setpoint_sent = false;
    std::uint32_t work = 0;  ///< units of the supervisor's budget
    std::uint32_t bytes_in = 0;
    std::uint32_t bytes_out = 0;
    std::uint16_t tracks = 0;
    std::uint16_t uncertain_heights = 0;  ///< tracks with a Track::half_height
    std::uint16_t obstacles = 0;
    std::uint16_t barrels = 0;  ///< closed volumes and storm cells that are known
    Control control = Control::autopilot;
    OwnSource own_source = OwnSource::none;
    avoid::Guidance guidance;
};

/// Counts since start, beside those of the rooms (see the accessors).
struct Diagnostics {
    std::uint32_t steps = 0;
    std::uint32_t deadlines_missed = 0;
    std::uint32_t setpoints = 0;
    std::uint32_t setpoints_withheld = 0;  ///< ticks of the stream whose velocity was not a number
    std::uint32_t own_states = 0;
    std::uint32_t own_state_refused = 0;  ///< stamped in the future, or older than what is known
    std::uint32_t estimator_resets = 0;
    std::uint32_t autopilot_reboots = 0;
    std::uint32_t params_set = 0;
    std::uint32_t params_refused = 0;
    std::uint32_t params_unknown = 0;
    std::uint32_t commands = 0;
    std::uint32_t commands_refused = 0;
    std::uint32_t scans = 0;
    std::uint32_t readings = 0;
    std::uint32_t readings_refused = 0;  ///< not level, and wider than kWidestSteep
    std::uint32_t tracks_in = 0;
    std::uint32_t own_heard = 0;     ///< own transponder (JNK_OWN_ICAO), heard back
    std::uint32_t legs_dropped = 0;  ///< the autopilot went on to a place that is not known: the own motion is the way
    std::uint32_t faults = 0;        ///< times the state became CRITICAL
    std::uint32_t bus_states = 0;    ///< own states of the bus that were used: the autopilot's was missing or old
    std::uint32_t bus_states_beside = 0;    ///< that were not needed
    std::uint32_t bus_states_refused = 0;   ///< stamped in the future, or older than what is known
    std::uint32_t bus_reports_dropped = 0;  ///< reports of the bus, placed before the frame changed within the step
    std::uint32_t places_disagree = 0;      ///< times the autopilot's and the bus's own place came to differ too much
    std::uint32_t frame_changes = 0;        ///< from the bus's own frame to the autopilot's: all places forgotten
    std::uint32_t origin_changes = 0;       ///< the link knows better, or another: traffic goes by as much
    std::uint32_t tracks_not_moved = 0;     ///< and was forgotten: by more than the map reaches
    std::uint32_t near_told = 0;            ///< NearObjects that went out
};

/// The co-processor: one call does everything the firmware does in a tick. Images own the ports and call it; so do the
/// tests and the simulator.
///
/// A sensor bus beside the link is optional. Its traffic and ranges count like the link's. Frames:
/// * Until an autopilot is heard, places are in the bus's own frame (about its first fix), nobody is there to be
///   steered, and there are no bounds, because there is no home they could refer to.
/// * From the first HEARTBEAT on there is one frame, the autopilot's. The bus places by the origin that the link knows,
///   and nothing while it knows none; what was known in the bus's own frame is forgotten.
/// * Another origin (of a better source, or moved by the autopilot) moves the tracks by as much within the step: they
///   are known by their place on the globe. Own state, home, echoes and ground were told in the local frame itself and
///   stay; a frame that jumps under them is told as an estimator's reset. The link places the leg anew.
/// * Own state is the autopilot's while that is fresh (OWN_AGE). Otherwise the bus's, for advice alone: faults are
///   about the autopilot's, and in a fault nothing is steered.
///
/// Memory: sizeof(Coprocessor), about 110 KiB with the default capacities (most of it candidate reports;
/// JINK_MAX_CANDIDATES shrinks them). No allocation after construction, none in it. step() is O(bytes + candidates *
/// waypoints * threats), bounded by kMaxBytesPerStep and the work budget.
class Coprocessor {
public:
    /// Bytes read per step; 921600 baud bring 1843 in 20 ms.
    static constexpr std::size_t kMaxBytesPerStep = 4096;
    static constexpr Seconds kTick = 0.02F;

    Coprocessor(link::Link& link, hal::SerialPort& port, hal::Watchdog& watchdog, const Parameters& parameters,
                link::SensorBus* bus = nullptr) noexcept;
    Coprocessor(const Coprocessor&) = delete;
    Coprocessor& operator=(const Coprocessor&) = delete;

    StepReport step(TimePoint now) noexcept;

    /// From here on every step prepares what a fault handler is to say, before it sends anything. They outlive this.
    void keep_last_words(hal::LastWords& words) noexcept { last_words_ = &words; }
    /// From here on the points of the link and of the input's own port become obstacles. It outlives this, and takes
    /// nothing once this is gone.
    void use_clouds(Clouds& clouds) noexcept;
    /// One more taker of the same scans ; nothing without use_clouds() before. It outlives
    /// this.
    void forward_clouds_to(link::CloudSink& sink) noexcept;
    /// The scans that are forwarded go to this picture, and reach sets plan by it. After use_clouds(); it outlives
    /// this.
    void let_reach_sets_see(ReachPicture& picture) noexcept;
    /// What is closed from now on, in place of all that was set before, here or over the link: kept clear of like every
    /// other threat, by all methods and the final check. Constraints in the local frame are the autopilot's. What is
    /// wrong is refused and counted (ConstraintDiagnostics); what is too much is merged.
    void set_constraints(std::span<const Constraint> constraints, TimePoint now) noexcept
    {
        constraints_.tell(constraints, link_.origin(), own_.position, now);
    }
    /// Listens and says CRITICAL, but plans nothing and asks for nothing: after faults that will not end.
    void stay_passive() noexcept { passive_ = true; }
    /// The geometric planner alone, whatever the parameters say: an image whose reach sets fail their check at its
    /// start calls this, and the autopilot is told.
    void leave_out_reach_sets() noexcept;
    /// A text that waits until an autopilot is heard, kMostNotices of them; false when there is no room.
    [[nodiscard]] bool tell_when_heard(link::Severity severity, const Text& text) noexcept
    {
        return notices_.try_push_back({severity, text});
    }

    /// Values that outlived a restart come into force. Those of the constructor stay what "erase" brings back. Before
    /// the first step. @return how many were refused: out of range, or not together with the others
    std::size_t restore_parameters(const ParamValues& values) noexcept;
    /// The parameters of this generation are what a restart brings: "save" on the bus is answered by it.
    void note_stored(std::uint32_t generation) noexcept { param_service_.note_stored(generation); }
    /// The autopilot says that it is disarmed, by a HEARTBEAT not older than 1.5 s, and nothing is being taken over: a
    /// stall of seconds harms nobody.
    [[nodiscard]] bool is_disarmed(TimePoint now) const noexcept;

    /// Says CRITICAL and stops streaming: called before an image stops on purpose. The bytes are written as far as the
    /// port takes them.
    void shut_down(TimePoint now) noexcept;

    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return diagnostics_; }
    [[nodiscard]] const avoid::Diagnostics& supervisor_diagnostics() const noexcept
    {
        return supervisor_.diagnostics();
    }
    [[nodiscard]] const world::TrackDiagnostics& track_diagnostics() const noexcept { return tracks_.diagnostics(); }
    [[nodiscard]] const world::ObstacleDiagnostics& obstacle_diagnostics() const noexcept
    {
        return obstacles_.diagnostics();
    }
    [[nodiscard]] const ConstraintDiagnostics& constraint_diagnostics() const noexcept
    {
        return constraints_.diagnostics();
    }
    [[nodiscard]] const ConstraintUploadDiagnostics& constraint_upload_diagnostics() const noexcept
    {
        return constraint_upload_.diagnostics();
    }
    [[nodiscard]] const TakeoverDiagnostics& takeover_diagnostics() const noexcept { return takeover_.diagnostics(); }
    [[nodiscard]] const NominalPaths& nominal_paths() const noexcept { return nominal_; }
    [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
    /// Those of the constructor.
    [[nodiscard]] const ParamValues& initial_parameters() const noexcept { return param_service_.initial(); }
    [[nodiscard]] const geometric::Planner& planner() const noexcept { return planner_; }
    /// For studies on a bench: settings that no parameter reaches. The next change of a parameter takes them back.
    [[nodiscard]] geometric::Planner& planner() noexcept { return planner_; }
    [[nodiscard]] const reach::Planner& reach_planner() const noexcept { return reach_; }
    [[nodiscard]] const orca::Planner& orca_planner() const noexcept { return orca_; }
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return supervisor_.flying(); }
    [[nodiscard]] const vehicle::VehicleState& own() const noexcept { return own_; }
    /// The autopilot as last heard; nullptr: never.
    [[nodiscard]] const link::AutopilotReport* autopilot() const noexcept
    {
        return has_autopilot_ ? &autopilot_ : nullptr;
    }
    /// Home in the local frame [m]; its origin until it was received.
    [[nodiscard]] const Vec3& home() const noexcept { return home_; }
    /// As a plan at `now` has them, until the next step.
    [[nodiscard]] std::span<const world::Track> tracks(TimePoint now) noexcept { return tracks_.snapshot(now); }

private:
    void read_port(TimePoint now, StepReport& report) noexcept;
    void write_port(StepReport& report) noexcept;
    void take_inbox(TimePoint now) noexcept;
    void read_bus(TimePoint now) noexcept;
    void follow_origin() noexcept;
    void settle_frame(std::size_t bus_tracks) noexcept;
    void take_bus_state(TimePoint now) noexcept;
    void compare_places(const vehicle::VehicleState& fix) noexcept;
    void tell_bus(TimePoint now, const StepReport& report) noexcept;
    void tell_near(TimePoint now, const StepReport& report) noexcept;
    void say(link::Severity severity, std::string_view text) noexcept;
    void forget_places() noexcept;
    void use_own(const link::OwnStateReport& report, OwnSource source) noexcept;
    void take_own_state(TimePoint now) noexcept;
    void take_autopilot(TimePoint now) noexcept;
    void take_tracks(TimePoint now) noexcept;
    void take_scan(TimePoint now) noexcept;
    void take_readings() noexcept;
    void take_clouds(TimePoint now) noexcept;
    void take_params() noexcept;
    void take_commands() noexcept;
    void take_constraints(TimePoint now) noexcept;
    void apply_configuration() noexcept;
    [[nodiscard]] avoid::Settings supervisor_settings() const noexcept;
    void prepare_last_words() noexcept;
    void tell_notices() noexcept;
    void take_reading(const link::RangeReading& reading) noexcept;
    [[nodiscard]] geometry::Shape overhead_echo(const link::RangeReading& reading) const noexcept;
    void place(std::uint32_t id, const geometry::Shape& shape, TimePoint expires) noexcept;
    void place_level(std::uint32_t first, float yaw, float range, float half_angle, TimePoint expires) noexcept;
    void remove_obstacles(std::uint32_t first, std::size_t n) noexcept;
    [[nodiscard]] std::uint16_t find_faults(TimePoint now, bool late) const noexcept;
    [[nodiscard]] vehicle::VehicleState own_at(TimePoint now) const noexcept;
    [[nodiscard]] const world::Leg* flown_leg() const noexcept;
    [[nodiscard]] world::Airspace airspace(TimePoint now) const noexcept;
    void note_block(const avoid::Guidance& guidance) noexcept;
    void control(TimePoint now, StepReport& report) noexcept;
    [[nodiscard]] TakeoverInput takeover_input(TimePoint now, const vehicle::VehicleState& own,
                                               const StepReport& report) noexcept;
    [[nodiscard]] bool can_steer() const noexcept;
    [[nodiscard]] bool is_hold_urgent(TimePoint now, const vehicle::VehicleState& own,
                                      const avoid::Guidance& guidance) noexcept;
    void tell_autopilot_state(const StepReport& report) noexcept;
    [[nodiscard]] Seconds setpoint_period() const noexcept;
    void send_setpoint(TimePoint now, const vehicle::VehicleState& own, StepReport& report) noexcept;
    void ask_autopilot(const TakeoverOutput& output, TimePoint now) noexcept;
    void drop_stale(TimePoint now) noexcept;
    void tell(TimePoint now, const StepReport& report) noexcept;
    void tell_braking(TimePoint now, const avoid::Guidance& guidance) noexcept;
    void announce(TakeoverEvent event) noexcept;
    void warn_of_conflict(TimePoint now, const StepReport& report) noexcept;
    [[nodiscard]] link::SystemState system_state(const StepReport& report) const noexcept;

    struct Notice {
        link::Severity severity = link::Severity::info;
        Text text;
    };
    /// What a start has to tell of the one before: two lines of a fault, one of what follows from it.
    static constexpr std::size_t kMostNotices = 3;

    link::Link& link_;
    hal::SerialPort& port_;
    hal::Watchdog& watchdog_;
    Parameters parameters_;
    link::SensorBus* bus_;
    std::uint32_t applied_generation_ = 0;
    // The supervisor's settings depend on these two: they come before it.
    bool leaves_reach_out_ = false;
    ReachPicture* reach_picture_ = nullptr;
    geometric::Planner planner_;
    reach::Planner reach_;
    orca::Planner orca_;
    avoid::Supervisor<geometric::Planner, reach::Planner, orca::Planner> supervisor_;
    bool told_left_out_ = false;
    bool told_unsuited_ = false;
    bool told_flood_ = false;
    Takeover takeover_;
    FollowCheck follow_check_;
    StickWatch stick_watch_;
    bool sticks_moved_ = false;
    bool told_advising_ = false;   ///< that this vehicle cannot be steered
    int unsteerable_reports_ = 0;  ///< HEARTBEATs in a row
    bool loss_untold_ = false;     ///< control was lost while the line was down
    world::TrackTable tracks_;
    world::ObstacleTable obstacles_;
    ConstraintTable constraints_;
    ConstraintUpload constraint_upload_;
    link::Inbox inbox_;
    std::array<std::byte, kMaxBytesPerStep> bytes_{};

    vehicle::VehicleState own_;
    bool has_own_ = false;
    bool own_yaw_known_ = false;
    OwnSource own_source_ = OwnSource::none;
    bool has_autopilot_own_ = false;
    TimePoint autopilot_own_;  ///< stamp of the autopilot's newest
    TimePoint bus_own_;        ///< and of the bus's
    bool follows_origin_ = false;
    std::optional<link::GlobalPosition> origin_;     ///< that the bus was told
    std::optional<link::GlobalPosition> placed_by_;  ///< that the tracks were placed by
    bool places_differ_ = false;
    bool bus_was_up_ = false;
    bool told_alone_ = false;
    TimePoint last_near_;
    link::AutopilotReport autopilot_;
    bool has_autopilot_ = false;
    bool new_autopilot_report_ = false;
    decltype(link::Inbox::earlier_autopilot) earlier_reports_;
    bool mode_denied_ = false;
    bool mode_accepted_ = false;
    world::Leg leg_;
    bool has_leg_ = false;
    NominalPaths nominal_;
    bool way_blocked_ = false;  ///< given up in front of what stands: a hold is asked for, or held
    Vec3 home_ = Vec3::Zero();
    bool has_ground_ = false;  ///< seen by a sensor that looks down
    float ground_ = 0.0F;
    TimePoint ground_expires_;
    bool was_port_open_ = false;
    std::uint16_t last_faults_ = 0;
    std::uint16_t param_cursor_ = 0;
    bool param_listing_ = false;
    bool has_stepped_ = false;
    TimePoint last_step_;
    TimePoint last_heartbeat_;
    TimePoint last_setpoint_;
    Vec3 last_velocity_ = Vec3::Zero();  ///< of the last set-point [m/s]
    TimePoint last_mode_request_;
    TimePoint last_collision_;
    bool heartbeat_sent_ = false;
    link::SystemState told_state_ = link::SystemState::boot;
    bool told_conflict_ = false;
    bool told_unsafe_ = false;   ///< in this conflict
    bool told_braking_ = false;  ///< likewise
    TimePoint last_conflict_;
    Diagnostics diagnostics_;
    hal::LastWords* last_words_ = nullptr;
    Clouds* clouds_ = nullptr;
    StaticVector<Notice, kMostNotices> notices_;
    bool passive_ = false;
    ParamService param_service_;
};

}  // namespace jink::app
