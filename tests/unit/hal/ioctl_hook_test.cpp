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
WriteHook::Answer write_hook;

}  // namespace

IoctlHook::IoctlHook(Answer answer) { hook = std::move(answer); }

IoctlHook::~IoctlHook() { hook = nullptr; }

WriteHook::WriteHook(Answer answer) { write_hook = std::move(answer); }

WriteHook::~WriteHook() { write_hook = nullptr; }

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

TEST(WriteHook, AnswersInTheKernelsPlaceWhileItLives)
{
    int ends[2] = {-1, -1};
    ASSERT_EQ(::pipe(ends), 0);
    {
        const WriteHook answering([&](int descriptor, const void*, std::size_t size) -> std::optional<ssize_t> {
            return descriptor == ends[1] ? std::optional<ssize_t>(static_cast<ssize_t>(size) - 1) : std::nullopt;
        });
        EXPECT_EQ(::write(ends[1], "abc", 3), 2);
        EXPECT_EQ(::write(-1, "abc", 3), -1);
    }
    char got[4] = {};
    EXPECT_EQ(::write(ends[1], "de", 2), 2);
    EXPECT_EQ(::read(ends[0], got, sizeof got), 2) << "what the hook has answered has gone nowhere";
    ::close(ends[0]);
    ::close(ends[1]);
}

}  // namespace jink::hal::test

// Replace the C library's functions for everything linked into this program.
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

extern "C" ssize_t write(int descriptor, const void* data, std::size_t size)
{
    if (jink::hal::test::write_hook) {
        const std::optional<ssize_t> answer = jink::hal::test::write_hook(descriptor, data, size);
        if (answer) {
            return *answer;
        }
    }
    return static_cast<ssize_t>(::syscall(SYS_write, descriptor, data, size));
}
