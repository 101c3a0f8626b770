"""Real Fourier transforms of the three components of a field: FFTW where it is, else SciPy."""

import numpy as np


class Transforms:
    """Forward and backward transforms of fields (3, n, n, n), each component for itself.

    One component at a time stays in the cache; on the machine of the benchmarks FFTW is four
    times faster than scipy.fft at n = 64, so a fair rival uses it where it is installed.
    """

    def __init__(self, n: int, threads: int):
        self.n, self.threads = n, threads
        self.real = np.zeros((3, n, n, n))
        self.spectrum = np.zeros((3, n, n, n // 2 + 1), complex)
        try:
            self._forward, self._backward = self._plan_fftw()
            self.library = "FFTW"
        except ImportError:
            self._forward, self._backward = self._plan_scipy()
            self.library = "scipy.fft"

    def forward(self) -> np.ndarray:
        """Return ``spectrum``, the transform of ``real``, without a factor."""
        for transform in self._forward:
            transform()
        return self.spectrum

    def backward(self) -> np.ndarray:
        """Return ``real``, n^3 times the inverse of ``spectrum``, whose contents are lost."""
        for transform in self._backward:
            transform()
        return self.real

    def _plan_fftw(self):
        import pyfftw

        self.real = pyfftw.zeros_aligned(self.real.shape)
        self.spectrum = pyfftw.zeros_aligned(self.spectrum.shape, complex)

        def plan(source, target, direction):
            flags = ("FFTW_MEASURE", "FFTW_DESTROY_INPUT")
            made = pyfftw.FFTW(
                source, target, (0, 1, 2), direction, flags=flags, threads=self.threads
            )
            return made.execute

        pairs = list(zip(self.real, self.spectrum, strict=True))
        forward = [plan(real, spectrum, "FFTW_FORWARD") for real, spectrum in pairs]
        backward = [plan(spectrum, real, "FFTW_BACKWARD") for real, spectrum in pairs]
        self.real[:], self.spectrum[:] = 0.0, 0.0  # planning has written into them
        return forward, backward

    def _plan_scipy(self):
        from scipy import fft

        def forward(c):
            self.spectrum[c] = fft.rfftn(self.real[c], workers=self.threads)

        def backward(c):
            self.real[c] = fft.irfftn(
                self.spectrum[c], s=(self.n,) * 3, norm="forward", workers=self.threads
            )

        return tuple([lambda c=c, f=f: f(c) for c in range(3)] for f in (forward, backward))
