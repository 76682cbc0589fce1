// Spectral libraries (nw/light/SpectralLibraries.nw), and bands that need their spectra (nw/light/MeasuredSpectrum.nw).
// The files are made: real headers, and a few numbers.
#include "malus/light/SpectralLibraries.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "Program.hpp"
#include "malus/base/Error.hpp"
#include "malus/light/MeasuredSpectrum.hpp"

using namespace malus;

namespace {
const std::string wavelengths_name = "splib07a_Wavelengths_BECK_Beckman_0.2-3.0_microns.txt",
                  usgs_name = "splib07a_Kaolinite_CM5_BECKb_AREF.txt";
const std::string wavelengths =
    " splib07a Record=13: Wavelengths BECK 0.2-3.0 microns\n 0.40\n 0.45\n 0.50\n 0.55\n "
    "0.60\n 0.65\n 0.70\n";
// channels 4 and 5, 550 and 600 nm, were deleted, and the last is more than all light
const std::string usgs =
    " splib07a Record=5932: Kaolinite CM5                 BECKb AREF\r\n 2.0e-01\r\n "
    "3.0e-01\r\n 4.0e-01\r\n"
    " -1.2300000e+034\r\n -1.2300000e+034\r\n 5.0e-01\r\n 1.0200000e+000\r\n";
const std::string ecostress =
    "Name: Quercus douglasii 2\nType: vegetation\nClass: Tree\nDescription: Leaves: 3 of "
    "them\nof one tree.\n"
    "Measurement: Bidirectional reflectance\nFirst Column: X\nX Units: Wavelength "
    "(micrometers)\n"
    "Y Units: Reflectance (percentage)\nNumber of X Values: 3\n\n 0.7000\t 50.0\n 0.5000\t "
    "10.0\n 0.4000\t 6.0\n";

struct Library : Scratch {
  Library() {
    put(*this / wavelengths_name, wavelengths);
    put(*this / ("ChapterM_Minerals/" + usgs_name), usgs);
    put(*this / "oak.txt", ecostress);
  }
  std::filesystem::path mineral() const { return *this / ("ChapterM_Minerals/" + usgs_name); }
};

template <class Read>
std::string complaint(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string whole = error.what();
    EXPECT_EQ(whole.find('\n'), whole.npos);
    return whole.substr(whole.find('/', whole.find("malus-test")) + 1);
  }
  return "read";
}

double at(const std::filesystem::path& file, double nm,
          const std::string& column = "reflectance", const Limits& limits = fractions) {
  return readSpectrum(file, column, SpectralGrid::make({nm}), limits)[0];
}

// The result of a spectrum with one text replaced by another.
std::string changed(const std::string& text, const std::string& old, const std::string& fresh,
                    const std::string& name = "oak.txt") {
  const Library library;
  std::string broken = text;
  broken.replace(broken.find(old), old.size(), fresh);
  put(library / name, broken);
  return complaint([&] { at(library / name, 450); });
}
}  // namespace

TEST(SpectralLibrariesIdentity, SpectraAsTheyAreDownloaded) {
  const Library library;
  EXPECT_DOUBLE_EQ(at(library.mineral(), 400), 0.2);
  EXPECT_DOUBLE_EQ(at(library.mineral(), 425), 0.25);
  EXPECT_DOUBLE_EQ(at(library.mineral(), 500), 0.4);
  EXPECT_DOUBLE_EQ(at(library / "oak.txt", 400), 0.06);
  EXPECT_DOUBLE_EQ(at(library / "oak.txt", 600), 0.3);
  EXPECT_EQ(libraryWavelengths(library.mineral()), library / wavelengths_name);
  EXPECT_EQ(libraryWavelengths(library / "oak.txt"), std::nullopt);
  EXPECT_EQ(readLibrarySpectrum("scenes/data/grass.csv"), std::nullopt);
  // an albedo is a share of light as well, and other columns are what they are called
  EXPECT_DOUBLE_EQ(at(library / "oak.txt", 400, "albedo"), 0.06);
}

TEST(SpectralLibrariesIdentity, ASceneTakesThem) {
  const Library library;
  const auto scene = [&](const std::string& file, const std::string& bands) {
    put(library / "scene.json", R"({"malus": 1, "bands": {"wavelength_nm": [)" + bands +
                                    R"(]}, "geometry": [{"ground": {"material": "plate"}}],
 "materials": {"plate": {"model": "lambertian", "reflectance": {"file": ")" +
                                    file + R"("}}},
 "sun": {"zenith_deg": 60, "azimuth_deg": 0, "irradiance_W_m2_nm": 3.14159265358979},
 "sensor": {"kind": "framing", "width": 1, "height": 1, "field_of_view_deg": 1},
 "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 0, 0]}})");
    return malusIn(library.path, "render scene.json --write cube --out out");
  };
  ASSERT_EQ(scene("ChapterM_Minerals/" + usgs_name, "425").code, 0);
  const std::string record = contents(library / "out/scene.run.json");
  EXPECT_NE(record.find(wavelengths_name),
            std::string::npos);  // it belongs to what the picture was made of
  const Outcome gap = scene("ChapterM_Minerals/" + usgs_name, "425, 560");
  EXPECT_EQ(gap.code, 2);
  EXPECT_NE(gap.err.find(
                usgs_name +
                ":5: reflectance = 500 to 650 nm: is a gap of deleted channels, but the "
                "band at 560 "
                "nm needs them; leave out the band, or give another spectrum of the material"),
            std::string::npos)
      << gap.err;
  const Outcome beyond = scene("oak.txt", "450, 800");
  EXPECT_EQ(beyond.code, 2);
  EXPECT_NE(beyond.err.find("lacks 700 to 800 nm"), std::string::npos) << beyond.err;
  EXPECT_NE(beyond.err.find("covers 400 to 700 nm"), std::string::npos) << beyond.err;
}

TEST(SpectralLibrariesRefusals, BandsThatNeedWhatIsNotThere) {
  const Library library;
  // at the edge of the gap nothing is missing; a hair inside it is
  EXPECT_DOUBLE_EQ(at(library.mineral(), 650), 0.5);
  EXPECT_NE(complaint([&] { at(library.mineral(), 649.9); }).find("is a gap of deleted"),
            std::string::npos);
  // more light than there is, where a band needs it and only there
  EXPECT_NE(complaint([&] {
              at(library.mineral(), 690);
            }).find(usgs_name + ":8: reflectance = 1.02 at 700 nm: is beyond its limits"),
            std::string::npos);
  EXPECT_EQ(complaint([&] { at(library / "oak.txt", 450, "irradiance_W_m2_nm", {}); }),
            "oak.txt: reflectance: is the quantity of this library spectrum, not "
            "irradiance_W_m2_nm; give a table with that "
            "column");
}

TEST(SpectralLibrariesRefusals, BrokenFilesOfECOSTRESS) {
  EXPECT_EQ(changed(ecostress, "10.0", "1O.0"),
            "oak.txt:13: 1O.0: is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(changed(ecostress, "\t 10.0", ""),
            "oak.txt:13:  0.5000: holds 1 numbers; give 2 as in the lines before");
  EXPECT_EQ(changed(ecostress, "Values: 3", "Values: 4"),
            "oak.txt: 3 values: but its header says 4; give the whole file of the library");
  EXPECT_EQ(changed(ecostress, "(micrometers)", "(1/cm)"),
            "oak.txt:8: (1/cm): is not a unit of wavelength; give a spectrum over Wavelength "
            "(micrometers) or (nanometers)");
  EXPECT_EQ(changed(ecostress, "(percentage)", "(dB)"),
            "oak.txt:9: (dB): is not a unit of reflectance or transmittance; give a spectrum "
            "in (percent), (percentage) "
            "or (fraction)");
  EXPECT_EQ(
      changed(ecostress, "X Units", "X Unit"),
      "oak.txt:12: comes before the units; keep the lines X Units and Y Units of the library");
  EXPECT_EQ(changed(ecostress, "0.5000", "0.4000").substr(0, 40),
            "oak.txt:13: wavelength = 400 nm: does no");
  EXPECT_EQ(changed(ecostress, "Reflectance", "Transmittance").substr(0, 64),
            "oak.txt: transmittance: is the quantity of this library spectrum");
}

TEST(SpectralLibrariesRefusals, BrokenFilesOfTheUSGS) {
  EXPECT_EQ(
      changed(usgs, "3.0e-01", "3.0e-O1", usgs_name),
      usgs_name +
          ":3: channel 2 = 3.0e-O1: is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(changed(usgs, " 2.0e-01\r\n", "", usgs_name).substr(0, usgs_name.size() + 19),
            usgs_name + ": 6 channels: but /");
  EXPECT_EQ(changed(usgs, "BECKb", "OWNb", usgs_name),
            usgs_name +
                ":1: OWNb: needs the wavelengths of its spectrometer; keep "
                "splib07a_Wavelengths_... of the library "
                "beside it, or in the directory above");
  const Library library;
  EXPECT_EQ(complaint([&] {
              at(library / wavelengths_name, 450);
            }).substr(0, wavelengths_name.size() + 39),
            wavelengths_name + ":1: is not a spectrum of the library; g");
  put(library / wavelengths_name, " splib07a Record=13: Wavelengths BECK\n 0.40\n 0.4x\n");
  EXPECT_EQ(
      complaint([&] { at(library.mineral(), 450); }).substr(0, wavelengths_name.size() + 25),
      wavelengths_name + ":3: channel 2 = 0.4x: is ");
}
