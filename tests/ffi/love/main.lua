-- A game for LÖVE: a model is built on loading, queried in every frame from memory that the engine
-- owns (love.data), and shared with a thread of the engine that has a workspace of its own.
--
--     love tests/ffi/love BINDING_FOLDER HEADER LIBRARY MESH GOLDEN
--
-- SPDX-License-Identifier: MIT
local ffi = require("ffi")

local frames_wanted = 60
local frame = 0
local game = {}

function love.load(arguments)
    local folder, header, library, mesh_path, golden_path = unpack(arguments)
    package.path = folder .. "/?.lua;" .. package.path
    local example = require("example_mesh")
    local sc = require("starcontour").load(header, library)
    local mesh = example.read(mesh_path)

    game.example, game.sc, game.mesh = example, sc, mesh
    game.golden = example.golden(golden_path)
    game.check = example.checks()
    game.check("a frame's pairs are not those of the other pose", #game.golden.rest ~= #game.golden.moved)

    game.model = sc.build(mesh.vertices, mesh.vertex_count, mesh.triangles, mesh.triangle_count)
    game.workspace = game.model:workspace()

    -- Positions live in the engine's memory and are read there.
    local bytes = 4 * 3 * mesh.vertex_count
    game.buffer = love.data.newByteData(bytes)
    game.positions = ffi.cast("float *", game.buffer:getFFIPointer())

    -- The thread gets the model's address, and answers how many pairs it found.
    game.thread = love.thread.newThread([[
        local folder, header, library, mesh_path, address, times = ...
        package.path = folder .. "/?.lua;" .. package.path
        local example = require("example_mesh")
        local sc = require("starcontour").load(header, library)
        local mesh = example.read(mesh_path)
        local workspace = sc.borrow(address):workspace()
        for _ = 1, times do
            local _, count = workspace:query(mesh.vertices, mesh.vertex_count)
            love.thread.getChannel("counts"):push(count)
        end
    ]])
    game.thread:start(folder, header, library, mesh_path, game.model:address(), frames_wanted)
end

-- Even frames are at rest, odd ones moved.
function love.update()
    frame = frame + 1
    local mesh, n = game.mesh, 3 * game.mesh.vertex_count
    local pose = frame % 2 == 0 and "rest" or "moved"
    local source = pose == "rest" and mesh.vertices or game.example.moved(mesh)
    for i = 0, n - 1 do game.positions[i] = source[i] end

    local pairs, count = game.workspace:query(game.positions, mesh.vertex_count)
    game.check("pairs in frame " .. frame, game.example.same(game.golden[pose], pairs, count))
    if frame < frames_wanted then return end

    game.positions[5] = 1 / 0
    local fine, problem = pcall(game.workspace.query, game.workspace, game.positions, mesh.vertex_count)
    game.check("infinity is refused", not fine and problem.status == game.sc.C.SC_ERROR_NOT_FINITE
        and problem.message:match("infinite") ~= nil)

    game.thread:wait()
    game.check("the thread had no error", game.thread:getError() == nil)
    local counts = love.thread.getChannel("counts")
    local answers, right = counts:getCount(), 0
    while counts:getCount() > 0 do
        if counts:pop() == #game.golden.rest then right = right + 1 end
    end
    game.check("the thread's answers", answers == frames_wanted and right == answers)
    love.event.quit(game.check.finish("love") == 0 and 0 or 1)
end
