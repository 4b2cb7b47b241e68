// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What is executed between these two is what the emulator's plugin counts (toolchain/emulator/window_count.c).

extern "C" void jink_window_begin();
extern "C" void jink_window_end();
