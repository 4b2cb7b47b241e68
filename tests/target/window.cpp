// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/window.hpp"

// Separate and non-empty: each has its own address.
extern "C" __attribute__((noinline)) void jink_window_begin() { __asm volatile("" ::: "memory"); }
extern "C" __attribute__((noinline)) void jink_window_end() { __asm volatile("nop" ::: "memory"); }
