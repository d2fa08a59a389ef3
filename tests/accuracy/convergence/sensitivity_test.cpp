// SPDX-License-Identifier: GPL-3.0-or-later
// How much does a figure depend on a constant of the scene? One performer's samples, open-loop, in the same scene with
// one constant at a time 30 % smaller and 30 % larger; scripts/sensitivity.sh prints the change of each figure of the
// paper's Table 2 and of each force figure.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "recorder/live/worker_pool.h"
#include "tests/accuracy/convergence/support/graded.h"

namespace calot::analytics {
namespace {

constexpr double change = 0.3;

/// A constant, by its name in docs/materials.md.
struct Constant {
  std::string name;
  std::function<bool(SceneDescription&, double)> multiply;  ///< false where the scene has none
};

OrganDescription* organOf(SceneDescription& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.organs.begin(), scene.organs.end(), [&](const auto& o) { return o.name == name; });
  return found == scene.organs.end() ? nullptr : &*found;
}

/// One of an organ.
Constant ofOrgan(const std::string& organ, const std::string& name,
                 const std::function<double&(OrganDescription&)>& of) {
  return {fmt::format("organs.{}.{}", organ, name), [organ, of](SceneDescription& scene, double factor) {
            OrganDescription* found = organOf(scene, organ);
            if (found == nullptr || of(*found) == 0.0) return false;
            of(*found) *= factor;
            return true;
          }};
}

/// One of every element of a list.
template <class Part>
Constant ofEach(const std::string& name, std::vector<Part> SceneDescription::*list,
                const std::function<double&(Part&)>& of) {
  return {name, [list, of](SceneDescription& scene, double factor) {
            for (Part& part : scene.*list) of(part) *= factor;
            return !(scene.*list).empty();
          }};
}

/// One of both hands.
Constant ofHands(const std::string& name, double HandDescription::*member) {
  return {"hands.*." + name, [member](SceneDescription& scene, double factor) {
            for (HandDescription& hand : scene.hands) hand.*member *= factor;
            return true;
          }};
}

Constant ofCautery(const std::string& name, double CauteryDescription::*member) {
  return {"cautery." + name, [member](SceneDescription& scene, double factor) {
            scene.cautery.*member *= factor;
            return true;
          }};
}

std::vector<Constant> constants() {
  using Organ = OrganDescription;
  using Bed = ConnectiveDescription;
  using Vessel = VesselDescription;
  using Fat = FatDescription;
  std::vector<Constant> all;
  for (const char* organ : {"liver", "gallbladder"}) {
    all.push_back(ofOrgan(organ, "material.youngModulus", [](Organ& o) -> double& { return o.material.youngModulus; }));
    all.push_back(
        ofOrgan(organ, "material.stiffnessDamping", [](Organ& o) -> double& { return o.material.stiffnessDamping; }));
    all.push_back(ofOrgan(organ, "material.density", [](Organ& o) -> double& { return o.material.density; }));
    all.push_back(ofOrgan(organ, "friction", [](Organ& o) -> double& { return o.friction; }));
    all.push_back(ofOrgan(organ, "burnThrough", [](Organ& o) -> double& { return o.burnThrough; }));
  }
  // Times 0.5 - nu, which compressibility goes with: nu itself may not reach one half.
  all.push_back({"organs.*.material.poissonRatio (0.5 - nu)", [](SceneDescription& scene, double factor) {
                   for (Organ& organ : scene.organs) {
                     organ.material.poissonRatio = 0.5 - factor * (0.5 - organ.material.poissonRatio);
                   }
                   return true;
                 }});
  all.push_back(ofEach<Bed>("connective.*.stiffness", &SceneDescription::connective,
                            [](Bed& b) -> double& { return b.stiffness; }));
  all.push_back(
      ofEach<Bed>("connective.*.damping", &SceneDescription::connective, [](Bed& b) -> double& { return b.damping; }));
  // With the separation at which it is torn, 2 G_c / sigma, as it was.
  all.push_back({"connective.*.strength", [](SceneDescription& scene, double factor) {
                   for (Bed& bed : scene.connective) {
                     bed.strength *= factor;
                     bed.fractureEnergy *= factor;
                   }
                   return !scene.connective.empty();
                 }});
  all.push_back(ofEach<Bed>("connective.*.fadeTime", &SceneDescription::connective,
                            [](Bed& b) -> double& { return b.fadeTime; }));
  all.push_back(ofEach<Vessel>("vessels.*.material.youngModulus", &SceneDescription::vessels,
                               [](Vessel& v) -> double& { return v.material.youngModulus; }));
  all.push_back(
      ofEach<Vessel>("vessels.*.wall", &SceneDescription::vessels, [](Vessel& v) -> double& { return v.wall; }));
  all.push_back(ofEach<Vessel>("vessels.*.ultimateStrain", &SceneDescription::vessels,
                               [](Vessel& v) -> double& { return v.ultimateStrain; }));
  all.push_back(ofEach<Vessel>("vessels.*.burnThrough", &SceneDescription::vessels,
                               [](Vessel& v) -> double& { return v.burnThrough; }));
  all.push_back(ofEach<Vessel>("vessels.*.friction", &SceneDescription::vessels,
                               [](Vessel& v) -> double& { return v.friction; }));
  all.push_back(ofEach<Fat>("fat.*.material.youngModulus", &SceneDescription::fat,
                            [](Fat& f) -> double& { return f.material.youngModulus; }));
  all.push_back(ofEach<Fat>("fat.*.friction", &SceneDescription::fat, [](Fat& f) -> double& { return f.friction; }));
  all.push_back({"fat.*.attachments.*.stiffness", [](SceneDescription& scene, double factor) {
                   for (Fat& fat : scene.fat) {
                     for (FatAttachmentDescription& attachment : fat.attachments) attachment.stiffness *= factor;
                   }
                   return !scene.fat.empty();
                 }});
  all.push_back(ofEach<RetractionDescription>("retraction.*.stiffness", &SceneDescription::retraction,
                                              [](RetractionDescription& r) -> double& { return r.stiffness; }));
  all.push_back(ofHands("couplingStiffness", &HandDescription::couplingStiffness));
  all.push_back(ofHands("slipForce", &HandDescription::slipForce));
  all.push_back(ofHands("tearForce", &HandDescription::tearForce));
  all.push_back(ofCautery("power", &CauteryDescription::power));
  all.push_back(ofCautery("reach", &CauteryDescription::reach));
  all.push_back(ofCautery("recession", &CauteryDescription::recession));
  all.push_back(ofCautery("coagulationPace", &CauteryDescription::coagulationPace));
  all.push_back(ofCautery("cutChar", &CauteryDescription::cutChar));
  all.push_back(ofCautery("spot", &CauteryDescription::spot));
  all.push_back(ofCautery("charTime", &CauteryDescription::charTime));
  return all;
}

/// Of the paper's Table 2, with the torn share beside the bed's remainder, or of force.
bool isShown(const std::string& name) {
  static const std::vector<std::string> shown = {
      "elapsed-time",         "path-length",     "fat-remaining", "cystic-contact-time",
      "connective-remaining", "connective-torn", "organ-burned",  "force-"};
  return std::any_of(shown.begin(), shown.end(), [&](const std::string& s) { return name.starts_with(s); });
}

struct Sensitivity {
  std::vector<std::string> constant;
  Graded base;
  std::vector<std::array<Graded, 2>> perturbed;  ///< 30 % smaller, 30 % larger

  [[nodiscard]] double value(const Graded& run, const std::string& figure) const {
    const auto found = run.values.find(figure);
    EXPECT_TRUE(found != run.values.end() && found->second.value) << figure;
    return found != run.values.end() && found->second.value ? *found->second.value : 0.0;
  }
};

/// Each run has a session of its own; runs share the processors.
Sensitivity sensitivity(const std::string& scene, double seconds, const std::vector<std::string>& names) {
  const std::vector<TickSamples> ticks = performedTicks(scene, seconds);
  Sensitivity out;
  std::vector<std::pair<std::string, SceneDescription>> runs{{scene, sceneOf(scene)}};
  for (const Constant& constant : constants()) {
    if (!names.empty() && std::find(names.begin(), names.end(), constant.name) == names.end()) continue;
    bool there = true;
    for (const double factor : {1.0 - change, 1.0 + change}) {
      SceneDescription description = sceneOf(scene);
      there = there && constant.multiply(description, factor);
      if (there) runs.emplace_back(fmt::format("{}, {} x {}", scene, constant.name, factor), std::move(description));
    }
    if (there) out.constant.push_back(constant.name);
  }
  std::vector<Graded> results(runs.size());
  recorder::WorkerPool pool(0);
  pool.run(runs.size(), [&](std::size_t i) { results[i] = graded(runs[i].first, runs[i].second, ticks); });
  out.base = std::move(results[0]);
  for (std::size_t i = 1; i < results.size(); i += 2)
    out.perturbed.push_back({std::move(results[i]), std::move(results[i + 1])});
  return out;
}

std::string changeOf(const Graded& run, const std::string& name, double base) {
  const auto found = run.values.find(name);
  if (found == run.values.end() || !found->second.value) return "none";
  if (*found->second.value == base) return "same";
  if (base == 0.0) return fmt::format("{:.3g}", *found->second.value);
  return fmt::format("{:+.1f} %", 100.0 * (*found->second.value / base - 1.0));
}

/// A line for each constant and figure that changes, sorted by constant.
void print(const std::string& scene, double seconds, const Sensitivity& s) {
  std::printf(
      "\n### %s, at most %g s\n\n| constant | figure | value | -30 %% | +30 %% |\n| --- | --- | --- | --- | --- |\n",
      scene.c_str(), seconds);
  for (std::size_t i = 0; i < s.constant.size(); ++i) {
    bool any = false;
    for (const auto& [name, value] : s.base.values) {
      if (!isShown(name) || !value.value) continue;
      const std::string smaller = changeOf(s.perturbed[i][0], name, *value.value);
      const std::string larger = changeOf(s.perturbed[i][1], name, *value.value);
      if (smaller == "same" && larger == "same") continue;
      any = true;
      std::printf("| `%s` | %s | %.4g %s | %s | %s |\n", s.constant[i].c_str(), name.c_str(), *value.value,
                  value.unit.c_str(), smaller.c_str(), larger.c_str());
    }
    if (!any) std::printf("| `%s` | every figure | | same | same |\n", s.constant[i].c_str());
  }
}

/// A softer bed is held with less force, a stiffer one with more; skin that chars in less time is burned more.
TEST(Sensitivity, HasTheRightSign) {
  const double seconds = 12.0;
  const Sensitivity s = sensitivity("dissect-bed", seconds, {"connective.*.stiffness", "cautery.charTime"});
  print("dissect-bed", seconds, s);
  ASSERT_EQ(s.constant, (std::vector<std::string>{"connective.*.stiffness", "cautery.charTime"}));
  const auto value = [&](const Graded& run, const std::string& figure) { return s.value(run, figure); };
  const double force = value(s.base, "force-mean left");
  EXPECT_LT(value(s.perturbed[0][0], "force-mean left"), force);
  EXPECT_GT(value(s.perturbed[0][1], "force-mean left"), force);
  const double burned = value(s.base, "organ-burned gallbladder");
  EXPECT_GT(value(s.perturbed[1][0], "organ-burned gallbladder"), burned);
  EXPECT_LT(value(s.perturbed[1][1], "organ-burned gallbladder"), burned);
  EXPECT_EQ(value(s.perturbed[0][0], "path-length left"), value(s.base, "path-length left")) << "open loop";
}

class SensitivityHeavy : public testing::TestWithParam<const char*> {};

TEST_P(SensitivityHeavy, OfEveryFigure) {
  const char* heavy = std::getenv("CALOT_HEAVY");
  if (heavy == nullptr) GTEST_SKIP() << "set CALOT_HEAVY (to so many seconds of an attempt, or to 1 for all of it)";
  const double seconds = std::atof(heavy) > 1.0 ? std::atof(heavy) : 300.0;
  const Sensitivity s = sensitivity(GetParam(), seconds, {});
  print(GetParam(), seconds, s);
  EXPECT_GT(s.constant.size(), 10U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SensitivityHeavy,
                         testing::Values("dissect-bed", "carve-fat", "clip-and-cut", "cholecystectomy"),
                         [](const auto& which) {
                           std::string name = which.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace calot::analytics
