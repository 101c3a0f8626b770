"""Smoothing of traced points: Reinsch's spline, as smooth as a distance from them allows."""

import numpy as np

HALVINGS = 45  # of the logarithm of the weight of roughness


def smoothed(knots, values, distance, period=None):
    """Return values (n, k) moved by ``distance`` in the root mean square, as smooth as that allows.

    Of all curves g with mean |g(u_i) - y_i|^2 = distance^2, the knot values of the one with the
    least integral of |g''|^2 (Reinsch, Numer. Math. 10 (1967) 177-183): g = y - w Q c, where
    (R + w Q^T Q) c = Q^T y, R and Q the tridiagonal matrices of natural cubic splines (of periodic
    ones with ``period``) and w > 0 the one that fits. None where even a straight line (for a closed
    curve, a point) is nearer than that.
    """
    system = _System(np.asarray(knots, float), np.asarray(values, float), period)
    scale = np.mean(np.diff(knots)) ** 3
    low, high = np.log(1e-12 * scale), np.log(1e12 * scale * len(knots) ** 4)
    if system.distance(np.exp(high)) < distance:
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if system.distance(np.exp(middle)) < distance else (low, middle)
    return values - system.change(np.exp(low))


class _System:
    """R and Q of the knots: the second derivatives c at the knots fulfil R c = Q^T g."""

    def __init__(self, knots, values, period):
        self.values, self.cyclic = values, period is not None
        last = [knots[0] + period] if self.cyclic else []
        width = np.diff(np.append(knots, last))
        before = np.roll(width, 1) if self.cyclic else width[:-1]
        after = width if self.cyclic else width[1:]
        # Q^T y at a knot: y_(i-1)/h_(i-1) - (1/h_(i-1) + 1/h_i) y_i + y_(i+1)/h_i
        self.left, self.right = 1.0 / before, 1.0 / after
        self.centre = -(self.left + self.right)
        self.rough = (before + after) / 3.0, after / 6.0
        self.target = self.curved(values)

    def curved(self, y):
        """Return Q^T y."""
        if self.cyclic:
            below, above = np.roll(y, 1, axis=0), np.roll(y, -1, axis=0)
        else:
            below, y, above = y[:-2], y[1:-1], y[2:]
        return self.left[:, None] * below + self.centre[:, None] * y + self.right[:, None] * above

    def spread(self, c):
        """Return Q c."""
        parts = [weight[:, None] * c for weight in (self.left, self.centre, self.right)]
        if self.cyclic:
            return np.roll(parts[0], -1, axis=0) + parts[1] + np.roll(parts[2], 1, axis=0)
        total = np.zeros_like(self.values)
        for shift, part in enumerate(parts):
            total[shift : shift + len(c)] += part
        return total

    def change(self, weight):
        """Return y - g at a weight of the roughness."""
        after, further = np.roll(self.left, -1), np.roll(self.left, -2)
        squares = (
            self.left**2 + self.centre**2 + self.right**2,
            self.centre * after + self.right * np.roll(self.centre, -1),
            self.right * further,
        )
        diagonal, beside = self.rough
        bands = [diagonal + weight * squares[0], beside + weight * squares[1], weight * squares[2]]
        return weight * self.spread(solve_banded(bands, self.target, self.cyclic))

    def distance(self, weight):
        """Return the root mean square of |y - g|."""
        return np.sqrt(np.mean(np.sum(self.change(weight) ** 2, axis=1)))


def solve_banded(bands, target, cyclic):
    """Solve A x = b, (n, k), for a symmetric positive definite A of two bands beside the diagonal.

    ``bands``: A_ii, A_i,i+1, A_i,i+2 for all i, modulo n if ``cyclic``. By A = L D L^T. A cyclic
    matrix is folded: in the order 0, n-1, 1, n-2, ... it has four bands, and no corners.
    """
    n = len(target)
    order = np.arange(n)
    if cyclic:
        order = np.where(order % 2 == 0, order // 2, n - 1 - order // 2)
    place = np.argsort(order)
    width = min(n - 1, 4 if cyclic else 2)
    lower = np.zeros((n, width + 1))  # lower[i, j] = A[i + j, i] in the new order
    for shift, band in enumerate(bands):
        pairs = np.arange(n if cyclic else n - shift)
        one, other = place[pairs], place[(pairs + shift) % n]
        np.add.at(lower, (np.minimum(one, other), np.abs(one - other)), band[pairs])
    x = target[order].copy()
    for i in range(n):
        reach = min(width, n - 1 - i)
        column = lower[i, 1 : reach + 1].copy()
        lower[i, 1 : reach + 1] /= lower[i, 0]
        for j in range(reach):
            lower[i + 1 + j, : reach - j] -= lower[i, 1 + j] * column[j:]
        x[i + 1 : i + 1 + reach] -= lower[i, 1 : reach + 1, None] * x[i]
    x /= lower[:, :1]
    for i in range(n - 2, -1, -1):
        reach = min(width, n - 1 - i)
        x[i] -= lower[i, 1 : reach + 1] @ x[i + 1 : i + 1 + reach]
    return x[place]
