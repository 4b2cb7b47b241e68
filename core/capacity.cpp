// SPDX-License-Identifier: BSD-3-Clause
#include "core/capacity.hpp"

asm(".pushsection .rodata.jink_capacities, \"a\", %progbits\n\t.globl " JINK_CAPACITIES_SYMBOL
    "\n\t.hidden " JINK_CAPACITIES_SYMBOL "\n" JINK_CAPACITIES_SYMBOL ":\n\t.byte 0\n\t.popsection");
