-- starcontour for LuaJIT, as an engine binds it: the declarations are read out of starcontour.h
-- when the program starts, so structures are the header's and need no copying.
--
--     local sc = require("starcontour").load(header, library)
--     local model = sc.build(vertices, vertex_count, triangles, triangle_count)
--     local workspace = model:workspace()
--     local pairs, count = workspace:query(pose, vertex_count)
--     -- pairs[0] to pairs[count - 1] have the fields a and b
--
--     local larger = model:workspace({ flags = sc.C.SC_WORKSPACE_NEAR })
--     local step = larger:step(pose, next_pose, vertex_count)     -- a sc_step_result, or
--     local near = larger:near(pose, vertex_count, 0.01)          -- a sc_near_result: vertex_faces[0]
--     -- to vertex_faces[tonumber(vertex_face_count) - 1], edge_edges likewise; step.earliest
--
--     local traced = workspace:trace(pose, vertex_count)          -- a sc_trace_result: contours[0] to
--     -- contours[tonumber(contour_count) - 1]; nodes[contour.first] is a contour's first
--
--     local scene = sc.scene()                                    -- several objects
--     local cloth, body = scene:add(model), scene:add(other, { itself = 0 })
--     cloth:set_pose(pose, vertex_count)                          -- again whenever it has moved
--     for _, meeting in ipairs(scene:query()) do                  -- meeting.a, .b: numbers of two objects
--         -- meeting.pairs[0] to meeting.pairs[meeting.count - 1], of a step meeting.times likewise
--     end
--
-- Vertices and poses are cdata arrays of float or double, three a vertex, triangles of uint32_t;
-- they are read in place. What query returns stays as it is until the next query of the same
-- workspace. Errors of the library are Lua errors: tables with status and message. What is not
-- wrapped is in sc.C.
--
-- SPDX-License-Identifier: MIT
local ffi = require("ffi")

local starcontour = {}

-- Libraries stay loaded as long as this module does: a garbage collection that takes a library
-- together with handles of it may unload the library first, and then call it to free them.
local libraries = {}

-- The header's text without comments, directives, what is for C++ only, and SC_API. Macros that are
-- numbers become constants.
function starcontour.declarations(header)
    local file = assert(io.open(header))
    local text = file:read("*a")
    file:close()
    text = text:gsub("/%*.-%*/", " "):gsub("\\\n", " ")
    local lines, depth, skipped = {}, 0, nil
    for line in text:gmatch("[^\n]+") do
        if line:match("^%s*#%s*if") then
            depth = depth + 1
            if line:match("__cplusplus") then skipped = depth end
        elseif line:match("^%s*#%s*endif") then
            if skipped == depth then skipped = nil end
            depth = depth - 1
        elseif line:match("^#define SC_[A-Z_]+ %d%w*$") then
            lines[#lines + 1] = line:gsub("#define (%S+) (%w-)u?$", "static const uint32_t %1 = %2;")
        elseif line:match("^#define SC_[A-Z_]+ %(%-.*%)$") then
            lines[#lines + 1] = line:gsub("#define (%S+) (.*)$", "static const int32_t %1 = %2;")
        elseif not line:match("^%s*#") and not skipped then
            lines[#lines + 1] = line
        end
    end
    return (table.concat(lines, "\n"):gsub("SC_API", ""))
end

-- The library's number for the type of a cdata array's elements.
local function scalar_type(C, positions)
    local name = tostring(ffi.typeof(positions))
    if name:match("double") then return C.SC_DOUBLE end
    if name:match("float") then return C.SC_FLOAT end
    error("a pose is an array of float or double, not " .. name, 3)
end

function starcontour.load(header, library)
    ffi.cdef(starcontour.declarations(header))
    local C = ffi.load(library)
    libraries[#libraries + 1] = C
    local sc = { C = C, ffi = ffi }

    local function check(status)
        if status ~= C.SC_OK then
            error({ status = status, message = ffi.string(C.sc_status_string(status)) }, 0)
        end
    end

    local function sized(type, members)
        local struct = ffi.new(type, members or {})
        struct.struct_size = ffi.sizeof(type)
        return struct
    end

    local function pose_of(positions, vertex_count)
        return sized("sc_pose", {
            vertex_count = vertex_count, position_type = scalar_type(C, positions),
            positions = positions })
    end

    local Workspace = {}
    Workspace.__index = Workspace

    -- options: members of sc_query_options by name, or nil.
    function Workspace:query(positions, vertex_count, options)
        local pose, asked = pose_of(positions, vertex_count), sized("sc_query_options", options)
        local result = self.result
        while true do
            result.capacity, result.pairs = self.capacity, self.pairs
            local status = C.sc_query(self.model.handle, self.handle, pose, asked, result)
            if status ~= C.SC_ERROR_SHORT_BUFFER then
                check(status)
                return self.pairs, tonumber(result.count)
            end
            self.capacity = tonumber(result.count) * 2
            self.pairs = ffi.new("sc_pair[?]", self.capacity)
        end
    end

    -- Asks until both arrays of the result are long enough; they stay alive with the workspace.
    function Workspace:find(type, ask)
        local result = sized(type)
        self.features = { result }
        while true do
            local status = ask(result)
            if status ~= C.SC_ERROR_SHORT_BUFFER then
                check(status)
                return result
            end
            for _, kind in ipairs({ "vertex_face", "edge_edge" }) do
                local count = tonumber(result[kind .. "_count"])
                local array = ffi.new("sc_pair[?]", count)
                result[kind .. "_capacity"], result[kind .. "s"] = count, array
                self.features[#self.features + 1] = array
                if type == "sc_step_result" then
                    local times = ffi.new("double[?]", count)
                    result[kind .. "_times"] = times
                    self.features[#self.features + 1] = times
                end
            end
        end
    end

    -- What collides on the way from one pose to another. options: members of sc_step_options by
    -- name, or nil: all pairs with their times. The result stays until the next step or near.
    function Workspace:step(from, to, vertex_count, options)
        local start, goal = pose_of(from, vertex_count), pose_of(to, vertex_count)
        local asked = sized("sc_step_options", options or { times = C.SC_STEP_TIMES_EACH })
        return self:find("sc_step_result", function(result)
            return C.sc_query_step(self.model.handle, self.handle, start, goal, asked, result)
        end)
    end

    -- What is within a distance in a pose. options: members of sc_near_options by name, or nil.
    function Workspace:near(positions, vertex_count, distance, options)
        local pose, asked = pose_of(positions, vertex_count), sized("sc_near_options", options)
        asked.distance = distance
        return self:find("sc_near_result", function(result)
            return C.sc_query_near(self.model.handle, self.handle, pose, asked, result)
        end)
    end

    -- Contours of the intersections in a pose. Its pairs of edges and triangles are found first, in
    -- place of those of the last query. options: members of sc_trace_options by name, or nil; simd,
    -- tasks and cancel are the query's, too. The result stays until the next trace.
    function Workspace:trace(positions, vertex_count, options)
        local pose, asked = pose_of(positions, vertex_count), sized("sc_trace_options", options)
        local pairs, count = self:query(positions, vertex_count, {
            pairs = C.SC_PAIRS_EDGE, simd = asked.simd, tasks = asked.tasks, cancel = asked.cancel })
        local result = sized("sc_trace_result")
        self.traced = { result }
        while true do
            local status = C.sc_trace(self.model.handle, pose, pairs, count, asked, result)
            if status ~= C.SC_ERROR_SHORT_BUFFER then
                check(status)
                return result
            end
            local nodes = ffi.new("sc_trace_node[?]", tonumber(result.node_count))
            local contours = ffi.new("sc_trace_contour[?]", tonumber(result.contour_count))
            result.node_capacity, result.nodes = result.node_count, nodes
            result.contour_capacity, result.contours = result.contour_count, contours
            self.traced = { result, nodes, contours }
        end
    end

    local Model = {}
    Model.__index = Model

    -- options: members of sc_workspace_options by name, or nil.
    function Model:workspace(options)
        local out = ffi.new("sc_workspace *[1]")
        check(C.sc_workspace_create_for(self.handle, sized("sc_workspace_options", options), out))
        return setmetatable({
            model = self, handle = ffi.gc(out[0], C.sc_workspace_free), capacity = 16,
            pairs = ffi.new("sc_pair[16]"), result = sized("sc_result") }, Workspace)
    end

    function Model:info()
        local info = sized("sc_model_info")
        check(C.sc_model_get_info(self.handle, info))
        return info
    end

    -- The model's address, to be handed to another thread's Lua state, and a Model made of one. The
    -- one that built it has to outlive those.
    function Model:address()
        return tonumber(ffi.cast("uintptr_t", self.handle))
    end

    function sc.borrow(address)
        return setmetatable({ handle = ffi.cast("sc_model *", address) }, Model)
    end

    -- vertices: cdata of float or double. triangles: cdata of uint32_t.
    function sc.build(vertices, vertex_count, triangles, triangle_count, options)
        local mesh = sized("sc_mesh", {
            vertex_count = vertex_count, triangle_count = triangle_count,
            position_type = scalar_type(C, vertices), positions = vertices, indices = triangles })
        local out = ffi.new("sc_model *[1]")
        check(C.sc_build(mesh, sized("sc_build_options", options), out))
        return setmetatable({ handle = ffi.gc(out[0], C.sc_model_free) }, Model)
    end

    local Object = {}
    Object.__index = Object

    -- Where it is, of a step at its start. The array stays as it is until the next set_pose.
    function Object:set_pose(positions, vertex_count)
        self.positions, self.pose = positions, pose_of(positions, vertex_count)
        self.options.pose_version = self.options.pose_version + 1
    end

    -- Of a step, where it is at its end, likewise; nil, as at first: where it began.
    function Object:set_end(positions, vertex_count)
        self.end_positions, self.goal = positions, positions and pose_of(positions, vertex_count)
        self.options.pose_version = self.options.pose_version + 1
    end

    local Scene = {}
    Scene.__index = Scene

    local function room()
        return { capacity = 16, pairs = ffi.new("sc_pair[16]"), times = ffi.new("double[16]"),
                 range_capacity = 1, ranges = ffi.new("sc_object_pairs[1]") }
    end

    -- options: members of sc_workspace_options by name, for the workspace of each object, or nil.
    function sc.scene(options)
        return setmetatable({ options = options, objects = {}, lenders = {},
                              rooms = { room(), room() } }, Scene)
    end

    -- The scene's options for workspaces, and others beside.
    local function options_with(scene, flags, lender)
        local all = {}
        for name, value in pairs(scene.options or {}) do all[name] = value end
        all.flags = (all.flags or 0) + flags
        all.room = lender and lender.handle
        return all
    end

    -- Objects of one model have one room, but for the first, which has its own: nil.
    local function lender_for(scene, model)
        local known = scene.lenders[model]
        if known == nil then
            scene.lenders[model] = false
        elseif not known then
            scene.lenders[model] = model:workspace(options_with(scene, C.SC_WORKSPACE_ROOM))
        end
        return scene.lenders[model] or nil
    end

    -- A new object, without a pose. options: members of sc_object by name, such as itself (1, if it
    -- is not given) and group, or nil; they may be changed later, in the object's options.
    function Scene:add(model, options)
        local lender = lender_for(self, model)
        local object = { model = model, workspace = model:workspace(options_with(self, 0, lender)),
                         options = ffi.new("sc_object", options or {}) }
        if not (options and options.itself) then object.options.itself = 1 end
        object.options.model, object.options.workspace = model.handle, object.workspace.handle
        self.objects[#self.objects + 1] = object
        return setmetatable(object, Object)
    end

    -- Asks until the arrays of all lists are long enough. Each list becomes a table of meetings,
    -- which stay until the scene's next question.
    function Scene:ask(lists, moves, question)
        local array = ffi.new("sc_object[?]", #self.objects)
        for i, object in ipairs(self.objects) do
            local options = object.options
            options.pose, options["end"] = object.pose, moves and object.goal or nil
            array[i - 1] = options
        end
        local objects = sized("sc_objects", { count = #self.objects, objects = array })
        local status
        repeat
            for i, list in ipairs(lists) do
                local own = self.rooms[i]
                list.capacity, list.pairs = own.capacity, own.pairs
                list.range_capacity, list.ranges = own.range_capacity, own.ranges
                if moves then list.times = own.times end
            end
            status = question(objects)
            if status == C.SC_ERROR_SHORT_BUFFER then
                for i, list in ipairs(lists) do
                    local own, count = self.rooms[i], tonumber(list.count)
                    local range_count = tonumber(list.range_count)
                    if count > own.capacity then
                        own.capacity, own.pairs = count, ffi.new("sc_pair[?]", count)
                        own.times = ffi.new("double[?]", count)
                    end
                    if range_count > own.range_capacity then
                        own.range_capacity = range_count
                        own.ranges = ffi.new("sc_object_pairs[?]", range_count)
                    end
                end
            end
        until status ~= C.SC_ERROR_SHORT_BUFFER
        check(status)
        local found = {}
        for i, list in ipairs(lists) do
            local own = self.rooms[i]
            found[i] = {}
            for k = 0, tonumber(list.range_count) - 1 do
                local range = own.ranges[k]
                local first = tonumber(range.first)
                found[i][k + 1] = { a = range.object_a, b = range.object_b, count = tonumber(range.count),
                                    pairs = own.pairs + first,
                                    times = moves and own.times + first or nil,
                                    arrays = { own.pairs, own.times } } -- keeps them alive
            end
        end
        return unpack(found)
    end

    -- What intersects: a list of meetings. options: members of sc_query_options by name, or nil.
    function Scene:query(options)
        local asked, result = sized("sc_query_options", options), sized("sc_objects_result")
        return self:ask({ result }, false, function(objects)
            return C.sc_query_objects(objects, asked, result)
        end)
    end

    -- What is within a distance: meetings of vertices and triangles, and of edges. options: members
    -- of sc_near_options by name, or nil.
    function Scene:near(distance, options)
        local asked, result = sized("sc_near_options", options), sized("sc_objects_lists")
        asked.distance = distance
        return self:ask({ result.vertex_faces, result.edge_edges }, false, function(objects)
            return C.sc_query_objects_near(objects, asked, result)
        end)
    end

    -- What collides while objects move from their pose to their end: the same two lists, and the
    -- time before which nothing does. options: members of sc_step_options by name, or nil.
    function Scene:step(options)
        local asked, result = sized("sc_step_options", options), sized("sc_objects_lists")
        asked.times = C.SC_STEP_TIMES_EACH
        local faces, edges = self:ask({ result.vertex_faces, result.edge_edges }, true, function(objects)
            return C.sc_query_objects_step(objects, asked, result)
        end)
        return faces, edges, result.earliest
    end

    return sc
end

return starcontour
