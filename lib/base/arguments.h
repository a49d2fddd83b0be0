/*
 * Looks at what the caller passed, and tells the log by its name what is wrong with it.
 *
 * SPDX-License-Identifier: MIT
 *
 * `of` is the argument as the header calls it, such as "options" or "options.tasks". hooks may be
 * NULL.
 */
#ifndef SC_BASE_ARGUMENTS_H
#define SC_BASE_ARGUMENTS_H

#include <stddef.h>

#include "base/hooks.h"

/* The size of a structure up to the end of a member: the least struct_size, if that member has no
   default. */
#define SC_ARGUMENTS_UP_TO(type, member)                                                           \
  (uint32_t)(offsetof(type, member) + sizeof(((type *)0)->member))

/* The least struct_size of structures all of whose members have defaults. */
enum { SC_ARGUMENTS_DEFAULTS = 8 };

/* A member that names one of several things by a number from 0 to last; or one that is 0. */
typedef struct sc_choice {
    const char *name;
    uint32_t value, last;
} sc_choice;

/* SC_ERROR_OPTION if one is larger than that. */
sc_status sc_arguments_choose(const sc_hooks *hooks, const char *of, const sc_choice *choices,
                              size_t count);

/* SC_ERROR_NULL if a pointer is. name: the member, or NULL if `of` is the pointer. */
sc_status sc_arguments_need(const sc_hooks *hooks, const char *of, const char *name,
                            const void *pointer);

/* SC_ERROR_STRIDE if a member's bytes from one element to the next are fewer than an element has;
   0 stands for as many. Gives them. */
sc_status sc_arguments_stride(const sc_hooks *hooks, const char *of, const char *name,
                              uint32_t given, uint32_t element, uint64_t *stride);

/*
 * Checks the caller's struct_size, which every structure starts with: a multiple of the size of a
 * pointer, least or more, and whatever reaches beyond size, which this library does not know, zero.
 */
sc_status sc_arguments_check(const sc_hooks *hooks, const char *of, const void *from, uint32_t size,
                             uint32_t least);

/* The same, and copies what both know; the rest of *to becomes zero. */
sc_status sc_arguments_read(const sc_hooks *hooks, const char *of, void *to, uint32_t size,
                            const void *from, uint32_t least);

/* The same of a structure that may be NULL, which is all defaults. */
sc_status sc_arguments_read_options(const sc_hooks *hooks, const char *of, void *to, uint32_t size,
                                    const void *from);

/* Reads options.tasks: functions that are there, and one worker at least. NULL gives one worker and
   no functions. */
sc_status sc_arguments_read_tasks(const sc_hooks *hooks, const sc_tasks *caller, sc_tasks *tasks);

/* Reads the caller's hooks; NULL gives none. */
sc_status sc_arguments_read_hooks(const sc_hooks *caller, sc_hooks *hooks);

#endif
