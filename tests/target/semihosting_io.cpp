// SPDX-License-Identifier: BSD-3-Clause
// The probe as a bare-metal image under qemu: records and answers through ARM semihosting (IHI 0093).
#include <array>
#include <cstdint>

#include "hal/cortex_m/vector_table.hpp"
#include "tests/target/probe_io.hpp"

namespace jink::target {
namespace {

enum Operation : std::uint32_t { kOpen = 0x01, kWrite = 0x05, kRead = 0x06, kExit = 0x20 };

std::uint32_t call(Operation operation, const void* block) noexcept
{
    register std::uint32_t r0 __asm("r0") = operation;
    register const void* r1 __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

std::uint32_t open(std::uint32_t mode) noexcept
{
    static constexpr char kConsole[] = ":tt";  // mode 0 its input, mode 4 its output
    const std::array<std::uint32_t, 3> block{reinterpret_cast<std::uintptr_t>(kConsole), mode, sizeof kConsole - 1};
    return call(kOpen, block.data());
}

}  // namespace

bool read_all(void* bytes, std::size_t count) noexcept
{
    static const std::uint32_t handle = open(0);
    auto* to = static_cast<char*>(bytes);
    while (count > 0) {
        const std::array<std::uint32_t, 3> block{handle, reinterpret_cast<std::uintptr_t>(to), count};
        const std::uint32_t left = call(kRead, block.data());  // how many were not read
        if (left >= count) {
            return false;
        }
        to += count - left;
        count = left;
    }
    return true;
}

void write_all(const void* bytes, std::size_t count) noexcept
{
    static const std::uint32_t handle = open(4);
    const std::array<std::uint32_t, 3> block{handle, reinterpret_cast<std::uintptr_t>(bytes), count};
    static_cast<void>(call(kWrite, block.data()));
}

std::uint32_t stack_used() noexcept { return hal::cortex_m::stack_used(); }

}  // namespace jink::target

namespace {

void leave(std::uint32_t code) noexcept
{
    constexpr std::uint32_t kApplicationExit = 0x20026;
    const std::array<std::uint32_t, 2> block{kApplicationExit, code};
    jink::target::call(jink::target::kExit, block.data());
}

__attribute__((section(".vectors"), used)) constinit const auto vectors = jink::hal::cortex_m::make_vectors<0>({});

}  // namespace

extern "C" void jink::hal::cortex_m::jink_on_fault(const FaultRecord& record)
{
    constexpr std::uint32_t kFaulted = 90;
    leave(kFaulted + record.exception);
}

extern "C" void jink::hal::cortex_m::jink_main()
{
    let_faults_speak();
    jink::target::serve();
    leave(0);
}
