"""Small motions of a network about its static state: mass, damping and stiffness, frequencies, forced response.

The force that every node lacks, M a + C v' + K r' = external, is linearised about nodes at rest by complex steps of
`moving_network.Forces`, all laws in the branch where they stand. Drag about still water has no linear part; in a
current it has one, and all of it is in C and K. Exact for the network of cells, not for the continuous line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verification.exact.mooring.moving_network import Forces, Mesh

STEP = 1e-30


@dataclass(frozen=True)
class LinearNetwork:
    """Matrices (3 size, 3 size) of all nodes of the mesh, component by component of node after node, kg, N s/m, N/m.

    tension_by_position, tension_by_velocity (c, 3 size) : N/m and N s/m;  at_rest (size, 3) : m
    """

    mesh: Mesh
    at_rest: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    tension_by_position: np.ndarray
    tension_by_velocity: np.ndarray

    def _places(self, nodes):
        return (3 * nodes[:, None] + np.arange(3)).ravel()

    def frequencies(self):
        """Return the undamped natural frequencies, ndarray (3 free,), Hz ascending, and the shapes (3 free, size, 3).

        The stiffness must be symmetric, as it is without current.
        """
        free = self._places(self.mesh.free)
        factor = np.linalg.cholesky(self.mass[np.ix_(free, free)])
        half = np.linalg.solve(factor, self.stiffness[np.ix_(free, free)])
        reduced = np.linalg.solve(factor, half.T)
        values, vectors = np.linalg.eigh((reduced + reduced.T) / 2)
        shapes = np.zeros((len(values), 3 * self.mesh.size))
        shapes[:, free] = np.linalg.solve(factor.T, vectors).T
        return np.sqrt(values) / (2 * np.pi), shapes.reshape(len(values), self.mesh.size, 3)

    def response(self, omega, held):
        """Return complex amplitudes of all nodes (size, 3), of cell tensions (c,), of holder forces (size, 3).

        omega : rad/s, of x(t) = Re X exp(i omega t);  held : (h, 3) complex amplitudes, m, of the nodes `mesh.held`
        Holder forces are those of the network on what holds the node, as in `moving_network.History`.
        """
        free, fixed = self._places(self.mesh.free), self._places(self.mesh.held)
        dynamic = self.stiffness + 1j * omega * self.damping - omega**2 * self.mass
        x = np.zeros(3 * self.mesh.size, complex)
        x[fixed] = np.ravel(held)
        x[free] = np.linalg.solve(dynamic[np.ix_(free, free)], -dynamic[np.ix_(free, fixed)] @ x[fixed])
        forces = np.zeros(x.shape, complex)
        forces[fixed] = -(dynamic @ x)[fixed]
        tension = (self.tension_by_position + 1j * omega * self.tension_by_velocity) @ x
        return x.reshape(-1, 3), tension, forces.reshape(-1, 3)

    def held_by_body(self, amplitude, phase):
        """Return the amplitudes (h, 3) of held nodes for small surge, sway, heave, roll, pitch, yaw of the body."""
        q = np.asarray(amplitude) * np.exp(1j * np.asarray(phase))
        arms = self.at_rest[self.mesh.held] - np.array(self.mesh.network.motion.reference, float)
        moved = q[:3] + np.cross(q[3:], arms)
        return np.where(np.isin(self.mesh.held, self.mesh.coupled)[:, None], moved, 0.0)


def linearise(network, at_rest):
    """Return the `LinearNetwork` of a network about positions at_rest (size, 3), m, without velocity."""
    mesh = Mesh(network)
    n = 3 * mesh.size
    rest = np.repeat(np.asarray(at_rest, complex)[:, None], n, axis=1)
    nudge = np.zeros(rest.shape, complex)
    nudge[np.repeat(np.arange(mesh.size), 3), np.arange(n), np.tile(np.arange(3), mesh.size)] = STEP * 1j
    by_position = Forces(mesh, rest + nudge, np.zeros(rest.shape, complex))
    by_velocity = Forces(mesh, rest, nudge)
    matrix = lambda forces: -np.moveaxis(forces.total, 1, -1).reshape(n, n).imag / STEP
    mass = np.zeros((mesh.size, 3, mesh.size, 3))
    here = np.arange(mesh.size)
    mass[here, :, here, :] = Forces(mesh, np.asarray(at_rest, float), np.zeros((mesh.size, 3))).mass
    return LinearNetwork(
        mesh=mesh,
        at_rest=np.asarray(at_rest, float),
        mass=mass.reshape(n, n),
        damping=matrix(by_velocity),
        stiffness=matrix(by_position),
        tension_by_position=by_position.tension.imag / STEP,
        tension_by_velocity=by_velocity.tension.imag / STEP,
    )
