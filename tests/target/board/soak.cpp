// SPDX-License-Identifier: BSD-3-Clause
// A release flight image with a full line: 92160 bytes per second to the board, the rate of 921600 baud, and as many
// answers as it can send. Then compares its own counters, read by the debugger, with the sent bytes.
//
//   jink_board_soak IMAGE MACHINE LAYOUT [--seconds S] [--drop N] [--shift N]
//
// LAYOUT: library of counter_layout.cpp. --drop: byte N is never sent, and the soak has to fail. --shift: an
// instruction takes 2^N ns of the board's time (3).
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <unistd.h>

#include "tests/target/board/board.hpp"
#include "tests/target/board/counters.hpp"

#include "tests/target/board/full_line.hpp"
#include "toolchain/sim/child.hpp"
#include "toolchain/sim/datagram_line.hpp"
#include "toolchain/sim/hold_up.hpp"

namespace jink::target {
namespace {

using namespace link::mavlink;
using Clock = std::chrono::steady_clock;

/// Of the board's program [s].
constexpr double kStep = 0.02;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Options {
    std::string image, machine, layout;
    double seconds = 60.0;
    std::optional<std::uint64_t> drop;
    /// An instruction takes 2^shift ns of the board's time, 125 million per second; while the board waits, its clock
    /// follows wall time. Without this the board's time is wall time, and a step delayed by the host is late.
    unsigned shift = 3;
};

/// Receives the board's output.
struct Ear {
    Parser parser{nullptr, LongerPayload::reject};
    std::uint64_t bytes = 0;
    double clock = -1.0;     ///< the board's own, at the last step that answered [s]
    std::uint64_t read = 0;  ///< lower bound on the number of our bytes that the board has read
    std::uint32_t params = 0, acknowledged = 0, timesyncs = 0, setpoints = 0, heartbeats = 0;

    void listen(std::span<const std::byte> heard)
    {
        bytes += heard.size();
        while (const auto frame = parser.next(heard)) {
            Timesync sync;
            CommandAck ack;
            params += frame->message_id == ParamValue::kInfo.id ? 1U : 0U;
            acknowledged += decode(*frame, ack) && ack.command == 512 ? 1U : 0U;
            if (decode(*frame, sync) && sync.tc1 != 0) {
                ++timesyncs;
                clock = static_cast<double>(sync.tc1) * 1e-9;
                read = sync.ts1 >= kPlaceMark ? static_cast<std::uint64_t>(sync.ts1 - kPlaceMark) : read;
            }
            setpoints += frame->message_id == SetPositionTargetLocalNed::kInfo.id ? 1U : 0U;
            heartbeats += frame->message_id == Heartbeat::kInfo.id ? 1U : 0U;
        }
    }
};

class Soak {
public:
    Soak(const Options& options, const sim::Scenario& scenario, const std::filesystem::path& folder)
        : options_(options), reader_(options.image, options.layout), line_(scenario)
    {
        const std::string socket = (folder / "debugger").string();
        std::vector<std::string> command{
            "qemu-system-arm",
            "-M",
            options.machine,
            "-nographic",
            "-monitor",
            "none",
            "-icount",
            std::string("shift=").append(std::to_string(options.shift)).append(",sleep=on"),
            "-gdb",
            "unix:path=" + socket + ",server=on,wait=off",
            "-S",
            "-kernel",
            options.image};
        for (const std::string& option : wire_.options()) {
            command.push_back(option);
        }
        qemu_.emplace(command, folder / "qemu.log");
        debugger_.emplace(socket);
    }

    int run()
    {
        debugger_->go();
        for (const Clock::time_point start = Clock::now(); ear_.heartbeats == 0;) {
            if (since(start) > 10.0) {
                throw std::runtime_error("the board says nothing");
            }
            pause();
        }
        send_all();
        for (const Clock::time_point end = Clock::now(); since(end) < 2.0;) {
            pause();
        }
        return judge(read_counters());
    }

    [[nodiscard]] double held_up() const { return hold_up_.longest(); }

private:
    void pause()
    {
        hold_up_.watch(*qemu_, since(start_));
        if (!qemu_->running()) {
            throw std::runtime_error("the emulator ended: " + qemu_->ending());
        }
        std::this_thread::sleep_for(std::chrono::microseconds(800));
        const std::vector<std::byte> heard = wire_.take();
        ear_.listen(heard);
        line_.deliver(heard);
    }

    /// By the board's own clock, which each answer to TIMESYNC tells: an emulator keeps no pace with that of the wall.
    /// Within a step the bytes are spread over its 20 ms. Where the machine holds the emulator up while the board
    /// waits, the board's clock jumps; then kMaxUnread holds, and the rest follows. A board that is too slow for the
    /// line holds it up for good, and the line was not full.
    void send_all()
    {
        constexpr double kAhead = 0.005;
        constexpr std::uint64_t kMaxInSlice = 200;
        const auto total = static_cast<std::uint64_t>(options_.seconds * kLineBytesPerSecond);
        const Clock::time_point start = Clock::now();
        Clock::time_point reported_at = start;
        double reported = -1.0;
        while (sent_ < total) {
            pause();
            if (ear_.clock != reported) {
                reported = ear_.clock;
                reported_at = Clock::now();
                first_ = first_ < 0.0 ? reported : first_;
            }
            // Until its clock is known, enough to be answered.
            const double time =
                reported < 0.0 ? kAhead : reported - first_ + kAhead + std::min(since(reported_at), kStep);
            const double owed = time * kLineBytesPerSecond - static_cast<double>(sent_);
            longest_lag_ = std::max(longest_lag_, owed / kLineBytesPerSecond);
            const std::uint64_t room = kMaxUnread - std::min(kMaxUnread, sent_ - std::min(sent_, ear_.read));
            const std::uint64_t now =
                std::min({static_cast<std::uint64_t>(std::max(owed, 0.0)), room, kMaxInSlice, total - sent_});
            if (now > 0 && wire_.may_send()) {
                // Whole frames: a delay of the host never leaves the board within a frame.
                send(line_.ahead(now).size());
            }
            // Nothing else ends it where the board falls silent.
            if (since(start) > 12.0 * options_.seconds + 30.0) {
                throw std::runtime_error("the board does not take the line's rate");
            }
        }
        send(line_.ahead(1).size());  // the end of the last frame
        walled_ = since(start);
    }

    void send(std::uint64_t n)
    {
        const std::span<const std::byte> next = line_.ahead(n);
        std::vector<std::byte> bytes(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(n));
        if (options_.drop && *options_.drop >= sent_ && *options_.drop < sent_ + n) {
            bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(*options_.drop - sent_));
        }
        wire_.send(bytes);
        line_.take(n);
        sent_ += n;
    }

    /// Stops the processor when no output is in transit.
    Counters read_counters()
    {
        for (int i = 0;; ++i) {
            debugger_->halt();
            const Counters counters = reader_.read(*debugger_);
            for (int j = 0; j < 20; ++j) {
                pause();
            }
            if (counters.port.bytes_out == ear_.bytes || i == 5) {
                return counters;
            }
            debugger_->go();
            pause();
        }
    }

    void expect(const char* what, std::uint64_t got, std::uint64_t wanted)
    {
        const bool ok = got == wanted;
        failures_ += ok ? 0 : 1;
        std::printf("%s %s: %llu%s%llu\n", ok ? "  ok" : "FAIL", what, static_cast<unsigned long long>(got),
                    ok ? " = " : ", expected ", static_cast<unsigned long long>(wanted));
    }

    int judge(const Counters& c)
    {
        // From the step before the first reported time to the last report.
        const double took = ear_.clock - first_ + kStep;
        const double in = static_cast<double>(sent_) / took;
        const double out = static_cast<double>(ear_.bytes) / took;
        const ParserDiagnostics& heard = ear_.parser.diagnostics();
        const FullLine::Requests& asked = line_.requests();
        std::printf("%s, %.2f s of its own time, %.1f s of ours\nto the board:   %llu bytes, %.0f B/s = %.1f %% of "
                    "921600 baud, %u frames; at most %.1f "
                    "ms behind the clock\n",
                    options_.machine.c_str(), took, walled_, static_cast<unsigned long long>(sent_), in,
                    100.0 * in / kLineBytesPerSecond, line_.frames(), 1e3 * longest_lag_);
        std::printf(
            "from the board: %llu bytes, %.0f B/s = %.1f %% of 921600 baud, %.1f %% of 1 KiB a step, %u frames\n",
            static_cast<unsigned long long>(ear_.bytes), out, 100.0 * out / kLineBytesPerSecond, 100.0 * out / 51'200.0,
            heard.accepted);
        std::printf("the board:      %u steps, %u late, %u tracks and %u scans taken, %u set-points, %u takeovers\n",
                    c.app.steps, c.app.deadlines_missed, c.app.tracks_in, c.app.scans, ear_.setpoints,
                    line_.plant().autopilot().takeovers());
        expect("datagrams dropped by this machine, not by the board", wire_.dropped(), 0);
        expect("bytes read by the board", c.port.bytes_in, sent_);
        expect("overruns", c.port.overruns, 0);
        expect("line errors", c.port.line_errors, 0);
        expect("frames taken by the board", c.link.frames_in, line_.frames());
        expect("frames refused", c.link.frames_refused, 0);
        expect("bytes between frames", c.parser.noise_bytes, 0);
        expect("numbers skipped", c.parser.lost + c.parser.repeated, 0);
        expect("reports that found the inbox full", c.link.inbox_full, 0);
        expect("frames that found the transmit buffer full", c.link.outbox_full, 0);
        expect("bytes heard from the board", ear_.bytes, c.port.bytes_out);
        expect("bytes between its frames", heard.noise_bytes + ear_.parser.pending(), 0);
        expect("its numbers skipped", heard.lost + heard.repeated, 0);
        expect("parameters answered", ear_.params, asked.params);
        expect("commands answered", ear_.acknowledged, asked.commands);
        expect("time requests answered", ear_.timesyncs, asked.timesyncs + asked.own_timesyncs);
        const bool full = in >= 0.99 * kLineBytesPerSecond;
        failures_ += full ? 0 : 1;
        std::printf("%s the line was full\n", full ? "  ok" : "FAIL");
        return failures_;
    }

    const Options& options_;
    CounterReader reader_;
    sim::DatagramLine wire_;
    FullLine line_;
    Ear ear_;
    std::optional<sim::Child> qemu_;
    std::optional<Debugger> debugger_;
    sim::HoldUp hold_up_;
    Clock::time_point start_ = Clock::now();
    std::uint64_t sent_ = 0;
    double first_ = -1.0;  ///< first reported value of the board's clock [s]
    double walled_ = 0.0;  ///< by the wall's [s]
    double longest_lag_ = 0.0;
    int failures_ = 0;
};

std::optional<Options> parse(int argc, char** argv)
{
    if (argc < 4 || argc % 2 != 0) {
        return std::nullopt;
    }
    Options options;
    options.image = argv[1];
    options.machine = argv[2];
    options.layout = argv[3];
    for (int i = 4; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--seconds") == 0) {
            options.seconds = std::atof(argv[i + 1]);
        } else if (std::strcmp(argv[i], "--shift") == 0) {
            options.shift = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
        } else if (std::strcmp(argv[i], "--drop") == 0) {
            options.drop = std::strtoull(argv[i + 1], nullptr, 10);
        } else {
            return std::nullopt;
        }
    }
    return options.seconds >= 1.0 && options.seconds <= 3600.0 ? std::optional(options) : std::nullopt;
}

}  // namespace
}  // namespace jink::target

int main(int argc, char** argv)
{
    using namespace jink;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const std::optional<target::Options> options = target::parse(argc, argv);
    if (!options) {
        std::fprintf(stderr, "usage: %s IMAGE MACHINE LAYOUT [--seconds S] [--drop N] [--shift N]\n", argv[0]);
        return 2;
    }
    std::string folder_name = "/tmp/jink_board_XXXXXX";
    const std::filesystem::path folder = ::mkdtemp(folder_name.data());
    int failures = 1;
    try {
        const sim::Scenario scenario = target::crowd_for(options->seconds);
        failures = sim::run_unheld([&](int attempt, double& held_up) {
            target::Soak soak(*options, scenario, folder);
            const int result = soak.run();
            held_up = soak.held_up();
            if (result != 0) {
                std::printf("attempt %d, held up for %.3f s at most\n", attempt, held_up);
            }
            return result;
        });
    } catch (const std::exception& e) {
        std::printf("FAIL %s\n", e.what());
    }
    std::filesystem::remove_all(folder);
    return failures == 0 ? 0 : 1;
}
