// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The emulator's plugin counts the instructions executed between these two (toolchain/emulator/window_count.c).

extern "C" void jink_window_begin();
extern "C" void jink_window_end();
