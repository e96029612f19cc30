"""An extended Kalman filter of the pads' ratio as a book writes it, to compare the product's with.

Written from the equations in the docstrings of `calib.estimation.measurement` and
`calib.estimation.states`, and from their numbers in `Priors`; no code of theirs runs here. Dense
matrices, numerical gradients, both measurements at once (Simon, Optimal State Estimation, ch. 13):

    x = F x,  P = F P F' + Q
    nu = y - h(x),  S = H P H' + R,  K = P H' S^-1
    x = x + K nu,  P = (I - K H) P (I - K H)' + K R K'
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from calib.base.names import G
from calib.model.settings import SETTINGS

STATES = (
    *("rho", "s", "w", "xi", "kappa", "nu", "eta0", "sl0", "lag"),
    *("q", "c", "b2", "b3", "rho0", "tau", "r", "dtau", "delta"),
)
PLACE = {name: i for i, name in enumerate(STATES)}
COUNT = len(STATES)
FROM_TABLE = {
    "log_compliance": "c",
    "curvature_2": "b2",
    "curvature_3": "b3",
    "load_exponent": "q",
    "clock_offset": "lag",
    "log_pad_ratio": "rho0",
    "log_tyre_ratio": "tau",
    "radius_load": "r",
}
OF_A_RAMP = {"tau": 0.1, "r": 0.003}
"""Sigma around zero of what an older table does not name: 10 % between the axles' tyres, 0.3 %."""


@dataclass(frozen=True)
class Answer:
    """States (k, 18), covariances (k, 18, 18), normalised innovations (k, 2), times of changes."""

    x: np.ndarray
    P: np.ndarray
    innovation: np.ndarray
    changes: tuple[float, ...]

    def state(self, symbol: str) -> np.ndarray:
        return self.x[:, PLACE[symbol]]

    def variance(self, one: str, other: str) -> np.ndarray:
        return self.P[:, PLACE[one], PLACE[other]]


def sensed(x, demand, block):
    """Eta and the mean slip of one block: what the sensors show without noise."""
    return shown(x, demand, block)[0]


def shown(x, demand, block):
    """The same, and how near to its peak the nearer axle is."""
    a = dict(zip(STATES, x, strict=True))
    W = block["weight"]
    deficit = demand["pitch_deficit"] + a["nu"] * demand["pitch_slope"]
    late = (a["xi"] + a["kappa"] * deficit) * W
    loads = demand["load_f"] - late, demand["load_r"] + late
    if math.isfinite(demand["level"]):
        front = demand["nominal_f"] * math.exp(0.5 * a["rho"])
        rear = demand["nominal_r"] * math.exp(-0.5 * a["rho"])
        total = demand["level"] * (demand["nominal_f"] + demand["nominal_r"])
        F_f = (front / (front + rear) * total + demand["moment_f"]) / loads[0]
        F_r = (rear / (front + rear) * total + demand["moment_r"]) / loads[1]
        steeper = demand["level"] * demand["rise"] / (front + rear)
        rises = front * steeper / loads[0], rear * steeper / loads[1]
    else:
        rises = 0.0, 0.0
        free = (demand["tyre_sum"] - demand["drive_f"] - demand["drive_r"]) / W
        F_f = free + demand["drive_f"] / demand["load_f"]
        F_r = free + demand["drive_r"] / demand["load_r"]
    slips, near = [], []
    apart = 0.5 * (a["tau"] + a["dtau"])
    rests = block["rest_f"], block["rest_r"]
    signs = (1.0, -1.0)
    for F, rise, load, rest, sign in zip((F_f, F_r), rises, loads, rests, signs, strict=True):
        u = F * math.exp(a["w"])
        near.append(u)
        curve = F + a["b2"] * F * u + a["b3"] * F * u**2
        curve -= a["delta"] * rise * (1.0 + 2.0 * a["b2"] * u + 3.0 * a["b3"] * u**2)
        compliance = math.exp(a["c"] - a["s"] + sign * apart)
        slip = compliance * (2.0 * load / W) ** a["q"] * curve
        # the radius under load over that at rest
        slips.append(1.0 - (1.0 - slip) / math.exp(a["r"] * (1.0 - load / rest)))
    eta = (1.0 + a["eta0"]) * (1.0 - slips[1]) / (1.0 - slips[0])
    share = demand["load_f"] / W
    mean = share * slips[0] + (1.0 - share) * slips[1]
    late = G * block["z"] / block["speed"] * a["lag"]
    return np.array([eta, mean + a["sl0"] + late]), max(near)


def gradients(h, x):
    """Central differences of h over x; errors of third and fifth order taken out (Richardson)."""
    columns = []
    for i in range(x.size):
        slopes = []
        for step in (8e-4, 4e-4, 2e-4):
            e = np.zeros_like(x)
            e[i] = step
            slopes.append((h(x + e) - h(x - e)) / (2.0 * step))
        coarse, fine = ((4.0 * b - a) / 3.0 for a, b in pairwise(slopes))
        columns.append((16.0 * fine - coarse) / 15.0)
    return np.column_stack(columns)


def first(posterior, p):
    """Mean and covariance before the first block; the covariance less the table's scatter."""
    x, P = np.zeros(COUNT), np.zeros((COUNT, COUNT))
    for name, sigma in OF_A_RAMP.items():
        P[PLACE[name], PLACE[name]] = sigma**2
    at = [PLACE[FROM_TABLE[name]] for name in posterior.names]
    x[at], P[np.ix_(at, at)] = posterior.mean, np.asarray(posterior.covariance)
    less = P.copy()
    if posterior.scatter:
        less[np.ix_(at, at)] -= np.asarray(posterior.scatter)
    x[PLACE["kappa"]] = p.elastic_share
    x[PLACE["delta"]] = p.delay
    # rho = rho0 + an own part; w = slope * s + an own part
    T = np.eye(COUNT)
    T[PLACE["rho"], PLACE["rho0"]] = 1.0
    T[PLACE["w"], PLACE["s"]] = p.peak_per_stiffness
    x[PLACE["rho"]] = x[PLACE["rho0"]]
    for name, sigma in (
        ("rho", p.ratio), ("s", p.stiffness), ("w", p.peak),
        ("kappa", p.elastic_sigma), ("nu", p.pitch_tempo), ("eta0", p.zero), ("sl0", p.zero),
        ("dtau", p.tyre_change), ("delta", p.delay_sigma),
    ):  # fmt: skip
        for matrix in (P, less):
            matrix[PLACE[name], PLACE[name]] = sigma**2
    return x, T @ P @ T.T, T @ less @ T.T


def textbook(car, blocks, demand, noise, posterior, p):
    """Run the filter; the arguments are those of `filter_pad_ratio`.

    P is the covariance that the gains are of, ``whole`` that of the error: with the table's
    scatter, which no gain counts.
    """
    x, whole, P = first(posterior, p)
    T = blocks.length
    decay = math.exp(-T / p.pitch_memory)
    F = np.eye(COUNT)
    F[PLACE["xi"], PLACE["xi"]] = decay
    followed, wild, same = blocks.z[0], [], 0
    out = []
    changes = []
    pressure = np.maximum(blocks.p_f, blocks.p_r)
    for k in range(blocks.end.size):
        now = {n: np.nan if v is None else v[k] for n, v in vars(demand).items()}
        speed = max(blocks.speed[k], 1.0)
        block = {"weight": car.mass * G, "z": blocks.z[k], "speed": speed}
        length = car.cg_to_front_axle + car.cg_to_rear_axle
        block["rest_f"] = car.mass * G * car.cg_to_rear_axle / length
        block["rest_r"] = car.mass * G * car.cg_to_front_axle / length
        followed += (1.0 - math.exp(-T / p.pitch_time)) * (blocks.z[k] - followed)
        held = abs(blocks.z[k] - followed)
        fed = p.pitch * held * car.cg_height / length
        Q = np.zeros(COUNT)
        Q[[PLACE["rho"], PLACE["s"], PLACE["w"]]] = p.drift_ratio, p.drift_road, p.drift_road
        Q[[PLACE["eta0"], PLACE["sl0"]]] = p.drift_zero * blocks.lead_in[k]
        Q = np.diag(Q**2 * T)
        Q[PLACE["xi"], PLACE["xi"]] = (1.0 - decay**2) * fed**2
        if changes:
            Q = Q + surface_spread(p, p.change_rate**2 * T)
        x, P, whole = F @ x, F @ P @ F.T + Q, F @ whole @ F.T + Q
        nu = np.full(2, np.nan)
        deficit = now["pitch_deficit"] + x[PLACE["nu"]] * now["pitch_slope"]
        late = (x[PLACE["xi"]] + x[PLACE["kappa"]] * deficit) * block["weight"]
        seen = np.array([blocks.omega_r[k] / blocks.omega_f[k], now["slip"]])
        off = np.array([abs(seen[0] - 1.0), abs(seen[1])])
        stands = now["load_f"] > late > -now["load_r"]
        told = math.isfinite(now["level"]) or blocks.lead_in[k]
        if told and blocks.speed[k] > 3.0 and not np.any(off >= p.rolling) and stands:
            before = np.diff(pressure, prepend=pressure[0])[k]
            sync = p.sync * abs(before) / T / max(pressure[k], 3e5)
            relative = p.model
            if math.isfinite(now["level"]):
                relative = math.hypot(p.model + sync, now["level_error"])
            form = SETTINGS.form_error * (shown(x, now, block)[1] / SETTINGS.form_reach) ** 12
            relative = math.hypot(relative, min(form, SETTINGS.form_error))
            # an error that lasts, as white noise: AR(1) of one block to the next
            rho = math.exp(-T / p.model_memory)
            relative *= math.sqrt((1.0 + rho) / (1.0 - rho))
            wheel = (noise.omega / max(blocks.omega_f[k], 1.0)) ** 2 / T
            sensors = np.array([2.0 * wheel, wheel + (noise.v / speed) ** 2 / T])

            def h(x, now=now, block=block):
                return sensed(x, now, block)

            gate = p.calm_gate if wild else p.wild_gate
            braked = math.isfinite(now["level"])
            road = None
            # four blocks in a row that are off the same way: the road has changed
            last = np.array([row[2] for row in out[same:]][-4:])
            if braked and held < p.change_calm and len(last) == 4:
                summed = last.sum(axis=0) ** 2 / 4.0
                if np.isfinite(summed[0]) and np.nanmean(summed) > gate:
                    road = float(blocks.end[k - 4])
            new = update(x, P, whole, h, seen, sensors, relative)
            squares = np.nanmean(new[3] ** 2)
            if road is None and braked and squares > gate:
                wild.append(float(blocks.end[k]))
                if (len(wild) - 1) * T < p.wild_time - 1e-6:
                    # a bump, as far as anybody can tell: nothing is learnt
                    new = (x, P, whole, nu)
                elif held < p.change_calm:
                    road = wild[0]
            else:
                wild = []
            if road is not None:
                opened = surface_spread(p, 1.0)
                new = update(x, P + opened, whole + opened, h, seen, sensors, relative)
                changes.append(road)
                wild, same = [], k
            x, P, whole, nu = new
        out.append((x, whole, nu))
    xs, Ps, nus = (np.array(part) for part in zip(*out, strict=True))
    return Answer(xs, Ps, nus, tuple(changes))


def surface_spread(p, share):
    """Covariance of a surface that nobody knows, times ``share``."""
    s, w = PLACE["s"], PLACE["w"]
    slope = np.array([1.0, p.peak_per_stiffness]) * p.stiffness
    out = np.zeros((COUNT, COUNT))
    out[np.ix_([s, w], [s, w])] = np.outer(slope, slope)
    out[w, w] += p.peak**2
    return share * out


def update(x, P, whole, h, seen, sensors, relative):
    """One measurement update in Joseph's form; the innovations whitened one after the other."""
    use = np.isfinite(seen)
    expected = h(x)
    slips = np.array([expected[0] - 1.0 - x[PLACE["eta0"]], expected[1] - x[PLACE["sl0"]]])
    H = gradients(h, x)[use]
    R = np.diag(sensors + (relative * slips) ** 2)[np.ix_(use, use)]
    nu = (seen - expected)[use]
    S = H @ P @ H.T + R
    K = np.linalg.solve(S, H @ P).T
    I_KH = np.eye(x.size) - K @ H
    white = np.full(2, np.nan)
    white[use] = np.linalg.solve(np.linalg.cholesky(S), nu)
    after = [I_KH @ of @ I_KH.T + K @ R @ K.T for of in (P, whole)]
    return x + K @ nu, *after, white
