// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "firmware/app/autopilot_control.hpp"
#include "firmware/app/autopilot_state.hpp"
#include "firmware/app/decision.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/intake.hpp"
#include "firmware/app/outbox.hpp"
#include "firmware/app/own_state.hpp"
#include "firmware/app/param_exchange.hpp"
#include "firmware/app/picture.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/app/telemetry.hpp"
#include "hal/watchdog.hpp"

namespace jink::app {

/// The co-processor: one call does everything the firmware does in a tick. Images own the ports and call it; so do the
/// tests and the simulator. It is put together from parts, each with a header of its own; a part reads other parts and
/// acts through the outbox alone.
///
/// A sensor bus beside the link is optional. Its traffic and ranges count like the link's. Frames:
/// * Until an autopilot is heard, places are in the bus's own frame (about its first fix), nobody is there to be
///   steered, and there are no bounds, because there is no home they could refer to.
/// * From the first HEARTBEAT on there is one frame, the autopilot's. The bus places by the origin that the link knows,
///   and nothing while it knows none; what was known in the bus's own frame is forgotten.
/// * Another origin (of a better source, or moved by the autopilot) moves the tracks by as much within the step: they
///   are known by their place on the globe. Own state, home, returns and ground were reported in the local frame itself
///   and stay; a frame that jumps under them is reported as an estimator's reset. The link places the leg anew.
/// * Own state is the autopilot's while that is fresh (OWN_AGE). Otherwise the bus's, for advice alone: faults are
///   about the autopilot's, and in a fault nothing is steered.
///
/// Memory: sizeof(Coprocessor), about 110 KiB with the default capacities (most of it candidate reports;
/// JINK_MAX_CANDIDATES shrinks them). No allocation after construction, none in it. step() is O(bytes + candidates *
/// waypoints * threats), bounded by kMaxBytesPerStep and the work budget.
class Coprocessor {
public:
    /// Bytes read per step; 921600 baud bring 1843 in 20 ms.
    static constexpr std::size_t kMaxBytesPerStep = Intake::kMaxBytesPerStep;
    static constexpr Seconds kTick = AutopilotControl::kTick;

    Coprocessor(link::Link& link, hal::SerialPort& port, hal::Watchdog& watchdog, const Parameters& parameters,
                link::SensorBus* bus = nullptr) noexcept;
    Coprocessor(const Coprocessor&) = delete;
    Coprocessor& operator=(const Coprocessor&) = delete;

    StepReport step(TimePoint now) noexcept;

    /// What the last step took, on a board that counts it: the longest is reported to whoever asks for a text, and each
    /// stands in the log. @param per_us  cycles of a microsecond, > 0
    void note_cycles(std::uint32_t cycles, std::uint32_t per_us) noexcept
    {
        telemetry_.note_cycles(cycles);
        last_duration_us_ = cycles / per_us;
    }
    /// From here on every step prepares the texts of a fault handler, before it sends anything. They outlive this.
    void keep_last_words(hal::LastWords& words) noexcept { telemetry_.keep_last_words(words); }
    /// From here on this log may be asked for over the link (LOGGING_START). It outlives this.
    void stream(StepLog& log) noexcept { outbox_.log_to(log); }
    /// From here on the points of the link and of the input's own port become obstacles. It outlives this, and takes
    /// nothing once this is gone.
    void use_clouds(Clouds& clouds) noexcept { picture_.use_clouds(clouds, link_); }
    /// One more consumer of the same scans; no effect before use_clouds(). It outlives this.
    void forward_clouds_to(link::CloudSink& sink) noexcept { picture_.forward_clouds_to(sink); }
    /// The scans that are forwarded go to this picture, and reach sets plan by it. After use_clouds(); it outlives
    /// this.
    void let_reach_sets_see(ReachPicture& picture) noexcept;
    /// From here on plans go on over several steps, in `plan`, and a step does as much as `work` says (WorkRate); until
    /// then a plan is made in one step. Before the first step; it outlives this. False, and nothing changed, where the
    /// work is too little (avoid::is_valid).
    [[nodiscard]] bool plan_in_slices(avoid::SlicedPlan& plan, const avoid::WorkPerUpdate& work) noexcept
    {
        return decision_.plan_in_slices(plan, work, params_.configuration());
    }
    /// What is closed from now on, in place of all that was set before, here or over the link: kept clear of like every
    /// other threat, by all methods and the final check. Constraints in the local frame are the autopilot's. What is
    /// wrong is refused and counted (ConstraintDiagnostics); what is too much is merged.
    void set_constraints(std::span<const Constraint> constraints, TimePoint now) noexcept
    {
        picture_.set_constraints(constraints, link_.origin(), own_.measured().position, now);
    }
    /// A map of known surroundings, kept clear of like what sensors see, by all methods and the final check. Good
    /// (geometry::check), before the first step; it outlives this.
    void use_map(const geometry::MeshMap& map) noexcept { picture_.use_map(map); }
    /// Listens and says CRITICAL, but plans nothing and asks for nothing: after faults that will not end.
    void stay_passive() noexcept { passive_ = true; }
    /// The geometric planner alone, whatever the parameters say: an image whose reach sets fail their check at its
    /// start calls this, and the autopilot gets a report.
    void leave_out_reach_sets() noexcept { decision_.leave_out_reach_sets(params_.configuration()); }
    /// A text that waits until an autopilot is heard. @return false: Outbox::kMaxNotices wait already
    [[nodiscard]] bool tell_when_heard(link::Severity severity, const Text& text) noexcept
    {
        return outbox_.keep(severity, text);
    }

    /// Values that outlived a restart come into force. Those of the constructor stay what "erase" brings back. Before
    /// the first step. @return how many were refused: out of range, or not together with the others
    std::size_t restore_parameters(const ParamValues& values) noexcept;
    /// The parameters of this generation are what a restart brings: "save" on the bus is answered by it.
    void note_stored(std::uint32_t generation) noexcept { params_.service().note_stored(generation); }
    /// The autopilot says that it is disarmed, by a HEARTBEAT not older than 1.5 s, and nothing is being taken over: a
    /// stall of seconds harms nobody.
    [[nodiscard]] bool is_disarmed(TimePoint now) const noexcept;

    /// Says CRITICAL and stops streaming: called before an image stops on purpose. The bytes are written as far as the
    /// port takes them.
    void shut_down(TimePoint now) noexcept;

    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return diagnostics_; }
    [[nodiscard]] const avoid::Diagnostics& supervisor_diagnostics() const noexcept { return decision_.diagnostics(); }
    [[nodiscard]] const world::TrackDiagnostics& track_diagnostics() const noexcept
    {
        return picture_.track_table().diagnostics();
    }
    [[nodiscard]] const world::ObstacleDiagnostics& obstacle_diagnostics() const noexcept
    {
        return picture_.obstacle_table().diagnostics();
    }
    [[nodiscard]] const ConstraintDiagnostics& constraint_diagnostics() const noexcept
    {
        return picture_.constraints().diagnostics();
    }
    [[nodiscard]] const KnownMap& known_map() const noexcept { return picture_.known_map(); }
    [[nodiscard]] const ConstraintUploadDiagnostics& constraint_upload_diagnostics() const noexcept
    {
        return picture_.constraint_upload().diagnostics();
    }
    [[nodiscard]] const TakeoverDiagnostics& takeover_diagnostics() const noexcept
    {
        return control_.takeover().diagnostics();
    }
    [[nodiscard]] const NominalPaths& nominal_paths() const noexcept { return decision_.nominal_paths(); }
    [[nodiscard]] const Parameters& parameters() const noexcept { return params_.parameters(); }
    /// Those of the constructor.
    [[nodiscard]] const ParamValues& initial_parameters() const noexcept { return params_.service().initial(); }
    // The methods' own, where the image has them (built_methods.hpp).
#ifndef JINK_WITHOUT_GEOMETRIC
    [[nodiscard]] const geometric::Planner& planner() const noexcept
    {
        return decision_.methods().planner<GeometricMethod>();
    }
    /// For studies on a bench: settings that no parameter reaches. The next change of a parameter takes them back.
    [[nodiscard]] geometric::Planner& planner() noexcept { return decision_.methods().planner<GeometricMethod>(); }
#endif
    /// The geometric planner's, for logs. No result where the image is built without the planner.
    [[nodiscard]] LastPlan last_plan() const noexcept
    {
#ifndef JINK_WITHOUT_GEOMETRIC
        const CountingPlanner& asked = decision_.methods().planner<GeometricMethod>();
        return {&asked.last(), asked.plans()};
#else
        return {};
#endif
    }
#ifndef JINK_WITHOUT_REACH
    [[nodiscard]] const reach::Planner& reach_planner() const noexcept
    {
        return decision_.methods().planner<ReachMethod>();
    }
#endif
#ifndef JINK_WITHOUT_ORCA
    [[nodiscard]] const orca::Planner& orca_planner() const noexcept
    {
        return decision_.methods().planner<ReciprocalMethod>();
    }
#endif
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return decision_.flying(); }
    [[nodiscard]] const vehicle::VehicleState& own() const noexcept { return own_.measured(); }
    /// The autopilot as last heard; nullptr: never.
    [[nodiscard]] const link::AutopilotReport* autopilot() const noexcept
    {
        return autopilot_.is_heard() ? &autopilot_.report() : nullptr;
    }
    /// Home in the local frame [m]; its origin until it was received.
    [[nodiscard]] const Vec3& home() const noexcept { return picture_.home(); }
    /// As a plan at `now` has them, until the next step.
    [[nodiscard]] std::span<const world::Track> tracks(TimePoint now) noexcept { return picture_.tracks(now); }
    /// As the last step decided with them, until the next step: those of a map follow the others.
    [[nodiscard]] std::span<const world::Obstacle> obstacles() const noexcept { return picture_.obstacles(); }
    /// Those of them that are not of a map.
    [[nodiscard]] std::span<const world::Obstacle> sensed_obstacles() const noexcept { return picture_.sensed(); }
    /// Closed areas, as the last step decided with them, until the next step.
    [[nodiscard]] std::span<const world::Cylinder> closed_areas() const noexcept
    {
        return autopilot_.is_heard() ? picture_.constraints().cylinders() : std::span<const world::Cylinder>();
    }

private:
    void take_inbox(TimePoint now) noexcept;
    void heed(Jump jump) noexcept;
    void apply_configuration() noexcept;
    [[nodiscard]] std::uint16_t find_faults(TimePoint now, bool stalled) const noexcept;
    /// @return tracks that were decided with
    std::span<const world::Track> decide_and_control(TimePoint now, StepReport& report) noexcept;
    [[nodiscard]] avoid::Guidance decide(TimePoint now, const vehicle::VehicleState& own,
                                         std::span<const world::Track> tracks, StepReport& report) noexcept;
    void report_state(TimePoint now, std::span<const world::Track> tracks, StepReport& report) noexcept;

    link::Link& link_;
    hal::Watchdog& watchdog_;
    Diagnostics diagnostics_;
    ParamExchange params_;
    Outbox outbox_;
    Intake intake_;
    AutopilotState autopilot_;
    OwnState own_;
    Picture picture_;
    Decision decision_;
    AutopilotControl control_;
    Telemetry telemetry_;
    std::optional<TimePoint> last_step_;
    std::uint16_t last_faults_ = 0;
    std::uint32_t last_duration_us_ = 0;  ///< of the step before; 0: not counted
    bool passive_ = false;
};

}  // namespace jink::app
