/* The sum of rodsim/flows/free.py for algebraic7 in three dimensions, by hand for AVX-512.

   Eight sources at a time, the last of them by a mask: no scalar remainder. ROOT 0 takes a square
   root and a division, ROOT 1 the processor's estimate of 1/R and two steps of Newton. */

#include <immintrin.h>

typedef __m512d V;

static inline V all(double a) { return _mm512_set1_pd(a); }
static inline V add(V a, V b) { return _mm512_add_pd(a, b); }
static inline V sub(V a, V b) { return _mm512_sub_pd(a, b); }
static inline V mul(V a, V b) { return _mm512_mul_pd(a, b); }
static inline V more(V a, V b, V c) { return _mm512_fmadd_pd(a, b, c); }  /* c + a b */
static inline V less(V a, V b, V c) { return _mm512_fnmadd_pd(a, b, c); } /* c - a b */
static inline V cross(V a, V b, V c, V d) { return less(b, c, mul(a, d)); } /* a d - b c */

static inline V newton(V x, V y) /* y (3 - x y^2)/2 */
{
    V e = less(mul(x, y), y, all(1.0));
    return more(mul(all(0.5), y), e, y);
}

static inline V inverse_root(int root, V x)
{
    if (root == 0)
        return _mm512_div_pd(all(1.0), _mm512_sqrt_pd(x));
    return newton(x, newton(x, _mm512_rsqrt14_pd(x)));
}

static inline void sums(int root, long targets, long sources, const double *at, const double *from,
                        const double *loads, double e2, double scale, double *out)
{
    for (long i = 0; i < targets; i++) {
        V x = all(at[i]), y = all(at[targets + i]), z = all(at[2 * targets + i]);
        V ux = all(0.0), uy = ux, uz = ux, wx = ux, wy = ux, wz = ux;
        for (long k = 0; k < sources; k += 8) {
            __mmask8 mask = sources - k >= 8 ? 0xff : (1 << (sources - k)) - 1;
#define ROW(a, n) _mm512_maskz_loadu_pd(mask, (a) + (n) * sources + k)
            V rx = sub(x, ROW(from, 0)), ry = sub(y, ROW(from, 1)), rz = sub(z, ROW(from, 2));
            V gx = ROW(loads, 0), gy = ROW(loads, 1), gz = ROW(loads, 2);
            V mx = ROW(loads, 3), my = ROW(loads, 4), mz = ROW(loads, 5);
            V i1 = inverse_root(root, more(rx, rx, more(ry, ry, more(rz, rz, all(e2)))));
            V i2 = mul(i1, i1), i3 = mul(i1, i2), p = mul(all(e2), i2);
            V h1 = more(i1, p, i1), q = mul(i3, more(all(1.5), p, all(1.0)));
            V along = mul(i3, more(gx, rx, more(gy, ry, mul(gz, rz))));
            ux = more(q, cross(my, mz, ry, rz), more(along, rx, more(gx, h1, ux)));
            uy = more(q, cross(mz, mx, rz, rx), more(along, ry, more(gy, h1, uy)));
            uz = more(q, cross(mx, my, rx, ry), more(along, rz, more(gz, h1, uz)));
            V d1 = mul(i3, more(p, more(all(3.75), p, all(-0.75)), all(-0.5)));
            V d2 = mul(mul(i3, i2), more(all(3.75), p, all(1.5)));
            V axial = mul(d2, more(mx, rx, more(my, ry, mul(mz, rz))));
            wx = more(q, cross(gy, gz, ry, rz), more(axial, rx, more(d1, mx, wx)));
            wy = more(q, cross(gz, gx, rz, rx), more(axial, ry, more(d1, my, wy)));
            wz = more(q, cross(gx, gy, rx, ry), more(axial, rz, more(d1, mz, wz)));
        }
        V six[6] = {ux, uy, uz, wx, wy, wz};
        for (int c = 0; c < 6; c++)
            out[c * targets + i] += scale * _mm512_reduce_add_pd(six[c]);
    }
}

/* Add the velocities (6, targets) to ``out``, as often as asked. */
void repeat(int root, long times, long targets, long sources, const double *at,
            const double *from, const double *loads, double e2, double scale, double *out)
{
    for (long n = 0; n < times; n++) {
        if (root == 0)
            sums(0, targets, sources, at, from, loads, e2, scale, out);
        else
            sums(1, targets, sources, at, from, loads, e2, scale, out);
    }
}
