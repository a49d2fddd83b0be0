/*
 * A folder for files of a test. See scratch.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700

#include "scratch.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static char folder[64];

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *place)
{
    (void)info;
    (void)type;
    (void)place;
    return remove(path);
}

void scratch_begin(void)
{
    strcpy(folder, "/tmp/starcontour.XXXXXX");
    if (!mkdtemp(folder)) {
        fprintf(stderr, "no folder can be made in /tmp\n");
        exit(2);
    }
}

void scratch_end(void)
{
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

const char *scratch_at(const char *name)
{
    static char paths[4][200];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(paths[turn], sizeof paths[turn], "%s/%s", folder, name);
    return paths[turn];
}
