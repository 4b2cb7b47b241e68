// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/arduplane.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/item_pilot.hpp"
#include "toolchain/sim/mission_pilot.hpp"
#include "toolchain/sim/mission_server.hpp"
#include "toolchain/sim/sensors.hpp"
#include "toolchain/sim/world.hpp"

namespace jink::sim {

/// The co-processor's component id: obstacle avoidance.
inline constexpr std::uint8_t kJink = 196;
/// MAV_FRAME_LOCAL_NED.
inline constexpr std::uint8_t kLocalNed = 1;
/// SET_POSITION_TARGET_LOCAL_NED type mask that uses the velocity alone: links.md, B.1.
inline constexpr std::uint16_t kVelocityMask = 0x0DC7;

/// PX4's checksum of the mission, in MISSION_COUNT and MISSION_CURRENT.
inline constexpr std::uint32_t kMissionId = 2089934376;

/// A received STATUSTEXT.
struct Text {
    double time = 0.0;
    int severity = 0;
    std::string text;
};

/// The co-processor's behaviour as observed on the link.
struct Heard {
    unsigned frames = 0;
    unsigned frames_refused = 0;  ///< noise, wrong checksums
    unsigned heartbeats = 0;
    int state = 0;  ///< MAV_STATE of the newest heartbeat, 0: none received
    Micros last_heartbeat = -1;
    Micros longest_heartbeat_gap = 0;
    unsigned setpoints = 0;
    unsigned bad_setpoints = 0;        ///< mask, frame, target or values that an autopilot refuses
    unsigned setpoints_overruled = 0;  ///< sent more than 0.2 s after another sender chose a mode
    Micros longest_setpoint_gap = 0;   ///< while in external mode
    unsigned jumps = 0;                ///< of the velocity that is flown, by more than half the cruise speed at once
    unsigned warnings = 0;             ///< COLLISION
    Micros first_warning = -1;         ///< of them [us]
    Micros last_warning = -1;          ///< [us]
    unsigned external_requests = 0;
    unsigned refused_requests = 0;  ///< of any mode
    std::vector<Text> texts;
};

/// The autopilot's end of the link: models ArduPilot Copter or PX4 as seen by a companion, flying the vehicle of a
/// World.
///
/// Modes, set-point time-outs and refusals follow the stacks' own rules (docs/guides/take_over.md). Both fly
/// velocities that come in their external mode alone. ArduPilot stops 3 s after the last one. PX4 enters OFFBOARD if
/// one came within half a second (its documentation wants a second of them: Faults::offboard_proof), and changes to
/// AUTO.LOITER 1 s after the last one. A vehicle with a min_speed is ArduPlane (arduplane.hpp).
class Autopilot {
public:
    /// @param world  outlives the autopilot
    explicit Autopilot(World& world);

    /// Bytes from the co-processor, as they arrive.
    void receive(std::span<const std::byte> bytes);
    /// One kStep: sends the telemetry that is due and advances the world under the present mode's command.
    void step();
    /// Frames of other systems from the radio: routed to the co-processor unchanged.
    void relay(std::span<const std::byte> frames);
    /// The position that the autopilot reports.
    [[nodiscard]] link::mavlink::GlobalPositionInt global_position() const;
    [[nodiscard]] link::mavlink::Heartbeat heartbeat() const;
    /// Everything to be sent since the last call.
    [[nodiscard]] std::vector<std::byte> take_output();

    /// Position of the autopilot's own estimate, before latency [m].
    [[nodiscard]] Vec believed_position() const { return world_.own().position + estimate_.bias(); }
    [[nodiscard]] Mode mode() const noexcept { return mode_; }
    [[nodiscard]] const Heard& heard() const noexcept { return heard_; }
    [[nodiscard]] const MissionPilot& mission() const noexcept { return mission_; }
    /// CRITICAL texts to the pilot that the co-processor caused.
    [[nodiscard]] const std::vector<std::string>& critical_texts() const noexcept { return server_.critical(); }
    /// The set-point in force [m/s], external mode.
    [[nodiscard]] const Vec& setpoint() const noexcept { return setpoint_; }
    [[nodiscard]] const Vec& command() const noexcept { return command_; }
    [[nodiscard]] unsigned takeovers() const noexcept { return takeovers_; }
    /// True when the co-processor requested the last change of mode.
    [[nodiscard]] bool last_change_was_asked() const noexcept { return last_change_was_asked_; }
    [[nodiscard]] Micros mode_since() const noexcept { return mode_since_; }
    /// When the last parameter was verified [us]; -1: not yet.
    [[nodiscard]] Micros parameters_verified() const noexcept { return parameters_verified_; }
    [[nodiscard]] std::vector<std::string> parameters_missing() const;
    /// Time at which the first message that reports a threat was sent [us]; -1: not yet. Scan messages do not count.
    [[nodiscard]] Micros reported(std::size_t threat) const { return reported_[threat].first; }
    /// The same of the first message since the threat's last turn.
    [[nodiscard]] Micros course_reported(std::size_t threat) const { return reported_[threat].course; }

private:
    struct Reported {
        Micros first = -1;
        Micros course = -1;
        std::size_t turns = 0;
    };
    struct Wanted {
        std::string name;
        float value = 0.0F;
        bool verified = false;
    };

    void handle(const link::mavlink::Frame& frame);
    void hear_heartbeat(const link::mavlink::Heartbeat& heartbeat);
    void hear_setpoint(const link::mavlink::SetPositionTargetLocalNed& target);
    void hear_command(const link::mavlink::CommandLong& command, link::mavlink::Header from);
    void hear_command_int(const link::mavlink::CommandInt& command, link::mavlink::Header from);
    void hear_param(const link::mavlink::ParamValue& value);
    void answer_param(const link::mavlink::ParamRequestRead& request);
    void answer_timesync(const link::mavlink::Timesync& sync, link::mavlink::Header from);
    [[nodiscard]] std::uint8_t set_mode(const link::mavlink::CommandLong& command);
    [[nodiscard]] bool send_message(int id);
    [[nodiscard]] link::mavlink::HomePosition home_position() const;

    void enter(Mode mode, bool asked);
    void suffer_faults();
    void follow_others();
    void watch_setpoints();
    void aim_plane();
    [[nodiscard]] Vec mission_velocity();
    [[nodiscard]] Vec pilot_velocity(const Truth& own);
    [[nodiscard]] Vec held_place(const Truth& own);
    [[nodiscard]] Vec plane_velocity(const Truth& own);
    [[nodiscard]] std::vector<link::mavlink::MissionItemInt> mission_items() const;
    [[nodiscard]] link::mavlink::MissionItemInt item_at(const Item& item, std::size_t index) const;
    [[nodiscard]] std::uint16_t sequence() const noexcept;
    [[nodiscard]] std::uint32_t mission_id() const noexcept;
    [[nodiscard]] Vec wanted_velocity();

    void send_telemetry();
    void send_heartbeat();
    void send_own_state();
    void send_odometry();
    void send_mission_state();
    void send_slow();
    void send_target();
    void send_parameters();
    void send_traffic();
    void send_scan();
    [[nodiscard]] Micros boot_us() const noexcept;
    [[nodiscard]] std::uint32_t boot_ms() const noexcept { return static_cast<std::uint32_t>(boot_us() / 1000); }
    /// True `rate` times a second from the start on. If kStep does not divide the interval, intervals differ by kStep.
    [[nodiscard]] bool often(Micros rate) const noexcept
    {
        return world_.now() == 0 || world_.now() * rate / kSecond != (world_.now() - kStep) * rate / kSecond;
    }
    [[nodiscard]] bool due(Micros period, Micros phase = 0) const noexcept { return world_.now() % period == phase; }
    [[nodiscard]] bool is_plane() const noexcept { return scenario_.vehicle.min_speed > 0.0; }
    [[nodiscard]] bool rebooting() const noexcept;
    [[nodiscard]] bool for_us(std::uint8_t system, std::uint8_t component) const noexcept;
    [[nodiscard]] std::uint16_t home_items() const noexcept;

    World& world_;
    const Scenario& scenario_;
    MissionPilot mission_;
    PlaneGuidance plane_;
    std::unique_ptr<ItemPilot> items_;  ///< flown in place of `mission_`
    OwnEstimate estimate_;
    TrafficReceiver receiver_;
    link::mavlink::Parser parser_;
    FrameWriter writer_;
    MissionServer server_;
    Heard heard_;
    std::vector<Wanted> wanted_;
    Micros parameters_verified_ = -1;
    std::vector<Reported> reported_;  ///< by threat

    Mode mode_ = Mode::mission;
    Micros mode_since_ = 0;
    bool last_change_was_asked_ = false;
    bool pilot_acted_ = false;
    bool rebooted_ = false;
    unsigned takeovers_ = 0;
    Vec setpoint_ = Vec::Zero();
    Micros last_setpoint_ = -1;  ///< newest acceptable one
    Micros stream_since_ = -1;   ///< first set-point of the present gap-free sequence
    Micros last_followed_ = -1;  ///< in external mode: newest set-point, or the mode's entry
    bool has_external_setpoint_ = false;
    Vec command_ = Vec::Zero();
    Vec hold_at_ = Vec::Zero();
    bool holding_ = false;
    bool reported_origin_ = false;  ///< since the boot
    bool uploaded_ = false;         ///< the ground station's mission has come
    bool sent_to_mission_ = false;
    std::uint16_t reported_sequence_ = 0;
};

}  // namespace jink::sim
