// SPDX-License-Identifier: GPL-3.0-or-later
// What the pages say of the energised hook, over three meshes and three steps: times at one place, doses of sweeps, one
// reach for all tissue, cutting and coagulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr std::array<std::uint32_t, 3> steps{5, 10, 20};  // ms

/// A stiff block with a wall, the left hand's port high above its middle: the shaft is vertical.
SceneDescription stiffBlock(int squares) {
  SceneDescription scene = test::blockScene(300, squares);
  scene.organs[0].material.youngModulus = 1e6;
  scene.organs[0].burnThrough = 1.5;
  scene.hands[0].port = Vec3(0.0, 0.0, 0.3);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.04);
  scene.hands[0].instrument = InstrumentKind::hook;
  scene.hands[1].port = Vec3(0.1, 0.0, 0.3);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  return scene;
}

/// A duct of 4 mm and an artery of 1.8 mm, both straight and held at both ends, high above the block.
SceneDescription twoVessels(std::uint32_t elements) {
  SceneDescription scene = stiffBlock(6);
  VesselDescription v;
  v.name = "duct";
  v.role = StructureRole::cysticDuct;
  v.path = {Vec3(-0.02, 0.0, 0.04), Vec3(0.02, 0.0, 0.04)};
  v.radius = 0.002;
  v.wall = 0.001;
  v.elements = elements;
  v.material = {1e7, 0.45, 1050.0, 5.0, 0.01};
  v.start.kind = v.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(v);
  v.name = "artery";
  v.role = StructureRole::cysticArtery;
  v.path = {Vec3(-0.02, 0.02, 0.04), Vec3(0.02, 0.02, 0.04)};
  v.radius = 0.0009;
  scene.vessels.push_back(v);
  scene.hands[0].home = Vec3(0.0, 0.01, 0.08);
  return scene;
}

/// Drives the left hand's hook; keeps events and the last result.
class Hook {
 public:
  explicit Hook(const SceneDescription& scene)
      : model_(test::buildModel(scene)), rig_(*model_), tip_(scene.hands[0].home) {}

  /// Moves in a straight line from where it is. @param toe along x or y of W
  const StepResult& go(const Vec3& to, double seconds, std::uint8_t buttons, const Vec3& toe = Vec3::UnitX()) {
    const double h = model_->stepSeconds();
    const int count = std::max(1, static_cast<int>(std::lround(seconds / h)));
    const Vec3 from = tip_;
    const std::uint32_t ticks = model_->scene().ticksPerStep;
    for (int i = 0; i < count; ++i) {
      std::vector<TickSamples> samples(ticks);
      for (std::uint32_t k = 0; k < ticks; ++k) {
        const double s = (i + (k + 1.0) / ticks) / count;
        InstrumentSample& hand = samples[k].hand[0];
        hand.position = from + s * (to - from);
        Mat3 frame;  // z down, y along the toe
        frame.col(2) = -Vec3::UnitZ();
        frame.col(1) = toe;
        frame.col(0) = toe.cross(-Vec3::UnitZ());
        hand.orientation = Quat(frame);
        hand.instrument = InstrumentKind::hook;
        hand.buttons = buttons;
        samples[k].hand[1].position = model_->scene().hands[1].home;
        samples[k].camera = model_->scene().camera;
      }
      result_ = &rig_.stepper.step(rig_.state, samples);
      events_.insert(events_.end(), result_->events.begin(), result_->events.end());
      for (const HandResult& hand : result_->hand) {
        if (hand.cautery == Cautery::onTissue) ++onTissue_;
      }
    }
    tip_ = to;
    return *result_;
  }
  /// Time of current until an event of this kind; 0: none within `longest`.
  double until(EventKind kind, double longest, std::uint8_t buttons, const Vec3& toe = Vec3::UnitX()) {
    const double h = model_->stepSeconds();
    for (double t = h; t < longest; t += h) {
      go(tip_, h, buttons, toe);
      if (count(kind) > 0) return t;
    }
    return 0.0;
  }
  [[nodiscard]] int count(EventKind kind) const {
    return static_cast<int>(
        std::count_if(events_.begin(), events_.end(), [&](const Event& e) { return e.kind == kind; }));
  }
  [[nodiscard]] int stepsOnTissue() const { return onTissue_; }
  [[nodiscard]] const State& state() const { return rig_.state; }
  [[nodiscard]] const Model& model() const { return *model_; }

 private:
  std::unique_ptr<const Model> model_;
  test::Rig rig_;
  Vec3 tip_;
  std::vector<Event> events_;
  const StepResult* result_ = nullptr;
  int onTissue_ = 0;
};

std::uint8_t cut() { return button::cutPedal; }
std::uint8_t coagulate() { return button::coagulatePedal; }

/// Values that must agree, by mesh and step; prints them where they don't.
void expectAlike(const std::vector<double>& values, double tolerance) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  EXPECT_GT(*least, 0.0);
  EXPECT_LE(*most - *least, tolerance * *most) << testing::PrintToString(values);
}

/// The hook that stands on an organ opens its wall after burnThrough, however large the skin's triangles are.
TEST(CauteryScene, AWallOpensAfterTheDocumentedTime) {
  for (const int squares : {6, 12, 30}) {
    for (const std::uint32_t step : steps) {
      SceneDescription scene = stiffBlock(squares);
      scene.ticksPerStep = step;
      Hook hook(scene);
      hook.go(Vec3(0.001, 0.002, test::blockTop + 0.001), 0.4, 0);
      hook.go(Vec3(0.001, 0.002, test::blockTop - 0.0002), 0.2, 0);
      const double time = hook.until(EventKind::organPerforated, 5.0, cut());
      EXPECT_NEAR(time, scene.organs[0].burnThrough, 0.02 * scene.organs[0].burnThrough + 0.001 * step)
          << squares << " squares, " << step << " ms";
    }
  }
}

/// Charred area and dose of a still and of a moving hook, over meshes of the skin and steps.
TEST(CauteryScene, CharDependsOnNeitherMeshNorStep) {
  std::vector<double> still, swept, dose;
  for (const int squares : {6, 12, 30}) {
    for (const std::uint32_t step : steps) {
      SceneDescription scene = stiffBlock(squares);
      scene.ticksPerStep = step;
      Hook hook(scene);
      const double low = test::blockTop - 0.0002;
      hook.go(Vec3(-0.01, 0.002, test::blockTop + 0.001), 0.4, 0);
      hook.go(Vec3(-0.01, 0.002, low), 0.2, 0);
      still.push_back(hook.go(Vec3(-0.01, 0.002, low), 0.2, coagulate()).organ[0].charredArea);
      // Across the toe, with the current on all the way.
      hook.go(Vec3(-0.01, 0.012, low), 0.4, 0);
      const double before = hook.state().charred[0].area;
      const double after = hook.go(Vec3(0.01, 0.012, low), 1.0, coagulate(), Vec3::UnitY()).organ[0].charredArea;
      swept.push_back(after - before);
      double sum = 0.0;
      const CharState& burns = hook.state().charred[0];
      const OrganModel& organ = hook.model().organs()[0];
      for (std::size_t k = 0; k < burns.triangle.size(); ++k) {
        const std::size_t n = std::size_t{organ.division[burns.triangle[k]]} * organ.division[burns.triangle[k]];
        for (std::size_t c = 0; c < n; ++c) {
          sum += double{burns.exposure[burns.firstCell[k] + c]} * organ.triangleArea[burns.triangle[k]] /
                 static_cast<double>(n);
        }
      }
      dose.push_back(sum);
    }
  }
  expectAlike(still, 0.06);
  expectAlike(swept, 0.06);
  expectAlike(dose, 0.06);
}

/// A vessel is parted after burnThrough, and a sweep over it leaves a dose per length, for any number of elements.
TEST(CauteryScene, AVesselsDoseIsPerLength) {
  std::vector<double> dose;
  for (const std::uint32_t elements : {16U, 40U, 120U}) {
    for (const std::uint32_t step : steps) {
      SceneDescription scene = twoVessels(elements);
      scene.ticksPerStep = step;
      {
        Hook hook(scene);
        hook.go(Vec3(0.003, 0.0, 0.0430), 0.4, 0, Vec3::UnitY());
        hook.go(Vec3(0.003, -0.001, 0.0418), 0.2, 0, Vec3::UnitY());
        const double time = hook.until(EventKind::vesselBurned, 5.0, cut(), Vec3::UnitY());
        EXPECT_NEAR(time, scene.vessels[0].burnThrough, 0.02 + 0.001 * step) << elements << ", " << step << " ms";
      }
      Hook hook(scene);
      hook.go(Vec3(-0.01, 0.0, 0.0430), 0.4, 0, Vec3::UnitY());
      hook.go(Vec3(-0.01, -0.001, 0.0420), 0.2, 0, Vec3::UnitY());
      hook.go(Vec3(0.01, -0.001, 0.0420), 1.0, cut(), Vec3::UnitY());
      const BeamModel::Branch& duct = hook.model().vesselTrees()[0].beams.branches()[0];
      const BeamState& vessels = hook.state().vessel[0];
      // The middle of the way, where the sweep was whole.
      double sum = 0.0;
      for (std::size_t s = 0; s < duct.stations; ++s) {
        if (std::abs(duct.arcLengthOf(s) - 0.02) < 0.005) sum += vessels.exposure[s];
      }
      dose.push_back(sum);
      EXPECT_EQ(hook.count(EventKind::vesselBurned), 0);
    }
  }
  expectAlike(dose, 0.06);
}

/// All tissue is touched up to the documented reach of the metal, and none beyond.
TEST(CauteryScene, OneReachForAllTissue) {
  const double wire = 0.0006;
  SceneDescription scene = twoVessels(40);
  for (Vec3& p : scene.vessels[0].path) p[1] = 0.012;  // out of the shaft's way
  FatDescription fat;
  fat.name = "pad";
  fat.surface = test::boxSurface(Vec3(0.014, -0.006, test::blockTop + 0.0002), Vec3(0.026, 0.006, 0.022), {6, 6, 4});
  fat.cellSize = 0.001;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}};
  scene.fat.push_back(fat);
  OrganDescription pad = scene.organs[0];
  pad.name = "pad organ";
  pad.surface = test::boxSurface(Vec3(-0.03, -0.008, test::blockTop + 0.003), Vec3(-0.014, 0.008, 0.03), {6, 6, 6});
  pad.tetrahedra = 150;
  pad.anchors = {{Vec3(0.0, 0.0, 100.03 - 0.004), 100.0, "", 0.0}};
  scene.organs.push_back(pad);
  ConnectiveDescription bed;
  bed.name = "bed";
  bed.first = "pad organ";
  bed.second = "block";
  bed.reach = 0.004;
  bed.strands = 60;
  bed.fadeTime = 100.0;
  scene.connective.push_back(bed);
  const double reach = scene.cautery.reach;
  const struct {
    const char* tissue;
    Vec3 tip;  // where the metal would touch
    Vec3 off;  // and the way off
    Vec3 toe;
    double margin;  // of where the skin is: that of fat is drawn by its cells
  } places[] = {
      {"organ", Vec3(0.0, -0.015, test::blockTop), Vec3::UnitZ(), Vec3::UnitX(), 5e-5},
      {"vessel", Vec3(0.0, 0.010, 0.042), Vec3::UnitZ(), Vec3::UnitY(), 5e-5},
      {"fat", Vec3(0.018, 0.0, 0.022), Vec3::UnitZ(), Vec3::UnitX(), 1.5e-4},
      // The end of the toe, before the strands at the bed's edge.
      {"strands", Vec3(-0.014 + 0.0046 + wire, 0.0, test::blockTop + 0.0009), Vec3::UnitX(), -Vec3::UnitX(), 5e-5},
  };
  for (const auto& place : places) {
    for (const bool near : {true, false}) {
      const double off = reach + (near ? -place.margin : place.margin);
      const Vec3 tip = place.tip + off * place.off;
      scene.hands[0].port = Vec3(tip[0], tip[1], 0.3);
      scene.hands[0].home = tip + Vec3(0.0, 0.0, 0.03);
      Hook hook(scene);
      hook.go(tip + Vec3(0.0, 0.0, 0.012), 0.5, 0, place.toe);
      hook.go(tip, 0.5, 0, place.toe);
      hook.go(tip, 0.1, 0, place.toe);
      hook.go(tip, 0.05, coagulate(), place.toe);
      EXPECT_EQ(hook.stepsOnTissue() > 0, near) << place.tissue << ", " << 1e3 * off << " mm from the metal";
    }
  }
}

/// The cutting current divides faster and chars less; the coagulating one chars, and seals the small artery that it
/// divides, but never a duct.
TEST(CauteryScene, CutAndCoagulateDiffer) {
  const SceneDescription scene = twoVessels(40);
  double time[2];
  for (const bool cuts : {false, true}) {
    Hook hook(scene);
    const std::uint8_t current = cuts ? cut() : coagulate();
    hook.go(Vec3(0.0, 0.02, 0.0430), 0.5, 0, Vec3::UnitY());
    hook.go(Vec3(0.0, 0.018, 0.0408), 0.3, 0, Vec3::UnitY());
    time[cuts ? 1 : 0] = hook.until(EventKind::vesselBurned, 5.0, current, Vec3::UnitY());
    EXPECT_GT(time[cuts ? 1 : 0], 0.0);
    EXPECT_EQ(hook.count(EventKind::vesselSealed), cuts ? 0 : 1);
    EXPECT_EQ(hook.count(EventKind::cutOpen), cuts ? 1 : 0);
    Hook onDuct(scene);
    onDuct.go(Vec3(0.0, 0.0, 0.0430), 0.5, 0, Vec3::UnitY());
    onDuct.go(Vec3(0.0, -0.001, 0.0418), 0.3, 0, Vec3::UnitY());
    EXPECT_GT(onDuct.until(EventKind::vesselBurned, 5.0, current, Vec3::UnitY()), 0.0);
    EXPECT_EQ(onDuct.count(EventKind::vesselSealed), 0) << "a duct";
    EXPECT_EQ(onDuct.count(EventKind::cutOpen), 1);
  }
  EXPECT_NEAR(time[1] / time[0], scene.cautery.coagulationPace, 0.05);
  double area[2];
  for (const bool cuts : {false, true}) {
    Hook hook(stiffBlock(12));
    hook.go(Vec3(0.0, 0.002, test::blockTop + 0.001), 0.4, 0);
    hook.go(Vec3(0.0, 0.002, test::blockTop - 0.0002), 0.2, 0);
    area[cuts ? 1 : 0] =
        hook.go(Vec3(0.0, 0.002, test::blockTop - 0.0002), 0.2, cuts ? cut() : coagulate()).organ[0].charredArea;
  }
  EXPECT_NEAR(area[1] / area[0], scene.cautery.cutChar, 0.02);
}

/// Power that goes into more than `spot` is shared: a duct that is touched together with much of an organ takes longer.
TEST(CauteryScene, PowerIsSharedOverWhatIsTouched) {
  SceneDescription scene = stiffBlock(12);
  std::vector<double> exposure;
  for (const double spot : {8e-6, 2e-6}) {
    scene.cautery.spot = spot;
    Hook hook(scene);
    hook.go(Vec3(0.0, 0.002, test::blockTop + 0.001), 0.4, 0);
    hook.go(Vec3(0.0, 0.002, test::blockTop - 0.0002), 0.2, 0);
    exposure.push_back(hook.go(Vec3(0.0, 0.002, test::blockTop - 0.0002), 0.2, cut()).organ[0].wallExposure);
  }
  // The toe covers some 6 mm^2.
  EXPECT_NEAR(exposure[0], 0.2, 0.004);
  EXPECT_GT(exposure[0] / exposure[1], 2.0);
  EXPECT_LT(exposure[0] / exposure[1], 4.0);
}

/// A wall that is heated and not parted is told: once, with the length that was hurt.
TEST(CauteryScene, AWallIsInjuredBeforeItParts) {
  const SceneDescription scene = twoVessels(40);
  Hook hook(scene);
  hook.go(Vec3(0.0, 0.0, 0.0430), 0.5, 0, Vec3::UnitY());
  hook.go(Vec3(0.0, -0.001, 0.0418), 0.3, 0, Vec3::UnitY());
  const double time = hook.until(EventKind::wallInjured, 5.0, cut(), Vec3::UnitY());
  EXPECT_NEAR(time, scene.cautery.injury * scene.vessels[0].burnThrough, 0.03);
  const StepResult& later = hook.go(Vec3(0.0, -0.001, 0.0418), 0.2, cut(), Vec3::UnitY());
  EXPECT_EQ(hook.count(EventKind::wallInjured), 1);
  EXPECT_EQ(hook.count(EventKind::vesselBurned), 0);
  EXPECT_GT(later.vessel[0].injured, 0.0005);
  EXPECT_LT(later.vessel[0].injured, 0.003);
  EXPECT_EQ(later.vessel[1].injured, 0.0);
}

/// Fat recedes at the documented speed, in steps of any length.
TEST(CauteryScene, FatRecedesAtTheDocumentedSpeed) {
  std::vector<double> removed;
  for (const std::uint32_t step : steps) {
    SceneDescription scene = stiffBlock(6);
    FatDescription fat;
    fat.name = "pad";
    fat.surface = test::boxSurface(Vec3(-0.01, -0.01, test::blockTop + 0.0002), Vec3(0.01, 0.01, 0.030), {8, 8, 6});
    fat.cellSize = 0.00075;
    fat.attachments = {{"block", 0.0015, 2e7, 2e5}};
    fat.material.youngModulus = 1e5;
    scene.fat.push_back(fat);
    scene.ticksPerStep = step;
    scene.cautery.recession = 0.015;
    Hook hook(scene);
    hook.go(Vec3(-0.002, 0.0, 0.031), 0.3, 0);
    hook.go(Vec3(-0.002, 0.0, 0.0298), 0.3, 0);
    const double before = hook.go(Vec3(-0.002, 0.0, 0.0298), 0.2, 0).fat[0].volume;
    // The hand goes ahead of what it can carve.
    hook.go(Vec3(-0.002, 0.0, 0.022), 0.05, cut());
    const double after = hook.go(Vec3(-0.002, 0.0, 0.022), 0.25, cut()).fat[0].volume;
    removed.push_back(before - after);
  }
  expectAlike(removed, 0.12);  // it stands as far ahead in the fat as that recedes in a step
  // 0.3 s at 15 mm/s through a trench as wide as wire and reach, as long as the toe.
  const double trench = 0.3 * 0.015 * 0.0018 * 0.0052;
  EXPECT_GT(removed[0], 0.4 * trench);  // it gives way, too
  EXPECT_LT(removed[0], 1.2 * trench);
}

}  // namespace
}  // namespace calot
