// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink::target {

/// Counts a check, and prints a failed check.
void expect(bool ok, const char* what, int line);

}  // namespace jink::target

#define EXPECT(condition) jink::target::expect((condition), #condition, __LINE__)
