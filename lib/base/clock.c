/*
 * The one place that is not C99: a monotonic clock where the system has one, processor time
 * elsewhere.
 *
 * SPDX-License-Identifier: MIT
 */
#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#  define _POSIX_C_SOURCE 199309L
#endif
#include "base/clock.h"

#include <time.h>

#if defined(_WIN32)
/* Declared here, as windows.h brings thousands of names, which would be in the way of the library's
   where all of it is compiled as one file. */
__declspec(dllimport) int __stdcall QueryPerformanceCounter(int64_t *ticks);
__declspec(dllimport) int __stdcall QueryPerformanceFrequency(int64_t *ticks_per_second);
#endif

uint64_t sc_clock_nanoseconds(void)
{
#if defined(_WIN32)
    int64_t ticks = 0, rate = 1;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&rate);
    return (uint64_t)((double)ticks * 1e9 / (double)rate);
#elif defined(CLOCK_MONOTONIC)
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
#else
    return (uint64_t)((double)clock() * (1e9 / CLOCKS_PER_SEC));
#endif
}
