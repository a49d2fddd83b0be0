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

-- Contours.
local traced = one:trace(mesh.vertices, n)
check("contours at rest", traced.contour_count > 0 and example.same_contours(golden, traced))
check("lengths of contours", example.lengths_fit(traced, sc.C.SC_TRACE_CLOSED))
local traced_later = two:trace(moved, n)
check("contours when moved", not example.same_contours(golden, traced_later)
    and example.lengths_fit(traced_later, sc.C.SC_TRACE_CLOSED))
local stop = ffi.new("uint32_t[1]", 1)
check("contours that are not wanted any more", raised(sc.C.SC_ERROR_INCOMPLETE, ".",
    one.trace, one, moved, n, { cancel = stop }))

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
check("contours of NaN", raised(sc.C.SC_ERROR_NOT_FINITE, "NaN", one.trace, one, moved, n))
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

-- The mesh's two cloths as two objects have the pairs that the mesh has.
mesh = example.read(arg[3])
moved = example.moved(mesh)
local half, half_count = n / 2, mesh.triangle_count / 2
local later_triangles = ffi.new("uint32_t[?]", 3 * half_count)
for i = 0, 3 * half_count - 1 do later_triangles[i] = mesh.triangles[3 * half_count + i] - half end
local cloths = { sc.build(mesh.vertices, half, mesh.triangles, half_count),
                 sc.build(mesh.vertices + 3 * half, half, later_triangles, half_count) }
local scene = sc.scene({ flags = sc.C.SC_WORKSPACE_NEAR })
local first, second = scene:add(cloths[1]), scene:add(cloths[2])

-- Whether meetings are golden pairs; first_a and first_b: numbers in the mesh of what is the second
-- cloth's first.
local function joined(wanted, meetings, first_a, first_b)
    local found = {}
    for _, meeting in ipairs(meetings) do
        for i = 0, meeting.count - 1 do
            found[#found + 1] = { a = meeting.pairs[i].a + meeting.a * first_a,
                                  b = meeting.pairs[i].b + meeting.b * first_b }
        end
    end
    table.sort(found, function(p, q) return p.a < q.a or p.a == q.a and p.b < q.b end)
    found[0] = table.remove(found, 1)
    return example.same(wanted, found, #found + (found[0] and 1 or 0))
end

check("objects without a pose", raised(sc.C.SC_ERROR_NULL, ".", scene.query, scene))
first:set_pose(mesh.vertices, half)
second:set_pose(mesh.vertices + 3 * half, half)
check("pairs of two objects", joined(golden.rest, scene:query(), half_count, half_count))
first:set_end(moved, half)
second:set_end(moved + 3 * half, half)
local faces, edges, earliest = scene:step()
check("a step of two objects", joined(golden.stepfaces, faces, half, half_count)
    and joined(golden.stepedges, edges, 3 * half_count, 3 * half_count))
later = earliest > 0 and earliest == step.earliest
for i = 0, edges[1].count - 1 do later = later and edges[1].times[i] >= earliest end
check("at the times of the mesh", later)
first:set_pose(moved, half)
second:set_pose(moved + 3 * half, half)
faces, edges = scene:near(0.045)
check("near of two objects", joined(golden.nearfaces, faces, half, half_count)
    and joined(golden.nearedges, edges, 3 * half_count, 3 * half_count))
check("pairs when they moved", joined(golden.moved, scene:query(), half_count, half_count))
first.options.group, second.options.group = { 1, 1 }, { 2, 2 }
check("groups of objects", #scene:query() == 0)
local flat = ffi.new("double[?]", 3 * half)
first:set_pose(flat, half)
local alone, alone_count = cloths[1]:workspace():query(flat, half)
local itself = scene:query()
check("an object and itself", #itself == 1 and itself[1].count == alone_count
    and ffi.string(itself[1].pairs, 8 * alone_count) == ffi.string(alone, 8 * alone_count))
first.options.itself = 0
check("an object without itself", #scene:query() == 0)

-- Workspaces keep their model, and what is not needed goes.
model, one, larger = nil, nil, nil
collectgarbage()
collectgarbage()
check("workspace keeps its model", example.same(golden.moved, two:query(moved, n)))

-- A program that ends with an error frees what it has before the library is unloaded.
local ends = [[
    package.path = %q
    local ffi = require("ffi")
    local sc = require("starcontour").load(%q, %q)
    local corners = ffi.new("double[9]", { 0, 0, 0, 1, 0, 0, 0, 1, 0 })
    local model = sc.build(corners, 3, ffi.new("uint32_t[3]", { 0, 1, 2 }), 1)
    local workspace = model:workspace()
    error("it ends here")
]]
local program = os.tmpname()
local file = assert(io.open(program, "w"))
file:write(ends:format(package.path, arg[1], arg[2]))
file:close()
local child = assert(io.popen(("%s %s 2>&1; echo status $?"):format(arg[-1], program)))
local said = child:read("*a")
child:close()
os.remove(program)
check("a program that ends with an error", said:match("it ends here") and said:match("status 1%s*$"))

os.exit(check.finish("luajit") == 0 and 0 or 1)
