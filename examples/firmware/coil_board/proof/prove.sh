#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prove by Frama-C's Eva what proof/one_step.c asserts; folder of the core and of coil_limits.h may be given.
# Debian: frama-c-base. Relations between two numbers need octagons; what a function refuses is kept apart from
# what it accepts.
here=$(dirname "$0")/..
src=${1:-$here/src}
limits=${2:-$here/limits}
exec frama-c -eva -eva-precision 3 -eva-domains octagon,symbolic-locations \
    -eva-split-return-function judge_request:0,guard_ask:0 \
    -eva-slevel-function judge_request:200,guard_ask:200,take_request:200 \
    -machdep gcc_x86_32 -cpp-extra-args="-I$limits -I$src" "$src"/*.c "$here"/proof/one_step.c
