"""Every step of the paper's loop with 50 decimal digits: the tables of this folder. Needs mpmath.

python3 paper_loop.py backward 0.001     # what A_run01.csv has, by another program
python3 paper_loop.py backward 1         # D_run01.csv
python3 paper_loop.py forward 0.001 > A_run01_forward.csv
python3 paper_loop.py forward 1     > D_run01_forward.csv

Written from the text of the paper (equations (1) to (18), Table 1, section 3.2), not from the code of Rundown, and in
the textbook form: plain weighted sums over the sigma points. 50 digits make up for what these cancel.
"""

import csv
import pathlib
import sys
import tomllib

import mpmath as mp

mp.mp.dps = 50
HERE = pathlib.Path(__file__).parent
L = 5
NAMES = [f"{i}{j}" for i in range(L) for j in range(i, L)]


def read():
    train = tomllib.loads((HERE / "train.toml").read_text())
    track = tomllib.loads((HERE / "track.toml").read_text())
    with open(HERE / "run01.csv") as file:
        return train, track, list(csv.DictReader(file))


class Line:
    """Gravity on a train as long as it is."""

    def __init__(self, train, track):
        self.length = mp.mpf(train["length_m"])
        self.weight = mp.mpf("9.80665") / mp.mpf(train["rotating_mass_factor"])
        self.pieces = [(mp.mpf(g["from_m"]), mp.mpf(g["permille"]) / 1000) for g in track["gradient"]]

    def height(self, s):
        height = mp.mpf(0)
        ends = [start for start, _ in self.pieces[1:]] + [mp.inf]
        for (start, slope), end in zip(self.pieces, ends):
            if s > start:
                height += slope * (min(s, end) - start)
        return height

    def g(self, s):
        return self.weight * (self.height(s) - self.height(s - self.length)) / self.length


def resistance(x):
    return x[2] + x[3] * x[1] + x[4] * x[1] ** 2


def cholesky(p):
    low = mp.zeros(L, L)
    for i in range(L):
        for j in range(i + 1):
            rest = p[i, j] - mp.fsum(low[i, k] * low[j, k] for k in range(j))
            low[i, j] = mp.sqrt(rest) if i == j else rest / low[j, j]
    return low


def step(line, x, p, z, u, dt, alpha):
    """Eq. (7) to (18) from a state and its covariance, with the effort `u` over the step."""
    beta, kappa = mp.mpf(2), mp.mpf(-2)
    lam = alpha**2 * (L + kappa) - L
    root = cholesky((L + lam) * p)
    points = [x] + [x + sign * root[:, i] for sign in (1, -1) for i in range(L)]
    mean_weights = [lam / (L + lam)] + [1 / (2 * (L + lam))] * (2 * L)
    weights = [mean_weights[0] + 1 - alpha**2 + beta] + mean_weights[1:]
    moved = []
    for point in points:
        a = u - resistance(point) - line.g(point[0])
        moved.append(point + mp.matrix([dt * point[1] + dt**2 * a / 2, dt * a, 0, 0, 0]))
    prior = sum((w * y for w, y in zip(mean_weights, moved)), mp.zeros(L, 1))
    off = [y - prior for y in moved]
    p_x = sum((w * d * d.T for w, d in zip(weights, off)), mp.zeros(L, L))
    # h takes location and speed, so its points are the first two rows.
    noise = mp.diag([mp.mpf(4) ** 2, (1 / mp.mpf("3.6")) ** 2])
    p_z = p_x[0:2, 0:2] + noise
    gain = p_x[:, 0:2] * p_z**-1
    nu = z - prior[0:2]
    return prior, prior + gain * nu, p_x - gain * p_z * gain.T, nu, p_z


def regime(u, a):
    if abs(u) <= mp.mpf("0.025"):
        return "coast"
    if abs(a) < mp.mpf("0.06"):
        return "cruise"
    return "traction" if u > 0 else "brake"


def text(value):
    return mp.nstr(value, 17, min_fixed=0, max_fixed=0) if value is not None else ""


def main(difference, alpha):
    train, track, texts = read()
    # As doubles, for such are the readings of any program that is compared.
    rows = [[mp.mpf(float(row[name])) for name in ("time_s", "location_m", "speed_kmh")] for row in texts]
    line = Line(train, track)
    davis = train["davis"]
    x = mp.matrix([rows[0][1], rows[0][2] / mp.mpf("3.6"), *(mp.mpf(davis[name]) for name in ("r0", "r1", "r2"))])
    sds = [mp.mpf(1), mp.mpf("0.0018") / mp.mpf("3.6"), mp.mpf("1e-6"), mp.mpf("1e-8"), mp.mpf("1e-9")]
    p = mp.diag([sd**2 for sd in sds])
    out = csv.writer(sys.stdout, lineterminator="\n")
    state = [f"x_{i}" for i in range(L)] + [f"P_{name}" for name in NAMES]
    out.writerow(
        ["k", "time_s", "z_s", "z_kmh", "u_prev", "a_obs"] + [f"xbar_{i}" for i in range(L)] + state
        + ["nu_s", "nu_v", "S_ss", "S_sv", "S_vv", "u_k", "a_k", "regime"]
    )
    u = resistance(x) + line.g(x[0])
    found = None
    for k, (time, location, kmh) in enumerate(rows):
        driving, a_obs, a = None, mp.mpf(0), mp.mpf(0)
        if k > 0:
            dt = time - rows[k - 1][0]
            a_obs = (kmh - rows[k - 1][2]) / mp.mpf("3.6") / dt
            # The difference over the step drives it, with r and g where it begins; or that up to the sample before.
            driving = a_obs + resistance(x) + line.g(x[0]) if difference == "forward" else u
            before = x[1]
            prior, x, p, nu, p_z = step(line, x, p, mp.matrix([location, kmh / mp.mpf("3.6")]), driving, dt, alpha)
            found = (prior, nu, p_z)
            a = (x[1] - before) / dt
            u = a_obs + resistance(x) + line.g(x[0])
        prior, nu, p_z = found or ([None] * L, [None] * 2, None)
        s = [p_z[0, 0], p_z[0, 1], p_z[1, 1]] if found else [None] * 3
        covariance = [p[int(name[0]), int(name[1])] for name in NAMES]
        values = [driving, a_obs, *prior, *x, *covariance, *nu, *s, u, a]
        out.writerow([k, *texts[k].values()] + [text(v) for v in values] + [regime(u, a)])


if __name__ == "__main__":
    main(sys.argv[1], mp.mpf(sys.argv[2]))
