// SPDX-License-Identifier: BSD-3-Clause
// Stack use of a flight image after a flight: the board's debugger reads the paint written at start-up, so the image is
// the unmodified release image.
//
//   jink_board_stack IMAGE MACHINE SCENARIO
//
// Prints "stack BYTES", "plan stack BYTES", and the takeovers of the flight.
#include <algorithm>
#include <cstdio>

#include <unistd.h>

#include "tests/target/board/board.hpp"
#include "toolchain/sim/scenario_file.hpp"

int main(int argc, char** argv)
{
    using namespace jink;
    if (argc != 4) {
        std::fprintf(stderr, "usage: %s IMAGE MACHINE SCENARIO\n", argv[0]);
        return 2;
    }
    constexpr std::uint8_t kPaint = 0xC5;
    constexpr std::uint8_t kPlanPaint = 0xA5;         // hal::Fiber
    constexpr std::uint32_t kPlanStack = 8U * 1024U;  // app::PlanMemory
    std::string folder_name = "/tmp/jink_board_XXXXXX";
    const std::filesystem::path folder = ::mkdtemp(folder_name.data());
    int status = 1;
    try {
        const sim::Scenario scenario = sim::load_scenario(argv[3]);
        target::Board board(argv[1], argv[2], scenario, folder);
        board.debugger().go();
        static_cast<void>(board.fly_until([&] { return board.plant().finished(); }, 1e9));
        board.debugger().halt();
        const std::uint32_t bottom = board.symbol("_stack_bottom");
        const auto bytes = board.debugger().read(bottom, board.symbol("_stack_top") - bottom);
        const auto touched = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b != kPaint; });
        const auto plan = board.debugger().read(board.symbol("_plan_bottom_emulated"), kPlanStack);
        const auto planned = std::find_if(plan.begin(), plan.end(), [](std::uint8_t b) { return b != kPlanPaint; });
        std::printf("stack %td\nplan stack %td\ntakeovers %u\n", bytes.end() - touched, plan.end() - planned,
                    board.plant().autopilot().takeovers());
        status = touched == bytes.end() ? 1 : 0;  // nothing used: not a valid flight
    } catch (const std::exception& e) {
        std::printf("%s: %s\n", argv[3], e.what());
    }
    std::filesystem::remove_all(folder);
    return status;
}
