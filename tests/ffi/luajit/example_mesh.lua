-- The mesh, the two poses and the golden pairs of these tests, for LuaJIT and LÖVE.
--
-- SPDX-License-Identifier: MIT
local ffi = require("ffi")

local example = {}

-- An OBJ file: float[3 n] and uint32_t[3 m], n and m.
function example.read(path)
    local at, corners = {}, {}
    for line in io.lines(path) do
        local kind, rest = line:match("^(%a+)%s+(.*)")
        if kind == "v" then
            for number in rest:gmatch("%S+") do at[#at + 1] = tonumber(number) end
        elseif kind == "f" then
            for number in rest:gmatch("(%d+)%S*") do corners[#corners + 1] = tonumber(number) - 1 end
        end
    end
    return { vertices = ffi.new("float[?]", #at, at), vertex_count = #at / 3,
             triangles = ffi.new("uint32_t[?]", #corners, corners), triangle_count = #corners / 3 }
end

-- The second pose, in doubles: the later half of the vertices tilted.
function example.moved(mesh)
    local pose = ffi.new("double[?]", 3 * mesh.vertex_count)
    for i = 0, mesh.vertex_count - 1 do
        local x, y, z = mesh.vertices[3 * i], mesh.vertices[3 * i + 1], mesh.vertices[3 * i + 2]
        pose[3 * i], pose[3 * i + 1] = x, y
        pose[3 * i + 2] = z + (i >= math.floor(mesh.vertex_count / 2) and x / 4 - 0.25 or 0)
    end
    return pose
end

-- { rest = { "a b", ... }, moved = { ... }, nearfaces = ..., node = ..., contour = { "count begin
-- end length", ... } }
function example.golden(path)
    local golden = {}
    for line in io.lines(path) do
        local pose, pair = line:match("^(%a+) (%d+ %d+.*)$")
        if pose then
            golden[pose] = golden[pose] or {}
            table.insert(golden[pose], pair)
        end
    end
    return golden
end

-- Whether these are the golden pairs, in the same order.
function example.same(golden, pairs, count)
    if count ~= #golden then return false end
    for i = 1, count do
        local pair = pairs[i - 1]
        if golden[i] ~= string.format("%d %d", pair.a, pair.b) then return false end
    end
    return true
end

local function close(a, b)
    return math.abs(a - b) <= 1e-12 * b
end

-- Whether these are the golden contours: nodes, and of contours number of nodes, begin, end and
-- length.
function example.same_contours(golden, traced)
    if traced.node_count ~= #golden.node or traced.contour_count ~= #golden.contour then return false end
    for i = 1, #golden.node do
        local node = traced.nodes[i - 1]
        if golden.node[i] ~= string.format("%d %d", node.edge, node.triangle) then return false end
    end
    for i = 1, #golden.contour do
        local contour = traced.contours[i - 1]
        local numbers, length = golden.contour[i]:match("^(%d+ %d+ %d+) (%S+)$")
        if numbers ~= string.format("%d %d %d", tonumber(contour.count), contour.begin, contour["end"])
            or not close(contour.length, tonumber(length)) then
            return false
        end
    end
    return true
end

-- Whether nodes follow each other contour after contour, and so does the length of their segments.
function example.lengths_fit(traced, closed)
    local following = 0
    for i = 0, tonumber(traced.contour_count) - 1 do
        local contour = traced.contours[i]
        local count, length = tonumber(contour.count), 0
        if contour.first ~= following then return false end
        for k = 0, count - (contour.begin == closed and 1 or 2) do
            local p, q = traced.nodes[following + k].point, traced.nodes[following + (k + 1) % count].point
            length = length + math.sqrt((p[0] - q[0]) ^ 2 + (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2)
        end
        if not close(length, contour.length) then return false end
        following = following + count
    end
    return traced.node_count == following
end

-- Counts checks: check(what, condition); check.finish(name) prints the sum and returns the
-- failures.
function example.checks()
    local passed, failed = 0, 0
    local checks = {}
    function checks.finish(name)
        print(string.format("%s: %d passed, %d failed", name, passed, failed))
        return failed
    end
    return setmetatable(checks, { __call = function(_, what, condition)
        if condition then
            passed = passed + 1
        else
            failed = failed + 1
            print("failed: " .. what)
        end
    end })
end

return example
