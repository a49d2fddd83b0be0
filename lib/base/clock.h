/*
 * A clock for statistics, in nanoseconds from an arbitrary start; read only if a caller asks for
 * statistics.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BASE_CLOCK_H
#define SC_BASE_CLOCK_H

#include <stdint.h>

uint64_t sc_clock_nanoseconds(void);

#endif
