# SPDX-License-Identifier: BSD-3-Clause
# Sourced by toolchain/test and toolchain/demo: named steps with their time, their output in a log file.
# shellcheck shell=bash disable=SC2034  # variables are for those who source this

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
logs=$top/build/logs
started=$SECONDS
step_number=0
rm -f "$logs/steps.txt"  # of each step its seconds: toolchain/report/test_times

# try_step "what it does" log-name command...
# One line when it starts, one when it ends, a sign of life each minute; the log's end when it fails.
try_step() {
    local what=$1 log=$logs/$2.log
    shift 2
    mkdir -p "$logs"
    step_number=$((step_number + 1))
    printf '[%d] %s ...\n' "$step_number" "$what"
    local begin=$SECONDS status=0 next_sign=60
    set -m  # a process group of its own, so that an interrupt ends the compilers too
    "$@" >"$log" 2>&1 </dev/null &
    local job=$!
    set +m
    # shellcheck disable=SC2064  # this step's job, not a later one's
    trap "kill -- -$job 2>/dev/null; exit 130" INT TERM
    while kill -0 "$job" 2>/dev/null; do
        sleep 0.2
        if [ $((SECONDS - begin)) -ge "$next_sign" ]; then
            next_sign=$((next_sign + 60))
            printf '[%d] %s, %d s: %.100s\n' "$step_number" "$what" $((SECONDS - begin)) "$(tail -n 1 "$log")"
        fi
    done
    wait "$job" || status=$?
    trap - INT TERM
    if [ "$status" -ne 0 ]; then
        printf '[%d] %s: FAILED after %d s. The end of %s:\n' "$step_number" "$what" $((SECONDS - begin)) "$log"
        tail -n 60 "$log"
        return 1
    fi
    printf '[%d] %s: %d s\n' "$step_number" "$what" $((SECONDS - begin))
    printf '  %8d s  %s\n' $((SECONDS - begin)) "$what" >>"$logs/steps.txt"
}

# The same; exits when the step fails.
step() { try_step "$@" || exit 1; }

cores() { nproc 2>/dev/null || echo 2; }
