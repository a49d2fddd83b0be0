/*
 * The public headers in C++: they compile there, and the library's functions link and work.
 *
 * SPDX-License-Identifier: MIT
 */
#include "starcontour.h"
#include "starcontour_metis.h"

#include <cstdio>

/* The METIS library is not linked here; its function has the type that a build asks for. */
typedef sc_status bisect_type(void *, const sc_dual_graph *, uint32_t, uint8_t *);
template <bisect_type *> struct takes_bisect {
};
typedef takes_bisect<&sc_metis_bisect> metis_bisects;

static bool run()
{
    /* Two triangles, the second with an edge through the first. */
    static const float positions[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 1, 1, 1, 9, 9, 1};
    static const uint16_t indices[] = {0, 1, 2, 3, 4, 5};
    sc_mesh mesh = sc_mesh();
    mesh.struct_size = sizeof(mesh);
    mesh.vertex_count = 6;
    mesh.triangle_count = 2;
    mesh.position_type = SC_FLOAT;
    mesh.index_type = SC_UINT16;
    mesh.positions = positions;
    mesh.indices = indices;

    sc_model *model = nullptr;
    sc_workspace *workspace = nullptr;
    sc_pair pairs[4];
    sc_pose pose = sc_pose();
    pose.struct_size = sizeof(pose);
    pose.vertex_count = 6;
    pose.position_type = SC_FLOAT;
    pose.positions = positions;
    sc_result result = sc_result();
    result.struct_size = sizeof(result);
    result.pairs = pairs;
    result.capacity = 4;

    bool ok = sc_build(&mesh, nullptr, &model) == SC_OK &&
              sc_workspace_create(model, nullptr, &workspace) == SC_OK &&
              sc_query(model, workspace, &pose, nullptr, &result) == SC_OK && result.count == 1 &&
              pairs[0].a == 0 && pairs[0].b == 1 && sc_version() == SC_VERSION_NUMBER &&
              sc_status_string(SC_OK) != nullptr;
    sc_workspace_free(workspace);
    sc_model_free(model);
    return ok;
}

int main()
{
    bool ok = run();
    std::printf("header_cxx: %d passed, %d failed, 0 skipped\n", ok ? 1 : 0, ok ? 0 : 1);
    return ok ? 0 : 1;
}
