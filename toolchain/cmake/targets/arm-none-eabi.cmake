# SPDX-License-Identifier: BSD-3-Clause
# Common to all bare-metal ARM targets. Included by cortex-m7.cmake and cortex-m4f.cmake, which set JINK_CPU_FLAGS.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
# Nothing links before the image's own start-up code and linker script are there.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

# One section per function, so that the linker drops unused functions: this proves that no allocator is needed. The
# stack report reads frame sizes (.su) and call graphs (.ci).
string(CONCAT flags "${JINK_CPU_FLAGS} -mthumb -ffunction-sections -fdata-sections -fno-math-errno "
                    "-fstack-usage -fcallgraph-info=su,da")
set(CMAKE_C_FLAGS_INIT "${flags}")
# psabi: a note about compilers older than 7, no warning.
set(CMAKE_CXX_FLAGS_INIT "${flags} -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -Wno-psabi -DEIGEN_MAX_ALIGN_BYTES=8")
set(CMAKE_ASM_FLAGS_INIT "${JINK_CPU_FLAGS} -mthumb")
# newlib-nano, without nosys: an allocator needs _sbrk, which is undefined, so an image with an allocator does not link.
set(CMAKE_EXE_LINKER_FLAGS_INIT "${JINK_CPU_FLAGS} -mthumb --specs=nano.specs -nostartfiles -Wl,--gc-sections -Wl,--fatal-warnings")
