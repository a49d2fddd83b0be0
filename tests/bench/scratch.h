/*
 * A folder for files of a test, gone afterwards with all that is in it. One at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_SCRATCH_H
#define SC_TESTS_SCRATCH_H

/* Makes the folder, below /tmp; ends the program where that cannot be. */
void scratch_begin(void);

/* Removes it. */
void scratch_end(void);

/* A path in the folder. Good until three more have been asked for. */
const char *scratch_at(const char *name);

#endif
