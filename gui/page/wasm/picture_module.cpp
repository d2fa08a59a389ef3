// SPDX-License-Identifier: GPL-3.0-or-later
// The renderer as a WebAssembly module: an engine's scene view to pixels. Its OpenGL is the host's.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gui/page/wasm/thrown.h"
#include "gui/render/draw_list.h"
#include "gui/render/every_look.h"
#include "gui/render/gl_objects.h"
#include "gui/render/graphics.h"
#include "gui/render/scene_painter.h"
#include "gui/render/translucent.h"
#include "gui/render/view_check.h"
#include "recorder/engine/fallen_clips.h"
#include "recorder/engine/wire.h"
#include "sim/scene/scene_view.h"

extern "C" {
#define CALOT_GL_IMPORT(Name) __attribute__((import_module("gl"), import_name(#Name))) decltype(gl##Name) gl##Name;
CALOT_GL_FUNCTIONS(CALOT_GL_IMPORT)
#undef CALOT_GL_IMPORT
}

namespace {

using namespace calot;

/// A context whose functions are the host's: WebGL 2, under the names that OpenGL has for them.
class WebContext final : public gui::GraphicsContext {
 public:
  void makeCurrent() override {}
  [[nodiscard]] Function function(const char* name) const override {
    const std::string_view wanted = name;
#define CALOT_GL_FIND(Name) \
  if (wanted == "gl" #Name) return reinterpret_cast<Function>(&gl##Name);
    CALOT_GL_FUNCTIONS(CALOT_GL_FIND)
#undef CALOT_GL_FIND
    return nullptr;
  }
  [[nodiscard]] const char* way() const override { return "WebGL"; }
};

struct Pictures {
  WebContext context;
  gui::ScenePainter painter{context};
  std::array<gui::DrawListMaker, 2> lists;  ///< the endoscope's, and another camera's: both remember surfaces
  SceneView view;
  Vec3 down = SceneView().down;  ///< of the scene, which no view of an engine contains
  ClipDescription clip;          ///< likewise
  std::vector<gui::Puff> smoke;
};

Pictures& pictures() {
  static Pictures one;
  return one;
}

gui::RenderSettings settingsOf(bool film, bool mask) {
  return {.quality = film ? gui::Quality::film : gui::Quality::interactive, .endoscopeMask = mask};
}

/// Draws into the framebuffer that is bound.
void draw(gui::DrawListMaker& lists, const SceneView& view, int width, int height,
          const gui::RenderSettings& settings) {
  const double field = view.verticalFieldOfView;
  const gui::Sight sight = gui::sightOf(width, height, field, settings.endoscopeMask);
  Pictures& p = pictures();
  p.painter.draw(lists.make(view, sight, settings.cavity, p.smoke), sight, field, width, height, settings);
}

/// Pivot of another camera, and the radius of the visible scene around it.
std::array<double, 4>& extent() {
  static std::array<double, 4> centreAndRadius{};
  return centreAndRadius;
}

}  // namespace

extern "C" {

/// Makes ready what draws.
__attribute__((export_name("calot_warm"))) void calot_warm() {
  const SceneView view = gui::everyLook();
  gui::DrawListMaker lists;
  draw(lists, view, 64, 64, settingsOf(false, true));
}

/// Gravity of the scene whose views are to come; three zeros: none.
__attribute__((export_name("calot_gravity"))) void calot_gravity(double x, double y, double z) {
  pictures().down = downOf(Vec3(x, y, z));
}

/// Width and length of the scene's clips (m); not a number: the usual one.
__attribute__((export_name("calot_clips"))) void calot_clips(double width, double legs) {
  const ClipDescription usual;
  pictures().clip.width = width > 0.0 ? width : usual.width;
  pictures().clip.legs = legs > 0.0 ? legs : usual.legs;
}

/// Takes the placed payload of an engine's scene view. @return 1, or 0 if it is invalid
__attribute__((export_name("calot_view"))) int calot_view() {
  recorder::wire::View wire;
  SceneView view;
  if (!recorder::decode(page::placed(), wire) || !recorder::wire::fromWire(std::move(wire), view)) return 0;
  gui::checkView(view);
  view.down = pictures().down;
  pictures().view = std::move(view);
  pictures().smoke.clear();
  return 1;
}

/// Smoke and clips that fell, which a view does not hold. Placed is the list of their events, each of the protocol's
/// form. @return as above
__attribute__((export_name("calot_traces"))) int calot_traces(double stepSeconds) {
  std::vector<recorder::wire::Event> events;
  if (!recorder::decode(page::placed(), events)) return 0;
  gui::SmokeTrail trail;
  recorder::FallenClips fallen(pictures().clip, stepSeconds);
  // Events of one step belong together: a puff's number counts within its step.
  for (std::size_t i = 0; i < events.size();) {
    std::vector<Event> together;
    const std::uint64_t step = events[i].step;
    for (; i < events.size() && events[i].step == step; ++i) together.push_back(recorder::wire::fromWire(events[i]));
    trail.add(static_cast<double>(step + 1) * stepSeconds, together);
    for (const Event& event : together) fallen.add(event);
  }
  pictures().smoke = trail.at(pictures().view.time);
  gui::checkSmoke(pictures().smoke);
  fallen.show(pictures().view);
  return 1;
}

/// Four f8: centre (m, in W) and radius of the smallest structure's neighbourhood, the middle of the operation.
__attribute__((export_name("calot_extent"))) const double* calot_extent() {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  const SceneView& view = pictures().view;
  const auto take = [&](const SurfaceView& s) {
    for (const Vec3& p : s.position) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  };
  for (const SurfaceView& s : view.surface)
    if (s.role == StructureRole::gallbladder) take(s);
  if (low.x() > high.x())
    for (const SurfaceView& s : view.surface) take(s);
  if (low.x() > high.x()) low = high = Vec3::Zero();
  const Vec3 centre = 0.5 * (low + high);
  extent() = {centre.x(), centre.y(), centre.z(), 0.5 * (high - low).norm()};
  return extent().data();
}

/// The view's own camera: position, orientation (w x y z), vertical field of view.
__attribute__((export_name("calot_camera"))) const double* calot_camera() {
  static std::array<double, 8> camera;
  const SceneView& view = pictures().view;
  const Quat& q = view.camera.orientation;
  const Vec3& p = view.camera.position;
  camera = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), view.verticalFieldOfView};
  return camera.data();
}

/// Draws with the view's own camera into the framebuffer that is bound then. @param film 1: film quality
__attribute__((export_name("calot_endoscope"))) void calot_endoscope(int width, int height, int film, int mask) {
  gui::checkPictureSize(width, height);
  draw(pictures().lists[0], pictures().view, width, height, settingsOf(film == 1, mask == 1));
}

/// Draws with another camera: placed are position, orientation (w x y z) and vertical field of view, eight f8.
__attribute__((export_name("calot_orbit"))) int calot_orbit(int width, int height, int film) {
  std::array<double, 8> camera{};
  if (!recorder::decode(page::placed(), camera)) return 0;
  Pictures& p = pictures();
  gui::checkPictureSize(width, height);
  const CameraSample own = p.view.camera;
  const double field = p.view.verticalFieldOfView;
  p.view.camera = {Vec3(camera[0], camera[1], camera[2]), Quat(camera[3], camera[4], camera[5], camera[6])};
  p.view.verticalFieldOfView = camera[7];
  draw(p.lists[1], p.view, width, height, settingsOf(film == 1, false));
  p.view.camera = own;
  p.view.verticalFieldOfView = field;
  return 1;
}

}  // extern "C"
