// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <sys/types.h>

namespace jink::hal::test {

/// While a hook exists, every ioctl() of this program passes through it first: simulates drivers that test machines
/// lack. The hook answers with ioctl's result (errno set where -1), or with nothing to let the kernel answer.
class IoctlHook {
public:
    using Answer = std::function<std::optional<int>(int descriptor, unsigned long request, void* argument)>;

    explicit IoctlHook(Answer answer);
    ~IoctlHook();
    IoctlHook(const IoctlHook&) = delete;
    IoctlHook& operator=(const IoctlHook&) = delete;
};

/// The same for write(): answers that real devices do not give on demand.
class WriteHook {
public:
    using Answer = std::function<std::optional<ssize_t>(int descriptor, const void* data, std::size_t size)>;

    explicit WriteHook(Answer answer);
    ~WriteHook();
    WriteHook(const WriteHook&) = delete;
    WriteHook& operator=(const WriteHook&) = delete;
};

/// The kernel's answer, bypassing the hook.
int kernel_ioctl(int descriptor, unsigned long request, void* argument);

}  // namespace jink::hal::test
