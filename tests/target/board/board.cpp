// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/board/board.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "toolchain/sim/frame_writer.hpp"

namespace jink::target {
namespace {

std::map<std::string, std::uint32_t> symbols_of(const std::filesystem::path& image)
{
    std::map<std::string, std::uint32_t> symbols;
    const std::string command = "arm-none-eabi-nm '" + image.string() + "'";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::array<char, 4096> line{};
    while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe) != nullptr) {
        std::istringstream words(line.data());
        std::string address, kind, name;
        if (words >> address >> kind >> name) {
            symbols[name] = static_cast<std::uint32_t>(std::stoul(address, nullptr, 16));
        }
    }
    if (pipe == nullptr || ::pclose(pipe) != 0 || symbols.empty()) {
        throw std::runtime_error("no symbols of " + image.string());
    }
    return symbols;
}

/// Polling interval of the line.
constexpr auto kNap = std::chrono::microseconds(500);
/// The plant waits for the board's clock no longer than BoardClock::kDeaf.
constexpr auto kPatience = std::chrono::seconds(30);

}  // namespace

Board::Board(const std::filesystem::path& image, const std::string& machine, const sim::Scenario& scenario,
             const std::filesystem::path& folder)
    : plant_(scenario), symbols_(symbols_of(image)), parser_(nullptr, link::mavlink::LongerPayload::accept)
{
    const std::string socket = (folder / "debugger").string();
    std::filesystem::remove(socket);
    std::vector<std::string> command{"qemu-system-arm",
                                     "-M",
                                     machine,
                                     "-nographic",
                                     "-monitor",
                                     "none",
                                     "-gdb",
                                     "unix:path=" + socket + ",server=on,wait=off",
                                     "-S",
                                     "-kernel",
                                     image.string()};
    for (const std::string& option : line_.options()) {
        command.push_back(option);
    }
    qemu_ = std::make_unique<sim::Child>(command, folder / "qemu.log");
    debugger_ = std::make_unique<Debugger>(socket);
    moved_ = std::chrono::steady_clock::now();
}

void Board::tick()
{
    std::this_thread::sleep_for(kNap);
    const std::vector<std::byte> heard = line_.listen(plant_.now());
    plant_.deliver(heard);
    std::span<const std::byte> bytes = heard;
    while (const auto frame = parser_.next(bytes)) {
        Heard& one = heard_.emplace_back(Heard{seconds(), frame->header, frame->message_id, {}});
        std::copy(frame->payload.begin(), frame->payload.end(), one.payload.begin());
    }
    const auto now = std::chrono::steady_clock::now();
    if (plant_.now() + sim::kStep <= line_.due(plant_.now())) {
        plant_.step();
        line_.say(plant_.collect());
        moved_ = now;
    }
    line_.flush();
    hold_up_.watch(*qemu_, line_.wall());
    if (!qemu_->running()) {
        throw std::runtime_error("the emulator ended: " + qemu_->ending());
    }
    if (now - moved_ > kPatience) {
        throw std::runtime_error("this machine does not run the emulator");
    }
}

bool Board::run_to(std::uint32_t address, double limit)
{
    debugger_->break_at(address);
    debugger_->go();
    bool there = false;
    static_cast<void>(fly_until([&] { return there = there || debugger_->stopped(); }, limit));
    if (!there) {
        debugger_->halt();
    }
    debugger_->clear(address);
    return there;
}

void Board::execute(const std::vector<std::uint16_t>& instructions, std::uint32_t address)
{
    std::vector<std::uint8_t> bytes;
    for (const std::uint16_t half : instructions) {
        bytes.push_back(static_cast<std::uint8_t>(half & 0xFFU));
        bytes.push_back(static_cast<std::uint8_t>(half >> 8U));
    }
    debugger_->write(address, bytes);
    debugger_->jump(address);
    line_.let_go(plant_.now());
    debugger_->go();
}

std::uint32_t Board::symbol(const std::string& part) const
{
    if (const auto exact = symbols_.find(part); exact != symbols_.end()) {
        return exact->second & ~1U;
    }
    const auto found = std::find_if(symbols_.begin(), symbols_.end(),
                                    [&](const auto& s) { return s.first.find(part) != std::string::npos; });
    if (found == symbols_.end()) {
        throw std::runtime_error("the image has no " + part);
    }
    return found->second & ~1U;
}

void Board::ask_for_mission()
{
    link::mavlink::CommandLong wish;
    wish.command = 176;
    wish.target_system = wish.target_component = 1;
    wish.param1 = 129.0F;
    wish.param2 = 3.0F;  // AUTO
    sim::FrameWriter writer;
    writer.write(wish, sim::kGroundStation);
    plant_.deliver(writer.bytes());
}

}  // namespace jink::target
