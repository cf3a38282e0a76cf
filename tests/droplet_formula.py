"""The law of droplets as its page writes it, also for complex numbers.

Their imaginary parts are derivatives. Nothing is shared with the kernels: sums over pairs of
contacts, and the dilogarithm of scipy.
"""

import numpy as np
from scipy.optimize import least_squares
from scipy.special import spence

KAPPA, BALANCE = 2.6, 0.5
OF_TRACE, OF_FORCES, OF_GREEN2 = -0.00368257, -0.00026156, -0.11453672
STEP = 1e-30


def green(m):
    return -(0.5 + 4 / 3 * m + m * np.log((1 - m) / 2)) / (4 * np.pi)


def slope_of(m):
    q = (1 - m) / 2
    return -(4 / 3 + np.log(q) - m / (2 * q)) / (4 * np.pi)


def green2(m):
    """Integral of G_c G_k over the sphere; spence(q) is Li2(1 - q)."""
    q = (1 - m) / 2
    linear = (10 / 27 - np.pi**2 / 18) * m
    log = np.log(q)
    return (1 / 12 + linear + (1 - m) / 3 * log + m / 3 * spence(q)) / (4 * np.pi)


GREEN2_AT_ONE = 49 / 108 / (4 * np.pi)


def between(function, n, itself):
    m = n @ n.T
    own = np.eye(len(n), dtype=bool)
    return np.where(own, itself, function(np.where(own, 0.0, m)))


def facets(f, n):
    """t of each contact, (Z, 3)."""
    slope, m = between(slope_of, n, 0.0), n @ n.T
    weight = slope * f
    return -(weight @ n - (weight * m).sum(axis=1)[:, None] * n)


def load(f):
    return f.sum() / (8 * np.pi)


def parts(f, n):
    """The terms of W by name, in units of R and g R."""
    s, x, evenness = f * f / (8 * np.pi), load(f), (f * f).sum() / f.sum() ** 2
    log, first, second = (
        np.log(8 * np.pi / f),
        between(green, n, 0.0),
        between(green2, n, GREEN2_AT_ONE),
    )
    first_order = f / (4 * np.pi) * (log - 5 / 6) + first @ f
    P = 1.43 * (1 + 10 * evenness)
    Q = (n.T * f) @ n - np.eye(3) / 3 * f.sum()
    t = facets(f, n)
    cube = OF_TRACE * np.trace(Q @ Q @ Q) + OF_FORCES * (f**3).sum() + OF_GREEN2 * f**2 @ second @ f
    off = n.T @ f
    return {
        "Morse-Witten": (s * (log - 1 / 3)).sum() + f @ first @ f / 2,
        "psi": s.sum() * np.log(1 + P * x) / P,
        "a1": -2 * (s * first_order).sum(),
        "f^3": (f**3).sum() / (96 * np.pi**2),
        "T1": -0.5 * (f * (t * t).sum(axis=1)).sum(),
        "J": f @ second @ f,
        "I3": cube,
        "balance": BALANCE / 2 * x * (off @ off),
    }


def work(f, n):
    """W in units of R and g R."""
    p, x = parts(f, n), load(f)
    damped = np.exp(-KAPPA * x)
    return (
        sum(p[name] for name in ("Morse-Witten", "psi", "a1", "f^3", "balance"))
        + damped * (p["T1"] + 2 * x * p["J"])
        + damped**4 * 2 / 3 * p["I3"]
    )


def by_steps(function, x):
    """Derivatives of a function by the numbers of x, from complex steps."""
    x = np.asarray(x, float)
    steps = 1j * STEP * np.eye(x.size).reshape(-1, *x.shape)
    return np.array([function(x + step).imag / STEP for step in steps]).reshape(x.shape)


def film(radii, tensions):
    """lambda of the first of two droplets."""
    (R, S), (g, h) = radii, tensions
    return h * (R + S) / (S * (g + h))


def crystal(vectors):
    """Energy of a unit droplet among equal ones in these directions, which come in opposite pairs.

    By this symmetry both sides of a film see opposite ways: it turns by R t of each.
    """
    distance = np.linalg.norm(vectors, axis=1)
    n, overlap = vectors / distance[:, None], 2 - distance

    def dual(f):
        t = facets(f, n)
        turned = 0.5 * (f * (t * t).sum(axis=1)).sum() * np.exp(-KAPPA / 2 * load(f))
        return f @ overlap / 2 - work(f, n) - turned

    start, least = np.full(len(n), 0.1), dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
    f = least_squares(lambda f: by_steps(dual, f), start, bounds=(1e-9, np.inf), **least).x
    return dual(f), f
