/*
 * A model, a workspace and a pose that stay right whatever wrong input comes between. For
 * test_input.c and test_struct_sizes.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_INPUT_FIXTURE_H
#define TESTS_INPUT_FIXTURE_H

#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

/* A cloth of 200 triangles, folded, with what the oracle says of it. */
typedef struct input_fixture {
    soup mesh;
    double *posed;
    sc_mesh input;
    sc_pose pose;
    sc_model *model;
    sc_workspace *workspace;
    oracle_answer answer;
} input_fixture;

/* Returns 0 after a failed CHECK. */
int input_fixture_start(input_fixture *f);

void input_fixture_stop(input_fixture *f);

/* Whether the fixture's model and a workspace still give the oracle's answer. */
int input_fixture_is_right(const input_fixture *f, const sc_model *model, sc_workspace *workspace);

/* The same with its own. */
int input_fixture_is_still_right(const input_fixture *f);

/* A build that must end with a status: no model then; with SC_OK, the right one. */
void input_fixture_check_build(const input_fixture *f, const sc_mesh *mesh,
                               const sc_build_options *options, sc_status expected,
                               const char *what);

/* A query that must end with an error: counts 0, nothing written, and all still works. */
void input_fixture_check_query(const input_fixture *f, const sc_model *model,
                               sc_workspace *workspace, const sc_pose *pose,
                               const sc_query_options *options, sc_status expected,
                               const char *what);

/* Nothing but struct_size. */
sc_query_options input_fixture_no_options(void);
sc_build_options input_fixture_no_build_options(void);

#endif
