// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_resources.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <numbers>

#include "gui/render/shader_sources.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"
#include "sim/math/random.h"

namespace calot::gui {

namespace {

constexpr int sheetLook = -1, smokeLook = -2, readyLook = -3;

int lookOf(const DrawPart& part) { return 2 * static_cast<int>(part.appearance) + (part.harmed ? 1 : 0); }

bool isTissue(Appearance a) { return a < Appearance::insulation && !isSurroundings(a); }

std::vector<std::uint8_t> asBytes(const std::vector<float>& volume) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(volume.size());
  for (std::size_t i = 0; i < volume.size(); ++i) {  // slopes within [-2, 2], values within [-1, 1]
    const float share = volume[i] * (i % 4 == 3 ? 0.5F : 0.25F) + 0.5F;
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F))));
  }
  return bytes;
}

GLenum radianceFormat(Quality q) { return q == Quality::film ? GL_RGBA16F : GL_RGBA8; }
int samplesAside(Quality q) { return q == Quality::film ? 2 : 1; }
int coarse(int side, Quality q) { return q == Quality::film ? side : (side + 1) / 2; }
// Interactive: texels about as large as pixels, which show neither a shadow's steps nor cost what no pixel shows.
int shadowSide(int w, int h, Quality q) {
  constexpr int film = 1536, least = 512;
  return q == Quality::film ? film : std::clamp(4 * std::min(w, h) / 3, least, film);
}

// Three independent 32-bit values for a lattice point: "pcg3d" of Jarzynski and Olano, "Hash functions for GPU
// rendering", JCGT 9(3), 2020.
Vec3 latticeGradient(int i, int j, int k) {
  const auto wrap = [](int v) { return static_cast<std::uint32_t>((v + noiseCells) % noiseCells); };
  std::uint32_t x = wrap(i), y = wrap(j), z = wrap(k);
  x = x * 1664525U + 1013904223U;
  y = y * 1664525U + 1013904223U;
  z = z * 1664525U + 1013904223U;
  for (int round = 0; round < 2; ++round) {
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16U;
    y ^= y >> 16U;
    z ^= z >> 16U;
  }
  const auto unit = [](std::uint32_t v) { return static_cast<double>(v >> 8U) / 8388608.0 - 1.0; };
  const Vec3 g(unit(x), unit(y), unit(z));
  const double length = g.norm();
  return length > 1e-6 ? Vec3(g * (1.2 / length)) : Vec3(1.2, 0.0, 0.0);
}

double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
double fadeSlope(double t) { return 30.0 * t * t * (t * (t - 2.0) + 1.0); }

/// The noise volume between its texels: derivatives and value.
class Noise {
 public:
  std::array<double, 4> operator()(double x, double y, double z) const {
    const std::array<double, 3> p{x, y, z};
    std::array<std::size_t, 3> low{}, high{};
    std::array<double, 3> t{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double texel = p[a] * noiseSide / noiseCells - 0.5;
      const double whole = std::floor(texel);
      t[a] = texel - whole;
      const int at = (static_cast<int>(whole) % noiseSide + noiseSide) % noiseSide;
      low[a] = static_cast<std::size_t>(at);
      high[a] = static_cast<std::size_t>((at + 1) % noiseSide);
    }
    std::array<double, 4> out{};
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      std::array<std::size_t, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        const bool far = ((corner >> a) & 1U) != 0;
        at[a] = far ? high[a] : low[a];
        weight *= far ? t[a] : 1.0 - t[a];
      }
      const std::size_t texel = 4 * ((at[2] * noiseSide + at[1]) * noiseSide + at[0]);
      for (std::size_t c = 0; c < 4; ++c) out[c] += weight * static_cast<double>(volume_[texel + c]);
    }
    return out;
  }

 private:
  std::vector<float> volume_ = makeNoiseVolume();
};

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Fibres along the zero lines of a noise that is stretched along t: all of one width, branching where lines meet.
struct Fibre {
  double cover = 0.0;
  double side = 0.0;  // -1 to 1 across the fibre
};
Fibre fibres(const std::array<double, 4>& n, double width) {
  const double away = n[3] / std::max(std::hypot(n[0], n[1]), 0.35);
  return {1.0 - smoothstep(0.25 * width, width, std::abs(away)), std::clamp(away / width, -1.0, 1.0)};
}

std::uint8_t byteOf(double x) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(x, 0.0, 1.0))); }

constexpr int trunks = 11;
constexpr double step = 1.0;      // texels
constexpr double widest = 4.6;    // radius of a trunk (texels)
constexpr double thinnest = 0.7;  // where a vein ends
constexpr double reach = 11.0;    // from branch to branch, in radii and a fixed part (texels)
constexpr double fixed = 9.0;
constexpr double emerging = 60.0;  // way over which a trunk comes up out of the depth (texels)

/// The end of a vein that still grows.
struct Tip {
  double s = 0.0, t = 0.0;  ///< texels
  double angle = 0.0;       ///< rad, from s
  double bend = 0.0;        ///< rad a step
  double radius = 0.0;      ///< texels
  double left = 0.0;        ///< way to its next branch (texels)
  double gone = 1e9;        ///< since it came up out of the depth (texels)
};

std::size_t wrapped(double x) {
  return static_cast<std::size_t>((static_cast<int>(x) % veinSide + veinSide) % veinSide);
}

void addDot(std::vector<std::uint8_t>& texture, double s, double t, double radius) {
  const double strength = std::min(1.0, 0.30 + 0.28 * radius);  // a thin vein shows through less
  const int reached = static_cast<int>(radius + 2.0);
  for (int j = -reached; j <= reached; ++j) {
    for (int i = -reached; i <= reached; ++i) {
      const double column = std::floor(s) + i, row = std::floor(t) + j;
      const double away = std::hypot(column + 0.5 - s, row + 0.5 - t);
      const double cover = strength * std::clamp(radius + 0.5 - away, 0.0, 1.0);
      std::uint8_t& texel = texture[wrapped(row) * veinSide + wrapped(column)];
      texel = std::max(texel, byteOf(cover));
    }
  }
}

}  // namespace

bool noteLooks(LooksDrawn& drawn, const DrawList& list, const RenderSettings& settings) {
  bool isNew = false;
  const auto add = [&](int look) { isNew = drawn.insert({settings.quality, look}).second || isNew; };
  for (const DrawPart& part : list.part) add(lookOf(part));
  if (!list.sheets.index.empty()) add(sheetLook);
  if (!list.smoke.index.empty()) add(smokeLook);
  if (settings.ready) add(readyLook);
  return isNew;
}

std::vector<DrawPart> looksToCome(const DrawList& list) {
  std::vector<DrawPart> parts;
  const auto add = [&](Appearance appearance, bool harmed) {
    DrawPart part = list.part.front();
    part.indexCount = 3;
    part.appearance = appearance;
    part.harmed = harmed;
    const auto same = [&](const DrawPart& other) { return lookOf(other) == lookOf(part); };
    if (std::none_of(parts.begin(), parts.end(), same) && std::none_of(list.part.begin(), list.part.end(), same))
      parts.push_back(part);
  };
  bool vessels = false;
  for (const DrawPart& part : list.part) {
    if (isTissue(part.appearance)) add(part.appearance, true);
    vessels = vessels || part.appearance == Appearance::duct || part.appearance == Appearance::artery;
  }
  for (const Appearance a : {Appearance::insulation, Appearance::steel, Appearance::ceramic}) add(a, false);
  if (vessels)
    for (const Appearance a :
         {Appearance::titanium, Appearance::blood, Appearance::bile, Appearance::omentum, Appearance::bowel})
      add(a, false);
  return parts;
}

ScenePrograms::ScenePrograms(const GlFunctions& gl, Quality quality)
    : gl_(gl),
      choices_(quality == Quality::film ? glsl::filmChoices : glsl::interactiveChoices),
      shadow(gl, "shadow", {choices_, glsl::common, glsl::surfaceVertex}, {glsl::emptyFragment}),
      prepass(gl, "prepass", {choices_, glsl::common, glsl::surfaceVertex}, {glsl::prepassFragment}),
      surround(gl, "surround", {choices_, glsl::common, glsl::surroundVertex}, {glsl::surroundFragment}),
      sheet(gl, "sheet", {choices_, glsl::common, glsl::sheetVertex},
            {choices_, glsl::common, glsl::display, glsl::receiver, glsl::shadowLookup, glsl::sheetFragment}),
      smoke(gl, "smoke", {choices_, glsl::common, glsl::smokeVertex},
            {choices_, glsl::common, glsl::display, glsl::receiver, glsl::smokeFragment}),
      occlusion(gl, "occlusion", {glsl::pictureVertex}, {choices_, glsl::common, glsl::occlusionFragment}),
      backdrop(gl, "backdrop", {glsl::pictureVertex}, {glsl::backdropFragment}),
      blur(gl, "blur", {glsl::pictureVertex}, {choices_, glsl::blurFragment}),
      compose(gl, "compose", {glsl::pictureVertex}, {choices_, glsl::display, glsl::composeFragment}) {}

const ShaderProgram& ScenePrograms::surface(const DrawPart& part) {
  const int look = static_cast<int>(part.appearance);
  std::unique_ptr<ShaderProgram>& program = surface_[{look, part.harmed}];
  if (!program) {
    const std::string choice = fmt::format("#define LOOK {}\n#define HARMED {}\n", look, part.harmed ? 1 : 0);
    program = std::make_unique<ShaderProgram>(
        gl_, "surface",
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceVertex},
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceMaterial, glsl::display, glsl::receiver, glsl::shadowLookup,
                                           glsl::softShadow, glsl::surfaceFragment});
  }
  return *program;
}

SceneTextures::SceneTextures(const GlFunctions& gl) : gl_(gl) {
  const std::vector<float> volume = makeNoiseVolume();
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  const auto make = [&](GLuint& texture, GLint format, GLenum type, const void* texels, GLint filter) {
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(GL_TEXTURE_3D, texture);
    gl_.TexImage3D(GL_TEXTURE_3D, 0, format, noiseSide, noiseSide, noiseSide, 0, GL_RGBA, type, texels);
    if (filter != GL_LINEAR) gl_.GenerateMipmap(GL_TEXTURE_3D);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  };
  make(filmNoise_, GL_RGBA16F, GL_FLOAT, volume.data(), GL_LINEAR_MIPMAP_LINEAR);
  gl_.ActiveTexture(GL_TEXTURE0 + veinUnit);
  veins_ = makeFlat(GL_R8, GL_RED, veinSide, veinSide, makeVeinTexture());
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  make(interactiveNoise_, GL_RGBA8, GL_UNSIGNED_BYTE, asBytes(volume).data(), GL_LINEAR);
}

SceneTextures::~SceneTextures() {
  for (const GLuint texture : {filmNoise_, interactiveNoise_, fibres_, veins_}) gl_.DeleteTextures(1, &texture);
}

void SceneTextures::bindNoise(Quality quality) const {
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  gl_.BindTexture(GL_TEXTURE_3D, quality == Quality::film ? filmNoise_ : interactiveNoise_);
}

void SceneTextures::bindFibres() {
  gl_.ActiveTexture(GL_TEXTURE0 + fibreUnit);
  if (fibres_ != 0) {
    gl_.BindTexture(GL_TEXTURE_2D, fibres_);
    return;
  }
  fibres_ = makeFlat(GL_RGBA8, GL_RGBA, fibreColumns, fibreRows, makeFibreTexture());
}

GLuint SceneTextures::makeFlat(GLint kept, GLenum format, int columns, int rows,
                               const std::vector<std::uint8_t>& texels) const {
  GLuint texture = 0;
  gl_.GenTextures(1, &texture);
  gl_.BindTexture(GL_TEXTURE_2D, texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, kept, columns, rows, 0, format, GL_UNSIGNED_BYTE, texels.data());
  gl_.GenerateMipmap(GL_TEXTURE_2D);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

PictureTargets::PictureTargets(const GlFunctions& gl, int w, int h, Quality q)
    : width(w),
      height(h),
      quality(q),
      shadow(gl, shadowSide(w, h, q), shadowSide(w, h, q), {{}, true, false, q == Quality::interactive}),
      prepass(gl, coarse(w, q), coarse(h, q), {{GL_R32F, GL_RGBA8}, true}),
      open(gl, prepass.width() / occlusionStride(q), prepass.height() / occlusionStride(q), {{GL_RGBA8}}),
      smoothed(gl, open.width(), open.height(), {{GL_R8}, false, true}),
      radiance(gl, w * samplesAside(q), h * samplesAside(q), {{radianceFormat(q)}, true}) {
  if (q == Quality::film)
    picture = std::make_unique<RenderTarget>(gl, w, h, RenderTarget::Layout{{GL_RGBA8}});
  else
    backdrop = std::make_unique<RenderTarget>(gl, prepass.width(), prepass.height(),
                                              RenderTarget::Layout{{GL_RGBA8}, false, true, false, &prepass});
}

std::vector<float> makeNoiseVolume() {
  std::vector<float> volume;
  volume.reserve(4 * static_cast<std::size_t>(noiseSide) * noiseSide * noiseSide);
  constexpr double cellsPerTexel = static_cast<double>(noiseCells) / noiseSide;
  for (int z = 0; z < noiseSide; ++z)
    for (int y = 0; y < noiseSide; ++y)
      for (int x = 0; x < noiseSide; ++x) {
        const Vec3 p = (Vec3(x, y, z).array() + 0.5) * cellsPerTexel;
        const Index3 cell(static_cast<int>(p.x()), static_cast<int>(p.y()), static_cast<int>(p.z()));
        const Vec3 t = p - cell.cast<double>();
        double value = 0.0;
        Vec3 slope = Vec3::Zero();
        for (int corner = 0; corner < 8; ++corner) {
          const Index3 o(corner & 1, (corner >> 1) & 1, corner >> 2);
          const Vec3 g = latticeGradient(cell.x() + o.x(), cell.y() + o.y(), cell.z() + o.z());
          const double dot = g.dot(t - o.cast<double>());
          Vec3 weight, weightSlope;
          for (int a = 0; a < 3; ++a) {
            weight[a] = o[a] == 1 ? fade(t[a]) : 1.0 - fade(t[a]);
            weightSlope[a] = o[a] == 1 ? fadeSlope(t[a]) : -fadeSlope(t[a]);
          }
          const double w = weight.prod();
          value += w * dot;
          slope += w * g;
          slope.x() += weightSlope.x() * weight.y() * weight.z() * dot;
          slope.y() += weight.x() * weightSlope.y() * weight.z() * dot;
          slope.z() += weight.x() * weight.y() * weightSlope.z() * dot;
        }
        for (int a = 0; a < 3; ++a) volume.push_back(static_cast<float>(slope[a]));
        volume.push_back(static_cast<float>(value));
      }
  return volume;
}

std::vector<std::uint8_t> makeFibreTexture() {
  const Noise noise;
  std::vector<std::uint8_t> texture;
  texture.reserve(4 * static_cast<std::size_t>(fibreColumns) * fibreRows);
  for (int row = 0; row < fibreRows; ++row)
    for (int column = 0; column < fibreColumns; ++column) {
      // In cells; multiples of noiseCells over the whole texture, so that it repeats.
      const double s = noiseCells * (column + 0.5) / fibreColumns, t = noiseCells * (row + 0.5) / fibreRows;
      const auto bend = noise(s, t, 0.3), film = noise(2.0 * s, t, 6.2), tone = noise(2.0 * s, t, 4.4);
      const double bent = s + 0.45 * bend[3] + 0.10 * tone[3];
      const Fibre bundle = fibres(noise(2.0 * bent, t, 1.7), 0.14);
      const Fibre middle = fibres(noise(4.0 * s + 1.6 * bend[3] + 0.5 * film[3], t, 2.9), 0.12);
      const Fibre oblique = fibres(noise(3.0 * s + 2.0 * t + 0.8 * bend[3], t, 5.1), 0.07);
      const Fibre fine = fibres(noise(7.0 * s + 1.8 * bend[3] + 0.9 * film[3], 2.0 * t, 3.6), 0.20);
      const double strong = smoothstep(-0.35, 0.35, bend[3] + 0.4 * tone[3]);
      const double cover =
          std::max({bundle.cover * (0.55 + 0.45 * strong), 0.70 * middle.cover * (0.25 + 0.75 * strong),
                    0.55 * oblique.cover, 0.26 * fine.cover});
      const double slope = 0.5 * bundle.side * bundle.cover + 0.3 * middle.side * middle.cover +
                           0.2 * fine.side * fine.cover + 0.25 * film[0];
      const double thickness = 0.5 + 0.75 * film[3] + 0.25 * bend[3];
      texture.insert(texture.end(),
                     {byteOf(cover), byteOf(thickness), byteOf(0.5 + 0.5 * slope), byteOf(0.5 + 0.6 * tone[3])});
    }
  return texture;
}

std::vector<std::uint8_t> makeVeinTexture() {
  std::vector<std::uint8_t> texture(static_cast<std::size_t>(veinSide) * veinSide, 0);
  Random random(36, 5);
  const auto wayOf = [&](double radius) { return (fixed + reach * radius) * random.uniform(0.5, 1.4); };
  std::vector<Tip> growing;
  for (int i = 0; i < trunks; ++i) {
    const double up = i % 2 == 0 ? 0.5 * std::numbers::pi : -0.5 * std::numbers::pi;
    growing.push_back({veinSide * (i + random.uniform(0.2, 0.8)) / trunks,
                       veinSide * (i * 4 % trunks + random.uniform()) / trunks, up + random.uniform(-0.3, 0.3), 0.0,
                       widest * random.uniform(0.55, 1.0), 0.0});
    growing.back().left = wayOf(growing.back().radius);
    growing.back().gone = 0.0;
  }
  while (!growing.empty()) {
    Tip tip = growing.back();
    growing.pop_back();
    while (tip.radius > thinnest) {
      addDot(texture, tip.s, tip.t, tip.radius * std::min(1.0, 0.15 + tip.gone / emerging));
      tip.gone += step;
      // It meanders, and more the thinner it is.
      tip.bend = 0.93 * tip.bend + random.uniform(-0.010, 0.010) * (0.5 + 2.2 / tip.radius);
      tip.angle += tip.bend;
      tip.s += step * cosine(tip.angle);
      tip.t += step * sine(tip.angle);
      tip.radius *= 0.9993;
      tip.left -= step;
      if (tip.left > 0.0) continue;
      const double share = random.uniform(0.12, 0.42);  // of the cubes of the radii
      const double side = random.uniform() < 0.5 ? 1.0 : -1.0;
      Tip branch = tip;
      branch.radius = tip.radius * std::cbrt(share);
      branch.angle += side * random.uniform(0.5, 1.0);
      branch.bend = 0.0;
      branch.gone = 1e9;
      branch.left = wayOf(branch.radius);
      growing.push_back(branch);
      tip.radius *= std::cbrt(1.0 - share);
      tip.angle -= side * random.uniform(0.05, 0.35);
      tip.left = wayOf(tip.radius);
    }
  }
  return texture;
}

}  // namespace calot::gui
