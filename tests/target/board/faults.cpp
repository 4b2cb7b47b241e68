// SPDX-License-Identifier: BSD-3-Clause
// A release flight image, made to fault by the debugger of its emulated board: its messages before the reset, its
// behaviour afterwards, and its return to service.
//
//   jink_board_faults IMAGE MACHINE CASE
#include <cstdio>
#include <functional>
#include <string>

#include <unistd.h>

#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/text.hpp"
#include "tests/target/board/board.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::target {
namespace {

using namespace link::mavlink;

// Two static obstacles on the leg: the fault occurs before the first, the second shows that avoidance works again.
constexpr const char* kScenario = R"(
title: Two obstacles on the leg
duration: 120
mission: [[0, 0, 30], [600, 0, 30]]
threats:
  - {name: first, radius: 1, position: [70, 0, 30], sensed_by: point, appears_at: 3}
  - {name: second, radius: 1, position: [170, 0, 30], sensed_by: point, appears_at: 3}
expect: {outcome: avoided}
)";

constexpr std::uint16_t kUndefined = 0xDE00;
constexpr std::uint16_t kForEver = 0xE7FE;
constexpr double kQuiet = 2.5;   // [s] with reception, without a threat
constexpr double kLimit = 60.0;  // [s]

struct Case {
    std::string name;
    std::vector<std::uint16_t> instructions;
    bool in_control = true;
    std::string at;       ///< symbol to stop at before
    std::string story;    ///< the name that the restart gives it
    std::string details;  ///< "exc N cause CCCCCCCC address AAAAAAAA", or nothing
    bool knows_pc = true;
};

std::vector<Case> cases_for(const std::string& machine)
{
    const bool m7 = machine == "mps2-an500";
    const std::string step = "3app11Coprocessor4stepE";
    const std::string interrupt = m7 ? "jink_uart_receive" : "jink_usart1";
    const std::vector<std::uint16_t> undefined{kUndefined};
    // movw r1, #0; movt r1, #0x9000; str r0, [r1]: an unmapped address
    const std::vector<std::uint16_t> nowhere{0xF240, 0x0100, 0xF2C9, 0x0100, 0x6008};
    const std::string stuck = m7 ? "exc 2 cause 00000000 address 00000000" : "exc 15 cause 00000000 address 00000000";
    return {
        {"undefined", undefined, true, step, "usage fault", "exc 3 cause 00010000 address 00000000"},
        {"undefined_watching", undefined, false, step, "usage fault", "exc 3 cause 00010000 address 00000000"},
        {"bus", nowhere, true, step, "bus fault", "exc 3 cause 00008200 address 90000000", false},
        // movs r1, #1; ldm r1!, {r2, r3}
        {"unaligned", {0x2101, 0xC90C}, true, step, "usage fault", "exc 3 cause 01000000 address 00000000", false},
        // push {r0-r7}, again and again
        {"stack_overflow", {0xB4FF, 0xE7FD}, true, step, "memory fault", "exc 3 cause 000000", false},
        {"stuck_step", {kForEver}, true, step, m7 ? "watchdog" : "stuck step", stuck},
        {"interrupt", undefined, true, interrupt, "usage fault", "exc 3 cause 00010000 address 00000000"},
    };
}

class Test {
public:
    Test(Board& board, std::string name) : board_(board), name_(std::move(name)) {}

    void expect(bool holds, const std::string& what)
    {
        std::printf("%s: %s: %s\n", name_.c_str(), what.c_str(), holds ? "yes" : "NO");
        failures_ += holds ? 0 : 1;
    }
    [[nodiscard]] int failures() const { return failures_; }

    [[nodiscard]] std::string text_of(std::size_t i) const
    {
        Statustext m;
        return unpack_as(i, m) ? std::string(link::mavlink::text_of(m.text)) : std::string();
    }
    template <Message M>
    [[nodiscard]] bool unpack_as(std::size_t i, M& message) const
    {
        if (i >= board_.heard().size() || board_.heard()[i].id != M::kInfo.id) {
            return false;
        }
        unpack(board_.heard()[i].payload, M::kFields, reinterpret_cast<std::byte*>(&message));
        return true;
    }
    [[nodiscard]] bool is_hold(std::size_t i, std::uint8_t confirmation) const
    {
        CommandLong m;
        return unpack_as(i, m) && m.command == 176 && m.param1 == 129.0F && m.param2 == 17.0F &&
               m.confirmation == confirmation;
    }
    [[nodiscard]] bool is_heartbeat(std::size_t i, int state) const
    {
        Heartbeat m;
        return unpack_as(i, m) && m.system_status == state;
    }
    /// Frames of this message from `from` on.
    template <Message M>
    [[nodiscard]] std::size_t count(std::size_t from) const
    {
        std::size_t n = 0;
        for (std::size_t i = from; i < board_.heard().size(); ++i) {
            n += board_.heard()[i].id == M::kInfo.id ? 1U : 0U;
        }
        return n;
    }
    /// Index of the first text from `from` on that begins with `begin`; the end if there is none.
    [[nodiscard]] std::size_t find_text(std::size_t from, const std::string& begin) const
    {
        std::size_t i = from;
        while (i < board_.heard().size() && text_of(i).rfind(begin, 0) != 0) {
            ++i;
        }
        return i;
    }
    [[nodiscard]] bool heard_text(std::size_t from, const std::string& begin) const
    {
        return find_text(from, begin) < board_.heard().size();
    }
    [[nodiscard]] bool undamaged() const
    {
        const ParserDiagnostics& p = board_.parser();
        return p.bad_checksum + p.cut + p.too_short + p.too_long + p.unknown_message + p.incompatible_flags == 0;
    }
    [[nodiscard]] sim::Mode mode() const { return board_.plant().autopilot().mode(); }

private:
    Board& board_;
    std::string name_;
    int failures_ = 0;
};

/// From reset into the flight: silent and watching, or in control for a second.
void fly_to_fault(Board& board, Test& test, bool in_control)
{
    board.debugger().go();
    if (!in_control) {
        board.fly_for(kQuiet);
        test.expect(test.mode() == sim::Mode::mission && board.plant().autopilot().heard().heartbeats > 0,
                    "flies its mission, and jink is heard");
        return;
    }
    const bool taken = board.fly_until([&] { return test.mode() == sim::Mode::external; }, kLimit);
    test.expect(taken, "jink takes over");
    board.fly_for(1.2);
}

std::string hex(std::uint32_t value)
{
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%08X", value);
    return text.data();
}

void check_words(Board& board, Test& test, std::size_t first, bool held)
{
    const std::size_t k = test.find_text(first, "jink: processor fault");
    test.expect(k < board.heard().size(), "says that its processor has faulted");
    test.expect(test.is_heartbeat(k - 1, held ? 6 : 5), held ? "HEARTBEAT EMERGENCY" : "HEARTBEAT CRITICAL");
    if (held) {
        test.expect(test.is_hold(k - 2, 0) && test.is_hold(k + 1, 1), "asks for BRAKE before and after that");
        bool in_order = true;
        for (std::size_t i = k - 1; i <= k + 1 && i < board.heard().size(); ++i) {
            in_order = in_order && board.heard()[i].from.sequence ==
                                       static_cast<std::uint8_t>(board.heard()[i - 1].from.sequence + 1U);
        }
        test.expect(in_order, "numbered one after the other");
        std::size_t setpoints = 0;
        for (std::size_t i = k - 2; i < board.heard().size(); ++i) {
            setpoints += board.heard()[i].id == SetPositionTargetLocalNed::kInfo.id ? 1U : 0U;
        }
        test.expect(setpoints == 0, "no set-point after the request");
        test.expect(test.count<CommandLong>(first) >= 2, "the requests are on the wire");
        test.expect(test.mode() == sim::Mode::brake, "the autopilot brakes");
    } else {
        bool silent = true;
        for (std::size_t i = first; i < board.heard().size(); ++i) {
            CommandLong m;
            silent = silent && !(test.unpack_as(i, m) && m.command == 176);
        }
        test.expect(silent && test.mode() == sim::Mode::mission, "asks for no mode, and the mission goes on");
    }
}

void check_service(Board& board, Test& test)
{
    // Load on the host can delay the board, which then gives up control and requests a hold: tried again.
    constexpr int kAttempts = 4;
    bool again = false;
    bool back = false;
    for (int i = 0; i < kAttempts && !back; ++i) {
        const unsigned before = board.plant().autopilot().takeovers();
        board.ask_for_mission();
        again = board.fly_until([&] { return board.plant().autopilot().takeovers() > before; }, board.seconds() + 30.0);
        back = again && board.fly_until([&] { return test.mode() != sim::Mode::external; }, board.seconds() + 30.0) &&
               test.mode() == sim::Mode::mission;
        std::printf("service, attempt %d: %s\n", i + 1, back ? "given back" : again ? "taken over" : "nothing");
    }
    test.expect(again, "serves again: takes over for what is in the way");
    test.expect(back, "and gives back");
    test.expect(test.undamaged(), "every frame of the flight was whole");
}

int run_fault(Board& board, const Case& c)
{
    Test test(board, c.name);
    fly_to_fault(board, test, c.in_control);
    board.debugger().halt();
    test.expect(board.run_to(board.symbol(c.at), kLimit), "comes to " + c.at);
    const std::uint32_t place = board.symbol("_bss_end");
    const std::size_t first = board.heard().size();
    board.execute(c.instructions, place);
    const double then = board.seconds();
    const bool reported = board.fly_until([&] { return test.heard_text(first, "jink: exc "); }, then + 5.0);
    check_words(board, test, first, c.in_control);
    test.expect(reported &&
                    test.heard_text(first, "jink: restart 1 by " + c.story + (c.knows_pc ? " at " + hex(place) : "")),
                "tells of it after the restart: " + test.text_of(test.find_text(first, "jink: restart")));
    test.expect(test.heard_text(first, "jink: " + c.details),
                "with the cause: " + test.text_of(test.find_text(first, "jink: exc")));
    check_service(board, test);
    return test.failures();
}

/// A fault before any output is possible: no message, and a restart.
int run_early(Board& board)
{
    Test test(board, "start_up");
    test.expect(board.run_to(board.symbol("jink_main"), kLimit), "comes to jink_main");
    board.execute({kUndefined}, board.symbol("_bss_end"));
    const bool reported = board.fly_until([&] { return test.heard_text(0, "jink: exc 3"); }, 5.0);
    test.expect(reported && test.heard_text(0, "jink: restart 1 by usage fault"), "starts anew and tells");
    test.expect(!test.heard_text(0, "jink: processor fault"), "had nothing to say before");
    const bool taken = board.fly_until([&] { return test.mode() == sim::Mode::external; }, kLimit);
    test.expect(taken, "serves: takes over");
    return test.failures();
}

/// A fault in the fault handler that does not lock up: the watchdog's NMI while the last words are being sent.
int run_nested(Board& board)
{
    Test test(board, "in_handler");
    fly_to_fault(board, test, true);
    board.debugger().halt();
    test.expect(board.run_to(board.symbol("3app11Coprocessor4stepE"), kLimit), "comes to a step");
    const std::uint32_t place = board.symbol("_bss_end");
    board.debugger().break_at(board.symbol("jink_on_fault"));
    board.execute({kUndefined}, place);
    bool there = false;
    static_cast<void>(board.fly_until([&] { return there = there || board.debugger().stopped(); }, kLimit));
    test.expect(there, "comes to jink_on_fault");
    board.debugger().clear(board.symbol("jink_on_fault"));
    const std::size_t first = board.heard().size();
    // The handler once more, as an NMI would enter it.
    const std::uint32_t handler = board.symbol("jink_fault_handler");
    board.debugger().jump(handler);
    board.debugger().go();
    const bool reported =
        board.fly_until([&] { return test.heard_text(first, "jink: restart 1 by usage fault at " + hex(place)); },
                        board.seconds() + 5.0);
    test.expect(reported, "resets at once and tells of the first fault");
    test.expect(!test.heard_text(first, "jink: processor fault"), "does not try its last words again");
    check_service(board, test);
    return test.failures();
}

int run_loop(Board& board)
{
    // The image sends its reports once it receives the autopilot's HEARTBEAT, one per second.
    constexpr double kHeartbeats = 1.5;
    Test test(board, "crash_loop");
    board.debugger().go();
    board.fly_for(1.5);
    const std::uint32_t place = board.symbol("_bss_end");
    const std::uint32_t step = board.symbol("3app11Coprocessor4stepE");
    std::size_t first = 0;
    const auto crash = [&] {
        board.debugger().halt();
        test.expect(board.run_to(step, kLimit), "comes to a step");
        first = board.heard().size();
        board.execute({kUndefined}, place);
    };
    for (int i = 1; i <= 3; ++i) {
        crash();
        const std::string reported = std::string("jink: restart ").append(1, static_cast<char>('0' + i));
        test.expect(board.fly_until([&] { return test.heard_text(first, reported); }, board.seconds() + 5.0),
                    "tells: " + reported);
    }
    test.expect(board.fly_until([&] { return test.heard_text(first, "jink: 3 faults in a row, passive"); },
                                board.seconds() + 1.0),
                "says that it stays passive");
    const std::size_t passive_from = board.heard().size();
    const double since = board.seconds();
    const unsigned requests = board.plant().autopilot().heard().external_requests;
    // The fourth is reported, a power of two; the fifth to the seventh are not.
    for (int i = 4; i <= 7; ++i) {
        board.fly_for(0.1);
        crash();
        const std::size_t from = first;
        test.expect(board.fly_until([&] { return test.count<Heartbeat>(from) >= 2; }, board.seconds() + 5.0),
                    "is heard again");
        board.fly_for(kHeartbeats);
        const std::string line = std::string("jink: restart ").append(1, static_cast<char>('0' + i));
        test.expect(test.heard_text(from, line) == (i == 4), (i == 4 ? "tells: " : "does not tell: ") + line);
    }
    board.fly_for(8.0);
    test.expect(board.plant().autopilot().heard().external_requests == requests && test.mode() == sim::Mode::mission,
                "takes nothing over, whatever is in the way");
    test.expect(board.plant().autopilot().heard().state == 5, "HEARTBEAT says CRITICAL");
    test.expect(test.count<SetPositionTargetLocalNed>(passive_from) == 0, "sends no set-point");
    const std::size_t texts = test.count<Statustext>(passive_from);
    std::printf("crash_loop: %zu texts in %.1f s of 4 more faults\n", texts, board.seconds() - since);
    test.expect(texts >= 3 && texts <= 10, "does not flood");
    test.expect(test.undamaged(), "every frame was whole");
    return test.failures();
}

int run_case(Board& board, const std::string& wanted, const std::string& machine)
{
    if (wanted == "start_up") {
        return run_early(board);
    }
    if (wanted == "in_handler") {
        return run_nested(board);
    }
    if (wanted == "crash_loop") {
        return run_loop(board);
    }
    for (const Case& c : cases_for(machine)) {
        if (c.name == wanted) {
            return run_fault(board, c);
        }
    }
    throw std::runtime_error("no such case");
}

}  // namespace
}  // namespace jink::target

int main(int argc, char** argv)
{
    using namespace jink::target;
    if (argc != 4) {
        std::fprintf(stderr, "usage: %s IMAGE MACHINE CASE\n", argv[0]);
        return 2;
    }
    const std::string machine = argv[2];
    const std::string wanted = argv[3];
    std::string folder_name = "/tmp/jink_board_XXXXXX";
    const std::filesystem::path folder = ::mkdtemp(folder_name.data());
    jink::sim::Scenario scenario = jink::sim::parse_scenario(kScenario, "faults.yaml");
    jink::sim::default_radii(scenario);
    jink::sim::default_noise(scenario);
    int failures = -1;
    try {
        failures = jink::sim::run_unheld([&](int attempt, double& held_up) {
            Board board(argv[1], machine, scenario, folder);
            const int result = run_case(board, wanted, machine);
            held_up = board.held_up();
            std::printf("%s: attempt %d, held up for %.3f s at most\n", wanted.c_str(), attempt, held_up);
            if (result != 0 || held_up > jink::sim::HoldUp::kStall) {
                for (const auto& text : board.plant().autopilot().heard().texts) {
                    std::printf("heard at %.2f s: %s\n", text.time, text.text.c_str());
                }
            }
            return result;
        });
    } catch (const std::exception& e) {
        std::printf("%s: %s\n", wanted.c_str(), e.what());
        failures = 1;
    }
    std::filesystem::remove_all(folder);
    return failures == 0 ? 0 : 1;
}
