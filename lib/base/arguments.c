/*
 * What the caller passed. See arguments.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/arguments.h"

#include <inttypes.h>
#include <string.h>

sc_status sc_arguments_choose(const sc_hooks *hooks, const char *of, const sc_choice *choices,
                              size_t count)
{
    size_t i;
    for (i = 0; i < count; i++)
        if (choices[i].value > choices[i].last) {
            sc_hooks_log(hooks, SC_LOG_ERROR, "%s.%s is %" PRIu32 ", but at most %" PRIu32, of,
                         choices[i].name, choices[i].value, choices[i].last);
            return SC_ERROR_OPTION;
        }
    return SC_OK;
}

sc_status sc_arguments_need(const sc_hooks *hooks, const char *of, const char *name,
                            const void *pointer)
{
    if (pointer) return SC_OK;
    sc_hooks_log(hooks, SC_LOG_ERROR, "%s%s%s is NULL", of, name ? "." : "", name ? name : "");
    return SC_ERROR_NULL;
}

sc_status sc_arguments_stride(const sc_hooks *hooks, const char *of, const char *name,
                              uint32_t given, uint32_t element, uint64_t *stride)
{
    if (given && given < element) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "%s.%s is %" PRIu32 ", but 0 or at least %" PRIu32, of,
                     name, given, element);
        return SC_ERROR_STRIDE;
    }
    *stride = given ? given : element;
    return SC_OK;
}

sc_status sc_arguments_check(const sc_hooks *hooks, const char *of, const void *from, uint32_t size,
                             uint32_t least)
{
    uint32_t given, i;
    memcpy(&given, from, sizeof given);
    if (given < least || given % sizeof(void *)) {
        sc_hooks_log(hooks, SC_LOG_ERROR,
                     "%s.struct_size is %" PRIu32 ", but at least %" PRIu32 " and a multiple of %d",
                     of, given, least, (int)sizeof(void *));
        return SC_ERROR_STRUCT_SIZE;
    }
    for (i = size; i < given; i++)
        if (((const unsigned char *)from)[i]) {
            sc_hooks_log(hooks, SC_LOG_ERROR,
                         "%s.struct_size is %" PRIu32 ", of which this library knows %" PRIu32
                         ", and byte %" PRIu32 " is not 0",
                         of, given, size, i);
            return SC_ERROR_STRUCT_SIZE;
        }
    return SC_OK;
}

sc_status sc_arguments_read(const sc_hooks *hooks, const char *of, void *to, uint32_t size,
                            const void *from, uint32_t least)
{
    uint32_t given;
    sc_status status = sc_arguments_check(hooks, of, from, size, least);
    if (status) return status;
    memcpy(&given, from, sizeof given);
    memset(to, 0, size);
    memcpy(to, from, given < size ? given : size);
    return SC_OK;
}

sc_status sc_arguments_read_options(const sc_hooks *hooks, const char *of, void *to, uint32_t size,
                                    const void *from)
{
    if (from) return sc_arguments_read(hooks, of, to, size, from, SC_ARGUMENTS_DEFAULTS);
    memset(to, 0, size);
    return SC_OK;
}

sc_status sc_arguments_read_tasks(const sc_hooks *hooks, const sc_tasks *caller, sc_tasks *tasks)
{
    sc_status status;
    memset(tasks, 0, sizeof *tasks);
    tasks->workers = 1;
    if (!caller) return SC_OK;
    status = sc_arguments_read(hooks, "options.tasks", tasks, sizeof *tasks, caller,
                               SC_ARGUMENTS_UP_TO(sc_tasks, finish));
    if (status) return status;
    if (!tasks->enqueue || !tasks->finish) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "options.tasks.%s is NULL",
                     tasks->enqueue ? "finish" : "enqueue");
        return SC_ERROR_NULL;
    }
    if (!tasks->workers) tasks->workers = 1;
    return SC_OK;
}

sc_status sc_arguments_read_hooks(const sc_hooks *caller, sc_hooks *hooks)
{
    sc_status status;
    memset(hooks, 0, sizeof *hooks);
    if (!caller) return SC_OK;
    status = sc_arguments_read(NULL, "hooks", hooks, sizeof *hooks, caller, SC_ARGUMENTS_DEFAULTS);
    return !status && hooks->reserved ? SC_ERROR_OPTION : status;
}
