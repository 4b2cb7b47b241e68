# SPDX-License-Identifier: BSD-3-Clause
# ARM Linux, Debian's cross compiler; programs run under qemu-user with its C library.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-linux-gnueabihf-gcc)
set(CMAKE_CXX_COMPILER arm-linux-gnueabihf-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-L;/usr/arm-linux-gnueabihf)
set(CMAKE_CXX_FLAGS_INIT "-Wno-psabi")  # a note about compilers older than 7, no warning
