// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>

namespace jink::hal::test {

/// While one lives, every ioctl() of this program goes through it first: drivers that no test machine has.
/// The hook answers with ioctl's result (errno set where -1), or with nothing to let the kernel answer.
class IoctlHook {
public:
    using Answer = std::function<std::optional<int>(int descriptor, unsigned long request, void* argument)>;

    explicit IoctlHook(Answer answer);
    ~IoctlHook();
    IoctlHook(const IoctlHook&) = delete;
    IoctlHook& operator=(const IoctlHook&) = delete;
};

/// What the kernel says, hook or not.
int kernel_ioctl(int descriptor, unsigned long request, void* argument);

}  // namespace jink::hal::test
