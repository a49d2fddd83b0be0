"""A cloth that falls on a sphere and on itself: springs along its edges, gravity, and ipc-toolkit's barrier.

    fall = Fall(cells)
    goal = fall.goal(collisions)     where it would go in this step: collisions within fall.dhat at fall.at
    fall.go(goal, step)              goes there, or as far as the collision-free step size allows

Which broad phase finds collisions and step size, the caller says: see test_client.py and fall_picture.py.

SPDX-License-Identifier: MIT
"""

import ipctk
import numpy as np


def make_cloth(cells):
    """A square from -1 to 1, slightly wrinkled."""
    x, y = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1))
    vertices = np.stack([x.ravel(), y.ravel(), 0.62 + 0.01 * np.sin(7 * x.ravel()) * np.cos(5 * y.ravel())], 1)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.concatenate([np.stack([first, first + 1, first + cells + 2], 1),
                            np.stack([first, first + cells + 2, first + cells + 1], 1)])
    return vertices, faces


def make_sphere(around):
    """A sphere of radius 0.5, open at its poles."""
    angle, height = np.meshgrid(2 * np.pi * np.arange(around) / around,
                                np.pi * (np.arange(around // 2) + 1) / (around // 2 + 1))
    vertices = 0.5 * np.stack([np.sin(height) * np.cos(angle), np.sin(height) * np.sin(angle), np.cos(height)],
                              -1).reshape(-1, 3)
    j, i = np.meshgrid(np.arange(around // 2 - 1), np.arange(around), indexing="ij")
    a, b = (j * around + i).ravel(), (j * around + (i + 1) % around).ravel()
    return vertices, np.concatenate([np.stack([a, a + around, b + around], 1), np.stack([a, b + around, b], 1)])


class Fall:
    """rest, edges, faces, mesh: the cloth, whose vertices come first, and the sphere; moves: which vertices
    are the cloth's; at: where all vertices are now; dhat: how near a collision is. By default springs and
    barrier are so weak that nearly all steps are cut short, as a test wants them."""

    def __init__(self, cells, stiffness=50.0, barrier=1e3, dt=0.02):
        cloth, cloth_faces = make_cloth(cells)
        sphere, sphere_faces = make_sphere(cells)
        self.rest = np.asfortranarray(np.concatenate([cloth, sphere]))
        self.faces = np.asfortranarray(np.concatenate([cloth_faces, sphere_faces + len(cloth)]).astype(np.int32))
        self.edges = np.asfortranarray(ipctk.edges(self.faces))
        self.mesh = ipctk.CollisionMesh(self.rest, self.edges, self.faces)
        self.moves = np.arange(len(self.rest)) < len(cloth)
        self.springs = self.edges[self.moves[self.edges].all(1)]
        self.lengths = np.linalg.norm(self.rest[self.springs[:, 0]] - self.rest[self.springs[:, 1]], axis=1)
        self.dhat, self.stiffness, self.dt = 0.4 / cells, stiffness, dt
        self.barrier = ipctk.BarrierPotential(self.dhat, barrier)
        self.at, self.velocity = self.rest.copy(order="F"), np.zeros_like(self.rest)

    def goal(self, collisions):
        force = np.zeros_like(self.rest)
        way = self.at[self.springs[:, 1]] - self.at[self.springs[:, 0]]
        length = np.linalg.norm(way, axis=1)
        pull = (self.stiffness * (length - self.lengths) / self.lengths / np.maximum(length, 1e-12))[:, None] * way
        np.add.at(force, self.springs[:, 0], pull)
        np.add.at(force, self.springs[:, 1], -pull)
        force[:, 2] -= 9.81
        if len(collisions):
            force -= self.barrier.gradient(collisions, self.mesh, self.at).reshape(-1, 3)
        self.velocity = np.where(self.moves[:, None], 0.97 * (self.velocity + self.dt * force), 0)
        return np.asfortranarray(self.at + self.dt * self.velocity)

    def go(self, goal, step):
        self.at = np.asfortranarray(self.at + 0.9 * step * (goal - self.at)) if step < 1 else goal
        if step < 1:
            self.velocity *= step
