/*
 * The caller's hooks. See hooks.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/hooks.h"

#include <stdarg.h>
#include <stdio.h>

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
