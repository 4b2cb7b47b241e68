// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/hal/ioctl_hook.hpp"

#include <cerrno>
#include <cstdarg>
#include <utility>

#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace jink::hal::test {

namespace {

IoctlHook::Answer hook;

}  // namespace

IoctlHook::IoctlHook(Answer answer) { hook = std::move(answer); }

IoctlHook::~IoctlHook() { hook = nullptr; }

int kernel_ioctl(int descriptor, unsigned long request, void* argument)
{
    return static_cast<int>(::syscall(SYS_ioctl, descriptor, request, argument));
}

TEST(IoctlHook, AnswersInTheKernelsPlaceWhileItLives)
{
    constexpr unsigned long kRequest = FIONREAD;
    int bytes = -1;
    {
        const IoctlHook answering([](int, unsigned long request, void* argument) -> std::optional<int> {
            if (request != kRequest) {
                return std::nullopt;
            }
            *static_cast<int*>(argument) = 4321;
            return 0;
        });
        EXPECT_EQ(::ioctl(-1, kRequest, &bytes), 0);
        EXPECT_EQ(bytes, 4321);
        EXPECT_EQ(::ioctl(-1, TIOCEXCL, nullptr), -1);
    }
    EXPECT_EQ(::ioctl(-1, kRequest, &bytes), -1);
    EXPECT_EQ(errno, EBADF);
}

}  // namespace jink::hal::test

// Stands in front of the C library's ioctl for everything that is linked into this program.
extern "C" int ioctl(int descriptor, unsigned long request, ...) noexcept
{
    va_list arguments;
    va_start(arguments, request);
    void* const argument = va_arg(arguments, void*);
    va_end(arguments);
    if (jink::hal::test::hook) {
        const std::optional<int> answer = jink::hal::test::hook(descriptor, request, argument);
        if (answer) {
            return *answer;
        }
    }
    return jink::hal::test::kernel_ioctl(descriptor, request, argument);
}
