-- The modules that the sample needs: no window, no graphics, no sound, so it runs without a
-- display.
--
-- SPDX-License-Identifier: MIT
function love.conf(t)
    t.identity = "starcontour_sample"
    t.appendidentity = true
    t.modules.audio = false
    t.modules.font = false
    t.modules.graphics = false
    t.modules.image = false
    t.modules.joystick = false
    t.modules.keyboard = false
    t.modules.mouse = false
    t.modules.physics = false
    t.modules.sound = false
    t.modules.touch = false
    t.modules.video = false
    t.modules.window = false
end
