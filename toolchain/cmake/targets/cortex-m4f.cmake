# SPDX-License-Identifier: BSD-3-Clause
# Cortex-M4 with a single-precision FPU (STM32F405, qemu's netduinoplus2).
set(JINK_CPU_FLAGS "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
