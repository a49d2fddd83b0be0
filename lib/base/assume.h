/*
 * Conditions that no test can bring about.
 *
 * SPDX-License-Identifier: MIT
 *
 * SC_NEVER(x)    x is false and SC_ALWAYS(x) true, for a reason that stands at the line; the check
 *                is there in case the reason is wrong. Debug builds assert it.
 * SC_HARDLY(x)   x can be true, but it takes more memory than a test has, another machine or
 *                library, or a coincidence that no test can make.
 *
 * Where coverage is measured they are constants, so that what depends on them is not compiled;
 * elsewhere they are x. The names, and the idea, are those of SQLite and H3.
 */
#ifndef SC_BASE_ASSUME_H
#define SC_BASE_ASSUME_H

#if defined(SC_COVERAGE)
#  define SC_NEVER(x) 0
#  define SC_ALWAYS(x) 1
#  define SC_HARDLY(x) 0
#elif defined(SC_VALIDATE)
#  include <assert.h>
#  define SC_NEVER(x) ((x) ? (assert(0), 1) : 0)
#  define SC_ALWAYS(x) ((x) ? 1 : (assert(0), 0))
#  define SC_HARDLY(x) (x)
#else
#  define SC_NEVER(x) (x)
#  define SC_ALWAYS(x) (x)
#  define SC_HARDLY(x) (x)
#endif

#endif
