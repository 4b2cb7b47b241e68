# SPDX-License-Identifier: BSD-3-Clause
# Cortex-M7 with a double-precision FPU (STM32H7, qemu's mps2-an500).
set(JINK_CPU_FLAGS "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
