/* SPDX-License-Identifier: BSD-3-Clause */
/* The smallest user of jink.h: two seconds of a co-processor that hears nothing, and what it sends. */
#include <inttypes.h>
#include <stdio.h>

#include <jink.h>

int main(void)
{
    jink_coprocessor* jink = NULL;
    jink_options options = {0};
    jink_status status = {0};
    jink_result result;
    uint8_t bytes[4096];
    size_t count, sent = 0;
    int64_t now_us;
    options.size = sizeof options;
    status.size = sizeof status;
    result = jink_create(JINK_ABI, &options, &jink);
    if (result == JINK_OK) {
        result = jink_set_parameter(jink, "VEH_CRUISE", 8.0F);
    }
    for (now_us = 0; result == JINK_OK && now_us < 2000000; now_us += 20000) { /* your clock */
        result = jink_feed(jink, JINK_PORT_AUTOPILOT, bytes, 0, NULL);           /* your line: what has arrived */
        if (result == JINK_OK) {
            result = jink_step(jink, now_us);
        }
        if (result == JINK_OK) {
            result = jink_take(jink, bytes, sizeof bytes, &count); /* your line: what goes out */
            sent += count;
        }
    }
    if (result == JINK_OK) {
        result = jink_get_status(jink, &status);
    }
    jink_destroy(jink);
    if (result != JINK_OK) {
        fprintf(stderr, "%s\n", jink_error_text(result));
        return 1;
    }
    printf("jink %s: %zu bytes sent, faults %" PRIu32 "\n", jink_version(), sent, status.faults);
    return sent > 0 && (status.faults & JINK_FAULT_NO_AUTOPILOT) != 0 ? 0 : 1;
}
