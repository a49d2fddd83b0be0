/*
 * Patch hierarchies by METIS (G. Karypis, V. Kumar, 1998) for starcontour.
 *
 * SPDX-License-Identifier: MIT
 *
 * A library of its own, libstarcontour_metis, so that the core needs libc and libm alone:
 *
 *     options.partition = SC_PARTITION_BISECT;
 *     options.bisect = sc_metis_bisect;
 */
#ifndef STARCONTOUR_METIS_H
#define STARCONTOUR_METIS_H

#include "starcontour.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * An sc_bisect: METIS recursive bisection with a fixed seed; graphs of up to 32 nodes, which are
 * not worth METIS's time, are cut by the distance from one of their ends. user is ignored.
 *
 * METIS installs handlers for SIGABRT and SIGTERM while it runs and draws from the C library's
 * rand. The dispositions of both signals are put back as they were, and so is the state of rand
 * where the C library is GNU's; elsewhere rand goes on from where METIS leaves it. Both belong to
 * the process: so build with METIS on one thread at a time, and offline rather than in a frame.
 *
 * Returns SC_OK, SC_ERROR_MEMORY, SC_ERROR_PARTITION, or SC_ERROR_UNSUPPORTED if it was compiled
 * without SC_WITH_METIS.
 */
SC_API sc_status sc_metis_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target,
                                 uint8_t *side);

#ifdef __cplusplus
}
#endif

#endif /* STARCONTOUR_METIS_H */
