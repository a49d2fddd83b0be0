/* All that lib/ takes from <time.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_TIME_H
#define TESTS_LIBC_TIME_H

#if defined(__APPLE__)
struct timespec {
    long tv_sec, tv_nsec;
};
int clock_gettime(int clock, struct timespec *time);
#  define CLOCK_MONOTONIC 6
#endif

#endif /* TESTS_LIBC_TIME_H */
