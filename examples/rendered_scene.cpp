// Renders a scene file in memory: rendered_scene SCENE.json; prints the mean Stokes vector of each band.
#include <array>
#include <cstdio>
#include <exception>
#include <malus/files/SceneReader.hpp>
#include <malus/render/Renderer.hpp>

int main(int count, char** arguments) try {
  if (count != 2) return std::fputs("usage: rendered_scene SCENE.json\n", stderr), 2;
  const malus::Scene scene = malus::readScene(arguments[1]);
  const malus::RenderedImage image = malus::renderScene(scene);
  std::puts("wavelength_nm,S0,S1,S2,S3");
  for (std::size_t band = 0; band < image.bands; ++band) {
    std::array<double, 4> mean{};
    for (std::size_t y = 0; y < image.height; ++y)
      for (std::size_t x = 0; x < image.width; ++x)
        for (std::size_t i = 0; i < 4; ++i)
          mean[i] += image.at(x, y, band)[i] / double(image.width * image.height);
    std::printf("%g,%.9g,%.9g,%.9g,%.9g\n", scene.sensor.bands()->nm(band), mean[0], mean[1],
                mean[2], mean[3]);
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 2;
}
