/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A user of jink.h in C11.
 *
 *     fly_steps FILE.steps [FILE.steps]
 *     fly_steps --layout
 *
 * Repeats flights that `jink-sim fly --record-steps` recorded of the co-processor in C++, two at a time with a handle
 * each, and compares every byte that the library gives with the recorded ones. Counts what is allocated between
 * jink_create() and jink_destroy(). Exit status 1: another byte, or an allocation. --layout prints the structures.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jink.h>

/* glibc's own entries behind malloc, which this program replaces for itself and for every library that it loads. */
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

static long allocations = 0;

void* malloc(size_t size)
{
    ++allocations;
    return __libc_malloc(size);
}
void* calloc(size_t count, size_t size)
{
    ++allocations;
    return __libc_calloc(count, size);
}
void* realloc(void* old, size_t size)
{
    ++allocations;
    return __libc_realloc(old, size);
}
void* aligned_alloc(size_t alignment, size_t size)
{
    ++allocations;
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, size_t alignment, size_t size)
{
    ++allocations;
    *out = __libc_memalign(alignment, size);
    return *out != NULL ? 0 : ENOMEM;
}
void free(void* memory) { __libc_free(memory); }

/* toolchain/sim/step_record.hpp */
enum { STEP_MAGIC = 0x4A535201, STARTS_WITHOUT_REACH_SETS = 2, CLOCK_UNIT = 0x10000 };
typedef struct {
    uint32_t magic, start;
    int64_t now_us;
    uint32_t bytes_in, bytes_out;
} step_record;

typedef struct {
    const char* name;
    uint8_t* bytes;
    size_t size, at;
    jink_coprocessor* jink;
    long steps, differences, library_allocations;
    uint64_t bytes_compared;
    uint32_t controlled;
} flight;

static void fail(const char* name, const char* what)
{
    fprintf(stderr, "fly_steps: %s: %s\n", name, what);
    exit(2);
}

static void check(const flight* f, jink_result result)
{
    if (result != JINK_OK) {
        fail(f->name, jink_error_text(result));
    }
}

static void load(flight* f, const char* name)
{
    FILE* file = fopen(name, "rb");
    memset(f, 0, sizeof *f);
    f->name = name;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        fail(name, "cannot be read");
    }
    f->size = (size_t)ftell(file);
    rewind(file);
    f->bytes = malloc(f->size + 1);
    if (f->bytes == NULL || fread(f->bytes, 1, f->size, file) != f->size) {
        fail(name, "cannot be read");
    }
    fclose(file);
}

static void start(flight* f, uint32_t how)
{
    jink_options options = {0};
    long before;
    options.size = sizeof options;
    options.clock_mhz = how / CLOCK_UNIT;
    if ((how & STARTS_WITHOUT_REACH_SETS) != 0) {
        fail(f->name, "of a co-processor without reach sets");
    }
    jink_destroy(f->jink);
    before = allocations;
    check(f, jink_create(JINK_ABI, &options, &f->jink));
    if (allocations != before + 1) {
        fail(f->name, "jink_create() does not allocate once");
    }
}

/* One step; 0 at the end. */
static int step(flight* f)
{
    static uint8_t out[8192];
    step_record record;
    jink_status status;
    jink_track track;
    jink_counters counters;
    size_t taken = 0;
    long before;
    if (f->at + sizeof record > f->size) {
        return 0;
    }
    memcpy(&record, f->bytes + f->at, sizeof record);
    f->at += sizeof record;
    if (record.magic != STEP_MAGIC || f->at + record.bytes_in + record.bytes_out > f->size) {
        fail(f->name, "no record of steps");
    }
    if (record.start != 0) {
        start(f, record.start);
    }
    before = allocations;
    check(f, jink_feed(f->jink, JINK_PORT_AUTOPILOT, f->bytes + f->at, record.bytes_in, NULL));
    check(f, jink_step(f->jink, record.now_us));
    check(f, jink_take(f->jink, out, sizeof out, &taken));
    status.size = sizeof status;
    check(f, jink_get_status(f->jink, &status));
    counters.size = sizeof counters;
    check(f, jink_get_counters(f->jink, &counters));
    track.size = sizeof track;
    if (status.tracks > 0) {
        check(f, jink_get_track(f->jink, status.tracks - 1, &track));
    }
    f->library_allocations += allocations - before;
    f->controlled += status.control == JINK_CONTROL_OURS;
    f->at += record.bytes_in;
    if (taken != record.bytes_out || memcmp(out, f->bytes + f->at, taken) != 0) {
        if (f->differences++ == 0) {
            printf("%s: step %ld at %" PRId64 " us: %zu bytes, recorded %" PRIu32 "\n", f->name, f->steps,
                   record.now_us, taken, record.bytes_out);
        }
    }
    f->at += record.bytes_out;
    f->bytes_compared += record.bytes_out;
    ++f->steps;
    return 1;
}

static int report(const flight* f)
{
    printf("%s: %ld steps, %" PRIu32 " in control, %" PRIu64 " bytes compared, %ld steps differ, %ld allocations\n",
           f->name, f->steps, f->controlled, f->bytes_compared, f->differences, f->library_allocations);
    return f->steps > 0 && f->bytes_compared > 0 && f->differences == 0 && f->library_allocations == 0;
}

#define FIELD(type, field) printf("%s.%s %zu\n", #type, #field, offsetof(type, field))
#define SIZE(type) printf("%s %zu\n", #type, sizeof(type))
#include "tests/c_interface/layout_fields.h"

int main(int argc, char** argv)
{
    flight flights[2];
    int i, good = 1, n = argc - 1, running = 1;
    if (n == 1 && strcmp(argv[1], "--layout") == 0) {
        print_layout();
        return 0;
    }
    if (n < 1 || n > 2) {
        fprintf(stderr, "usage: fly_steps FILE.steps [FILE.steps] | --layout\n");
        return 2;
    }
    if (jink_abi() != JINK_ABI || strcmp(jink_version(), "") == 0) {
        fail("libjink", jink_error_text(JINK_ERROR_VERSION));
    }
    for (i = 0; i < n; ++i) {
        load(&flights[i], argv[i + 1]);
    }
    if (allocations == 0) {
        fail("malloc", "allocations are not counted");
    }
    while (running) {
        for (running = 0, i = 0; i < n; ++i) {
            running |= step(&flights[i]);
        }
    }
    for (i = 0; i < n; ++i) {
        good &= report(&flights[i]);
        jink_destroy(flights[i].jink);
        free(flights[i].bytes);
    }
    return good ? 0 : 1;
}
