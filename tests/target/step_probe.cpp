// SPDX-License-Identifier: BSD-3-Clause
// Recorded flights repeated on a target, step by step: input is each step's bytes, output its decisions and bytes. The
// time is the record's, independent of the target's speed.
//
// Between jink_window_begin() and jink_window_end() lies exactly Coprocessor::step().
#include <algorithm>
#include <array>
#include <optional>

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#include "tests/target/plan_bytes.hpp"
#include "tests/target/probe_io.hpp"
#include "tests/target/window.hpp"
#include "toolchain/sim/step_record.hpp"

namespace jink::target {
namespace {

using sim::StepAnswer;
using sim::StepRecord;

/// A line that delivers the record's bytes, and accepts all output.
class RecordedLine final : public hal::SerialPort {
public:
    [[nodiscard]] bool bring(std::uint32_t count) noexcept
    {
        read_ = 0;
        brought_ = count;
        written_ = 0;
        return read_all(in_.data(), count);
    }
    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), brought_ - read_);
        std::copy_n(in_.data() + read_, n, into.data());
        read_ += n;
        return n;
    }
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
    {
        const std::size_t n = std::min(from.size(), out_.size() - written_);
        std::copy_n(from.data(), n, out_.data() + written_);
        written_ += n;
        return n;
    }
    [[nodiscard]] hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = hal::PortState::open;
        return health;
    }
    [[nodiscard]] std::span<const std::byte> written() const noexcept { return {out_.data(), written_}; }

private:
    std::array<std::byte, sim::kStepBytes> in_{};
    std::array<std::byte, sim::kStepBytes> out_{};
    std::size_t brought_ = 0;
    std::size_t read_ = 0;
    std::size_t written_ = 0;
};

class IgnoredWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override {}
};

/// A board that has the reduced sets alone has them anyway.
app::Parameters parameters_of(std::uint32_t start) noexcept
{
    app::Parameters parameters;
    if (start % sim::kStepClock == sim::kStartsWithReducedSets) {
        parameters.use(reach::kDefaultReducedSets);
    }
    return parameters;
}

/// Everything that a start creates.
struct Device {
    Device(hal::SerialPort& port, std::uint32_t start) noexcept
        : coprocessor(endpoint, port, watchdog, parameters_of(start))
    {
        if (const unsigned clock = start / sim::kStepClock; clock >= app::WorkRate::kMinMegahertz) {
            static_cast<void>(
                coprocessor.plan_in_slices(fresh_plan_memory().plan, app::WorkRate::of_megahertz(clock).work()));
        }
    }

    link::mavlink::Endpoint endpoint;
    IgnoredWatchdog watchdog;
    app::Coprocessor coprocessor;
};

StepAnswer answer_of(const app::Coprocessor& coprocessor, const app::StepReport& report) noexcept
{
    StepAnswer a{};
    a.magic = sim::kStepMagic;
    a.state = static_cast<std::uint32_t>(report.state);
    a.faults = report.faults;
    a.control = static_cast<std::uint32_t>(report.control);
    a.guidance = static_cast<std::uint32_t>(report.guidance.state);
    a.kind = static_cast<std::uint32_t>(report.guidance.kind);
    a.plan_status = static_cast<std::uint32_t>(report.guidance.plan_status);
    a.plans = coprocessor.supervisor_diagnostics().plans;
    a.manoeuvres = coprocessor.supervisor_diagnostics().manoeuvres;
    const geometric::Result& last = coprocessor.planner().last();
    a.chosen = static_cast<std::uint32_t>(last.chosen);
    a.candidates = static_cast<std::uint32_t>(last.candidates.size());
    a.work = report.work;
    a.tracks = report.tracks;
    a.obstacles = report.obstacles;
    a.stack_used = stack_used();
    a.bytes_out = report.bytes_out;
    std::copy_n(report.guidance.velocity.data(), 3, a.velocity);
    a.margin = report.guidance.margin;
    if (last.chosen < last.candidates.size()) {
        const geometric::Candidate& chosen = last.candidates[last.chosen];
        a.cost = chosen.total + chosen.flip_penalty;
    }
    return a;
}

}  // namespace

void serve() noexcept
{
    static RecordedLine line;
    static std::optional<Device> device;
    StepRecord record;
    while (read_all(&record, sizeof record)) {
        const bool fits = record.magic == sim::kStepMagic && record.bytes_in <= sim::kStepBytes;
        if (!fits || (record.start == 0 && !device)) {
            const StepAnswer refusal{};
            write_all(&refusal, sizeof refusal);
            return;
        }
        if (record.start != 0) {
            device.emplace(line, record.start);
        }
        if (!line.bring(record.bytes_in)) {
            return;
        }
        jink_window_begin();
        const app::StepReport report = device->coprocessor.step({record.now_us});
        jink_window_end();
        const StepAnswer answer = answer_of(device->coprocessor, report);
        write_all(&answer, sizeof answer);
        write_all(line.written().data(), line.written().size());
    }
}

}  // namespace jink::target
