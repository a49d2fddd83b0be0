/*
 * The caller's hooks: which messages come when, and what becomes of an invariant that does not
 * hold.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_VALIDATE
#  define SC_VALIDATE /* here, if not in the library: for SC_HOOKS_ASSERT */
#endif
#include "base/hooks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"

typedef struct journal {
    char text[4096];
    uint32_t levels, failures; /* levels: a bit each */
    uint32_t line;
} journal;

static void take_message(void *user, uint32_t level, const char *message)
{
    journal *j = (journal *)user;
    size_t used = strlen(j->text);
    j->levels |= 1u << level;
    snprintf(j->text + used, sizeof(j->text) - used, "%s\n", message);
}

static void take_failure(void *user, const char *condition, const char *file, uint32_t line)
{
    journal *j = (journal *)user;
    size_t used = strlen(j->text);
    j->failures++;
    j->line = line;
    snprintf(j->text + used, sizeof(j->text) - used, "%s %s\n", condition, file);
}

static sc_hooks make_hooks(journal *j)
{
    sc_hooks hooks;
    memset(j, 0, sizeof(*j));
    memset(&hooks, 0, sizeof(hooks));
    hooks.struct_size = sizeof(hooks);
    hooks.log = take_message;
    hooks.failed = take_failure;
    hooks.user = j;
    return hooks;
}

static sc_status build(const soup *s, uint32_t weld, uint32_t content, journal *j)
{
    sc_mesh m = input_plain_mesh(s);
    sc_hooks hooks = make_hooks(j);
    sc_build_options options;
    sc_model *model = NULL;
    sc_status status;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.weld = weld;
    options.content = content;
    options.hooks = &hooks;
    status = sc_build(&m, &options, &model);
    CHECK(j->failures == 0);
    sc_model_free(model);
    return status;
}

static void messages_of_builds(void)
{
    journal j;
    soup s = soup_cloth(2, 2);
    CHECK(build(&s, SC_WELD_REST, SC_MODEL_FULL, &j) == SC_OK);
    CHECK_MSG(j.text[0] == '\0', "%s", j.text); /* nothing to say */
    s.triangles[4] = 99;
    CHECK(build(&s, SC_WELD_REST, SC_MODEL_FULL, &j) == SC_ERROR_INDEX &&
          j.levels == 1u << SC_LOG_ERROR);
    CHECK_MSG(strcmp(j.text, "triangle 1 names vertex 99 of 9\n") == 0, "%s", j.text);
    s.triangles[4] = 0;
    s.positions[3 * 8 + 1] = HUGE_VAL;
    CHECK(build(&s, SC_WELD_REST, SC_MODEL_FULL, &j) == SC_ERROR_NOT_FINITE &&
          j.levels == 1u << SC_LOG_ERROR);
    CHECK_MSG(strcmp(j.text, "vertex 8 is NaN or infinite\n") == 0, "%s", j.text);
    soup_free(&s);

    s = soup_seams(3);
    CHECK(build(&s, SC_WELD_REST, SC_MODEL_FULL, &j) == SC_OK && j.levels == 1u << SC_LOG_NOTE);
    CHECK_MSG(strcmp(j.text, "38 vertices are welded to others\n") == 0, "%s", j.text);
    CHECK(build(&s, SC_WELD_NONE, SC_MODEL_FULL, &j) == SC_OK &&
          strstr(j.text, "18 components\n") != NULL);
    CHECK_MSG(strstr(j.text, "leaf clusters are not connected") != NULL, "%s", j.text);
    CHECK(build(&s, SC_WELD_NONE, SC_MODEL_BOXES, &j) == SC_OK &&
          strstr(j.text, "18 components\n") != NULL);
    CHECK_MSG(strstr(j.text, "leaf clusters") == NULL, "%s", j.text); /* nothing is culled anyway */
    soup_free(&s);

    s = soup_fins(3);
    CHECK(build(&s, SC_WELD_REST, SC_MODEL_FULL, &j) == SC_OK &&
          (j.levels & 1u << SC_LOG_WARNING) != 0);
    CHECK_MSG(strstr(j.text, "edges have three or more triangles") != NULL, "%s", j.text);
    soup_free(&s);

    s = soup_make(5, 1);
    for (uint32_t i = 0; i < 15; ++i) s.positions[i] = i % 4 == 0;
    for (uint32_t i = 0; i < 3; ++i) s.triangles[i] = i + 1;
    CHECK(build(&s, SC_WELD_NONE, SC_MODEL_FULL, &j) == SC_OK);
    CHECK_MSG(strcmp(j.text, "2 vertices are in no triangle\n") == 0, "%s", j.text);
    soup_free(&s);
}

static void hooks_are_read(void)
{
    journal j;
    soup s = soup_cloth(2, 2);
    sc_mesh m = input_plain_mesh(&s);
    sc_hooks hooks = make_hooks(&j), larger[2];
    sc_build_options options;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.hooks = &hooks;
    hooks.struct_size = sizeof(void *) / 2 * 3; /* no multiple of a pointer's size */
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_STRUCT_SIZE && model == NULL);
    hooks.struct_size = sizeof(hooks);
    hooks.reserved = 3;
    CHECK(sc_build(&m, &options, &model) == SC_ERROR_OPTION && model == NULL);
    hooks.reserved = 0;
    if (CHECK(sc_build(&m, &options, &model) == SC_OK) &&
        CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) {
        sc_pose pose = input_plain_pose(s.positions, s.vertex_count);
        sc_result result;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        CHECK(sc_workspace_set_hooks(NULL, &hooks) == SC_ERROR_NULL);
        hooks.struct_size = 4;
        CHECK(sc_workspace_set_hooks(workspace, &hooks) == SC_ERROR_STRUCT_SIZE);
        hooks.struct_size = sizeof(hooks);
        CHECK(sc_workspace_set_hooks(workspace, &hooks) == SC_OK);
        hooks.user = NULL; /* it was copied */
        CHECK(sc_query(model, workspace, &pose, NULL, &result) == SC_OK);
        memset(larger, 0, sizeof(larger)); /* of a later version */
        larger[0].struct_size = sizeof(larger);
        CHECK(sc_workspace_set_hooks(workspace, larger) == SC_OK);
        ((unsigned char *)larger)[sizeof(larger) - 1] = 1;
        CHECK(sc_workspace_set_hooks(workspace, larger) == SC_ERROR_STRUCT_SIZE);
        CHECK(sc_workspace_set_hooks(workspace, NULL) == SC_OK);
        CHECK(sc_query(model, workspace, &pose, NULL, &result) == SC_OK);
    }
    CHECK(j.failures == 0 && j.text[0] == '\0');
    sc_workspace_free(workspace);
    sc_model_free(model);
    soup_free(&s);
}

/* Poses that are refused: which vertex is at fault, and at which end of a step. */
static void messages_of_queries(void)
{
    journal j;
    soup s = soup_make(5, 1);
    sc_mesh m;
    sc_hooks hooks = make_hooks(&j);
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    sc_workspace_options options;
    for (uint32_t i = 0; i < 15; ++i) s.positions[i] = i % 4 == 0;
    for (uint32_t i = 0; i < 3; ++i) s.triangles[i] = i + 1;
    m = input_plain_mesh(&s);
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.flags = SC_WORKSPACE_STEP;
    if (CHECK(sc_build(&m, NULL, &model) == SC_OK) &&
        CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK) &&
        CHECK(sc_workspace_set_hooks(workspace, &hooks) == SC_OK)) {
        double bad[15];
        sc_pose good = input_plain_pose(s.positions, 5), pose = input_plain_pose(bad, 5);
        sc_result result;
        sc_step_result step;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        memset(&step, 0, sizeof(step));
        step.struct_size = sizeof(step);
        memcpy(bad, s.positions, sizeof(bad));
        bad[1] = (double)NAN; /* in no triangle */
        CHECK(sc_query(model, workspace, &pose, NULL, &result) == SC_OK && j.text[0] == '\0');
        for (int k = 0; k < 3; k++) {
            bad[6 + k] = k == 1 ? -HUGE_VAL : (double)NAN;
            CHECK(sc_query(model, workspace, &pose, NULL, &result) == SC_ERROR_NOT_FINITE);
            CHECK_MSG(strcmp(j.text, "vertex 2 is NaN or infinite\n") == 0, "%s", j.text);
            j.text[0] = '\0';
            bad[6 + k] = 0;
        }
        bad[10] = (double)NAN;
        CHECK(sc_query_step(model, workspace, &pose, &good, NULL, &step) == SC_ERROR_NOT_FINITE);
        CHECK_MSG(strcmp(j.text, "vertex 3 is NaN or infinite at the start\n") == 0, "%s", j.text);
        j.text[0] = '\0';
        CHECK(sc_query_step(model, workspace, &good, &pose, NULL, &step) == SC_ERROR_NOT_FINITE);
        CHECK_MSG(strcmp(j.text, "vertex 3 is NaN or infinite at the end\n") == 0, "%s", j.text);
        CHECK(j.levels == 1u << SC_LOG_ERROR && j.failures == 0);
        j.text[0] = '\0';
        CHECK(sc_workspace_set_hooks(workspace, NULL) == SC_OK);
        CHECK(sc_query(model, workspace, &pose, NULL, &result) == SC_ERROR_NOT_FINITE);
        CHECK(j.text[0] == '\0');
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    soup_free(&s);
}

static void long_and_missing_messages(void)
{
    journal j;
    sc_hooks hooks = make_hooks(&j);
    char text[1000];
    memset(text, 'x', sizeof(text));
    text[sizeof(text) - 1] = '\0';
    sc_hooks_log(&hooks, SC_LOG_NOTE, "%s", text);
    CHECK(strlen(j.text) == 256 && j.text[255] == '\n'); /* 255 characters of it */
    hooks.log = NULL;
    sc_hooks_log(&hooks, SC_LOG_NOTE, "%d", 1);
    sc_hooks_log(NULL, SC_LOG_NOTE, "%d", 1);
    CHECK(strlen(j.text) == 256);
}

static void failed_invariants(void)
{
    journal j;
    sc_hooks hooks = make_hooks(&j);
    uint32_t one = 1, line;
    SC_HOOKS_ASSERT(&hooks, one == 1);
    CHECK(j.failures == 0);
    line = __LINE__ + 1;
    SC_HOOKS_ASSERT(&hooks, one == 2);
    CHECK(j.failures == 1 && j.line == line);
    CHECK_MSG(strncmp(j.text, "one == 2 ", 9) == 0 && strstr(j.text, "test_hooks.c") != NULL, "%s",
              j.text);
    hooks.failed = NULL;
    SC_HOOKS_ASSERT(&hooks, one == 1);
}

SC_TEST_MAIN(SC_TEST(messages_of_builds), SC_TEST(hooks_are_read), SC_TEST(messages_of_queries),
             SC_TEST(long_and_missing_messages), SC_TEST(failed_invariants))
