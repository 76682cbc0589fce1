#include "Bare.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bare {
Facet<double> facet(const double* i, const double* r, double sigma) {
  const double cosine = i[0] * r[0] + i[1] * r[1] + i[2] * r[2];  // of twice beta
  const double across = i[0] * r[1] - i[1] * r[0];
  const double one_plus = 1 + cosine, up = i[2] + r[2];
  const double secant2 = 2 * one_plus / (up * up);  // of the tilt
  const double groove = std::min(1.0, 2 * up * std::min(i[2], r[2]) / one_plus);
  const double two_variance = 2 * sigma * sigma;
  const double factor = secant2 * secant2 * std::exp((1 - secant2) / two_variance) * groove /
                        (4 * std::numbers::pi * two_variance * i[2] * r[2]);
  const double in = r[2] - cosine * i[2], out = i[2] - cosine * r[2], across2 = across * across;
  const double norm_in = 1 / (in * in + across2), norm_out = 1 / (out * out + across2);
  return {factor,
          std::sqrt(one_plus / 2),
          (1 - cosine) / 2,
          (in * in - across2) * norm_in,
          2 * in * across * norm_in,
          (out * out - across2) * norm_out,
          -2 * out * across * norm_out};
}

namespace {
template <class Real>
struct Four {
  Real sum, diff, re, im;
};
// Fresnel with one division: Rs / (u + v) = (m + c^2 - 2ac) / ((m + c^2 + 2ac)(u + v)).
template <class Real>
inline Four<Real> fresnel(Real c, Real s2, Real e1, Real e2) {
  const Real t = e1 - s2, m = std::sqrt(t * t + e2 * e2);
  const Real a = std::sqrt((m + t) / 2), b = std::sqrt((m - t) / 2);
  const Real c2 = c * c, mc2 = m * c2, s4 = s2 * s2, cs2 = 2 * c * s2, ac = 2 * a * c;
  const Real u = s4 + mc2, v = a * cs2;
  const Real y = (m + c2 - ac) / ((m + c2 + ac) * (u + v));
  return {y * u, y * v, y * (s4 - mc2), y * b * cs2};
}
}  // namespace

template <class Real>
void scatter(const Facet<Real>& g, std::size_t n, const Real* __restrict e1,
             const Real* __restrict e2, const Real* __restrict in, Real* __restrict sum) {
  const Real w = g.factor, ci = g.cos2i, si = g.sin2i, cr = g.cos2r, sr = g.sin2r;
  for (std::size_t j = 0; j < n; ++j) {
    const Four<Real> f = fresnel(g.cos_beta, g.sin2_beta, e1[j], e2[j]);
    const Real s0 = w * in[j], s1 = w * in[n + j], s2 = w * in[2 * n + j],
               s3 = w * in[3 * n + j];
    const Real u1 = ci * s1 + si * s2, u2 = ci * s2 - si * s1;
    const Real v1 = f.diff * s0 + f.sum * u1, v2 = f.re * u2 + f.im * s3;
    sum[j] += f.sum * s0 + f.diff * u1;
    sum[n + j] += cr * v1 + sr * v2;
    sum[2 * n + j] += cr * v2 - sr * v1;
    sum[3 * n + j] += f.re * s3 - f.im * u2;
  }
}

template <class Real>
void scatterUnpolarized(const Facet<Real>& g, std::size_t n, const Real* __restrict e1,
                        const Real* __restrict e2, const Real* __restrict in,
                        Real* __restrict sum) {
  for (std::size_t j = 0; j < n; ++j) {
    const Four<Real> f = fresnel(g.cos_beta, g.sin2_beta, e1[j], e2[j]);
    const Real s0 = g.factor * in[j], v1 = f.diff * s0;
    sum[j] += f.sum * s0;
    sum[n + j] += g.cos2r * v1;
    sum[2 * n + j] -= g.sin2r * v1;
  }
}

template <class Real>
void scatterScalar(const Facet<Real>& g, std::size_t n, const Real* __restrict e1,
                   const Real* __restrict e2, const Real* __restrict in, Real* __restrict sum) {
  for (std::size_t j = 0; j < n; ++j)
    sum[j] += g.factor * fresnel(g.cos_beta, g.sin2_beta, e1[j], e2[j]).sum * in[j];
}

void multiplyAdd(std::size_t n, const double* __restrict m, const double* __restrict s,
                 double* __restrict out) {
  for (std::size_t j = 0; j < n; ++j) {
    const double s0 = s[j], s1 = s[n + j], s2 = s[2 * n + j], s3 = s[3 * n + j];
    for (std::size_t i = 0; i < 4; ++i) {
      const double* row = m + 4 * i * n + j;
      out[i * n + j] += row[0] * s0 + row[n] * s1 + row[2 * n] * s2 + row[3 * n] * s3;
    }
  }
}

template void scatter(const Facet<double>&, std::size_t, const double*, const double*,
                      const double*, double*);
template void scatter(const Facet<float>&, std::size_t, const float*, const float*,
                      const float*, float*);
template void scatterUnpolarized(const Facet<double>&, std::size_t, const double*,
                                 const double*, const double*, double*);
template void scatterScalar(const Facet<double>&, std::size_t, const double*, const double*,
                            const double*, double*);
}  // namespace bare
