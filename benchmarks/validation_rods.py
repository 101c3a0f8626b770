"""Rods of ``validation.py``, held and driven: thresholds of stability, filaments with a base."""

import numpy as np
from extremes import changed
from validation_cases import MU, system_of

ROD = {  # A = C = 1, held at its first point
    "fluid": {"viscosity": MU, "epsilon": 1.0},
    "rods": {"rod": {"shape": {"kind": "straight", "points": 41, "length": 20.0},
                     "moduli": {"bending": 1.0, "twisting": 1.0, "shear": 400.0,
                                "stretch": 400.0},
                     "start": {"hold": "clamped"}}},
    "time": {"end": 1.0},
}  # fmt: skip


def jacobian(system, state, turning=0.0):
    """Return the Jacobian of all nodes but the held first one, in a frame that turns about z.

    Perturbations of places x and of triads theta: dx/dt = du - omega x dx, dtheta/dt = dw, since in
    the steady state all triads turn with omega.
    """
    n, h = system.scene.nodes, 1e-6
    free = np.delete(np.arange(6 * n), np.arange(6) * n)
    J, y = np.empty((6 * n, 6 * n)), system.zeros()
    for j in range(6 * n):
        both = []
        for step in (h, -h):
            y[:] = 0.0
            y[j] = step
            both.append(system.velocities(0.0, state, y, system.zeros())[: 6 * n].copy())
        J[:, j] = (both[0] - both[1]) / (2.0 * h)
    J[:n, n : 2 * n] += turning * np.eye(n)  # -omega x dx
    J[n : 2 * n, :n] -= turning * np.eye(n)
    return J[np.ix_(free, free)]


def growth(system, state, turning=0.0):
    """Return the growth rate and the frequency of the mode that grows most."""
    rates = np.linalg.eigvals(jacobian(system, state, turning))
    first = rates[np.argmax(rates.real)]
    return first.real, abs(first.imag)


def threshold(grows, low, high):
    """Return where a growth rate changes its sign."""
    from scipy.optimize import brentq

    return brentq(grows, low, high, rtol=1e-5)


def pushed_rod(points, length, epsilon, force, follower):
    """Return a system with a force on its tip, and its straight, shortened state."""
    data = changed(ROD, {
        "rods.rod.shape.points": points, "rods.rod.shape.length": length, "fluid.epsilon": epsilon,
        "rods.rod.loads": {"tip": {"at": "end", "force": [0, 0, -float(force)],
                                   "frame": "triad" if follower else "space"}},
    })  # fmt: skip
    system = system_of(data)
    state = system.scene.initial
    state.position[2] *= 1.0 - force / 400.0
    return system, state


def flutter(points, length, epsilon):
    """Return F L^2/A at which a clamped rod flutters under a follower force, and the frequency."""

    def grows(sigma):
        return growth(*pushed_rod(points, length, epsilon, sigma / length**2, True))[0]

    sigma = threshold(grows, 25.0, 40.0)
    return sigma, growth(*pushed_rod(points, length, epsilon, sigma / length**2, True))[1]


def euler(points, length, epsilon):
    """Return F L^2/A at which a clamped rod buckles under a dead load."""

    def grows(sigma):
        return growth(*pushed_rod(points, length, epsilon, sigma / length**2, False))[0]

    return threshold(grows, 2.0, 3.0)


def _twist_steadily(state, omega, spacing, epsilon, viscosity, twisting=1.0):
    """Twist a straight rod along z as one whose points all turn with omega.

    Torques m along a line answer with w_i = sum_j (D1 + z^2 D2)/(4 mu) m_j; the moment N_k of a
    segment is minus the sum of those beyond it, and its triads differ by 2 arcsin(N ds/(2 a_3)).
    """
    z = state.position[2]
    d2 = (z[:, None] - z) ** 2
    R2 = d2 + epsilon**2
    D1 = (10 * epsilon**4 - 7 * epsilon**2 * d2 - 2 * d2**2) / R2**3.5
    D2 = (21 * epsilon**2 + 6 * d2) / R2**3.5
    M = (D1 + d2 * D2) / (32 * np.pi * viscosity)
    torques = np.linalg.solve(M, np.full(len(z), omega))  # of the rod on the fluid
    moments = -np.cumsum(torques[::-1])[::-1][1:]  # N_k: what is beyond k pulls back
    turns = np.append(0.0, np.cumsum(2 * np.arcsin(0.5 * moments * spacing / twisting)))
    cos, sin, zero = np.cos(turns), np.sin(turns), np.zeros_like(turns)
    state.director[:] = [[cos, sin, zero], [-sin, cos, zero], [zero, zero, zero + 1.0]]


def whirl(points, length, epsilon):
    """Return zeta_r omega L^2/A at which a rod turned at its base starts to whirl.

    zeta_r = 2 pi mu eps^2. The state that turns steadily is straight; its twist is that of the
    fluid's torques.
    """
    zeta = 2.0 * np.pi * MU * epsilon**2

    def grows(sigma):
        omega = sigma / (zeta * length**2)
        data = changed(ROD, {
            "rods.rod.shape.points": points, "rods.rod.shape.length": length,
            "fluid.epsilon": epsilon,
            "rods.rod.start.move": {"turn": [0, 0, f"{omega!r}*t"]},
        })  # fmt: skip
        system = system_of(data)
        state = system.scene.initial
        _twist_steadily(state, omega, length / (points - 1), epsilon, MU)
        return growth(system, state, omega)[0]

    return threshold(grows, 5.5, 8.5)


def elastica(drive, sp, periods, amplitude=0.1, points=41):
    """Return the force and the power of a driven filament over each period, over omega^n a^2...

    force/(omega a^2) and power/(omega^2 a^2 L), a = alpha L or y0; L = 20, eps = 1, b = 100,
    zeta_perp = 3.145; a sine start from a straight rod.
    """
    from rodsim.case import case_from_mapping
    from rodsim.integrators.make import make_integrator

    length, zeta = 20.0, 3.145
    omega = (sp / length) ** 4 / zeta
    period, a = 2.0 * np.pi / omega, amplitude * length
    sine = f"sin({omega!r}*t)"
    move = {
        "pivot": {"turn": [f"{amplitude}*{sine}", 0, 0]},
        "hinge": {"displace": [0, f"{a}*{sine}", 0]},
        "heave": {"displace": [0, f"{a}*{sine}", 0]},
    }[drive]
    hold = "hinged" if drive == "hinge" else "clamped"
    data = changed(ROD, {
        "rods.rod.moduli": {"bending": 1.0, "twisting": 1.0, "shear": 100.0, "stretch": 100.0},
        "rods.rod.shape": {"kind": "straight", "points": points, "length": length},
        "rods.rod.start": {"hold": hold, "move": move}, "plane": "yz",
        "time": {"end": periods * period, "tolerance": 1e-5, "max_step": period / 40},
    })  # fmt: skip
    system, case = system_of(data), case_from_mapping(data)
    seen, at = [], 0
    for step in make_integrator(case.time, system).steps(system.scene.initial, case.time.end):
        while at <= periods and at * period <= step.end.time * (1.0 + 1e-12):
            state = step.at(min(at * period, step.end.time))
            _, found = system.observe(state)
            seen.append([found["anchor_impulse"][0, 2], found["anchor_work"], found["dissipated"]])
            at += 1
    change = np.diff(np.array(seen, dtype=float), axis=0) / period
    return change / np.array([omega * a * a, omega**2 * a * a * length, omega**2 * a * a * length])


def hook(bending=0.3, twisting=0.2):
    """Return (what, ours, exact) of a rod that hangs on a hook, at rest under a load on its tip.

    y = F L^2/k + F L^3/(3 A) + F L/b under a force F; T/k_t + T L/C under a torque T.
    """
    from rodsim.case import case_from_mapping
    from rodsim.integrators.make import make_integrator

    L, A, C, b, F, T = 2.0, 0.5, 0.4, 300.0, 1e-3, 0.02
    ends = {}
    for name, load in (("force", [0, F, 0]), ("torque", [0, 0, T])):
        data = changed(ROD, {
            "fluid.epsilon": 0.2, "rods.rod.shape.points": 21, "rods.rod.shape.length": L,
            "rods.rod.moduli": {"bending": A, "twisting": C, "shear": b, "stretch": b},
            "rods.rod.start.hook": {"bending": bending, "twisting": twisting},
            "rods.rod.loads": {"tip": {"at": "end", name: load}},
            "time": {"end": 2000.0, "tolerance": 1e-7},
        })  # fmt: skip
        system = system_of(data)
        integrator = make_integrator(case_from_mapping(data).time, system)
        for step in integrator.steps(system.scene.initial, 2000.0):
            ends[name] = step.end
    turn = ends["torque"].director[0, :, -1]
    return (
        ("tip, under a force", ends["force"].position[1, -1],
         F * L**2 / bending + F * L**3 / (3 * A) + F * L / b),
        ("turn of the last triad, under a torque", np.arctan2(turn[1], turn[0]),
         T / twisting + T * L / C),
    )  # fmt: skip
