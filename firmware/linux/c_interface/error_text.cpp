// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/jink.h"

const char* jink_error_text(jink_result result)
{
    switch (result) {
    case JINK_OK: return "no error";
    case JINK_ERROR_NULL: return "a pointer is null";
    case JINK_ERROR_HANDLE: return "no handle of jink_create, or already destroyed";
    case JINK_ERROR_SIZE: return "the size of a structure is unknown to this library: set `size` to its sizeof";
    case JINK_ERROR_VERSION: return "compiled with a jink.h of another JINK_ABI than this library's";
    case JINK_ERROR_OPTION: return "an option is out of range, or does not go with the others";
    case JINK_ERROR_MEMORY: return "no memory";
    case JINK_ERROR_TOO_MANY: return "JINK_MAX_HANDLES handles exist already";
    case JINK_ERROR_TIME: return "the time is not later than the last step, is negative or too large";
    case JINK_ERROR_PORT: return "no such port, or the options leave it out";
    case JINK_ERROR_FULL: return "the queue is full until the next step";
    case JINK_ERROR_NAME: return "no parameter of this name";
    case JINK_ERROR_VALUE: return "a value is not finite or out of range";
    case JINK_ERROR_INCONSISTENT: return "parameters in range that do not go together";
    case JINK_ERROR_INDEX: return "the index is at or beyond the count";
    case JINK_ERROR_ENDED: return "no step follows jink_shut_down";
    default: return "no result of this library";
    }
}
