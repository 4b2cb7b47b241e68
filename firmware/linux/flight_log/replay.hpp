// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/mesh_map.hpp"
#include "firmware/linux/flight_log/assembly.hpp"
#include "firmware/linux/flight_log/hal_parts.hpp"
#include "firmware/linux/flight_log/playing_ports.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"
#include "firmware/linux/signing_store.hpp"
#include "hal/watchdog.hpp"

namespace jink::flightlog {

/// What a replay is given beside the log.
struct ReplayOptions {
    std::optional<files::SigningKey> key;  ///< of MAVLink signing
    const geometry::MeshMap* map = nullptr;
    bool any_version = false;  ///< also logs of other sources than this program's
};

/// Outcome of a replay.
struct ReplayResult {
    std::uint64_t steps = 0;    ///< replayed and compared
    std::uint64_t bytes = 0;    ///< of writes, compared
    std::uint64_t reports = 0;  ///< of steps, compared
    std::string refused;        ///< why the log cannot be replayed; empty: it can
    std::string difference;     ///< the first one; empty: none
    std::string incomplete;     ///< why the log cannot be replayed to its end; empty: it can
    std::uint64_t difference_step = 0;
    bool was_shut_down = false;  ///< the log ends with the end of the run
    [[nodiscard]] bool is_identical() const
    {
        return refused.empty() && difference.empty() && incomplete.empty() && steps > 0;
    }
};

/// Runs the co-processor of a log again and compares all that it does: every byte written, every CAN frame sent, and
/// the report of every step but its duration.
class FlightReplay {
public:
    explicit FlightReplay(const ReplayOptions& options) : options_(options) {}

    /// The files of one run, in their order. False: nothing more can be replayed.
    bool play(ulog::Reader& log);
    /// Something that follows cannot be read.
    void note_damage(const std::string& what) { result_.incomplete = "the log is " + what; }
    [[nodiscard]] const ReplayResult& result() const noexcept { return result_; }
    /// As it flew last; nullptr before the first file.
    [[nodiscard]] Assembly* assembly() noexcept { return assembly_ ? &*assembly_ : nullptr; }

private:
    class NoWatchdog final : public hal::Watchdog {
    public:
        void feed() noexcept override {}
    };

    [[nodiscard]] bool set_up(const ulog::Reader& log);
    [[nodiscard]] bool may_follow(const ulog::Reader& log);
    [[nodiscard]] bool take(const ulog::Message& message, const ulog::Format& format);
    [[nodiscard]] bool step(std::span<const std::byte> record);
    [[nodiscard]] bool take_areas();
    [[nodiscard]] bool compare(std::span<const std::byte> content);
    [[nodiscard]] bool refuse(std::string why);

    ReplayOptions options_;
    ReplayResult result_;
    Setup setup_;
    std::string run_;
    Tape tape_;
    PlayingSerialPort line_{tape_, Port::line};
    PlayingSerialPort cloud_{tape_, Port::cloud};
    PlayingCanPort can_{tape_};
    NoWatchdog watchdog_;
    link::mavlink::Signing signing_;
    std::optional<Assembly> assembly_;
    std::uint32_t generation_ = 0;  ///< of the initial parameters here
    HalParts parts_;
    std::optional<StepTopic> expected_;
};

}  // namespace jink::flightlog
