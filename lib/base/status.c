/*
 * Texts for statuses, and the version.
 *
 * SPDX-License-Identifier: MIT
 */
#include "starcontour.h"

#define DIGITS_OF(number) #number
#define DIGITS(number) DIGITS_OF(number)

const char *sc_status_string(sc_status status)
{
    switch (status) {
    case SC_OK:
        return "no error";
    case SC_ERROR_NULL:
        return "a required pointer is NULL";
    case SC_ERROR_STRUCT_SIZE:
        return "struct_size is none this library can read";
    case SC_ERROR_OPTION:
        return "an option or type has a value that it cannot have";
    case SC_ERROR_EMPTY:
        return "the mesh has no triangles or no vertices";
    case SC_ERROR_COUNT:
        return "too many vertices or triangles";
    case SC_ERROR_STRIDE:
        return "a stride is smaller than its element";
    case SC_ERROR_INDEX:
        return "a triangle refers to a vertex that does not exist";
    case SC_ERROR_NOT_FINITE:
        return "a position is NaN or infinite";
    case SC_ERROR_VERTEX_COUNT:
        return "the pose has not as many vertices as the model";
    case SC_ERROR_MEMORY:
        return "out of memory";
    case SC_ERROR_SHORT_BUFFER:
        return "the array is too short for the result";
    case SC_ERROR_WORKSPACE:
        return "the workspace is too small or made for another model";
    case SC_ERROR_WELD_MAP:
        return "the weld map has an entry that is not a representative";
    case SC_ERROR_TREE:
        return "the leaf order or tree does not cover every triangle once, or is too deep";
    case SC_ERROR_PARTITION:
        return "the bisection function failed";
    case SC_ERROR_UNSUPPORTED:
        return "not supported by this build of the library";
    case SC_ERROR_ALIGNMENT:
        return "memory is not aligned as required";
    case SC_ERROR_LEVEL:
        return "the model has no such level";
    case SC_ERROR_NOT_SAVED:
        return "not a saved model; or not a record, where one is to be read";
    case SC_ERROR_TRUNCATED:
        return "saved data end too early";
    case SC_ERROR_BYTE_ORDER:
        return "saved on a machine with another byte order";
    case SC_ERROR_TOO_NEW:
        return "saved by a newer version of the library";
    case SC_ERROR_TOO_OLD:
        return "saved by a version of the library that is too old";
    case SC_ERROR_CHECKSUM:
        return "saved data were damaged: the checksum is wrong";
    case SC_ERROR_INCONSISTENT:
        return "saved data contradict themselves";
    case SC_ERROR_TOPOLOGY:
        return "the saved model is not that of the mesh expected";
    case SC_ERROR_PAIRS:
        return "a list of pairs is not sorted or names what does not exist";
    case SC_ERROR_INCOMPLETE:
        return "the query was stopped before its end";
    case SC_ERROR_BOXES_ONLY:
        return "the model is for boxes only, and this needs culling";
    default:
        return "unknown status";
    }
}

uint32_t sc_version(void)
{
    return SC_VERSION_NUMBER;
}

const char *sc_version_string(void)
{
    return DIGITS(SC_VERSION_MAJOR) "." DIGITS(SC_VERSION_MINOR) "." DIGITS(SC_VERSION_PATCH);
}
