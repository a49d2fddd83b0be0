/*
 * The caller's hooks: messages, and invariants that do not hold.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BASE_HOOKS_H
#define SC_BASE_HOOKS_H

#include "starcontour.h"

#ifdef SC_VALIDATE
#  include <assert.h>
#endif

/* Makes a message, as printf would, cut off at some 250 characters. Does nothing without
   hooks or a log among them. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void sc_hooks_log(const sc_hooks *hooks, uint32_t level, const char *format, ...);

/*
 * In builds with SC_VALIDATE (make config=debug or sanitize): tells the caller if a condition does
 * not hold, or ends the program if nobody is to be told. hooks is a pointer, not NULL. Elsewhere
 * the condition is not computed.
 */
#ifdef SC_VALIDATE
#  define SC_HOOKS_ASSERT(hooks, condition)                                                        \
    do {                                                                                           \
      if (!(hooks)->failed)                                                                        \
        assert(condition);                                                                         \
      else if (!(condition))                                                                       \
        (hooks)->failed((hooks)->user, #condition, __FILE__, (uint32_t)__LINE__);                  \
    } while (0)
#else
#  define SC_HOOKS_ASSERT(hooks, condition) ((void)(hooks))
#endif

#endif
