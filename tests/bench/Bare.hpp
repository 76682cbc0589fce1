// The loops that a programmer would write by hand for one task and no other: no classes, no checks, no
// choices, unit vectors in, plain arrays through. The product is measured against these.
#pragma once
#include <cstddef>

namespace bare {
/// What one geometry gives: factor, incidence on the facet, two rotations.
template <class Real>
struct Facet {
  Real factor, cos_beta, sin2_beta, cos2i, sin2i, cos2r, sin2r;
};
/// From unit vectors to source and viewer and one roughness, V-grooves.
Facet<double> facet(const double* to_source, const double* to_viewer, double sigma);

/// sum += weight f in; 4 planes of n bands in one piece.
template <class Real>
void scatter(const Facet<Real>& g, std::size_t n, const Real* e1, const Real* e2,
             const Real* in, Real* sum);
/// The same for unpolarised light in (one plane).
template <class Real>
void scatterUnpolarized(const Facet<Real>& g, std::size_t n, const Real* e1, const Real* e2,
                        const Real* in, Real* sum);
/// f00 alone (one plane in, one out).
template <class Real>
void scatterScalar(const Facet<Real>& g, std::size_t n, const Real* e1, const Real* e2,
                   const Real* in, Real* sum);

/// out += m s: 16 planes times 4 planes of n bands.
void multiplyAdd(std::size_t n, const double* m, const double* s, double* out);
}  // namespace bare
