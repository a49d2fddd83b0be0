/*
 * The caller's hooks. See hooks.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/hooks.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/arguments.h"

sc_status sc_hooks_read(const sc_hooks *caller, sc_hooks *hooks)
{
    sc_status status;
    memset(hooks, 0, sizeof *hooks);
    if (!caller) return SC_OK;
    status = sc_arguments_read(NULL, "hooks", hooks, sizeof *hooks, caller, SC_ARGUMENTS_DEFAULTS);
    return !status && hooks->reserved ? SC_ERROR_OPTION : status;
}

void sc_hooks_log(const sc_hooks *hooks, uint32_t level, const char *format, ...)
{
    char text[256];
    va_list arguments;
    if (!hooks || !hooks->log) return;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments); /* longer texts are cut off */
    va_end(arguments);
    hooks->log(hooks->user, level, text);
}
