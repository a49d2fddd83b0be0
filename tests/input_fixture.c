/*
 * See input_fixture.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "input_fixture.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"

int input_fixture_start(input_fixture *f)
{
    memset(f, 0, sizeof(*f));
    f->mesh = soup_cloth(10, 10);
    f->posed = (double *)test_allocate(3 * (size_t)f->mesh.vertex_count * sizeof(double));
    memcpy(f->posed, f->mesh.positions, 3 * (size_t)f->mesh.vertex_count * sizeof(double));
    for (uint32_t v = 0; v < f->mesh.vertex_count; ++v) /* fold it to a slope that crosses it */
        if (f->posed[3 * v] > 0.55) {
            f->posed[3 * v] = 1.1 - f->posed[3 * v];
            f->posed[3 * v + 2] = 0.1 * f->posed[3 * v + 1] - 0.03;
        }
    f->input = input_plain_mesh(&f->mesh);
    f->pose = input_plain_pose(f->posed, f->mesh.vertex_count);
    oracle_solve(f->posed, f->mesh.vertex_count, f->mesh.triangles, f->mesh.triangle_count, NULL,
                 &f->answer);
    return CHECK(f->answer.lists[0][0].count > 10) &&
           CHECK(sc_build(&f->input, NULL, &f->model) == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}

void input_fixture_stop(input_fixture *f)
{
    sc_workspace_free(f->workspace);
    sc_model_free(f->model);
    oracle_free(&f->answer);
    soup_free(&f->mesh);
    free(f->posed);
}

int input_fixture_is_right(const input_fixture *f, const sc_model *model, sc_workspace *workspace)
{
    const oracle_list *expected = &f->answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    sc_pair *pairs = (sc_pair *)test_allocate(expected->count * sizeof(sc_pair));
    sc_result result;
    int ok;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.capacity = expected->count;
    result.pairs = pairs;
    ok = sc_query(model, workspace, &f->pose, NULL, &result) == SC_OK &&
         result.count == expected->count && result.collides == 1 &&
         memcmp(pairs, expected->pairs, expected->count * sizeof(sc_pair)) == 0;
    free(pairs);
    return ok;
}

int input_fixture_is_still_right(const input_fixture *f)
{
    return input_fixture_is_right(f, f->model, f->workspace);
}

void input_fixture_check_build(const input_fixture *f, const sc_mesh *mesh,
                               const sc_build_options *options, sc_status expected,
                               const char *what)
{
    sc_model *model = f->model; /* anything but NULL */
    sc_status status = sc_build(mesh, options, &model);
    CHECK_MSG(status == expected, "%s: %s instead of %s", what, sc_status_string(status),
              sc_status_string(expected));
    if (status != SC_OK) {
        CHECK_MSG(model == NULL, "%s", what);
    } else {
        sc_workspace *workspace = NULL;
        CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK);
        CHECK_MSG(expected != SC_OK || input_fixture_is_right(f, model, workspace), "%s", what);
        sc_workspace_free(workspace);
        sc_model_free(model);
    }
}

void input_fixture_check_query(const input_fixture *f, const sc_model *model,
                               sc_workspace *workspace, const sc_pose *pose,
                               const sc_query_options *options, sc_status expected,
                               const char *what)
{
    static const sc_pair guard = {123, 456};
    sc_pair pairs[4];
    sc_result result;
    sc_status status;
    for (int i = 0; i < 4; ++i) pairs[i] = guard;
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    result.collides = 5;
    result.count = 55;
    result.capacity = 4;
    result.pairs = pairs;
    status = sc_query(model, workspace, pose, options, &result);
    CHECK_MSG(status == expected, "%s: %s instead of %s", what, sc_status_string(status),
              sc_status_string(expected));
    CHECK_MSG(result.count == 0 && result.collides == 0, "%s: count %u, collides %u", what,
              (unsigned)result.count, (unsigned)result.collides);
    for (int i = 0; i < 4; ++i)
        CHECK_MSG(pairs[i].a == guard.a && pairs[i].b == guard.b, "%s: pair %d written", what, i);
    CHECK(result.capacity == 4 && result.pairs == pairs && result.stats == NULL);
    CHECK_MSG(input_fixture_is_still_right(f), "%s", what);
}

sc_query_options input_fixture_no_options(void)
{
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}

sc_build_options input_fixture_no_build_options(void)
{
    sc_build_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}
