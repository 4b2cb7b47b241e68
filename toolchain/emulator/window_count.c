// SPDX-License-Identifier: BSD-3-Clause
// A plugin for qemu's translator (system and user mode, plugin interface 1): counts the instructions between two places
// of a program, each time it passes from one to the other. Exact and repeatable: counts executed instructions, not
// time.
//
//   -plugin libwindow_count.so,begin=0xADDRESS,end=0xADDRESS,out=FILE[,stages=FILE]
//
// `begin` and `end` are addresses of single instructions (functions that do nothing serve well). One line per window
// goes to `out` at its end: the number of instructions executed after the one at `begin` and before the one at `end`.
// Windows do not nest; one virtual processor.
//
// `stages` assigns code to stages: lines "FIRST LAST STAGE" (addresses in hexadecimal, LAST is one past the end; stages
// 1..8191; in ascending order). Code outside of all ranges counts for the stage that called it. The line of a window
// then ends with the counts of stages 0 (before any), 1, ... as far as there are any.
//
// Debian ships no header for plugins: the declarations below follow qemu's documentation (docs/devel/tcg-plugins.rst).
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef struct qemu_info_t qemu_info_t;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS };
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
typedef void (*qemu_plugin_vcpu_tb_trans_cb_t)(qemu_plugin_id_t id, struct qemu_plugin_tb* tb);
typedef void (*qemu_plugin_vcpu_udata_cb_t)(unsigned int vcpu_index, void* userdata);
typedef void (*qemu_plugin_udata_cb_t)(qemu_plugin_id_t id, void* userdata);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, qemu_plugin_vcpu_tb_trans_cb_t cb);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn* insn, qemu_plugin_vcpu_udata_cb_t cb,
                                            enum qemu_plugin_cb_flags flags, void* userdata);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb* tb, qemu_plugin_vcpu_udata_cb_t cb,
                                          enum qemu_plugin_cb_flags flags, void* userdata);
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb* tb, enum qemu_plugin_op op, void* ptr,
                                              uint64_t imm);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, qemu_plugin_udata_cb_t cb, void* userdata);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* tb);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* tb, size_t idx);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn* insn);

#define EXPORT __attribute__((visibility("default")))
EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* info, int argc, char** argv);

#define MOST_STAGES 8192

struct range {
    uint64_t first;
    uint64_t last;
    unsigned stage;
};

/// Consecutive instructions that count for the same stage.
struct run {
    unsigned stage;
    unsigned instructions;
    struct run* next;
};

static uint64_t begin_address;
static uint64_t end_address;
static uint64_t executed;
static uint64_t at_begin;
static bool open_window;
static FILE* out;
static struct range* ranges;
static size_t range_count;
static unsigned stage_count;
static unsigned current_stage;
static uint64_t of_stage[MOST_STAGES];

static void on_begin(unsigned int vcpu, void* data)
{
    (void)vcpu;
    (void)data;
    open_window = true;
    at_begin = executed;
    current_stage = 0;
    memset(of_stage, 0, sizeof of_stage);
}

static void on_end(unsigned int vcpu, void* data)
{
    (void)vcpu;
    (void)data;
    if (!open_window) {
        return;
    }
    open_window = false;
    fprintf(out, "%" PRIu64, executed - at_begin);
    for (unsigned i = 0; i < stage_count; ++i) {
        fprintf(out, " %" PRIu64, of_stage[i]);
    }
    fprintf(out, "\n");
    fflush(out);
}

static void on_run(unsigned int vcpu, void* data)
{
    (void)vcpu;
    for (const struct run* run = data; run != NULL; run = run->next) {
        current_stage = run->stage != 0 ? run->stage : current_stage;
        of_stage[current_stage] += run->instructions;
        executed += run->instructions;
    }
}

/// Stage of an address; 0: the calling stage.
static unsigned stage_at(uint64_t address)
{
    size_t low = 0;
    size_t high = range_count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (ranges[middle].last <= address) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < range_count && ranges[low].first <= address ? ranges[low].stage : 0;
}

static struct run* new_run(unsigned stage)
{
    struct run* const run = calloc(1, sizeof *run);  // kept for as long as the translation may run
    if (run == NULL) {
        abort();
    }
    run->stage = stage;
    return run;
}

static struct run* runs_of(const struct qemu_plugin_tb* tb, size_t first, size_t last)
{
    struct run* head = NULL;
    struct run* tail = NULL;
    for (size_t i = first; i < last; ++i) {
        const unsigned stage = stage_at(qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, i)));
        if (tail == NULL || tail->stage != stage) {
            struct run* const run = new_run(stage);
            *(tail != NULL ? &tail->next : &head) = run;
            tail = run;
        }
        ++tail->instructions;
    }
    return head;
}

/// A block that holds one of the two places is counted instruction by instruction, the places themselves not at all.
static void count_singly(struct qemu_plugin_tb* tb)
{
    const size_t n = qemu_plugin_tb_n_insns(tb);
    for (size_t i = 0; i < n; ++i) {
        struct qemu_plugin_insn* const insn = qemu_plugin_tb_get_insn(tb, i);
        const uint64_t address = qemu_plugin_insn_vaddr(insn);
        if (address == begin_address) {
            qemu_plugin_register_vcpu_insn_exec_cb(insn, on_begin, QEMU_PLUGIN_CB_NO_REGS, NULL);
        } else if (address == end_address) {
            qemu_plugin_register_vcpu_insn_exec_cb(insn, on_end, QEMU_PLUGIN_CB_NO_REGS, NULL);
        } else {
            qemu_plugin_register_vcpu_insn_exec_cb(insn, on_run, QEMU_PLUGIN_CB_NO_REGS, runs_of(tb, i, i + 1));
        }
    }
}

/// Any other block is counted as a whole: without faults and interrupts, a block that is entered is executed to its
/// end.
static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb* tb)
{
    (void)id;
    const size_t n = qemu_plugin_tb_n_insns(tb);
    for (size_t i = 0; i < n; ++i) {
        const uint64_t address = qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, i));
        if (address == begin_address || address == end_address) {
            count_singly(tb);
            return;
        }
    }
    if (range_count > 0) {
        qemu_plugin_register_vcpu_tb_exec_cb(tb, on_run, QEMU_PLUGIN_CB_NO_REGS, runs_of(tb, 0, n));
    } else {
        qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &executed, n);
    }
}

static bool read_stages(const char* name)
{
    FILE* const file = fopen(name, "r");
    struct range range;
    size_t room = 0;
    while (file != NULL && fscanf(file, "%" SCNx64 " %" SCNx64 " %u", &range.first, &range.last, &range.stage) == 3) {
        if (range_count == room) {
            room = room == 0 ? 1024 : 2 * room;
            ranges = realloc(ranges, room * sizeof *ranges);
        }
        if (ranges == NULL || range.stage >= MOST_STAGES) {
            return false;
        }
        ranges[range_count++] = range;
        stage_count = range.stage >= stage_count ? range.stage + 1 : stage_count;
    }
    return file != NULL && fclose(file) == 0 && range_count > 0;
}

static void on_exit_of_guest(qemu_plugin_id_t id, void* data)
{
    (void)id;
    (void)data;
    fclose(out);
}

EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* info, int argc, char** argv)
{
    (void)info;
    for (int i = 0; i < argc; ++i) {
        if (strncmp(argv[i], "begin=", 6) == 0) {
            begin_address = strtoull(argv[i] + 6, NULL, 0) & ~UINT64_C(1);  // bit 0 of a Thumb function says Thumb
        } else if (strncmp(argv[i], "end=", 4) == 0) {
            end_address = strtoull(argv[i] + 4, NULL, 0) & ~UINT64_C(1);
        } else if (strncmp(argv[i], "out=", 4) == 0) {
            out = fopen(argv[i] + 4, "w");
        } else if (strncmp(argv[i], "stages=", 7) == 0 && !read_stages(argv[i] + 7)) {
            fprintf(stderr, "window_count: cannot read the stages in %s\n", argv[i] + 7);
            return -1;
        }
    }
    if (begin_address == 0 || end_address == 0 || out == NULL) {
        fprintf(stderr, "window_count: needs begin=ADDRESS, end=ADDRESS and out=FILE that can be written\n");
        return -1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    qemu_plugin_register_atexit_cb(id, on_exit_of_guest, NULL);
    return 0;
}
