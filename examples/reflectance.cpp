// How strongly rough copper polarises sunlight: degree of linear polarisation of the reflected light
// at 550 and 650 nm, for a source at 60 deg and viewers in the plane of incidence.
#include <cmath>
#include <cstdio>
#include <malus/surface/BRDFTorranceSparrow.hpp>

int main() {
  using namespace malus;
  const auto grid = SpectralGrid::make({550, 650});
  const BRDFTorranceSparrow copper({grid, {0.826, 0.213}}, {grid, {2.60, 3.67}},
                                   CDSpectralVector<double>(grid, 0.2));
  std::puts("theta_r_deg,DoLP_550nm,DoLP_650nm");
  CDSpectralVector<CDMuellerMatrix> f(grid);
  for (int theta_r = 0; theta_r <= 80; theta_r += 10) {
    // the viewer's azimuth is 180 deg from the source's: the mirror's side
    copper.evaluate(BRDFGeometry::fromDegrees(60, theta_r, 180), f);
    std::printf("%d", theta_r);
    for (std::size_t band = 0; band < grid->size(); ++band) {
      const CDMuellerMatrix m = f[band];
      std::printf(",%.4f", std::hypot(m.getMueller(1, 0), m.getMueller(2, 0)) / m.getScalar());
    }
    std::puts("");
  }
}
