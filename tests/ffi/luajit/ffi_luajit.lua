-- LuaJIT: pairs of two poses, the header's layout, errors, one model and two workspaces.
--
--     luajit ffi_luajit.lua HEADER LIBRARY MESH GOLDEN LAYOUT
--
-- SPDX-License-Identifier: MIT
package.path = arg[0]:match("^(.-)[^/]*$") .. "?.lua"
local ffi = require("ffi")
local example = require("example_mesh")
local sc = require("starcontour").load(arg[1], arg[2])
local mesh = example.read(arg[3])
local golden = example.golden(arg[4])
local check = example.checks()
local moved = example.moved(mesh)

-- What the text of the header became is what a C compiler makes of it.
local compared, wrong = 0, 0
for line in io.lines(arg[5]) do
    local kind, name, rest = line:match("^(%a+) (%S+) (.*)$")
    local right
    if kind == "struct" then
        right = ffi.sizeof(name) == tonumber(rest)
    elseif kind == "value" then
        right = sc.C[name] == tonumber(rest)
    else
        local member, offset = rest:match("^(%S+) (%d+)")
        right = ffi.offsetof(name, member) == tonumber(offset)
    end
    compared = compared + 1
    if not right then
        wrong = wrong + 1
        print("differs: " .. line)
    end
end
check("layout and values are the header's", compared > 100 and wrong == 0)

local function raised(status, text, call, ...)
    local fine, problem = pcall(call, ...)
    return not fine and type(problem) == "table" and problem.status == status
        and problem.message:match(text) ~= nil
end

local n = mesh.vertex_count
local model = sc.build(mesh.vertices, n, mesh.triangles, mesh.triangle_count)
check("info", model:info().triangle_count == mesh.triangle_count)
local one, two = model:workspace(), model:workspace()
check("pairs at rest", example.same(golden.rest, one:query(mesh.vertices, n)))
check("pairs when moved", example.same(golden.moved, two:query(moved, n)))

-- In turns, each workspace on its own pose.
local fine = true
for _ = 1, 100 do
    local pairs, count = one:query(mesh.vertices, n)
    local others, other_count = two:query(moved, n)
    fine = fine and example.same(golden.rest, pairs, count)
        and example.same(golden.moved, others, other_count)
end
check("one model, two workspaces", fine)

check("options", select(2, one:query(moved, n, { output = sc.C.SC_OUTPUT_COUNT })) == #golden.moved)
check("unknown option", raised(sc.C.SC_ERROR_OPTION, ".", one.query, one, moved, n, { method = 99 }))
check("number of vertices", raised(sc.C.SC_ERROR_VERTEX_COUNT, "vert", one.query, one, moved, n - 1))
moved[10] = 0 / 0
check("NaN", raised(sc.C.SC_ERROR_NOT_FINITE, "NaN", one.query, one, moved, n))
check("usable after errors", example.same(golden.rest, one:query(mesh.vertices, n)))
mesh.triangles[1] = n
check("vertex out of range", raised(sc.C.SC_ERROR_INDEX, ".", sc.build,
    mesh.vertices, n, mesh.triangles, mesh.triangle_count))

-- Steps, and what is near.
local larger = model:workspace({ flags = sc.C.SC_WORKSPACE_NEAR })
moved = example.moved(mesh)
local near = larger:near(moved, n, 0.045)
check("pairs that are near", example.same(golden.nearfaces, near.vertex_faces, tonumber(near.vertex_face_count))
    and example.same(golden.nearedges, near.edge_edges, tonumber(near.edge_edge_count)))
local step = larger:step(mesh.vertices, moved, n)
local later = step.earliest > 0
for i = 0, tonumber(step.edge_edge_count) - 1 do later = later and step.edge_edge_times[i] >= step.earliest end
check("pairs of a step", example.same(golden.stepfaces, step.vertex_faces, tonumber(step.vertex_face_count))
    and example.same(golden.stepedges, step.edge_edges, tonumber(step.edge_edge_count)))
check("at their times", later)
check("a step that is free", larger:step(moved, moved, n).earliest == 1)
check("a distance below 0", raised(sc.C.SC_ERROR_OPTION, ".", larger.near, larger, moved, n, -1))
check("no room for steps", raised(sc.C.SC_ERROR_WORKSPACE, ".", one.step, one, moved, moved, n))

-- Workspaces keep their model, and what is not needed goes.
model, one, larger = nil, nil, nil
collectgarbage()
collectgarbage()
check("workspace keeps its model", example.same(golden.moved, two:query(moved, n)))

os.exit(check.finish("luajit") == 0 and 0 or 1)
