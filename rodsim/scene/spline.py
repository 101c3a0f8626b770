"""Cubic splines through rows of numbers, open or periodic; numpy only."""

import numpy as np

SWEEPS = 60  # of Jacobi's iteration, each of which at least halves the error
AT_THE_END = 5  # points of the polynomial that gives an open spline its end slopes


class Spline:
    """The cubic spline y(u) through rows y_i (n, ...) at increasing knots u_i, with C2.

    Its slopes d_i solve, with h_i = u_(i+1) - u_i and q_i = (y_(i+1) - y_i)/h_i,

        d_(i-1)/h_(i-1) + 2 (1/h_(i-1) + 1/h_i) d_i + d_(i+1)/h_i = 3 (q_(i-1)/h_(i-1) + q_i/h_i),

    by Jacobi's iteration: the rows are dominant by 2 for any knots. At the ends of an open spline
    the slopes are those of the polynomial through the nearest points. Errors of order 4 in y, 3 in
    its slope. With ``period`` the last row is joined to the first one at u_0 + period.
    """

    def __init__(self, knots, values, period=None):
        knots, values = np.asarray(knots, float), np.asarray(values, float)
        self.period, self.shape = period, values.shape[1:]
        values = values.reshape(len(knots), -1)
        if period is not None:
            knots = np.append(knots, knots[0] + period)
            values = np.concatenate([values, values[:1]])
        self.knots, self._values = knots, values
        width = np.diff(knots)[:, None]
        secant = np.diff(values, axis=0) / width
        self._slopes = (
            _periodic(width, secant) if period is not None else _open(knots, values, width, secant)
        )

    def __call__(self, u):
        """Return y at u of any shape: u's shape, then a row's. Beyond the ends: the last cubic."""
        return self._cubic(u, (1.0, 0.0))

    def slope(self, u):
        """Return dy/du at u."""
        return self._cubic(u, (0.0, 1.0))

    def _cubic(self, u, weights):
        """Return weights[0] y + weights[1] dy/du."""
        u = np.asarray(u, float)
        if self.period is not None:
            u = self.knots[0] + np.mod(u - self.knots[0], self.period)
        i = np.clip(np.searchsorted(self.knots, u, side="right") - 1, 0, len(self.knots) - 2)
        width = (self.knots[i + 1] - self.knots[i])[..., None]
        x = (u - self.knots[i])[..., None] / width
        left, right = self._values[i], self._values[i + 1]
        first, last = width * self._slopes[i], width * self._slopes[i + 1]
        # y = left + x (first + x (a + x b)), a and b from the values and slopes at the two ends
        a, b = 3.0 * (right - left) - 2.0 * first - last, first + last - 2.0 * (right - left)
        value = left + x * (first + x * (a + x * b))
        slope = (first + x * (2.0 * a + 3.0 * x * b)) / width
        result = weights[0] * value + weights[1] * slope
        return result.reshape(*u.shape, *self.shape)


def end_slope(knots, values):
    """Return the slope at the first knot of the polynomial through all of them (Lagrange)."""
    apart = knots[0] - knots[1:]
    weights = np.empty(len(knots))
    for j in range(1, len(knots)):
        others = np.delete(knots[1:], j - 1)
        weights[j] = np.prod((knots[0] - others) / (knots[j] - others)) / (knots[j] - knots[0])
    weights[0] = np.sum(1.0 / apart)
    return weights @ values


def _open(knots, values, width, secant):
    """Return the slopes of an open spline."""
    few = min(AT_THE_END, len(knots))
    slopes = np.zeros_like(values)
    slopes[0] = end_slope(knots[:few], values[:few])
    slopes[-1] = end_slope(knots[::-1][:few], values[::-1][:few])
    before, after = 1.0 / width[:-1], 1.0 / width[1:]
    target = 3.0 * (secant[:-1] * before + secant[1:] * after)
    for _ in range(SWEEPS):
        beside = before * slopes[:-2] + after * slopes[2:]
        slopes[1:-1] = 0.5 * (target - beside) / (before + after)
    return slopes


def _periodic(width, secant):
    """Return the slopes of a periodic spline, the first once more at the end."""
    after, before = 1.0 / width, 1.0 / np.roll(width, 1, axis=0)
    target = 3.0 * (np.roll(secant, 1, axis=0) * before + secant * after)
    slopes = np.zeros_like(secant)
    for _ in range(SWEEPS):
        beside = before * np.roll(slopes, 1, axis=0) + after * np.roll(slopes, -1, axis=0)
        slopes = 0.5 * (target - beside) / (before + after)
    return np.concatenate([slopes, slopes[:1]])
