// The door for scenes, by the structure: a scene that is valid, of which some values, keys and lists are exchanged. What the reader takes is
// rendered, a pixel of its last frame, and must give numbers.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "Choices.hpp"
#include "Door.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/render/Scene.hpp"
#include "malus/render/Tile.hpp"

namespace malus::fuzzing::scenes {
using nlohmann::json;

/// The scenes that ship with malus, as small as they can be.
inline const std::vector<json>& shipped() {
  static const std::vector<json> list = [] {
    std::vector<json> all;
    for (const char* name :
         {"flat-plate", "four-cameras", "mosaic", "flight-staring", "rochester-day",
          "chunky-bar-sky", "chunky-bar-night", "flight-nadir"}) {
      std::ifstream file(std::string(MALUS_SCENES "/") + name + ".json");
      json scene = json::parse(file, nullptr, true, true);
      scene["sensor"]["width"] = 8, scene["sensor"]["height"] = 8;
      scene["radiometry"]["rays"] = {4, 1};
      all.push_back(std::move(scene));
    }
    return all;
  }();
  return list;
}

inline void collect(json& value, std::vector<json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (json& part : value) collect(part, all);
}

inline json word(Choices& choices) {
  static const std::vector<std::string> words{"",
                                              "../../../ESCAPED",
                                              "a/b",
                                              "a\nb",
                                              "a\"b",
                                              ".hidden",
                                              "{}",
                                              "copper.csv",
                                              "data/copper.csv",
                                              "data",
                                              "/dev/zero",
                                              "data/glass.yml",
                                              "data/soil.csv",
                                              "chunky-bar.obj",
                                              "flat-plate.obj",
                                              "2001-06-10T17:06:00Z",
                                              "9999-12-31T23:59:59Z",
                                              "framing",
                                              "pushbroom",
                                              "line-scanner",
                                              "uniform",
                                              "rayleigh",
                                              "table",
                                              "haze",
                                              "grid",
                                              "random",
                                              "adaptive",
                                              "importance",
                                              "lambertian",
                                              "torrance-sparrow",
                                              "dirsig",
                                              "rough-water",
                                              "nadal-breon",
                                              "fixed",
                                              "straight",
                                              "staring",
                                              "gaussian",
                                              "rectangular",
                                              "narrow",
                                              "partly",
                                              "full",
                                              "none",
                                              std::string(5000, 'x'),
                                              "S0",
                                              "S3"};
  return choices.of(words);
}

inline std::string key(Choices& choices) {
  static const std::vector<std::string> keys{"name",
                                             "fwhm_nm",
                                             "response",
                                             "grid_nm",
                                             "scale",
                                             "rotate_deg",
                                             "translate_m",
                                             "instances",
                                             "temperature_K",
                                             "to_sun",
                                             "latitude_deg",
                                             "longitude_deg",
                                             "time",
                                             "half_angle_deg",
                                             "albedo",
                                             "pressure_hPa",
                                             "altitude_m",
                                             "path_radiance",
                                             "polarization",
                                             "atmosphere",
                                             "sky",
                                             "sun",
                                             "field_of_view_deg",
                                             "focal_length_mm",
                                             "pixel_pitch_um",
                                             "principal_point_px",
                                             "samples_per_pixel",
                                             "jitter",
                                             "row_time_s",
                                             "column_time_s",
                                             "polarimeter",
                                             "cameras",
                                             "mosaic",
                                             "window_px",
                                             "recover",
                                             "noise",
                                             "mueller",
                                             "calibration",
                                             "poses",
                                             "path",
                                             "start_m",
                                             "velocity_m_s",
                                             "target_m",
                                             "frames",
                                             "interval_s",
                                             "roll_deg",
                                             "look",
                                             "up",
                                             "model",
                                             "n",
                                             "k",
                                             "sigma",
                                             "reflectance",
                                             "diffuse",
                                             "shadowing",
                                             "optical_constants",
                                             "file",
                                             "column",
                                             "wavelength_nm",
                                             "values",
                                             "sobol",
                                             "mis",
                                             "seed"};
  return choices.of(keys);
}

inline json fresh(Choices& choices, int depth = 0) {
  switch (choices.below(depth > 2 ? 4 : 7)) {
    case 0:
    case 1:
      return choices.number();
    case 2:
      return word(choices);
    case 3:
      return choices.byte() % 2 ? json(choices.byte() % 2 == 1) : json(choices.byte());
    case 4:
    case 5: {
      json list = json::array();
      for (std::size_t left = choices.below(5); left > 0; --left)
        list.push_back(fresh(choices, depth + 1));
      return list;
    }
    default: {
      json object = json::object();
      for (std::size_t left = choices.below(4); left > 0; --left)
        object[key(choices)] = fresh(choices, depth + 1);
      return object;
    }
  }
}

inline void change(json& scene, Choices& choices) {
  std::vector<json*> all;
  collect(scene, all);
  json& value = *choices.of(all);
  switch (choices.below(8)) {
    case 0:
      value = fresh(choices);
      return;
    case 1:
      if (value.is_object() && !value.empty())
        value.erase(
            std::next(value.begin(), std::ptrdiff_t(choices.below(value.size()))).key());
      return;
    case 2:
      if (value.is_object()) value[key(choices)] = fresh(choices);
      return;
    case 3:
      if (value.is_array() && !value.empty())
        for (std::size_t more = choices.below(20); more > 0; --more)
          value.push_back(json(value[choices.below(value.size())]));
      return;
    case 4:
      if (value.is_array() && !value.empty()) value.erase(choices.below(value.size()));
      return;
    case 5:
      value = json(*choices.of(all));  // another part of the scene
      return;
    default:
      if (value.is_number())
        value = choices.number();
      else if (value.is_string())
        value = word(choices);
  }
}

inline void render(const Scene& scene) {
  const std::size_t frame = scene.platform.frames() - 1;
  const SensorGeometry& sensor = scene.sensor.geometry();
  if (sensor.samples > 16 || scene.sensor.bands()->size() > 100 ||
      scene.world.grid->size() > 1000)
    return;  // sound, and slow
  std::size_t rays = 1;
  for (const int more : scene.radiometry.rays) rays *= std::size_t(std::min(more, 1000));
  if (rays > 1000) return;
  const std::size_t x = sensor.width / 2, y = sensor.height / 2;
  const RenderedImage picture =
      renderScene(scene, frame, {1, Tile{x, y, x + 1, y + 1}, nullptr});
  for (const double number : picture.stokes)
    if (!std::isfinite(number)) {
      std::fprintf(stderr, "a pixel that is no number\n");
      std::abort();
    }
}
}  // namespace malus::fuzzing::scenes

using namespace malus;

MALUS_DOOR(scenes) {
  fuzzing::Choices choices(data, size);
  nlohmann::json scene = choices.of(fuzzing::scenes::shipped());
  for (std::size_t left = 1 + choices.below(4); left > 0; --left)
    fuzzing::scenes::change(scene, choices);
  const std::string text = scene.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
  return fuzzing::knock(
      [&] { fuzzing::scenes::render(readSceneText(text, "scene.json", MALUS_SCENES)); });
}
