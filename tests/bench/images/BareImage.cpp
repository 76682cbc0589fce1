#include "BareImage.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "malus/render/Scene.hpp"

namespace bare {
namespace {
constexpr float pi = std::numbers::pi_v<float>;
constexpr int most = 128;
struct V {
  float x, y, z;
};
inline V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V operator*(V a, float f) { return {a.x * f, a.y * f, a.z * f}; }
inline float dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V cross(V a, V b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline V unit(V a) { return a * (1 / std::sqrt(dot(a, a))); }

struct Hemisphere {  // a grid, padded to sixteens
  int count = 0;
  alignas(64) std::array<float, most> x{}, y{}, z{}, weight{};
  explicit Hemisphere(int rays) {
    const int zeniths = std::max(1, int(std::lround(std::sqrt(rays / 4.0)))),
              azimuths = rays / zeniths;
    for (int j = 0; j < zeniths; ++j)
      for (int i = 0; i < azimuths; ++i, ++count) {
        const float step = pi / 2 / float(zeniths), t = (float(j) + 0.5f) * step,
                    p = 2 * pi * float(i) / float(azimuths);
        x[count] = std::sin(t) * std::cos(p), y[count] = std::sin(t) * std::sin(p),
        z[count] = std::cos(t);
        weight[count] = std::cos(t) * 2 * pi / float(azimuths) *
                        (std::cos(float(j) * step) - std::cos(float(j + 1) * step));
      }
    while (count % 16 != 0) z[count++] = 1;
  }
};

struct Frame {
  V x, y, z;
};
Frame frameOf(V n, std::uint32_t random) {
  random = ((random >> ((random >> 28) + 4)) ^ random) * 277803737u;
  const float a = float(random >> 8) * (2 * pi / 16777216), c = std::cos(a), s = std::sin(a);
  const float sign = std::copysign(1.0f, n.z), f = -1 / (sign + n.z), g = n.x * n.y * f;
  const V t{1 + sign * n.x * n.x * f, sign * g, -sign * n.x}, b{g, sign + n.y * n.y * f, -n.y};
  return {t * c + b * s, b * c - t * s, n};
}

inline float exponential(float x) {
  x = std::max(x, -87.0f);
  const float n = std::floor(x * 1.44269504f + 0.5f), r = x - n * 0.69314718f;
  const float e =
      1 + r * (1 + r * (0.5f + r * (0.16666667f + r * (0.041666667f + r * 0.0083333333f))));
  return e * std::bit_cast<float>((std::int32_t(n) + 127) << 23);
}

struct Facet {
  float factor, c, s2, cos2r, sin2r, cos2i, sin2i;
};
inline Facet facet(float ix, float iy, float iz, V r, float precision, float norm) {
  const float cosine = ix * r.x + iy * r.y + iz * r.z, across = ix * r.y - iy * r.x,
              one = 1 + cosine, up = iz + r.z;
  const float secant2 = 2 * one / (up * up),
              groove = std::min(1.0f, 2 * up * std::min(iz, r.z) / one);
  const float in = r.z - cosine * iz, out = iz - cosine * r.z, a2 = across * across;
  const float ni = 1 / (in * in + a2 + 1e-30f), no = 1 / (out * out + a2 + 1e-30f);
  return {
      norm * secant2 * secant2 * exponential((1 - secant2) * precision) * groove / (iz * r.z),
      std::sqrt(one * 0.5f),
      (1 - cosine) * 0.5f,
      (out * out - a2) * no,
      -2 * out * across * no,
      (in * in - a2) * ni,
      2 * in * across * ni};
}
struct Four {
  float sum, diff, re, im;
};
inline Four fresnel(float c, float s2, float e1, float e2) {
  const float t = e1 - s2, m = std::sqrt(t * t + e2 * e2), a = std::sqrt((m + t) * 0.5f);
  const float c2 = c * c, mc2 = m * c2, s4 = s2 * s2, cs2 = 2 * c * s2, ac = 2 * a * c,
              u = s4 + mc2, v = a * cs2;
  const float y = (m + c2 - ac) / ((m + c2 + ac) * (u + v));
  return {y * u, y * v, y * (s4 - mc2), y * (e2 / (2 * a)) * cs2};
}

__attribute__((noinline)) void shadeOneBand(const Hemisphere& h, const float* weight, V r,
                                            float sigma, float e1, float e2, bool polarized,
                                            float* out) {
  alignas(64) float s0[most], s1[most], s2[most];
  const float precision = 1 / (2 * sigma * sigma), norm = 1 / (8 * pi * sigma * sigma);
  for (int i = 0; i < h.count; ++i) {
    const Facet g = facet(h.x[i], h.y[i], h.z[i], r, precision, norm);
    const Four f = fresnel(g.c, g.s2, e1, e2);
    const float w = g.factor * weight[i];
    s0[i] = w * f.sum, s1[i] = w * f.diff * g.cos2r, s2[i] = -w * f.diff * g.sin2r;
  }
  float a = 0, b = 0, c = 0;
  for (int i = 0; i < h.count; ++i) a += s0[i];
  out[0] += a;
  if (!polarized) return;
  for (int i = 0; i < h.count; ++i) b += s1[i], c += s2[i];
  out[1] += b, out[2] += c;
}

__attribute__((noinline)) void addBands(const Facet& g, float w, std::size_t n,
                                        const float* __restrict e1, const float* __restrict e2,
                                        bool polarized, float* __restrict out) {
  const float f0 = g.factor * w, c = f0 * g.cos2r, s = f0 * g.sin2r;
  if (polarized)
    for (std::size_t j = 0; j < n; ++j) {
      const Four f = fresnel(g.c, g.s2, e1[j], e2[j]);
      out[j] += f0 * f.sum, out[n + j] += c * f.diff, out[2 * n + j] -= s * f.diff;
    }
  else
    for (std::size_t j = 0; j < n; ++j) out[j] += f0 * fresnel(g.c, g.s2, e1[j], e2[j]).sum;
}

// The Rayleigh sky: of every direction four weights of the table's nodes and the factors of its functions in S0, S1, S2 in
// the surface's frame, which are the same for all bands.
struct SkyAims {
  int first[most];
  alignas(64) float w0[most], w1[most], w2[most], w3[most];
  alignas(64) float b0[most], d0[most], q1[most], b1[most], d1[most], q2[most], b2[most],
      d2[most];
};
struct Directions {
  alignas(64) std::array<float, most> x, y, z;
};
__attribute__((noinline)) void aimAt(const Directions& d, int count, V n, V sun, SkyAims& a) {
  const float level = 1 / std::sqrt(sun.x * sun.x + sun.y * sun.y);
  const float sx = sun.x * level, sy = sun.y * level;
  for (int i = 0; i < count; ++i) {
    const float x = d.x[i], y = d.y[i], z = d.z[i], mu = std::max(z, 0.0f);
    const float sine2 = x * x + y * y + 1e-30f, sine = std::sqrt(sine2), scale = 1 / sine;
    const float c = (x * sx + y * sy) * scale, s = (x * sy - y * sx) * scale,
                c2 = c * c - s * s;
    const float p = std::sqrt(mu) * Scene::rayleigh_steps;
    const int first = std::min(std::max(int(p) - 1, 0), Scene::rayleigh_steps - 3);
    const float u = p - float(first), u1 = u - 1, u2 = u - 2, u3 = u - 3;
    a.first[i] = first, a.w0[i] = u1 * u2 * u3 * (-1 / 6.f), a.w1[i] = u * u2 * u3 * 0.5f,
    a.w2[i] = u * u1 * u3 * -0.5f, a.w3[i] = u * u1 * u2 * (1 / 6.f);
    const float tc = n.z - (n.x * x + n.y * y + n.z * z) * z, ts = n.y * x - n.x * y;
    const float over = 1 / (tc * tc + ts * ts + 1e-30f);
    const float cos2 = (tc * tc - ts * ts) * over, sin2 = 2 * tc * ts * over;
    const float once = 2 * mu * sine * c, twice = (1 + mu * mu) * c2, ub = 2 * sine * s,
                ud = 4 * mu * s * c;
    a.b0[i] = once, a.d0[i] = -sine2 * c2, a.q1[i] = cos2 * sine2,
    a.b1[i] = sin2 * ub - cos2 * once, a.d1[i] = sin2 * ud - cos2 * twice,
    a.q2[i] = -sin2 * sine2, a.b2[i] = cos2 * ub + sin2 * once,
    a.d2[i] = cos2 * ud + sin2 * twice;
  }
}
// sum += weight S0 of `eights` times eight bands
__attribute__((noinline)) void addS0(const SkyAims& a, int i, const float* __restrict n,
                                     std::size_t row, std::size_t eights, float weight,
                                     float* __restrict sum) {
  for (std::size_t e = 0; e < eights; ++e, n += 32, sum += 8)
    for (int k = 0; k < 8; ++k) {
      const auto at = [&](int f) {
        const float* p = n + 8 * f + k;
        return a.w0[i] * p[0] + a.w1[i] * p[row] + a.w2[i] * p[2 * row] + a.w3[i] * p[3 * row];
      };
      sum[k] += weight * (at(0) + a.b0[i] * at(2) + a.d0[i] * at(3));
    }
}
__attribute__((noinline)) void stokes(const SkyAims& a, int i, const float* __restrict n,
                                      std::size_t row, std::size_t eights, float* __restrict s0,
                                      float* __restrict s1, float* __restrict s2) {
  for (std::size_t e = 0; e < eights; ++e, n += 32, s0 += 8, s1 += 8, s2 += 8)
    for (int k = 0; k < 8; ++k) {
      const auto at = [&](int f) {
        const float* p = n + 8 * f + k;
        return a.w0[i] * p[0] + a.w1[i] * p[row] + a.w2[i] * p[2 * row] + a.w3[i] * p[3 * row];
      };
      const float P = at(0), Q = at(1), B = at(2), D = at(3);
      s0[k] = P + a.b0[i] * B + a.d0[i] * D;
      s1[k] = a.q1[i] * Q + a.b1[i] * B + a.d1[i] * D;
      s2[k] = a.q2[i] * Q + a.b2[i] * B + a.d2[i] * D;
    }
}
// one band: the functions of a node lie side by side
void stokesOfOneBand(const SkyAims& a, int count, const float* table, float* __restrict s0,
                     float* __restrict s1, float* __restrict s2) {
  for (int i = 0; i < count; ++i) {
    const float* n = table + 4 * a.first[i];
    float f[4];
    for (int k = 0; k < 4; ++k)
      f[k] = a.w0[i] * n[k] + a.w1[i] * n[4 + k] + a.w2[i] * n[8 + k] + a.w3[i] * n[12 + k];
    s0[i] = f[0] + a.b0[i] * f[2] + a.d0[i] * f[3];
    s1[i] = a.q1[i] * f[1] + a.b1[i] * f[2] + a.d1[i] * f[3];
    s2[i] = a.q2[i] * f[1] + a.b2[i] * f[2] + a.d2[i] * f[3];
  }
}
__attribute__((noinline)) void addStokes(const Facet& g, float w, std::size_t n,
                                         const float* __restrict e1, const float* __restrict e2,
                                         const float* __restrict s0, const float* __restrict s1,
                                         const float* __restrict s2, float* __restrict out) {
  const float f0 = g.factor * w, c = f0 * g.cos2r, s = f0 * g.sin2r;
  for (std::size_t j = 0; j < n; ++j) {
    const Four q = fresnel(g.c, g.s2, e1[j], e2[j]);
    const float u1 = g.cos2i * s1[j] + g.sin2i * s2[j], u2 = g.cos2i * s2[j] - g.sin2i * s1[j];
    const float v1 = q.diff * s0[j] + q.sum * u1, v2 = q.re * u2;
    out[j] += f0 * (q.sum * s0[j] + q.diff * u1), out[n + j] += c * v1 + s * v2,
        out[2 * n + j] += c * v2 - s * v1, out[3 * n + j] -= f0 * q.im * u2;
  }
}

struct Ray16 {
  alignas(64) std::array<int, 16> valid;
  RTCRayHit16 q;
  Ray16() { valid.fill(-1); }
  void fill(const Hemisphere& h, int first, const Frame& f, V o) {
    for (int k = 0; k < 16; ++k) {
      const float x = h.x[first + k], y = h.y[first + k], z = h.z[first + k];
      q.ray.dir_x[k] = f.x.x * x + f.y.x * y + f.z.x * z,
      q.ray.dir_y[k] = f.x.y * x + f.y.y * y + f.z.y * z;
      q.ray.dir_z[k] = f.x.z * x + f.y.z * y + f.z.z * z;
      q.ray.org_x[k] = o.x, q.ray.org_y[k] = o.y, q.ray.org_z[k] = o.z;
      q.ray.tnear[k] = 0, q.ray.tfar[k] = 1e30f, q.ray.time[k] = 0, q.ray.mask[k] = ~0u,
      q.ray.flags[k] = 0;
      q.hit.geomID[k] = q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
  }
};

struct Hit {
  V point, normal;  // moved off the surface; towards the viewer
  std::uint32_t material;
};

class Renderer {
 public:
  Renderer(const Scene& scene, int rays1, int rays2, bool polarized)
      : s_(scene),
        n_(scene.e1.size()),
        first_(std::max(1, rays1 - 1)),
        second_(std::max(1, rays2 - 1)),
        rays2_(rays2),
        polarized_(polarized) {
    rtcInitIntersectContext(&context_);
  }
  Hit complete(const Ray16& r, int k) const {
    const V d{r.q.ray.dir_x[k], r.q.ray.dir_y[k], r.q.ray.dir_z[k]},
        o{r.q.ray.org_x[k], r.q.ray.org_y[k], r.q.ray.org_z[k]};
    V n = unit({r.q.hit.Ng_x[k], r.q.hit.Ng_y[k], r.q.hit.Ng_z[k]});
    if (dot(n, d) > 0) n = n * -1;
    return {o + d * r.q.ray.tfar[k] + n * 1e-4f, n, s_.triangles[r.q.hit.primID[k]].material};
  }
  void leaving(const Hit& hit, V to_viewer, std::uint32_t random, int level, float* out) {
    const Hemisphere& h = level == 0 ? first_ : second_;
    const Material& m = s_.materials[hit.material];
    const Frame f = frameOf(hit.normal, random);
    const V r{dot(to_viewer, f.x), dot(to_viewer, f.y), std::max(1e-3f, dot(to_viewer, f.z))};
    addSun(hit, f, r, m, out);
    if (level == 1 && rays2_ == 1) return;
    alignas(64) float weight[most];
    const bool deeper = level == 0 && rays2_ > 0;
    Ray16 rays;
    Directions to_sky;
    for (int i = 0; i < h.count; i += 16) {
      rays.fill(h, i, f, hit.point);
      if (!s_.rayleigh.empty())
        for (int k = 0; k < 16; ++k)
          to_sky.x[i + k] = rays.q.ray.dir_x[k], to_sky.y[i + k] = rays.q.ray.dir_y[k],
                       to_sky.z[i + k] = rays.q.ray.dir_z[k];
      if (deeper)
        rtcIntersect16(rays.valid.data(), s_.embree, &context_, &rays.q);
      else
        rtcOccluded16(rays.valid.data(), s_.embree, &context_, &rays.q.ray);
      for (int k = 0; k < 16; ++k) {
        const bool met =
            deeper ? rays.q.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID : rays.q.ray.tfar[k] < 0;
        weight[i + k] = met ? 0 : h.weight[i + k];
        if (met && deeper && h.weight[i + k] > 0)
          addSurface(rays, k, h, i + k, f, r, m, random, out);
      }
    }
    if (s_.rayleigh.empty())
      addSky(h, weight, r, m, out);
    else
      addRayleigh(h, to_sky, f, weight, r, m, out);
  }

 private:
  void addSun(const Hit& hit, const Frame& f, V r, const Material& m, float* out) {
    const V sun{s_.to_sun[0], s_.to_sun[1], s_.to_sun[2]},
        i{dot(sun, f.x), dot(sun, f.y), dot(sun, f.z)};
    if (i.z <= 0) return;
    RTCRay q{hit.point.x, hit.point.y, hit.point.z, 0,   sun.x, sun.y,
             sun.z,       0,           1e30f,       ~0u, 0,     0};
    rtcOccluded1(s_.embree, &context_, &q);
    if (q.tfar < 0) return;
    if (m.sigma == 0)
      for (std::size_t j = 0; j < n_; ++j) out[j] += s_.sun[j] * i.z * m.reflectance / pi;
    else
      addSunBands(facet(i.x, i.y, i.z, r, 1 / (2 * m.sigma * m.sigma),
                        1 / (8 * pi * m.sigma * m.sigma)),
                  i.z, out);
  }
  void addSunBands(const Facet& g, float cosine, float* out) {
    light_.assign(3 * n_, 0);
    addBands(g, cosine, n_, s_.e1.data(), s_.e2.data(), polarized_, light_.data());
    for (std::size_t k = 0; k < (polarized_ ? 3 : 1); ++k)
      for (std::size_t j = 0; j < n_; ++j) out[k * n_ + j] += s_.sun[j] * light_[k * n_ + j];
  }
  void addRayleigh(const Hemisphere& h, const Directions& to_sky, const Frame& f,
                   const float* weight, V r, const Material& m, float* out) {
    SkyAims a;
    aimAt(to_sky, h.count, f.z, {s_.to_sun[0], s_.to_sun[1], s_.to_sun[2]}, a);
    if (n_ == 1) return addRayleighOneBand(h, a, weight, r, m, out);
    const std::size_t eights = (n_ + 7) / 8, row = 32 * eights, plane = 8 * eights;
    light_.assign(3 * plane, 0);
    float *s0 = light_.data(), *s1 = s0 + plane, *s2 = s1 + plane;
    const float p = 1 / (2 * m.sigma * m.sigma), norm = 1 / (8 * pi * m.sigma * m.sigma);
    for (int i = 0; i < h.count; ++i) {
      if (!(weight[i] > 0)) continue;
      const float* node = &s_.rayleigh[std::size_t(a.first[i]) * row];
      if (m.sigma == 0) {
        addS0(a, i, node, row, eights, weight[i], s0);
      } else {
        stokes(a, i, node, row, eights, s0, s1, s2);
        addStokes(facet(h.x[i], h.y[i], h.z[i], r, p, norm), weight[i], n_, s_.e1.data(),
                  s_.e2.data(), s0, s1, s2, out);
      }
    }
    if (m.sigma == 0)
      for (std::size_t j = 0; j < n_; ++j) out[j] += m.reflectance / pi * s0[j];
  }
  void addRayleighOneBand(const Hemisphere& h, const SkyAims& a, const float* weight, V r,
                          const Material& m, float* out) {
    alignas(64) float s0[most], s1[most], s2[most], s3[most];
    stokesOfOneBand(a, h.count, s_.rayleigh.data(), s0, s1, s2);
    float sum[4] = {};
    if (m.sigma == 0) {
      for (int i = 0; i < h.count; ++i) sum[0] += weight[i] * s0[i];
      out[0] += m.reflectance / pi * sum[0];
      return;
    }
    const float p = 1 / (2 * m.sigma * m.sigma), norm = 1 / (8 * pi * m.sigma * m.sigma);
    for (int i = 0; i < h.count; ++i) {
      const Facet g = facet(h.x[i], h.y[i], h.z[i], r, p, norm);
      const Four q = fresnel(g.c, g.s2, s_.e1[0], s_.e2[0]);
      const float u1 = g.cos2i * s1[i] + g.sin2i * s2[i],
                  u2 = g.cos2i * s2[i] - g.sin2i * s1[i];
      const float v1 = q.diff * s0[i] + q.sum * u1, v2 = q.re * u2, w = g.factor * weight[i];
      s0[i] = w * (q.sum * s0[i] + q.diff * u1), s1[i] = w * (g.cos2r * v1 + g.sin2r * v2),
      s2[i] = w * (g.cos2r * v2 - g.sin2r * v1), s3[i] = -w * q.im * u2;
    }
    for (int i = 0; i < h.count; ++i)
      sum[0] += s0[i], sum[1] += s1[i], sum[2] += s2[i], sum[3] += s3[i];
    for (int k = 0; k < 4; ++k) out[k] += sum[k];
  }
  void addSurface(const Ray16& rays, int k, const Hemisphere& h, int i, const Frame& f, V r,
                  const Material& m, std::uint32_t random, float* out) {
    light_.assign(4 * n_, 0);
    const V d{rays.q.ray.dir_x[k], rays.q.ray.dir_y[k], rays.q.ray.dir_z[k]};
    const Hit other = complete(rays, k);
    leaving(other, d * -1, random * 977 + std::uint32_t(i), 1, light_.data());
    const float w = h.weight[i];
    if (m.sigma == 0) {
      for (std::size_t j = 0; j < n_; ++j) out[j] += w * m.reflectance / pi * light_[j];
      return;
    }
    const Facet g = facet(h.x[i], h.y[i], h.z[i], r, 1 / (2 * m.sigma * m.sigma),
                          1 / (8 * pi * m.sigma * m.sigma));
    const V s1 = unit(cross(other.normal, d * -1)), s2 = unit(cross(d * -1, f.z)) * -1,
            p1 = cross(d * -1, s1);
    const float c = dot(s1, s2), s = dot(p1, s2), tc = c * c - s * s, ts = 2 * c * s,
                f0 = g.factor * w;
    for (std::size_t j = 0; j < n_; ++j) {
      const Four q = fresnel(g.c, g.s2, s_.e1[j], s_.e2[j]);
      const float *l = &light_[j], t1 = tc * l[n_] + ts * l[2 * n_],
                  t2 = tc * l[2 * n_] - ts * l[n_];
      const float u1 = g.cos2i * t1 + g.sin2i * t2, u2 = g.cos2i * t2 - g.sin2i * t1;
      const float v1 = q.diff * l[0] + q.sum * u1, v2 = q.re * u2 + q.im * l[3 * n_];
      out[j] += f0 * (q.sum * l[0] + q.diff * u1);
      if (!polarized_) continue;
      out[n_ + j] += f0 * (g.cos2r * v1 + g.sin2r * v2),
          out[2 * n_ + j] += f0 * (g.cos2r * v2 - g.sin2r * v1);
      out[3 * n_ + j] += f0 * (q.re * l[3 * n_] - q.im * u2);
    }
  }
  void addSky(const Hemisphere& h, float* weight, V r, const Material& m, float* out) {
    if (m.sigma == 0) {
      float sum = 0;
      for (int i = 0; i < h.count; ++i) sum += weight[i];
      for (std::size_t j = 0; j < n_; ++j) out[j] += s_.sky * sum * m.reflectance / pi;
      return;
    }
    for (int i = 0; i < h.count; ++i) weight[i] *= s_.sky;
    if (n_ == 1)
      return shadeOneBand(h, weight, r, m.sigma, s_.e1[0], s_.e2[0], polarized_, out);
    for (int i = 0; i < h.count; ++i)
      if (weight[i] > 0)
        addBands(facet(h.x[i], h.y[i], h.z[i], r, 1 / (2 * m.sigma * m.sigma),
                       1 / (8 * pi * m.sigma * m.sigma)),
                 weight[i], n_, s_.e1.data(), s_.e2.data(), polarized_, out);
  }

  const Scene& s_;
  std::size_t n_;
  Hemisphere first_, second_;
  int rays2_;
  bool polarized_;
  std::vector<float> light_;
  RTCIntersectContext context_;
};
}  // namespace

void Scene::build() {
  device = rtcNewDevice(nullptr);
  embree = rtcNewScene(device);
  rtcSetSceneFlags(embree, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices.size()));
  for (const auto& v : vertices) xyz = std::copy(v.begin(), v.end(), xyz);
  auto* abc = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size()));
  for (const Triangle& t : triangles) *abc++ = t.a, *abc++ = t.b, *abc++ = t.c;
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(embree, mesh);
  rtcReleaseGeometry(mesh);
  rtcCommitScene(embree);
}

Scene::~Scene() {
  if (embree) rtcReleaseScene(embree);
  if (device) rtcReleaseDevice(device);
}

void render(const Scene& scene, std::size_t pixels, float height, float width, std::size_t step,
            int rays1, int rays2, bool polarized, std::vector<float>& out) {
  const std::size_t bands = scene.e1.size();
  Renderer renderer(scene, rays1, rays2, polarized);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Ray16 rays;
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t y = 0; y < pixels; y += step)
    for (std::size_t x = 0; x < pixels; x += 16) {
      for (std::size_t k = 0; k < 16; ++k) {
        const float f = width / height / float(pixels), half = float(pixels) / 2;
        const V d = unit({(float(x + k) + 0.5f - half) * f, (half - float(y) - 0.5f) * f, -1});
        rays.q.ray.dir_x[k] = d.x, rays.q.ray.dir_y[k] = d.y, rays.q.ray.dir_z[k] = d.z;
        rays.q.ray.org_x[k] = rays.q.ray.org_y[k] = 0, rays.q.ray.org_z[k] = height;
        rays.q.ray.tnear[k] = 0, rays.q.ray.tfar[k] = 1e30f, rays.q.ray.time[k] = 0;
        rays.q.ray.mask[k] = ~0u, rays.q.ray.flags[k] = 0;
        rays.q.hit.geomID[k] = rays.q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(rays.valid.data(), scene.embree, &context, &rays.q);
      for (std::size_t k = 0; k < 16; ++k) {
        const V d{rays.q.ray.dir_x[k], rays.q.ray.dir_y[k], rays.q.ray.dir_z[k]};
        const std::size_t pixel = y / step * pixels + x + k;
        if (rays.q.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
          renderer.leaving(renderer.complete(rays, int(k)), d * -1,
                           std::uint32_t(pixel) * 747796405u + 2891336453u, 0,
                           &out[pixel * 4 * bands]);
      }
    }
}
}  // namespace bare
