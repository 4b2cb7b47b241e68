// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "toolchain/sim/recorded_mission.hpp"
#include "toolchain/sim/scenario.hpp"
#include "toolchain/sim/wire_file.hpp"

namespace jink::link::mavlink {
class Endpoint;
}

namespace jink::sim {

/// The nominal motion that jink expects of the vehicle.
struct NominalBelief {
    bool is_route = false;  ///< a known leg; otherwise the measured motion
    Vec end = Vec::Zero();  ///< end of the leg, or of the measured motion's prediction [m]
    double speed = 0.0;     ///< [m/s]
    bool turns = false;     ///< the measured motion begins with an arc
};

/// A place on the globe.
struct Globe {
    double lat = 0.0;  ///< [deg]
    double lon = 0.0;  ///< [deg]
    double alt = 0.0;  ///< above mean sea level [m]
};

/// jink's belief at one instant. Unknown and outdated parts are empty.
struct Belief {
    double time = 0.0;                ///< of the recording [s]
    std::optional<Stack> stack;       ///< stack whose HEARTBEATs are received
    std::optional<unsigned> vehicle;  ///< MAV_TYPE of the newest
    std::optional<std::string> mode;  ///< the autopilot's own name (mode_names.hpp)
    std::optional<bool> armed;
    std::string control;          ///< app::Control
    std::optional<Vec> position;  ///< present position, in the autopilot's local frame [m]
    std::optional<Vec> velocity;  ///< [m/s]
    std::optional<Globe> home;
    std::optional<NominalBelief> nominal;
    unsigned tracks = 0;
    bool conflict = false;
};

/// The co-processor at the receiving end of a recorded stream: Endpoint and Coprocessor of the product, on the
/// recording's clock. The recorded autopilot answered the recorded jinkd; all its bytes are fed. The endpoint's output
/// has no effect, except for two kinds of requests:
/// * TIMESYNC: a recorded answer repeats the request of the recorded jinkd, but the endpoint accepts only answers to
///   its own requests. Each recorded answer is followed by an answer to the endpoint's newest request, with the
///   autopilot's clock in the middle of that round trip.
/// * The mission: requests are answered by RecordedMission, in the next step.
class Replay {
public:
    static constexpr Micros kStep = 20'000;

    /// @param clock_start  time of the co-processor's clock when the recording begins [us] (clock_start_of)
    /// @param mission  that the endpoint reads; without a mission its requests are not answered
    Replay(const app::Parameters& parameters, std::int64_t clock_start, std::optional<RecordedMission> mission = {});
    ~Replay();
    Replay(const Replay&) = delete;
    Replay& operator=(const Replay&) = delete;

    /// Feeds bytes of the autopilot for the next step.
    /// @param time  time of arrival [us]
    void feed(Micros time, std::span<const std::byte> bytes);
    /// One step of the co-processor.
    /// @param now  time of the recording [us], kStep after the step before
    void step(Micros now);

    [[nodiscard]] Belief belief() const;
    [[nodiscard]] const app::Coprocessor& coprocessor() const noexcept { return *coprocessor_; }
    [[nodiscard]] const link::mavlink::Endpoint& endpoint() const noexcept { return *endpoint_; }

private:
    class Port;

    /// The autopilot's clock from a recorded answer.
    struct ReportedClock {
        link::mavlink::Header from;
        std::int64_t remote = 0;  ///< [us]
        std::int64_t at = 0;      ///< on our clock [us]
    };
    void hear(Micros time, const link::mavlink::Frame& frame);
    void answer_timesync(Micros now);
    void answer_mission(Micros now);
    template <class M>
    void bring(const M& message);

    std::int64_t clock_start_;
    std::optional<RecordedMission> mission_;
    Micros now_ = 0;
    std::unique_ptr<Port> port_;
    hal::CountingWatchdog watchdog_;
    std::unique_ptr<link::mavlink::Endpoint> endpoint_;
    std::unique_ptr<app::Coprocessor> coprocessor_;
    app::StepReport report_;
    link::mavlink::Parser parser_;  ///< decodes messages that the endpoint does not report
    std::optional<unsigned> vehicle_;
    std::optional<ReportedClock> reported_clock_;
};

/// Time on the recorded jinkd's clock at the start of the recording [us], from its first TIMESYNC request. The
/// autopilot's answers repeat that clock, and round-trip times are true only on it. One second where the recording has
/// no such request.
[[nodiscard]] std::int64_t clock_start_of(std::span<const WireRecord> records);

/// Replays records from 0 s to the last of them, in steps of 20 ms. Calls `each_second` after the step of every whole
/// second.
void replay(std::span<const WireRecord> records, const app::Parameters& parameters,
            const std::function<void(const Belief&)>& each_second);

/// One JSON object, without the end of the line; keys as docs/evidence/recordings.md lists them.
[[nodiscard]] std::string to_json(const Belief& belief);
/// One line for people, without its end.
[[nodiscard]] std::string to_text(const Belief& belief);

}  // namespace jink::sim
