"""scipy.integrate.solve_ivp on the problem of a scene: usage scipy_ode.py PROBLEM.json FOLDER full|quick|reference|start.

Prints per method and tolerance: name, tolerance, calls of the right-hand side, seconds of each run. The right-hand side
is plain Python on floats, which for a dozen unknowns is faster than numpy on arrays."""
import json
import sys
import time
import warnings

import numpy as np
from scipy.integrate import solve_ivp

problem, folder, scope = json.load(open(sys.argv[1])), sys.argv[2], sys.argv[3]
warnings.simplefilter("ignore")
w, t0, lp1, lp2 = (problem[k] for k in ("width", "thickness", "lp1", "lp2"))
mu, jm, eps, mass, damping, load, stop = (
    problem[k] for k in ("mu", "jm", "permittivity", "mass", "damping", "load", "stop"))
branches = [(b["mu"], b["tau"]) for b in problem["branches"]]
zones = [(z["side"], z["length"], z["resistance"]) for z in problem["zones"]]
B = len(branches)
X, V, Q = 1e-3, 1.0, 1e-7  # scales: mm, m/s, 0.1 uC
CHARGE = 2 + 2 * B  # states of a zone: 2 per branch, then the charge
NEAR = 1e-9 * stop  # closer times are one
SIZE = 2 + len(zones) * (2 * B + 1)


def respond(y, source):
    """Rates of all states for the source voltages; also the film voltages."""
    x, v = y[0] * X, y[1] * V
    force, rates, volts, at = load - damping * v, [y[1] * V / X, 0.0], [], 2
    for k, (side, length, resistance) in enumerate(zones):
        lam = lp1 * (1.0 + side * x / length)
        i1 = lam * lam + lp2 * lp2 + 1.0 / (lam * lam * lp2 * lp2)
        stress = mu * jm * (lam - 1.0 / (lam**3 * lp2 * lp2)) / (jm + 3.0 - i1)
        for mu_b, tau in branches:
            a, b = y[at], y[at + 1]
            g1, g2 = (lam / (lp1 * a)) ** 2, 1.0 / (b * b)
            g3 = 1.0 / (g1 * g2)
            s1, s2 = g1 - g3, g2 - g3
            stress += mu_b * s1 / lam
            rates.append(a * (s1 - 0.5 * s2) / (3.0 * tau))
            rates.append(b * (s2 - 0.5 * s1) / (3.0 * tau))
            at += 2
        c = eps * w * length * lam * lam / (lp1 * lp1 * t0)
        volt = y[at] * Q / c
        pull = w * t0 * lp1 * stress - 0.5 * volt * volt * eps * w * 2.0 * lam / (lp1 * t0)
        force -= side * pull
        rates.append((source[k] - volt) / resistance / Q)
        volts.append(volt)
        at += 1
    rates[1] = force / mass / V
    return rates, volts


def pieces():
    """Spans without a corner: start, end, and per zone value and slope of the source."""
    corners = sorted({c[i] for z in problem["zones"] for c in z["corners"] for i in (0, 2)})
    for start, end in zip(corners, corners[1:]):
        lines = []
        for z in problem["zones"]:
            c = next(c for c in z["corners"] if c[0] <= start < c[2])
            slope = (c[3] - c[1]) / (c[2] - c[0])
            lines.append((c[1] + slope * (start - c[0]), slope))
        yield start, end, lines


def solve(method, rtol, count):
    y = [0.0, 0.0]
    for k in range(len(zones)):
        y += [1.0] * (2 * B) + [0.0]
    rows, times, calls = [], np.linspace(0.0, stop, count + 1), 0
    rows.append((0.0, y))
    for start, end, lines in pieces():
        def rate(t, state, start=start, lines=lines):
            return respond(state, [value + slope * (t - start) for value, slope in lines])[0]
        inside = times[(times > start + NEAR) & (times < end - NEAR)]
        got = solve_ivp(rate, (start, end), y, method=method, rtol=rtol, atol=rtol * 1e-2, t_eval=np.append(inside, end))
        if got.status != 0:
            raise RuntimeError(got.message)
        calls += got.nfev
        rows += list(zip(got.t, got.y.T))
        y = list(got.y[:, -1])
    return rows, calls


def measure(method, rtol, count):
    """Solves up to five times, fewer where that takes long, and leaves the result in a file."""
    name, seconds = f"scipy_{method}", []
    try:
        while len(seconds) < (1 if scope == "quick" else 5) and sum(seconds) < 1.5:
            started = time.perf_counter()
            rows, calls = solve(method, rtol, count)
            seconds.append(time.perf_counter() - started)
        with open(f"{folder}/{name}-{rtol:g}.txt", "w") as file:
            for t, y in rows:
                volts = respond(list(y), [0.0] * len(zones))[1]
                file.write(" ".join(f"{n:.17g}" for n in (t, y[0] * X, *volts)) + "\n")
        print(name, f"{rtol:g}", calls, *(f"{s:.6g}" for s in seconds), flush=True)
    except (RuntimeError, ValueError, ZeroDivisionError, OverflowError) as failure:
        print(name, f"{rtol:g}", "failed", failure, flush=True)


if scope == "reference":
    measure("LSODA", 1e-12, 20000)
elif scope != "start":
    tolerances = (1e-3, 1e-5, 1e-7) if scope == "quick" else (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
    for tolerance in tolerances:
        for solver in ("LSODA", "Radau"):
            measure(solver, tolerance, int(problem["rows"]))
